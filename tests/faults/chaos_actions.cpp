// Actions of the chaos, one by one.
#include <linux/can/error.h>

#include <array>
#include <chrono>
#include <limits>
#include <utility>

#include "faults/chaos.hpp"

namespace rc10::test {

using namespace std::chrono_literals;

void Chaos::repair(std::size_t motor) {
  auto load = config_.buses[places_[motor].first].motors[places_[motor].second].simulated;
  busOf(motor).setLoad(driveOf(motor), load);
  busOf(motor).setEncoderFault(driveOf(motor), {});
  busOf(motor).setTemperature(driveOf(motor), 25.0);
}

void Chaos::repairBuses() {
  frozen_.reset();
  blocked_.reset();
  contact_open_ = false;
  for (std::size_t bus = 0; bus < wires_.size(); ++bus) leaveQueue(bus);
  for (std::size_t bus = 0; bus < wires_.size(); ++bus) {
    errorFrame(bus, 1);
    robot_->inboxes()[bus].link.store(CanLinkState::kUp);
    oracle_->linked(bus, true);
  }
}

// A second controller says what ours has said, or something else, to the same drive.
void Chaos::secondController() {
  if (seen_count_ < seen_.size()) return;
  auto [bus, frame] = seen_[choices_.next(static_cast<std::uint32_t>(seen_.size()))];
  if (choices_.oneIn(2)) frame.data[frame.length / 2] ^= 0x01U;
  const auto times = choices_.of<std::uint32_t>({1, 2, 3, 4, 60});
  const auto spacing = choices_.of<std::uint64_t>({0, 1, 20, 60});
  for (std::uint32_t i = 0; i < times; ++i) {
    frame.received = robot_->now() + config_.period() / 2;
    if (robot_->inboxes()[bus].frames.push(frame)) oracle_->foreign(bus, frame);
    ticks(spacing);
  }
}

// Anything on the bus: another commander, a drive with a loose screw, another protocol.
void Chaos::foreignFrame(std::size_t bus) {
  CanFrame frame;
  frame.id = {0x1F8U + choices_.next(32), choices_.oneIn(16)};
  frame.fd = choices_.oneIn(16);
  frame.type = choices_.oneIn(16) ? FrameType::kRemote : FrameType::kData;
  frame.length = static_cast<std::uint8_t>(choices_.oneIn(4) ? choices_.next(9) : 8);
  for (std::size_t i = 0; i < 8; ++i) frame.data[i] = static_cast<std::uint8_t>(choices_.next(256));
  if (choices_.oneIn(2)) frame.data[0] &= 0x1FU;  // an angle that exists
  frame.received = robot_->now() + config_.period() / 2;
  if (!robot_->inboxes()[bus].frames.push(frame)) return;
  oracle_->heard(bus, frame);
  oracle_->foreign(bus, frame);
}

// Error frames of a controller.
void Chaos::errorFrame(std::size_t bus, std::uint32_t which) {
  CanFrame frame;
  frame.type = FrameType::kError;
  frame.length = 8;
  frame.received = robot_->now() + config_.period() / 2;
  switch (which) {
    case 0: frame.id.value = CAN_ERR_BUSOFF; break;
    case 1: frame.id.value = CAN_ERR_RESTARTED; break;
    case 2:
      frame.id.value = CAN_ERR_CRTL;
      frame.data[1] = CAN_ERR_CRTL_TX_PASSIVE;
      break;
    default: frame.id.value = CAN_ERR_CRTL; frame.data[1] = CAN_ERR_CRTL_RX_WARNING;
  }
  if (robot_->inboxes()[bus].frames.push(frame)) oracle_->controllerOff(bus, which == 0);
}

// As its thread does, all the time.
void Chaos::showContact() {
  robot_->exchange().estop_contact.show(contact_open_ ? ContactState::kOpen : ContactState::kClosed);
  oracle_->contact(contact_open_);
  robot_->exchange().mode_contact.show(mode_open_ ? ContactState::kOpen : ContactState::kClosed);
  oracle_->modeInput(mode_open_);
}

void Chaos::stopAndStartAgain() {
  robot_->scheduler().beginStop();
  oracle_->stopBegun();
  for (int i = 0; i < 1200 && !robot_->scheduler().stopped(); ++i) tick();
  ticks(5);
  start();
}

void Chaos::act(Action action) {
  const auto buses = static_cast<std::uint32_t>(wires_.size());
  const auto everyone = MotorSet{(1ULL << places_.size()) - 1};
  MotorSet motors;
  double value = 0.0;
  const auto each = [&](auto&& what) {
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (motors.test(i)) what(i);
    }
  };
  switch (action) {
    case Action::kNothing:
    case Action::kCount: break;
    case Action::kCommand: {
      Client once = someClient();
      motors = once.motors = someMotors();
      if (choices_.oneIn(8)) ++once.session;
      once.validity = std::chrono::milliseconds{choices_.of<int>({1, 5, 20, 50, 100, 300, 1000, 0})};
      each([&](std::size_t i) { once.targets[i] = randomTarget(i); });
      if (motors.any()) command(once);
      break;
    }
    case Action::kProgram: {
      if (!inputs_.empty() && choices_.oneIn(2)) {
        chooseInputs();
        // A module acts where no other client commands.
        if (choices_.oneIn(4))
          for (auto& other : clients_) other.motors.reset();
        break;
      }
      auto& client = someClient();
      motors = client.motors = choices_.oneIn(6) ? MotorSet{} : someMotors();
      client.validity = std::chrono::milliseconds{choices_.of<int>({5, 20, 50, 100, 100, 300})};
      client.every_ticks = choices_.of<std::uint32_t>({1, 5, 10, 20, 20, 100});
      each([&](std::size_t i) { client.targets[i] = randomTarget(i); });
      break;
    }
    case Action::kEnable:
      motors = choices_.oneIn(2) ? everyone : someMotors();
      order(Operation::kEnable, motors);
      break;
    case Action::kEnableAlone: {
      // Mostly others are enabled, and it is refused.
      const MotorSet one = MotorSet{}.set(choices_.next(static_cast<std::uint32_t>(places_.size())));
      motors = one;
      if (!choices_.oneIn(4)) order(Operation::kDisable, everyone & ~one);
      order(Operation::kEnableAlone, one);
      if (choices_.oneIn(2)) order(Operation::kEnable, everyone & ~one);
      break;
    }
    case Action::kDisable:
      motors = someMotors();
      order(Operation::kDisable, motors);
      // Longer than what it holds is held: nothing else happens meanwhile.
      if (choices_.oneIn(4)) ticks(1200);
      break;
    case Action::kClear:
      motors = choices_.oneIn(2) ? everyone : someMotors();
      order(Operation::kClear, motors);
      break;
    case Action::kZero:
      motors = someMotors();
      value = choices_.of<double>({0.0, 45.0, -80.0, 1e6, 1e300});
      order(Operation::kZero, motors, value);
      break;
    case Action::kEstop:
      if (choices_.oneIn(2)) {
        robot_->exchange().estop.store(!lie_ || lie_->kind != Lie::Kind::kEstop);
        oracle_->estopped();
      } else {
        order(Operation::kEstop, someMotors());
      }
      break;
    case Action::kRepair:
      motors = choices_.oneIn(2) ? everyone : someMotors();
      each([&](std::size_t i) { repair(i); });
      if (motors == everyone) repairBuses();
      break;
    case Action::kSilence:
      motors = someMotors();
      each([&](std::size_t i) { busOf(i).silence(driveOf(i), true); });
      break;
    case Action::kLoseFrames:
      motors = someMotors();
      value = choices_.of<double>({0.1, 0.5, 0.9, 0.95});
      each([&](std::size_t i) { busOf(i).loseFrames(driveOf(i), static_cast<float>(value)); });
      break;
    case Action::kStall:
      motors = someMotors();
      each([&](std::size_t i) { busOf(i).stall(driveOf(i), true); });
      break;
    case Action::kHeat:
      motors = someMotors();
      value = choices_.of<double>({60.0, 75.0, 85.0, 130.0});
      each([&](std::size_t i) { busOf(i).setTemperature(driveOf(i), value); });
      break;
    case Action::kEncoder: {
      motors = someMotors();
      const auto which = choices_.next(4);
      value = which;
      const double slip = static_cast<double>(choices_.next(100)) / 100.0;
      each([&](std::size_t i) {
        busOf(i).setEncoderFault(
            driveOf(i), {.frozen = which == 0, .reversed = which == 1, .slip_turns = which > 1 ? slip : 0.0});
      });
      break;
    }
    case Action::kLoad: {
      motors = someMotors();
      value = choices_.of<double>({-3.0, -1.0, 1.0, 5.0});
      const bool torn = choices_.oneIn(3);  // a belt: there is no stop any more
      each([&](std::size_t i) {
        auto load = busOf(i).drive(driveOf(i)).load();
        load.load_torque_nm = torn ? 0.0F : static_cast<float>(value);
        if (torn) load.stop_min_deg = load.stop_max_deg = std::numeric_limits<float>::quiet_NaN();
        busOf(i).setLoad(driveOf(i), load);
      });
      break;
    }
    case Action::kFreezeBus: frozen_.flip(choices_.next(buses)); break;
    case Action::kBlockBus: blocked_.flip(choices_.next(buses)); break;
    case Action::kHoldEchoes: {
      // Up to five ticks nothing may happen; for ever is until somebody repairs it.
      const auto bus = choices_.next(buses);
      const auto for_ticks = choices_.of<std::uint64_t>({1, 3, 5, 6, 7, 8, 12, 60, 200, 1'000, 1'000'000});
      holdEchoes(bus, for_ticks, choices_.oneIn(3));
      value = static_cast<double>(for_ticks);
      break;
    }
    case Action::kLink: {
      const auto bus = choices_.next(buses);
      const bool up = !choices_.oneIn(3);
      robot_->inboxes()[bus].link.store(up ? CanLinkState::kUp : CanLinkState::kDown);
      oracle_->linked(bus, up);
      if (!up) queues_[bus] = {};  // down throws away what waited
      value = up ? 1.0 : 0.0;
      break;
    }
    case Action::kController: {
      const auto which = choices_.next(4);
      errorFrame(choices_.next(buses), which);
      value = which;
      break;
    }
    case Action::kContact:
      value = choices_.next(3);
      contact_open_ = value == 1.0;
      if (value == 2.0) {  // for an instant
        robot_->exchange().estop_contact.show(ContactState::kOpen);
        oracle_->estopped();
      }
      break;
    case Action::kModeContact:
      value = choices_.next(3);
      mode_open_ = value != 0.0;
      if (value == 2.0) robot_->exchange().mode_contact.show(ContactState::kUnreadable);
      break;
    case Action::kForeignFrames: {
      const auto bus = choices_.next(buses);
      if (choices_.oneIn(2)) secondController();
      for (auto n = choices_.next(8); n > 0; --n) foreignFrame(bus);
      break;
    }
    case Action::kFloodBus: {
      const auto bus = choices_.next(buses);
      CanFrame frame = makeClassicFrame({0x123, false}, std::array<std::uint8_t, 8>{});
      for (std::size_t i = 0; i < BusInbox::kFrames; ++i) deliver(bus, frame);
      break;
    }
    case Action::kFillRings: {
      Client once = someClient();
      once.motors = motors = everyone;
      once.validity = 20ms;
      each([&](std::size_t i) { once.targets[i] = randomTarget(i); });
      for (int i = 0; i < 70; ++i) command(once);
      for (int i = 0; i < 70; ++i)
        order(choices_.oneIn(2) ? Operation::kEnable : Operation::kClear, everyone);
      break;
    }
    case Action::kMissTicks:
      value = 2 + choices_.next(39);
      note(action, motors, value);
      tick(static_cast<std::uint64_t>(value));
      return;
    case Action::kScan:
      note(action, motors, value);
      scan();
      return;
    case Action::kModules:
      note(action, motors, value);
      useModules();
      return;
    case Action::kStop:
      note(action, motors, value);
      stopAndStartAgain();
      return;
    case Action::kCrash:
      note(action, motors, value);
      start();
      return;
  }
  if (action != Action::kNothing) note(action, motors, value);
}

}  // namespace rc10::test
