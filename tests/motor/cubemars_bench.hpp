#pragma once

#include <array>
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/byte_order.hpp"
#include "support/cubemars_settings.hpp"

namespace rc10::test::cubemars_bench {

using std::chrono::milliseconds;

inline constexpr double kPi = 3.14159265358979323846;

/// One motor, fed by hand, a millisecond per tick.
template <typename Motor>
class Bench {
 public:
  explicit Bench(const MotorSettings& settings)
      : settings_(settings), motor_(settings, setupOf(settings)), ranges_(setupOf(settings).ranges) {}

  [[nodiscard]] Motor& motor() { return motor_; }

  FrameVerdict feedServo(double degrees, double erpm = 0.0, double amperes = 0.0, int temperature_c = 30,
                         std::uint8_t error = 0, Duration after = milliseconds{1}) {
    now_ += after;
    return motor_.updateFeedback(servoFrame(degrees, erpm, amperes, temperature_c, error));
  }
  [[nodiscard]] CanFrame servoFrame(double degrees, double erpm, double amperes, int temperature_c,
                                    std::uint8_t error) const {
    std::array<std::uint8_t, 8> data{};
    writeBigEndian(data, 0, static_cast<std::int16_t>(std::lround(degrees * 10.0)));
    writeBigEndian(data, 2, static_cast<std::int16_t>(std::lround(erpm / 10.0)));
    writeBigEndian(data, 4, static_cast<std::int16_t>(std::lround(amperes * 100.0)));
    data[6] = static_cast<std::uint8_t>(temperature_c);
    data[7] = error;
    CanFrame frame = makeClassicFrame({0x2900U + static_cast<std::uint32_t>(settings_.id), true}, data);
    frame.received = now_;
    return frame;
  }
  FrameVerdict feedMit(double rad, double rad_s = 0.0, double nm = 0.0, std::uint8_t error = 0,
                       Duration after = milliseconds{1}) {
    now_ += after;
    CanFrame frame = mitReply(rad, rad_s, nm, error);
    return motor_.updateFeedback(frame);
  }
  /// Answers of a drive that stands at 0.
  void answer(int times) {
    for (int i = 0; i < times; ++i) (void)feedMit(0.0);
  }
  /// This code of the position, standing.
  FrameVerdict feedCode(std::uint16_t code) {
    now_ += milliseconds{1};
    CanFrame frame = mitReply(0.0, 0.0, 0.0, 0);
    writeBigEndian(frame.data, 1, code);
    return motor_.updateFeedback(frame);
  }
  [[nodiscard]] CanFrame mitReply(double rad, double rad_s, double nm, std::uint8_t error) const {
    const auto code = [](double value, double reach, double last) {
      return static_cast<unsigned>(std::lround((value + reach) / (2 * reach) * last));
    };
    const unsigned p = code(rad, ranges_.position_rad, 65535);
    const unsigned v = code(rad_s, ranges_.velocity_rad_s, 4095);
    const unsigned t = code(nm, ranges_.torque_nm, 4095);
    const std::array<std::uint8_t, 8> data{static_cast<std::uint8_t>(settings_.id),
                                           static_cast<std::uint8_t>(p >> 8U),
                                           static_cast<std::uint8_t>(p & 0xFFU),
                                           static_cast<std::uint8_t>(v >> 4U),
                                           static_cast<std::uint8_t>((v & 0xFU) << 4U | t >> 8U),
                                           static_cast<std::uint8_t>(t & 0xFFU),
                                           70,
                                           error};
    CanFrame frame = makeClassicFrame({0, false}, data);
    frame.received = now_;
    return frame;
  }
  /// Its frame in a tick at the present time.
  std::vector<CanFrame> tick(FrameKind kind) {
    motor_.order(kind);
    return tick();
  }
  std::vector<CanFrame> tick() {
    const Tick tick{.index = ++ticks_, .now = now_, .dt_s = 0.001F};
    motor_.update(tick);
    std::array<CanFrame, kMaxFramesPerPacker> out{};
    const auto count = motor_.packCommand(tick, out);
    return {out.begin(), out.begin() + static_cast<std::ptrdiff_t>(count)};
  }
  CanFrame command(const Target& target) {
    motor_.order(FrameKind::kCommand, target);
    const auto frames = tick();
    EXPECT_EQ(frames.size(), 1U);
    return frames.empty() ? CanFrame{} : frames.front();
  }
  void pass(Duration duration) { now_ += duration; }

