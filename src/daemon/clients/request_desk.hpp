#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/result.hpp"
#include "config/keys/loop_gains.hpp"
#include "daemon/clients/admission.hpp"
#include "daemon/exchange/hand_order.hpp"
#include "daemon/exchange/orders.hpp"
#include "link/link_protocol.hpp"

namespace rc10 {

/// Turns requests into orders for the supervisor, and its results into responses in words.
/// A repeated request, by sender, client, session, sequence number and operation, gets the first answer
/// again; one that stops is carried out again. Link thread only.
class RequestDesk {
 public:
  /// `optional`: motors that may fail to enable without the request failing. `setups`: what can be written to
  /// the drive of each motor; null or missing: nothing. `loops`: of each motor, as they are at the start;
  /// missing: none. `drives`: the simulated drive of each motor; null or missing: the motor is not simulated.
  RequestDesk(const Admission& motors, std::vector<std::string> motor_names, MotorSet optional = {},
              std::vector<const DriveSetup*> setups = {}, std::vector<MotorLoops> loops = {},
              std::vector<std::optional<SimulatedDrive>> drives = {});

  struct Hand {
    HandOrder order;
    link::Response response;  ///< For an order that the simulation takes.
  };
  struct Outcome {
    std::optional<Order> order;              ///< To be sent to the supervisor; answered by finish().
    std::optional<Hand> hand;                ///< To be sent to the simulation; it answers nothing.
    std::optional<link::Response> response;  ///< To be sent back at once.
    bool estop = false;                      ///< Raise the e-stop flag too: the ring may be full.
    std::string not_permitted;               ///< Why, if that is the reason of the response.
  };
  /// finish() tells the speaker's connection back.
  [[nodiscard]] Outcome begin(const link::Request& request, const Speaker& speaker);

  /// The simulation has taken the order of Outcome::hand, and its response is sent.
  void handTaken(const link::Request& request, const Speaker& speaker, const link::Response& response);

  struct Answer {
    std::uint64_t connection = 0;
    link::Response response;
  };
  /// The response to the request whose order has this result; empty if it is not known any more.
  [[nodiscard]] std::optional<Answer> finish(const OrderResult& result);
  /// The order could not be handed over.
  [[nodiscard]] std::optional<Answer> fail(std::uint64_t order_id, const std::string& reason);

 private:
  struct Open {
    std::uint64_t order_id = 0;
    std::uint64_t connection = 0;
    std::uint64_t asker = 0;
    link::Request request;
    MotorSet motors;
    DriveWrite drive;
    GainChanges gains;
  };

  [[nodiscard]] bool mayOpen(std::string_view client) const;
  [[nodiscard]] bool parseMotors(const link::Request& request, MotorSet& motors, std::string& problem) const;
  /// The motor that a request about one drive names, or what is wrong.
  [[nodiscard]] Result<std::size_t> theMotor(const link::Request& request) const;
  [[nodiscard]] const DriveSetup& setupOf(std::size_t motor) const;
  [[nodiscard]] Outcome tellSettings(const link::Request& request) const;
  [[nodiscard]] bool parseDrive(const link::Request& request, DriveWrite& drive, std::string& problem) const;
  [[nodiscard]] bool isOfOneMotor(const link::Request& request, std::string& problem) const;
  [[nodiscard]] std::string driveOutcome(const Open& open, const OrderResult& result) const;
  [[nodiscard]] Result<std::size_t> motorWithGains(const link::Request& request) const;
  [[nodiscard]] Outcome turnByHand(const link::Request& request, const Speaker& speaker) const;
  [[nodiscard]] Outcome tellConfig(const link::Request& request) const;
  [[nodiscard]] bool parseChanges(const link::Request& request, GainChanges& changes,
                                  std::string& problem) const;
  void finishGains(const Open& open, const OrderResult& result, link::Response& response);
  [[nodiscard]] std::string reasonOf(Refusal reason, const MotorSet& in_the_way) const;
  [[nodiscard]] std::string reasons(const MotorSet& motors, const OrderResult& result) const;
  [[nodiscard]] static link::Response respond(const link::Request& request, link::ResponseStatus status,
                                              const std::string& message);
  struct Remembered {
    std::uint64_t asker = 0;
    link::Text<32> operation;
    link::Response response;
  };

  void remember(std::uint64_t asker, const link::Request& request, const link::Response& response);
  [[nodiscard]] const link::Response* remembered(std::uint64_t asker, const link::Request& request) const;
  [[nodiscard]] Open* openRepetition(std::uint64_t asker, const link::Request& request);

  const Admission& admission_;
  std::vector<std::string> names_;
  MotorSet optional_;
  std::vector<const DriveSetup*> setups_;
  std::vector<MotorLoops> loops_;  ///< With the gains in force.
  std::vector<std::optional<SimulatedDrive>> drives_;
  std::uint64_t next_order_id_ = 1;
  std::deque<Open> open_;
  std::deque<Remembered> answered_;  // newest last; bounded
};

}  // namespace rc10
