#pragma once

#include <algorithm>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "fake_robot.hpp"
#include "module/dbus_protocol.hpp"
#include "module/remote.hpp"

namespace rc10::test {

class RemoteTarget : public Module_Base {
 public:
  RemoteTarget() : Module_Base({.inputs = {"vx_m_s", "frame"}, .outputs = {}, .events = {}}) {}
  void update(const Tick&, ModuleRobot&) noexcept override {}
};

inline OwnValues remoteRow(std::initializer_list<std::pair<const char*, OwnValues::Value>> values) {
  OwnValues row;
  for (const auto& [key, value] : values) row.set(key, value);
  return row;
}

inline ModuleSettings remoteSettings(const std::string& protocol, const std::string& channel,
                                     const std::string& arm) {
  ModuleSettings settings;
  settings.name = "remote";
  auto& own = settings.own;
  own.set("port", std::string{"/dev/ttyX"});
  own.set("protocol", protocol);
  own.set("lost_ms", 100.0);
  own.set("disable_s", 1.0);
  if (!arm.empty()) own.set("arm_channel", arm);
  own.set("arm_above", 0.5);
  own.set(
      "sticks",
      std::vector{remoteRow(
          {{"channel", channel}, {"to", std::string{"base.vx_m_s"}}, {"scale", 2.0}, {"deadband", 0.1}})});
  own.set("constants", std::vector{remoteRow({{"to", std::string{"base.frame"}}, {"value", 2.0}})});
  return settings;
}

/// A remote whose frames come every 14 ms, as long as the test lets them.
class RemoteBench : public ::testing::Test {
 protected:
  void build(const ModuleSettings& settings) {
    module_ = std::move(remoteType().build(settings, outlineOf(2)).value());
    auto need = module_->takeSerialNeed();
    ASSERT_TRUE(need.has_value());
    protocol_ = std::move(need->protocol);
    const RemoteTarget base;
    ASSERT_TRUE(module_->connect(ModuleDirectory{{{"base", &base}}}).has_value());
  }
  void build() { build(remoteSettings("dbus", "right_y", "left_switch")); }

  void run(int ticks, bool talks = true) {
    for (int i = 0; i < ticks; ++i) {
      if (talks && ++since_frame_ >= 14) {
        since_frame_ = 0;
        const auto frame = DbusProtocol::encode(dbus_);
        protocol_->parse_stream(frame, robot_.now());
      }
      robot_.update(*module_);
      asked_.insert(asked_.end(), robot_.asked().begin(), robot_.asked().end());
      events_.insert(events_.end(), robot_.events().begin(), robot_.events().end());
    }
  }
  void armSwitch(Dr16Input::Switch position) {
    dbus_.left_switch = position;
    run(60);  // four frames: the first one only shows where frames begin
  }
  void arm() {
    armSwitch(Dr16Input::Switch::kDown);
    armSwitch(Dr16Input::Switch::kUp);
  }
  void loseLinkWhileArmed(MotorStatus status) {
    build();
    robot_.motor(0).status = status;
    arm();
    run(300, false);
    asked_.clear();
  }
  double armed() { return module_->outputs()[1]; }
  double shown(std::string_view output) {
    const auto& names = module_->signals().outputs;
    const auto place = std::find(names.begin(), names.end(), output) - names.begin();
    return module_->outputs()[static_cast<std::size_t>(place)];
  }
  bool asks(RobotRequest request) {
    return std::any_of(asked_.begin(), asked_.end(),
                       [&](const auto& asked) { return asked.request == request; });
  }
  /// Motors that it has asked to disable.
  std::size_t disablings() {
    return static_cast<std::size_t>(std::count_if(
        asked_.begin(), asked_.end(), [](const auto& a) { return a.request == RobotRequest::kDisable; }));
  }

  FakeRobot robot_{2};
  std::unique_ptr<Module_Base> module_;
  std::unique_ptr<I_Protocol> protocol_;
  Dr16Input dbus_;
  int since_frame_ = 0;
  std::vector<FakeRobot::Asked> asked_;
  std::vector<std::size_t> events_;
};

}  // namespace rc10::test
