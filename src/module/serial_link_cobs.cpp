// Binary messages of a serial link: a number of the message, then its fields, lowest byte first.
#include <array>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "module/cobs_protocol.hpp"
#include "module/serial_link_codec.hpp"

namespace rc10 {
namespace {

/// A message: its number, and which fields it has at which bytes.
struct CobsMessage {
  struct Part {
    std::size_t field = 0;
    std::size_t at = 0;
  };
  std::uint8_t number = 0;
  std::size_t size = 1;  ///< With the number.
  std::vector<Part> parts;
};

[[nodiscard]] std::vector<CobsMessage> messagesOf(const std::vector<SerialLinkField>& fields) {
  std::vector<CobsMessage> messages;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const auto number = static_cast<std::uint8_t>(std::strtoul(fields[i].message.c_str(), nullptr, 10));
    CobsMessage* message = nullptr;
    for (auto& known : messages) {
      if (known.number == number) message = &known;
    }
    if (message == nullptr) {
      message = &messages.emplace_back();
      message->number = number;
    }
    message->parts.push_back({.field = i, .at = message->size});
    message->size += bytesOf(fields[i].type);
  }
  return messages;
}

class CobsCodec final : public SerialLinkCodec, public CobsListener {
 public:
  CobsCodec(std::vector<SerialLinkField> received, std::vector<SerialLinkField> sent)
      : heard_(messagesOf(received)),
        said_(messagesOf(sent)),
        received_(std::move(received)),
        sent_(std::move(sent)),
        owned_(std::make_unique<CobsProtocol>(*this)),
        protocol_(owned_.get()) {}

  [[nodiscard]] std::unique_ptr<I_Protocol> takeProtocol() override { return std::move(owned_); }
  [[nodiscard]] const ReceivedFields& received() const noexcept override { return received_; }
  [[nodiscard]] std::uint64_t errors() const noexcept override {
    return protocol_->counters().checksum_errors + wrong_size_;
  }

  void step(SerialDevice& device, std::span<const double> values, Round round,
            MonotonicTime) noexcept override {
    if (round == Round::kGoesOn) return;
    for (const auto& message : said_) {
      std::array<std::uint8_t, CobsProtocol::kLongestContent> content{};
      content[0] = message.number;
      for (const auto& part : message.parts) {
        const auto& field = sent_[part.field];
        writeWire(field.type, values[part.field] / field.scale,
                  std::span{content}.subspan(part.at, bytesOf(field.type)));
      }
      (void)device.sendFrame(std::span<const std::uint8_t>{content}.first(message.size));
    }
  }

 private:
  void onFrame(std::span<const std::uint8_t> content, MonotonicTime received) noexcept override {
    for (const auto& message : heard_) {
      if (message.number != content[0]) continue;
      if (content.size() != message.size) {
        ++wrong_size_;
        return;
      }
      for (const auto& part : message.parts) {
        const auto type = received_.fields[part.field].type;
        received_.set(part.field, readWire(type, content.subspan(part.at, bytesOf(type))), received);
      }
    }
  }

  std::vector<CobsMessage> heard_;
  std::vector<CobsMessage> said_;
  ReceivedFields received_;
  std::vector<SerialLinkField> sent_;
  std::uint64_t wrong_size_ = 0;
  std::unique_ptr<CobsProtocol> owned_;
  const CobsProtocol* protocol_;
};

}  // namespace

std::unique_ptr<SerialLinkCodec> makeCobsCodec(std::vector<SerialLinkField> received,
                                               std::vector<SerialLinkField> sent) {
  return std::make_unique<CobsCodec>(std::move(received), std::move(sent));
}

}  // namespace rc10
