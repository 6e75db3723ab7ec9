#pragma once

#include <array>
#include <cstdio>
#include <string>
#include <string_view>
#include <utility>

#include "bus/can_frame.hpp"

namespace rc10 {

/// A data frame of a family in words, with the values that it carries: "3 feedback: velocity 1500 rpm";
/// empty: none of this family. `model` is one of the family's: of scales that a configuration may change, its
/// own ones count, and the words name them. `sent`: by the host.
using Wording = std::string (*)(const CanFrame& frame, std::string_view model, bool sent);

/// Makes such words.
class FrameWords {
 public:
  explicit FrameWords(std::string_view what) : text_(what) {}
  FrameWords(int id, std::string_view what) : text_(std::to_string(id)) { (text_ += ' ') += what; }

  FrameWords& add(std::string_view name, double value, std::string_view unit = {}) {
    std::array<char, 32> number{};
    // Counts, and speeds of a rotor, in whole numbers.
    const bool large = value >= 1000.0 || value <= -1000.0;
    (void)std::snprintf(number.data(), number.size(),
                        large && value < 1e15 && value > -1e15 ? "%.0f" : "%.4g", value);
    text_ += first_ ? ": " : ", ";
    first_ = false;
    text_ += name;
    if (!name.empty()) text_ += ' ';
    text_ += number.data();
    if (!unit.empty()) (text_ += ' ') += unit;
    return *this;
  }
  /// A number as the drive's manual has it.
  FrameWords& code(std::string_view name, std::uint32_t value) {
    std::array<char, 16> number{};
    (void)std::snprintf(number.data(), number.size(), "0x%X", value);
    text_ += first_ ? ": " : ", ";
    first_ = false;
    ((text_ += name) += ' ') += number.data();
    return *this;
  }
  FrameWords& word(std::string_view word) {
    (text_ += first_ ? ": " : ", ") += word;
    first_ = false;
    return *this;
  }
  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  std::string text_;
  bool first_ = true;
};

}  // namespace rc10
