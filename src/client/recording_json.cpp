#include "client/recording_json.hpp"

#include <array>

#include "app/vocabulary.hpp"
#include "client/candump_line.hpp"
#include "client/json_line.hpp"
#include "client/recording_text.hpp"
#include "client/recording_words.hpp"
#include "link/event_text.hpp"
#include "link/words.hpp"

namespace rc10::client {
namespace {

using namespace blackbox;

template <std::size_t N>
[[nodiscard]] const char* word(const std::array<const char*, N>& words, std::size_t index) {
  return index < N ? words[index] : "unknown";
}

/// Adds to the line what each kind of record says.
class Writer {
 public:
  explicit Writer(const Recording& recording) : recording_(recording) {}

  Json line(const Record& record) {
    const auto& header = headerOf(record);
    json_ = {{"utime", recording_.wallUs(header.time_ns)}, {"mono_us", header.time_ns / 1000}};
    std::visit([this](const auto& r) { add(r); }, record);
    return std::move(json_);
  }

 private:
  void add(const Frame& r) {
    const bool sent = (r.header.flags & kFrameSent) != 0;
    json_["kind"] = "frame";
    json_["bus"] = recording_.busName(r.header.source);
    json_["direction"] = sent ? "sent" : "received";
    if (sent) json_["accepted"] = (r.header.flags & kFrameRefused) == 0;
    if ((r.header.id & kIdError) != 0) json_["error"] = true;
    json_["frame"] = frameText(r);
  }

  void add(const Command& r) {
    json_["kind"] = "command";
    json_["verdict"] = word(kVerdictWords, r.header.flags);
    json_["client"] = r.client.view();
    json_["session"] = r.session;
    json_["priority"] = r.priority;
    json_["valid_until_mono_us"] = r.deadline_ns / 1000;
    json_["setpoints"] = r.header.id;
  }

  void add(const Setpoint& r) {
    const auto mode = static_cast<ControlMode>(r.header.id);
    json_["kind"] = "setpoint";
    json_["motor"] = recording_.motorName(r.header.source);
    json_["mode"] = toString(mode);
    json_["value"] = r.value;
    json_["skipped"] = (r.header.flags & kSetpointSkipped) != 0;
    if (r.header.words * kWord <= kPlainSetpointBytes) return;
    json_["velocity_ff_rpm"] = shortest(r.velocity_ff_rpm);
    json_["torque_ff_nm"] = shortest(r.torque_ff_nm);
    json_["stiffness_nm_per_rad"] = shortest(r.stiffness_nm_per_rad);
    json_["damping_nms_per_rad"] = shortest(r.damping_nms_per_rad);
  }

  void add(const Signals& r) {
    json_["kind"] = "signals";
    json_["verdict"] = word(kVerdictWords, r.header.flags);
    json_["module"] = recording_.moduleName(r.header.source);
    json_["client"] = r.client.view();
    json_["session"] = r.session;
    json_["priority"] = r.priority;
    json_["valid_until_mono_us"] = r.deadline_ns / 1000;
    Json inputs = Json::object();
    std::size_t next = 0;
    for (std::size_t input = 0; input < link::kMaxSignals; ++input) {
      if ((r.header.id >> input & 1U) == 0) continue;
      inputs[std::string(recording_.inputName(r.header.source, input))] = r.values[next++];
    }
    json_["inputs"] = std::move(inputs);
  }

  void add(const Order& r) {
    json_["kind"] = "request";
    json_["operation"] = toString(static_cast<Operation>(r.header.flags));
    Json motors = Json::array();
    for (std::size_t i = 0; i < recording_.header().motor_count; ++i) {
      if ((r.motors[i / 64] >> (i % 64) & 1U) != 0) motors.push_back(recording_.motorName(i));
    }
    json_["motors"] = std::move(motors);
    json_["value"] = r.value;
    json_["client"] = r.client.view();
    json_["whole_robot"] = r.header.source != 0;
  }

