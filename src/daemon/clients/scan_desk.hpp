#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "daemon/clients/connections.hpp"
#include "daemon/exchange/bus_scan_exchange.hpp"
#include "daemon/exchange/orders.hpp"
#include "daemon/exchange/robot_description.hpp"
#include "link/link_protocol.hpp"
#include "survey/bus_survey.hpp"
#include "survey/drive_claims.hpp"

namespace rc10 {

/// Judges what a scan hears, chooses its questions, and reports: the one scan of the robot at a time. Link
/// thread only.
class ScanDesk {
 public:
  /// Both outlive it.
  ScanDesk(const RobotDescription& robot, BusScanExchange& exchange) : robot_(robot), exchange_(exchange) {}

  /// Before the order is handed over. False: another scan goes on.
  [[nodiscard]] bool begin(const Order& order, const link::Request& request);
  /// The order was not handed over.
  void abandon(std::uint64_t order_id);
  /// Takes what was heard; hands over the questions when the time to listen is over.
  void turn();

  struct Report {
    std::string message;  ///< For the answer: the drives in a line, then advice, a line each.
    std::vector<link::Sighting> sightings;
  };
  /// Result of the scan; none: the result is of another order, or of a scan that was refused or given up.
  [[nodiscard]] std::optional<Report> end(const OrderResult& result);

  /// Hands the sightings over as the connection has room, and the answer behind them.
  void deliver(std::uint64_t connection, const link::Response& response,
               std::vector<link::Sighting> sightings);
  void sendOn(Connections& connections);

 private:
  struct Running {
    std::uint64_t order_id = 0;
    link::Request request;
    std::size_t bus = 0;
    MonotonicTime begun{};
    std::uint64_t dropped_before = 0;
    bool listen_only = false;
    bool asked = false;
    survey::BusSurvey survey{};
    survey::DriveClaims claims;
    std::set<std::string> spared{};
  };
  struct Delivery {
    std::uint64_t connection = 0;
    link::Response response;
    std::deque<link::Sighting> left;
  };

  void takeHeard(Running& scan);
  void ask(Running& scan);
  [[nodiscard]] std::string message(const Running& scan, const OrderResult& result,
                                    const std::vector<survey::Sighting>& all,
                                    const std::vector<link::Sighting>& told) const;

  const RobotDescription& robot_;
  BusScanExchange& exchange_;
  std::optional<Running> running_;
  std::deque<Delivery> deliveries_;
};

}  // namespace rc10
