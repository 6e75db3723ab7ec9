#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "app/target.hpp"
#include "app/time.hpp"
#include "app/vocabulary.hpp"
#include "link/link_protocol.hpp"
#include "module/module_base.hpp"
#include "module/robot_status.hpp"
#include "motor/drive_setup.hpp"
#include "motor/loop_gain.hpp"

namespace rc10 {

inline constexpr std::size_t kMaxMotors = link::kMaxMotors;
static_assert(kMaxSignals == link::kMaxSignals);
using MotorSet = std::bitset<kMaxMotors>;

/// Bound of the work in a tick: with these applied, the commands that follow wait for the next one.
inline constexpr std::size_t kSetpointsPerTick = 1024;

/// Requests of all clients that are under way at the same time.
inline constexpr std::size_t kMaxOpenRequests = 64;

/// A command message that passed admission, with motors as indices. All setpoints act in one tick.
struct Command {
  struct Setpoint {
    std::uint16_t motor = 0;
    Target target;
  };
  link::Name client;
  std::uint64_t session = 0;
  std::int32_t priority = 0;
  MonotonicTime received;  ///< By this host, as the kernel stamped it; from a module: its tick.
  MonotonicTime deadline;  ///< That plus its validity.
  MonotonicTime said;  ///< By a client, as `received`; from a module: what it follows, by a client or person.
  std::size_t count = 0;
  std::array<Setpoint, kMaxMotors> setpoints;
};

/// kScan: the bus, and the pace.
struct BusScanOrder {
  std::size_t bus = 0;
  Duration listen{};   ///< Before the first question.
  Duration between{};  ///< From one question to the next, at least.
  bool listen_only = false;
};

/// Origin of a request. Only one that is asked anew is one more kDisable, and lets go.
enum class Asked : std::uint8_t {
  kAnew,
  kAgain,    ///< It was taken before; its answer may be lost.
  kUnasked,  ///< It comes of itself, as of a program that ends: what is held or braked already stays so.
};

/// A request that passed the link thread, for the supervisor.
struct Order {
  static constexpr std::uint64_t kFromModule = 0;  ///< The id of all that modules ask: they get no result.
  /// The id of what the link thread asks by itself: nobody waits for the result.
  static constexpr std::uint64_t kOfLinkThread = ~std::uint64_t{0};

  std::uint64_t id = kFromModule;  ///< Chosen by the link thread; comes back in the result.
  Operation operation{};
  MotorSet motors;
  double value = 0.0;        ///< kZero: what the present angle becomes, deg.
  DriveWrite drive{};        ///< kConfigure: what is written to the drive of the one motor.
  GainChanges gains{};       ///< kSetGains: of the one motor.
  BusScanOrder scan{};       ///< kScan; `motors` are those of its bus.
  link::Name client{};       ///< The one that asked.
  bool whole_robot = false;  ///< Named no motor. Only such a kClear ends an e-stop.
  Asked asked = Asked::kAnew;

  [[nodiscard]] bool fromModule() const noexcept { return id == kFromModule; }
};

/// A message for a module that passed the link thread: what its inputs become.
struct SignalMessage {
  link::Name client;
  std::uint64_t session = 0;
  std::int32_t priority = 0;
  MonotonicTime received;  ///< As Command::received.
  MonotonicTime deadline;
  std::uint16_t module = 0;
  std::array<double, kMaxSignals> values{};  ///< By input; NaN: not given.
};

/// Reason why an order did not reach a motor.
enum class Refusal : std::uint8_t {
  kNone,
  kOffline,  ///< No feedback.
  kFaulted,  ///< Clear the fault first.
  kEstop,    ///< The robot is in ESTOP.
  kStopping,
  kActive,        ///< Not while the motor is ACTIVE.
  kNoPosition,    ///< No feedback to set a zero from.
  kDriveRefused,  ///< The drive did not confirm.
  kGroup,  ///< A motor that it is coupled with is not there, or cannot be enabled: OrderResult::in_the_way.
  kTogether,    ///< Its group is enabled all or none, and the request left some out: OrderResult::in_the_way.
  kDisabled,    ///< Disabled while it was being enabled.
  kMoving,      ///< Not before the motor stands still.
  kEstopInput,  ///< The e-stop input is open.
  kMayTurn,     ///< Unheard for less than its run-down time: it may still turn.
  kEstopAsked,  ///< An e-stop was asked for in the same tick.
  kConfiguring,   ///< A drive is being configured.
  kNotConfirmed,  ///< The drive did not tell a setting as it was written.
  kNotSaved,      ///< The drive did not tell that its settings are stored.
  kNoGains,       ///< Its drive closes its loops.
  kStillActs,     ///< It is still being damped, braked or held.
  kAlone,         ///< Another motor is enabled alone: OrderResult::in_the_way.
  kOthersOn,      ///< Others are enabled, or of its group held, and may not be: OrderResult::in_the_way.
  kRestFirst,     ///< A fallback acts, and its drive can be enabled from rest alone.
  kTurnUnclear,   ///< Its encoder is absolute, but its travel does not say on which turn it stands.
  kOutOfReach,  ///< Not this zero: its drive could not be told all of its travel, or has not told its turns.
  kScanning,    ///< Another scan goes on.
  kBusHeld,     ///< Its bus carries no frames.
  kTooBusy,     ///< The link thread did not judge what was heard.
  kClientGone,  ///< The one that asked has ended.
};

struct OrderResult {
  std::uint64_t id = 0;
  bool refused = false;         ///< Not tried at all.
  std::size_t drive_value = 0;  ///< kConfigure: at which of the values it ended.
  std::array<Refusal, kMaxMotors> motors{};
  MotorSet switched_on{};  ///< kEnable, kEnableAlone: motors that were off. Their drives may have refused.
  MotorSet in_the_way{};   ///< kAlone, kOthersOn, kGroup, kTogether: which motors.
  /// kZero of one motor: Motor_Base::zeroForFile().
  double zero_deg = std::numeric_limits<double>::quiet_NaN();
  bool estop_stays = false;        ///< kClear of some motors in an e-stop.
  Refusal scan = Refusal::kNone;   ///< kScan: reason that concerns no motor,
  std::uint32_t asked = 0;         ///< questions that were sent,
  std::uint64_t error_frames = 0;  ///< and error frames of the bus meanwhile.
};

}  // namespace rc10