  void add(const Event& r) {
    json_["kind"] = "event";
    json_["severity"] = toString(Severity{r.header.flags});
    json_["code"] = static_cast<std::int32_t>(r.header.id);
    json_["source"] = recording_.sourceName(r);
    json_["client"] = r.client.view();
    json_["text"] = eventText(recording_, r);
  }

  void add(const Motor& r) {
    json_["kind"] = "motor";
    json_["motor"] = recording_.motorName(r.header.source);
    json_["status"] = toString(MotorStatus{r.header.flags});
    json_["fault"] = r.fault;
    json_["fault_text"] = link::faultText(r.fault);
    json_["limits"] = listOf(link::limitWords(r.limits));
    json_["mode"] = toString(static_cast<ControlMode>(r.header.id & 0xFFU));
    json_["acting"] = toString(static_cast<Acting>(r.header.id >> 24U));
    json_["stop_cause"] = toString(static_cast<StopCause>(r.stop_cause));
    json_["target"] = r.target;
    json_["target_shaped"] = r.target_shaped;
    json_["zeroed"] = (r.header.id >> 16U & 1U) != 0;
    visitReadings([this](std::string_view name, auto value) { json_[std::string(name)] = shortest(value); },
                  r);
    json_["command_value"] = shortest(r.command_value);
    json_["command_unit"] = toString(static_cast<CommandUnit>(r.header.id >> 8U & 0xFFU));
    json_["feedback_age_us"] = r.feedback_age_us;
    json_["feedback_age_at_use_us"] = r.feedback_age_at_use_us;
    json_["command_age_us"] = r.command_age_us;
  }

  void add(const Robot& r) {
    json_["kind"] = "robot";
    json_["state"] = toString(RobotStatus{r.header.flags});
    json_["stop_cause"] = toString(static_cast<StopCause>(r.header.source));
    json_["conditions"] = listOf(link::conditionWords(r.header.id));
    json_["estops"] = r.estops;
    json_["tick"] = r.tick;
    json_["missed_ticks"] = r.missed_ticks;
  }

  void add(const Bus& r) {
    json_["kind"] = "bus";
    json_["bus"] = recording_.busName(r.header.source);
    json_["state"] = toString(BusState{r.header.flags});
    json_["rx_frames"] = r.rx_frames;
    json_["tx_frames"] = r.tx_frames;
    json_["tx_dropped"] = r.tx_dropped;
    json_["error_frames"] = r.error_frames;
    json_["tec"] = r.tec < 0 ? Json(nullptr) : Json(r.tec);
    json_["rec"] = r.rec < 0 ? Json(nullptr) : Json(r.rec);
  }

  const Recording& recording_;
  Json json_;
};

}  // namespace

std::string recordJson(const Recording& recording, const Record& record) {
  return lineOf(Writer{recording}.line(record));
}

std::string recordingJson(const Recording& recording) {
  const auto& header = recording.header();
  Json motors = Json::array();
  for (std::size_t i = 0; i < header.motor_count; ++i) {
    motors.push_back({{"name", recording.motorName(i)},
                      {"model", header.motors[i].model.view()},
                      {"bus", recording.busName(header.motors[i].bus)}});
  }
  Json buses = Json::array();
  for (std::size_t i = 0; i < header.bus_count; ++i) {
    buses.push_back({{"name", recording.busName(i)}, {"interface", header.buses[i].interface.view()}});
  }
  Json modules = Json::array();
  for (std::size_t i = 0; i < header.module_count; ++i)
    modules.push_back({{"name", recording.moduleName(i)}});
  return lineOf({{"utime", recording.wallUs(recording.firstNs())},
                 {"mono_us", recording.firstNs() / 1000},
                 {"kind", "recording"},
                 {"robot", header.robot.view()},
                 {"version", header.program_version.view()},
                 {"pid", header.pid},
                 {"rate_hz", header.rate_hz},
                 {"cause", header.cause.view()},
                 {"ended", recording.control().ended != 0},
                 {"records", recording.size()},
                 {"dropped", recording.control().dropped},
                 {"buses", std::move(buses)},
                 {"motors", std::move(motors)},
                 {"modules", std::move(modules)}});
}

}  // namespace rc10::client
