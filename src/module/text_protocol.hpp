#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "bus/frame_scanner.hpp"
#include "bus/i_protocol.hpp"
#include "module/stamped.hpp"

namespace rc10 {

/// One line: a name and some numbers.
struct TextMessage {
  static constexpr std::size_t kLongestName = 15;
  static constexpr std::size_t kMostValues = 8;

  std::array<char, kLongestName> name_letters{};
  std::size_t name_length = 0;
  std::array<double, kMostValues> values{};
  std::size_t value_count = 0;

  [[nodiscard]] std::string_view name() const noexcept { return {name_letters.data(), name_length}; }
};

/// Takes every line, in order: several may come in one tick.
class TextListener {
 public:
  TextListener() = default;
  TextListener(const TextListener&) = delete;
  TextListener& operator=(const TextListener&) = delete;
  virtual ~TextListener() = default;
  virtual void onLine(const TextMessage& message, MonotonicTime received) noexcept = 0;
};

/// A line protocol for one's own boards, which a person can read and type, and the worked example of
/// docs/serial-devices.md:
///
///   $range,1.25,-0.5*61
///
/// `$`, a name of letters, digits and `_`, up to eight decimal numbers with a comma before each, `*`, the
/// exclusive or of all between `$` and `*` as two hexadecimal digits, and a line feed; a carriage return
/// before it is allowed.
class TextProtocol final : public I_Protocol {
 public:
  static constexpr std::size_t kLongestLine = 120;  ///< With `$` and line feed.

  /// `listener` outlives the protocol's last parse_stream().
  explicit TextProtocol(TextListener* listener = nullptr) noexcept : listener_(listener) {}

  void parse_stream(std::span<const std::uint8_t> bytes, MonotonicTime received) noexcept override;
  /// `payload` is what stands between `$` and `*`.
  [[nodiscard]] std::size_t pack_frame(std::span<const std::uint8_t> payload,
                                       std::span<std::uint8_t> out) const noexcept override;
  void restart() noexcept override { scanner_.clear(counters_); }

  /// The latest line whose checksum was right.
  [[nodiscard]] const Stamped<TextMessage>& message() const noexcept { return message_; }

 private:
  TextListener* listener_;
  FrameScanner<kLongestLine> scanner_;
  Stamped<TextMessage> message_;
};

}  // namespace rc10
