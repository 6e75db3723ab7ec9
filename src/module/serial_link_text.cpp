// The text protocol of docs/serial-devices.md, both ways: $name,1.25,-0.5*61
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "module/serial_link_codec.hpp"
#include "module/text_protocol.hpp"

namespace rc10 {
namespace {

constexpr int kDecimals = 4;
constexpr double kPerUnit = 10'000.0;

/// The part of a line between `$` and `*`, in a fixed room.
class LineWriter {
 public:
  void add(std::string_view text) noexcept {
    const auto room = std::min(text.size(), line_.size() - size_);
    std::copy_n(text.begin(), room, line_.begin() + static_cast<std::ptrdiff_t>(size_));
    size_ += room;
  }
  // By integers: std::to_chars of a double may allocate.
  void add(double value) noexcept {
    if (!std::isfinite(value)) value = 0.0;
    const double bounded = std::clamp(value, -kMostInText, kMostInText);
    auto left = std::llround(std::fabs(bounded) * kPerUnit);
    std::array<char, kLongestNumberInText> digits{};
    std::size_t at = digits.size();
    for (int i = 0; i <= kDecimals || left > 0; ++i) {
      if (i == kDecimals) digits[--at] = '.';
      digits[--at] = static_cast<char>('0' + left % 10);
      left /= 10;
    }
    if (bounded < 0.0) add("-");
    add(std::string_view{digits.data() + at, digits.size() - at});
  }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const noexcept {
    return {reinterpret_cast<const std::uint8_t*>(line_.data()), size_};
  }

 private:
  std::array<char, TextProtocol::kLongestLine> line_{};
  std::size_t size_ = 0;
};

class TextCodec final : public SerialLinkCodec, public TextListener {
 public:
  TextCodec(std::vector<SerialLinkField> received, std::vector<SerialLinkField> sent)
      : received_(std::move(received)),
        sent_(std::move(sent)),
        owned_(std::make_unique<TextProtocol>(this)),
        protocol_(owned_.get()) {
    for (std::size_t i = 0; i < sent_.size(); ++i) {
      const auto first = std::find_if(sent_.begin(), sent_.end(), [&](const SerialLinkField& field) {
        return field.message == sent_[i].message;
      });
      if (static_cast<std::size_t>(first - sent_.begin()) == i) messages_.push_back(sent_[i].message);
    }
  }

  [[nodiscard]] std::unique_ptr<I_Protocol> takeProtocol() override { return std::move(owned_); }
  [[nodiscard]] const ReceivedFields& received() const noexcept override { return received_; }
  [[nodiscard]] std::uint64_t errors() const noexcept override {
    return protocol_->counters().checksum_errors;
  }

  void step(SerialDevice& device, std::span<const double> values, Round round,
            MonotonicTime) noexcept override {
    if (round == Round::kGoesOn) return;
    for (const auto& message : messages_) {
      std::array<double, TextMessage::kMostValues> numbers{};
      std::size_t count = 0;
      for (std::size_t i = 0; i < sent_.size(); ++i) {
        if (sent_[i].message != message) continue;
        numbers.at(sent_[i].place) = values[i] / sent_[i].scale;
        count = std::max(count, sent_[i].place + 1);
      }
      LineWriter line;
      line.add(message);
      for (std::size_t i = 0; i < count; ++i) {
        line.add(",");
        line.add(numbers.at(i));
      }
      (void)device.sendFrame(line.bytes());
    }
  }

 private:
  void onLine(const TextMessage& message, MonotonicTime received) noexcept override {
    for (std::size_t i = 0; i < received_.fields.size(); ++i) {
      const auto& field = received_.fields[i];
      if (field.message == message.name() && field.place < message.value_count)
        received_.set(i, message.values.at(field.place), received);
    }
  }

  ReceivedFields received_;
  std::vector<SerialLinkField> sent_;
  std::vector<std::string> messages_;
  std::unique_ptr<TextProtocol> owned_;
  const TextProtocol* protocol_;
};

}  // namespace

std::unique_ptr<SerialLinkCodec> makeTextCodec(std::vector<SerialLinkField> received,
                                               std::vector<SerialLinkField> sent) {
  return std::make_unique<TextCodec>(std::move(received), std::move(sent));
}

}  // namespace rc10