  /// The fields of a MIT command, as numbers.
  [[nodiscard]] SpringLaw decode(const CanFrame& frame) const {
    const auto& d = frame.data;
    const auto number = [](unsigned code, double low, double high, double last) {
      return low + (high - low) * code / last;
    };
    const auto& r = ranges_;
    if (frame.id.extended) {
      return {.position_rad = number(d[3] * 256U + d[4], -r.position_rad, r.position_rad, 65535),
              .velocity_rad_s = number(d[5] * 16U + d[6] / 16U, -r.velocity_rad_s, r.velocity_rad_s, 4095),
              .stiffness_nm_per_rad = number(d[0] * 16U + d[1] / 16U, 0, 500, 4095),
              .damping_nms_per_rad = number((d[1] & 15U) * 256U + d[2], 0, 5, 4095),
              .torque_nm = number((d[6] & 15U) * 256U + d[7], -r.torque_nm, r.torque_nm, 4095)};
    }
    return {.position_rad = number(d[0] * 256U + d[1], -r.position_rad, r.position_rad, 65535),
            .velocity_rad_s = number(d[2] * 16U + d[3] / 16U, -r.velocity_rad_s, r.velocity_rad_s, 4095),
            .stiffness_nm_per_rad = number((d[3] & 15U) * 256U + d[4], 0, 500, 4095),
            .damping_nms_per_rad = number(d[5] * 16U + d[6] / 16U, 0, 5, 4095),
            .torque_nm = number((d[6] & 15U) * 256U + d[7], -r.torque_nm, r.torque_nm, 4095)};
  }
  /// To half a step of its torque.
  [[nodiscard]] bool isNoTorque(const CanFrame& frame) const {
    const auto law = decode(frame);
    return law.stiffness_nm_per_rad == 0.0 && law.damping_nms_per_rad == 0.0 &&
           std::abs(law.torque_nm) <= ranges_.torque_nm / 4095;
  }
  /// The drive's torque for it at this position and speed.
  [[nodiscard]] double sumNm(const CanFrame& frame, double rad, double rad_s) const {
    const auto c = decode(frame);
    return c.stiffness_nm_per_rad * (c.position_rad - rad) +
           c.damping_nms_per_rad * (c.velocity_rad_s - rad_s) + c.torque_nm;
  }

 private:
  MotorSettings settings_;
  Motor motor_;
  CubemarsRanges ranges_;
  MonotonicTime now_{std::chrono::hours{1}};
  std::uint64_t ticks_ = 0;
};

using Servo = Bench<CubemarsServo>;
using Mit = Bench<CubemarsMit>;

inline MotorSettings servo(const OwnKeys& keys = {}) { return cubemarsSettings("AK80-9", 5, keys); }
inline MotorSettings mit(OwnKeys keys = {}) {
  keys.emplace_back("protocol", std::string{"mit"});
  return cubemarsSettings("AK80-9", 5, keys);
}
inline MotorSettings mitV3(OwnKeys keys = {}) {
  keys.emplace_back("protocol", std::string{"mit_v3"});
  return cubemarsSettings("AK80-8-V3", 5, keys);
}

inline std::int32_t int32Of(const CanFrame& frame) { return readBigEndian<std::int32_t>(frame.payload(), 0); }

inline bool isCurrentZero(const CanFrame& frame) {
  return frame.id == CanId{0x105, true} && frame.length == 4 && int32Of(frame) == 0;
}
inline bool isExit(const CanFrame& frame) { return frame.id == CanId{5, false} && frame.data[7] == 0xFD; }
inline bool isEnter(const CanFrame& frame) { return frame.id == CanId{5, false} && frame.data[7] == 0xFC; }

}  // namespace rc10::test::cubemars_bench
