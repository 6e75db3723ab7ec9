#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "app/result.hpp"
#include "blackbox/format.hpp"

namespace rc10::blackbox {

using Record = std::variant<Frame, Command, Setpoint, Order, Event, Motor, Robot, Bus, Signals>;

[[nodiscard]] const RecordHeader& headerOf(const Record& record);

/// Content of a black box in the order of time. Any bytes may be read: the result is a recording or an error.
class Recording {
 public:
  /// `image`: all bytes of the file, as from readImage().
  [[nodiscard]] static Result<Recording> parse(std::span<const std::byte> image);

  [[nodiscard]] const Header& header() const noexcept { return head_.header; }
  [[nodiscard]] const Control& control() const noexcept { return head_.control; }
  /// Bytes at the end that are no records; 0 in a whole file.
  [[nodiscard]] std::uint64_t damagedBytes() const noexcept { return damaged_bytes_; }

  [[nodiscard]] std::size_t size() const noexcept { return entries_.size(); }
  /// The `index`th record; below size().
  [[nodiscard]] Record at(std::size_t index) const noexcept;
  /// CLOCK_MONOTONIC of the first and the last record; 0 without records.
  [[nodiscard]] std::int64_t firstNs() const noexcept {
    return entries_.empty() ? 0 : entries_.front().time_ns;
  }
  [[nodiscard]] std::int64_t lastNs() const noexcept {
    return entries_.empty() ? 0 : entries_.back().time_ns;
  }

  /// Microseconds since 1970 of a time of a record.
  [[nodiscard]] std::int64_t wallUs(std::int64_t mono_ns) const noexcept;
  /// The names of the header; "?" for an index that it does not have.
  [[nodiscard]] std::string_view motorName(std::size_t index) const noexcept;
  [[nodiscard]] std::string_view busName(std::size_t index) const noexcept;
  [[nodiscard]] std::string_view moduleName(std::size_t index) const noexcept;
  [[nodiscard]] std::string_view inputName(std::size_t module, std::size_t input) const noexcept;
  /// The interface, or the name of a simulated bus.
  [[nodiscard]] std::string_view interfaceName(std::size_t index) const noexcept;
  /// The module's word for its event; empty: not known.
  [[nodiscard]] std::string_view moduleEvent(std::size_t module, std::int32_t event) const noexcept;
  /// The robot that was recorded had simulated drives.
  [[nodiscard]] bool simulated() const noexcept;
  /// Whose event it is: of a motor, a module, a bus or the robot.
  [[nodiscard]] std::string_view sourceName(const Event& event) const noexcept;

 private:
  struct Entry {
    std::int64_t time_ns;
    std::uint64_t offset;
  };
  void index();

  FileHead head_;
  std::vector<std::byte> stream_;
  std::vector<Entry> entries_;
  std::uint64_t damaged_bytes_ = 0;
};

}  // namespace rc10::blackbox
