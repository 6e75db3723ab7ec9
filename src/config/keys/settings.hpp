#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/keys/key_table.hpp"
#include "config/yaml/yaml_node.hpp"

namespace rc10 {

/// A value that is given and was not refused, with where it stands.
struct GivenValue {
  const YamlNode* node = nullptr;
  std::string path;

  [[nodiscard]] SourcePlace place() const noexcept { return node->place; }
  [[nodiscard]] const std::string& text() const noexcept { return node->text; }
};

/// The keys of one checked section, where a motor's own stand over those of its profile. Points into the
/// document, which must live longer.
class Settings {
 public:
  struct Layer {
    const YamlNode* map = nullptr;
    std::string path;
  };

  explicit Settings(std::vector<Layer> layers) : layers_(std::move(layers)) {}

  /// The value in force.
  [[nodiscard]] std::optional<GivenValue> find(std::string_view key) const;
  /// Whether the key is written anywhere, refused or not: then its absence need not be reported.
  [[nodiscard]] bool mentions(std::string_view key) const noexcept;
  /// The section under this key, of all layers that have it.
  [[nodiscard]] Settings section(std::string_view key) const;

  /// These leave `value` alone if the key is not given.
  void read(std::string_view key, std::string& value) const;
  void read(std::string_view key, bool& value) const;
  void read(std::string_view key, int& value) const;
  void read(std::string_view key, std::uint64_t& value) const;
  void read(std::string_view key, float& value) const;
  void read(std::string_view key, double& value) const;

  [[nodiscard]] std::string text(std::string_view key) const;
  [[nodiscard]] std::optional<double> number(std::string_view key) const;
  [[nodiscard]] const std::vector<Layer>& layers() const noexcept { return layers_; }

 private:
  std::vector<Layer> layers_;
};

}  // namespace rc10
