#include "config/check/bus_id_check.hpp"

#include <algorithm>
#include <optional>
#include <string>

#include "bus/frame_text.hpp"

namespace rc10 {
namespace {

constexpr std::size_t kMostProposals = 8;

struct Device {
  const MotorDraft* draft = nullptr;
  BusUse use;

  [[nodiscard]] const MotorFamily& family() const noexcept { return *draft->config.family; }
};

[[nodiscard]] Device deviceOf(const MotorDraft& draft) {
  return {&draft, draft.config.family->busUse(draft.config.settings)};
}

[[nodiscard]] std::optional<CanId> common(const std::vector<FrameFilter>& some,
                                          const std::vector<FrameFilter>& others) {
  for (const auto& one : some) {
    for (const auto& other : others) {
      if (overlaps(one, other)) return commonId(one, other);
    }
  }
  return std::nullopt;
}

[[nodiscard]] std::vector<FrameFilter> exactly(const std::vector<BusUse::Stream>& streams) {
  std::vector<FrameFilter> filters;
  filters.reserve(streams.size());
  for (const auto& stream : streams) filters.push_back({.id = stream.id});
  return filters;
}

/// Conflict of two devices on one bus, without their names; empty: none.
[[nodiscard]] std::string clash(const Device& a, const Device& b) {
  if (&a.family() == &b.family() && a.family().idJudge() != nullptr) return {};
  if (const auto id = common(a.use.sends, b.use.sends)) return "both answer with " + idText(*id);
  const auto one_way = [](const Device& from, const Device& to) -> std::string {
    const std::string names = "'" + from.draft->config.name() + "'";
    if (const auto id = common(from.use.sends, to.use.obeys)) {
      return "clash: " + names + " answers with " + idText(*id) + ", which '" + to.draft->config.name() +
             "' takes for a command";
    }
    const bool shared = !from.use.layout.empty() && from.use.layout == to.use.layout;
    const auto id = shared ? std::nullopt : common(exactly(from.use.commands), to.use.obeys);
    if (!id) return {};
    return "clash: the commands of " + names + " leave with " + idText(*id) + ", which '" +
           to.draft->config.name() + "' obeys as well";
  };
  const auto forth = one_way(a, b);
  return forth.empty() ? one_way(b, a) : forth;
}

class BusIdCheck {
 public:
  BusIdCheck(const std::vector<MotorDraft>& motors, const BusConfig& bus, Problems& problems)
      : bus_(bus), problems_(problems) {
    for (const auto& motor : motors) {
      if (motor.complete) devices_.push_back(deviceOf(motor));
    }
  }

  void run() {
    for (std::size_t i = 0; i < devices_.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const auto why = clash(devices_[j], devices_[i]);
        if (!why.empty()) report(devices_[j], i, why);
      }
    }
    checkFormat();
  }

 private:
  void report(const Device& first, std::size_t second, const std::string& why) {
    const MotorDraft& motor = *devices_[second].draft;
    problems_.error(motor.id_place, joinPath(motor.path, "id"),
                    nameOf(*first.draft) + " and " + nameOf(motor) + " " + why + "; " + proposal(second));
  }

  /// "free for DM4310: 2, 3 and 4": ids with which this motor fits to all others.
  std::string proposal(std::size_t index) const {
    const MotorConfig& config = devices_[index].draft->config;
    const MotorTraits traits = config.traits();
    std::vector<std::string> free;
    for (int id = traits.min_id; id <= traits.max_id && free.size() < kMostProposals; ++id) {
      if (id != config.settings.id && fits(index, id)) free.push_back(std::to_string(id));
    }
    if (free.empty()) return "no id of the " + config.settings.model + " is free; move one to another bus";
    return "free for the " + config.settings.model + ": " + listWords(free) +
           (free.size() == kMostProposals ? " and more" : "");
  }

  bool fits(std::size_t index, int id) const {
    MotorDraft changed = *devices_[index].draft;
    changed.config.settings.id = id;
    if (!changed.config.family->check(changed.config.settings)) return false;
    const Device candidate = deviceOf(changed);
    for (std::size_t other = 0; other < devices_.size(); ++other) {
      if (other != index && !clash(devices_[other], candidate).empty()) return false;
    }
    return true;
  }

  void checkFormat() {
    const auto speaks_fd = [](const Device& device) { return device.draft->config.traits().fd; };
    const auto fd = std::find_if(devices_.begin(), devices_.end(), speaks_fd);
    if (fd == devices_.end()) return;
    const MotorDraft& fast = *fd->draft;
    if (bus_.data_bitrate == 0) {
      const int delivered = fast.config.traits().data_bitrate;
      const std::string hint = delivered == 0 ? std::string{}
                                              : " (" + std::string{fast.config.family->name()} + ": " +
                                                    std::to_string(delivered) + ")";
      problems_.error(fast.config.place, fast.path,
                      nameOf(fast) +
                          " speaks CAN FD and the bus is a classic one; add data_bitrate to the bus, "
                          "as it is set on the drive and on the interface" +
                          hint);
      return;
    }
    for (const auto& device : devices_) {
      const MotorDraft& motor = *device.draft;
      if (!motor.config.traits().classic_only) continue;
      problems_.error(motor.config.place, motor.path,
                      nameOf(motor) + " takes the CAN FD frames of " + nameOf(fast) +
                          " for errors and destroys them; put them on two buses");
      return;
    }
  }

  const BusConfig& bus_;
  Problems& problems_;
  std::vector<Device> devices_;
};

}  // namespace

void checkBusIds(const std::vector<MotorDraft>& motors, const BusConfig& bus, Problems& problems) {
  BusIdCheck{motors, bus, problems}.run();
}

}  // namespace rc10
