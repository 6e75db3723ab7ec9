#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/result.hpp"
#include "config/keys/loop_gains.hpp"
#include "daemon/clients/admission.hpp"
#include "daemon/clients/answered_requests.hpp"
#include "daemon/clients/gains_at_end.hpp"
#include "daemon/exchange/orders.hpp"
#include "daemon/exchange/robot_description.hpp"
#include "daemon/exchange/shaft_order.hpp"
#include "link/link_protocol.hpp"

namespace rc10 {

/// Turns requests into orders for the supervisor, and its results into responses in words.
/// A repeated request, by sender, client, session, sequence number and operation, gets the first answer
/// again; one that stops is carried out again. Link thread only.
class RequestDesk {
 public:
  /// Both outlive it.
  RequestDesk(const Admission& admission, const RobotDescription& robot);

  /// Whether a connection is still there.
  using IsOpen = std::function<bool(std::uint64_t connection)>;

  struct Shaft {
    ShaftOrder order;
    link::Response response;  ///< For an order that the simulation takes.
  };
  struct Outcome {
    std::optional<Order> order;              ///< To be sent to the supervisor; answered by finish().
    std::optional<Shaft> shaft;              ///< To be sent to the simulation; it answers nothing.
    std::optional<link::Response> response;  ///< To be sent back at once.
    bool disable_at_end = false;             ///< For the motors of the order: see DisableAtEnd.
    bool estop = false;                      ///< Raise the e-stop flag too: the ring may be full.
    std::string not_permitted;               ///< Cause, if that is the reason of the response.
  };
  /// finish() tells the speaker's connection back. One that is older than kMaxRequestAge is refused, unless
  /// it stops: rc10d, too, may have stood still.
  [[nodiscard]] Outcome begin(const link::Request& request, const Speaker& speaker, MonotonicTime now);

  /// The simulation has taken the order of Outcome::shaft, and its response is sent.
  void shaftTaken(const link::Request& request, const Speaker& speaker, const link::Response& response);

  struct Answer {
    std::uint64_t connection = 0;
    link::Response response;
    std::string note;  ///< For the log; mostly empty.
  };
  /// The response to the request whose order has this result; empty if it is not known any more. `report`: of
  /// a scan that was made.
  [[nodiscard]] std::optional<Answer> finish(const OrderResult& result, const std::string& report = {});
  /// The scan that is under way for a client whose connection has ended.
  [[nodiscard]] std::optional<std::uint64_t> scanForNobody(const IsOpen& is_open) const;
  /// To be sent to the supervisor: gains of before for one motor, whose client tried others and has ended.
  [[nodiscard]] std::optional<Order> gainsForNobody(const IsOpen& is_open);
  /// Gains that gainsForNobody() has tried to set back in vain, in words: one text for each motor, until
  /// somebody sets them.
  [[nodiscard]] std::vector<std::string> gainsLeft() const;
  /// The order could not be handed over.
  [[nodiscard]] std::optional<Answer> fail(std::uint64_t order_id, const std::string& reason);

 private:
  /// Connection of what this desk asks by itself.
  static constexpr std::uint64_t kNobody = 0;
  /// A request whose order is under way.
  struct Open {
    std::uint64_t connection = kNobody;
    std::uint64_t asker = 0;
    link::Request request;
    Order order;
    bool tries_gains = false;  ///< See GainsAtEnd.
  };

  [[nodiscard]] static Error unknownOperation(const link::Request& request);
  /// The order that a request becomes, without its id; or what is wrong with the request.
  [[nodiscard]] Result<Order> orderOf(const link::Request& request, Operation operation) const;
  [[nodiscard]] bool mayOpen(std::string_view client) const;
  [[nodiscard]] Result<MotorSet> motorsOf(const link::Request& request) const;
  /// The motor that a request about one drive names.
  [[nodiscard]] Result<std::size_t> theMotor(const link::Request& request) const;
  [[nodiscard]] Result<std::size_t> motorWithGains(const link::Request& request) const;
  [[nodiscard]] Result<DriveWrite> driveWriteOf(const link::Request& request) const;
  [[nodiscard]] Result<GainChanges> changesOf(const link::Request& request) const;

  [[nodiscard]] Outcome tellSettings(const link::Request& request) const;
  [[nodiscard]] Outcome tellConfig(const link::Request& request) const;
  /// A hand, or another load.
  [[nodiscard]] Outcome actOnShaft(Operation operation, const link::Request& request,
                                   const Speaker& speaker) const;

  [[nodiscard]] std::string driveOutcome(const Open& open, const OrderResult& result) const;
  static void tellZero(double zero_deg, link::Response& response);
  void finishGains(const Open& open, const OrderResult& result, Answer& answer);
  [[nodiscard]] std::string leftGainsOf(const GainsAtEnd::Due& left) const;
  [[nodiscard]] std::string namesOf(const MotorSet& motors, std::string_view between) const;
  [[nodiscard]] std::string reasonOf(Refusal reason, std::size_t motor, const MotorSet& in_the_way) const;
  [[nodiscard]] std::string reasons(const MotorSet& motors, const OrderResult& result) const;
  [[nodiscard]] static link::Response respond(const link::Request& request, link::ResponseStatus status,
                                              const std::string& message);

  [[nodiscard]] const std::string& nameOf(std::size_t motor) const { return robot_.motors[motor].name; }
  /// "the motors are: left, right; did you mean left?"
  [[nodiscard]] std::string theMotorsAre(std::string_view typed) const;
  [[nodiscard]] const DriveSetup& setupOf(std::size_t motor) const;
  [[nodiscard]] Open* openRepetition(std::uint64_t asker, const link::Request& request);

  const Admission& admission_;
  const RobotDescription& robot_;
  std::vector<MotorLoops> loops_;  ///< Loops of each motor, with the gains in force.
  std::uint64_t next_order_id_ = 1;
  std::deque<Open> open_;
  AnsweredRequests answered_;
  GainsAtEnd gains_at_end_;
};

}  // namespace rc10
