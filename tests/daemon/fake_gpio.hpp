#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/devices/gpio.hpp"
#include "daemon/devices/gpio_lines.hpp"

namespace rc10::test {

/// A contact that the test opens and closes.
class FakeContact final : public ContactInput {
 public:
  struct State {
    ContactState now = ContactState::kClosed;
    std::deque<ContactState> first;  ///< Answers of the next calls, before `now`.
    std::vector<Duration> waits;
  };
  explicit FakeContact(State& state) : state_(state) {}

  [[nodiscard]] ContactState wait(Duration timeout) noexcept override {
    state_.waits.push_back(timeout);
    if (state_.first.empty()) return state_.now;
    const auto said = state_.first.front();
    state_.first.pop_front();
    return said;
  }

 private:
  State& state_;
};

/// An output that remembers.
class FakePulse final : public DigitalOutput {
 public:
  struct State {
    std::vector<bool> levels;
    bool refuses = false;
  };
  explicit FakePulse(State& state) : state_(state) {}

  [[nodiscard]] bool set(bool high) noexcept override {
    if (!state_.refuses) state_.levels.push_back(high);
    return !state_.refuses;
  }

 private:
  State& state_;
};

/// Chips whose lines the test sees and holds. A line has one user.
class FakeGpio final : public GpioSystem {
 public:
  struct Line {
    std::string user{};  ///< Empty: nobody holds it.
    bool high = false;
    bool output = false;
    bool refuses = false;
    bool opens_dead = false;  ///< It can be taken though it refuses.
    GpioBias bias = GpioBias::kAsIs;
    std::vector<bool> levels{};  ///< All that were driven, the first on opening.
  };
  using Chip = std::map<std::string, Line>;  ///< By "chip:line".
  explicit FakeGpio(Chip& chip) : chip_(chip) {}

  [[nodiscard]] Result<std::unique_ptr<DigitalInput>> openInput(const std::string& user, const GpioPin& pin,
                                                                GpioBias bias) override {
    auto line = take(user, pin);
    if (!line) return tl::unexpected(line.error());
    (*line)->bias = bias;
    return std::make_unique<Input>(**line);
  }
  [[nodiscard]] Result<std::unique_ptr<DigitalOutput>> openOutput(const std::string& user, const GpioPin& pin,
                                                                  bool high) override {
    auto line = take(user, pin);
    if (!line) return tl::unexpected(line.error());
    (*line)->output = true;
    (*line)->high = high;
    (*line)->levels.push_back(high);
    return std::make_unique<Output>(**line);
  }

 private:
  [[nodiscard]] Result<Line*> take(const std::string& user, const GpioPin& pin) {
    const auto found = chip_.find(pin.name());
    if (found == chip_.end() || (found->second.refuses && !found->second.opens_dead))
      return fail(user + ": " + pin.name() + ": there is no chip");
    if (!found->second.user.empty()) return fail(user + ": " + pin.name() + ": in use");
    found->second.user = user;
    return &found->second;
  }

  class Input final : public DigitalInput {
   public:
    explicit Input(Line& line) : line_(line) {}
    ~Input() override { line_.user.clear(); }
    [[nodiscard]] std::optional<bool> high() noexcept override {
      return line_.refuses ? std::nullopt : std::optional{line_.high};
    }

   private:
    Line& line_;
  };
  class Output final : public DigitalOutput {
   public:
    explicit Output(Line& line) : line_(line) {}
    ~Output() override {
      line_.user.clear();
      line_.output = false;
    }
    [[nodiscard]] bool set(bool high) noexcept override {
      if (line_.refuses) return false;
      if (high != line_.high) line_.levels.push_back(high);
      line_.high = high;
      return true;
    }

   private:
    Line& line_;
  };

  Chip& chip_;
};

}  // namespace rc10::test
