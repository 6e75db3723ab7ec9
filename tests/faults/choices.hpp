#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <span>

namespace rc10::test {

/// Where the chaos takes its decisions from: a seed, or the bytes of a fuzzer.
class Choices {
 public:
  Choices() = default;
  Choices(const Choices&) = delete;
  Choices& operator=(const Choices&) = delete;
  virtual ~Choices() = default;

  /// One of 0 to bound - 1.
  [[nodiscard]] virtual std::uint32_t next(std::uint32_t bound) = 0;

  [[nodiscard]] bool oneIn(std::uint32_t n) { return next(n) == 0; }
  template <typename T, std::size_t N>
  [[nodiscard]] T of(const T (&values)[N]) {  // NOLINT(modernize-avoid-c-arrays)
    return values[next(static_cast<std::uint32_t>(N))];
  }
};

/// The same seed, the same choices, with every standard library.
class SeededChoices : public Choices {
 public:
  explicit SeededChoices(std::uint64_t seed) : random_(seed) {}
  [[nodiscard]] std::uint32_t next(std::uint32_t bound) override {
    return static_cast<std::uint32_t>((random_() >> 32U) * bound >> 32U);
  }

 private:
  std::mt19937_64 random_;
};

/// One or two bytes a choice; zeros after the end.
class BytesOfChoices : public Choices {
 public:
  explicit BytesOfChoices(std::span<const std::uint8_t> bytes) : left_(bytes) {}
  [[nodiscard]] std::uint32_t next(std::uint32_t bound) override {
    std::uint32_t value = take();
    if (bound > 256) value = value << 8U | take();
    return value % bound;
  }
  [[nodiscard]] bool over() const noexcept { return left_.empty(); }

 private:
  [[nodiscard]] std::uint32_t take() {
    if (left_.empty()) return 0;
    const std::uint8_t byte = left_.front();
    left_ = left_.subspan(1);
    return byte;
  }
  std::span<const std::uint8_t> left_;
};

}  // namespace rc10::test
