#include "config/module_motors.hpp"

namespace rc10 {
namespace {

void collectMotors(const OwnValues& own, std::span<const OwnKey> keys, std::vector<std::size_t>& motors) {
  for (const OwnKey& key : keys) {
    const bool nested = key.kind == OwnKey::Kind::kSection || key.kind == OwnKey::Kind::kRows;
    if (!own.given(key.name)) continue;
    if (key.kind == OwnKey::Kind::kMotor) motors.push_back(own.motor(key.name));
    if (!nested) continue;
    for (const OwnValues& row : own.rows(key.name)) collectMotors(row, key.keys, motors);
  }
}

}  // namespace

std::vector<std::size_t> motorsNamedBy(const ModuleConfig& module) {
  std::vector<std::size_t> motors;
  if (module.type != nullptr) collectMotors(module.settings.own, module.type->keys(), motors);
  return motors;
}

}  // namespace rc10
