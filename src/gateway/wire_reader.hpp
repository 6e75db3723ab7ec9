#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>

namespace rc10::gateway {

/// Reason why bytes from a stranger are not the message they should be.
enum class Defect : std::uint8_t {
  kNone,
  kTooLarge,          ///< More bytes than any message of the type has.
  kTruncated,         ///< Ends too early.
  kOtherDefinitions,  ///< The fingerprint is that of another type.
  kBadText,           ///< A string without its terminator, or with one inside.
  kTextTooLong,
  kBadCount,  ///< A negative number of elements.
  kTooMany,   ///< More elements than a message may have.
  kTrailingBytes,
};

/// "is truncated", ...: for "a message on CHANNEL ...".
[[nodiscard]] const char* inWords(Defect defect) noexcept;

/// Reads LCM's encoding (big-endian numbers; strings with their length and a final 0) from bytes that
/// nobody vouches for. Never reads outside them, never allocates, believes no count. After the first
/// defect every reading is 0 or empty.
class WireReader {
 public:
  explicit WireReader(std::span<const std::byte> bytes) noexcept : rest_(bytes) {}

  template <typename Number>
  [[nodiscard]] Number number() noexcept {
    static_assert(std::is_arithmetic_v<Number>);
    using Bits = std::conditional_t<
        sizeof(Number) == 1, std::uint8_t,
        std::conditional_t<sizeof(Number) == 2, std::uint16_t,
                           std::conditional_t<sizeof(Number) == 4, std::uint32_t, std::uint64_t>>>;
    return std::bit_cast<Number>(static_cast<Bits>(bigEndian(sizeof(Number))));
  }

  /// A string of at most `max_size` bytes; it points into the bytes.
  [[nodiscard]] std::string_view text(std::size_t max_size) noexcept;

  /// The bytes of a string up to its first 0, whatever its length and its end say; it points into the bytes.
  [[nodiscard]] std::string_view anyText() noexcept;

  /// Number of an array's elements, at most `max`.
  [[nodiscard]] std::uint32_t count(std::uint32_t max) noexcept;

  void end() noexcept {
    if (!rest_.empty()) spoil(Defect::kTrailingBytes);
  }
  void spoil(Defect defect) noexcept {
    if (defect_ == Defect::kNone) defect_ = defect;
    rest_ = {};
  }
  [[nodiscard]] Defect defect() const noexcept { return defect_; }

 private:
  [[nodiscard]] std::uint64_t bigEndian(std::size_t size) noexcept;

  std::span<const std::byte> rest_;
  Defect defect_ = Defect::kNone;
};

}  // namespace rc10::gateway
