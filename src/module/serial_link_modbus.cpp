// Registers of a Modbus RTU slave as fields of a serial link: one question at a time, in turn.
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "bus/byte_order.hpp"
#include "module/modbus_rtu.hpp"
#include "module/serial_link_codec.hpp"

namespace rc10 {
namespace {

/// Registers that one question reads or writes: neighbours.
struct ModbusExchange {
  ModbusFunction function{};
  std::uint16_t first = 0;
  std::uint16_t count = 0;
  std::vector<std::size_t> fields;
};

[[nodiscard]] std::uint16_t registersOf(const SerialLinkField& field) noexcept {
  return bytesOf(field.type) > 2 ? 2 : 1;
}

// Neighbouring registers of one kind together, in the order of their numbers.
void addExchanges(const std::vector<SerialLinkField>& fields, bool input_registers, bool write,
                  std::vector<ModbusExchange>& out) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (fields[i].input_register == input_registers) order.push_back(i);
  }
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return fields[a].reg < fields[b].reg; });
  const std::size_t most = write ? ModbusRtu::kMostWritten : ModbusRtu::kMostRead;
  const std::size_t begin = out.size();
  for (const auto i : order) {
    const auto& field = fields[i];
    const bool goes_on = out.size() > begin && out.back().first + out.back().count == field.reg &&
                         out.back().count + registersOf(field) <= static_cast<int>(most);
    if (!goes_on) {
      auto function = input_registers ? ModbusFunction::kReadInput : ModbusFunction::kReadHolding;
      if (write) function = ModbusFunction::kWriteMultiple;
      out.push_back({.function = function, .first = field.reg, .count = 0, .fields = {}});
    }
    out.back().count = static_cast<std::uint16_t>(out.back().count + registersOf(field));
    out.back().fields.push_back(i);
  }
  // Many small slaves know only the function for one.
  for (std::size_t i = begin; i < out.size() && write; ++i) {
    if (out[i].count == 1) out[i].function = ModbusFunction::kWriteSingle;
  }
}

class ModbusCodec final : public SerialLinkCodec {
 public:
  ModbusCodec(const ModbusSettings& settings, std::vector<SerialLinkField> received,
              std::vector<SerialLinkField> sent)
      : settings_(settings),
        received_(std::move(received)),
        sent_(std::move(sent)),
        owned_(std::make_unique<ModbusRtu>(settings.frame_gap)),
        modbus_(owned_.get()) {
    addExchanges(sent_, false, true, exchanges_);
    writes_ = exchanges_.size();
    addExchanges(received_.fields, false, false, exchanges_);
    addExchanges(received_.fields, true, false, exchanges_);
    next_ = exchanges_.size();
  }

  [[nodiscard]] std::unique_ptr<I_Protocol> takeProtocol() override { return std::move(owned_); }
  [[nodiscard]] const ReceivedFields& received() const noexcept override { return received_; }
  [[nodiscard]] std::uint64_t errors() const noexcept override {
    const auto& counters = modbus_->modbusCounters();
    return counters.exceptions + counters.timeouts + modbus_->counters().checksum_errors;
  }

  void step(SerialDevice& device, std::span<const double> values, Round round,
            MonotonicTime now) noexcept override {
    modbus_->update(now);
    if (asked_ && modbus_->state() != ModbusState::kWaiting) takeAnswer(now);
    if (round == Round::kUrgent) writes_first_ = true;
    if (round != Round::kGoesOn && next_ == exchanges_.size()) next_ = 0;  // a longer round goes on
    const bool free = modbus_->state() != ModbusState::kWaiting && now >= quiet_until_;
    if (free && std::exchange(writes_first_, writes_first_ && !free)) next_ = 0;
    if (free && next_ < exchanges_.size()) ask(device, values, now);
  }

 private:
  void ask(SerialDevice& device, std::span<const double> values, MonotonicTime now) noexcept {
    const auto& exchange = exchanges_[next_];
    std::array<std::uint16_t, ModbusRtu::kMostWritten> registers{};
    ModbusRequest request{.address = settings_.address,
                          .function = exchange.function,
                          .first = exchange.first,
                          .count = exchange.count};
    if (next_ < writes_) {
      std::size_t at = 0;
      for (const auto i : exchange.fields) {
        const auto words = wordsOf(sent_[i], values[i] / sent_[i].scale);
        std::copy_n(words.begin(), registersOf(sent_[i]),
                    registers.begin() + static_cast<std::ptrdiff_t>(at));
        at += registersOf(sent_[i]);
      }
      request.values = std::span{registers}.first(at);
    }
    std::array<std::uint8_t, ModbusRtu::kLongestFrame> frame{};
    const auto size = modbus_->begin(request, now, patience(exchange), frame);
    if (size == 0) return;  // the line is not silent yet
    (void)device.send(std::span<const std::uint8_t>{frame}.first(size));
    asked_ = true;
  }

  // The bytes of question and answer are on the wire in it.
  [[nodiscard]] Duration patience(const ModbusExchange& exchange) const noexcept {
    constexpr int kFrameBytes =
        9;  // of a write or a question, and what stands around the registers of an answer
    return settings_.timeout + settings_.byte_time * (2 * kFrameBytes + 2 * exchange.count) +
           settings_.frame_gap;
  }

  void takeAnswer(MonotonicTime now) noexcept {
    asked_ = false;
    // A late answer does not say to which question: it is let pass before the next one.
    if (modbus_->state() == ModbusState::kTimedOut) quiet_until_ = now + patience(exchanges_[next_]);
    const auto& exchange = exchanges_[next_];
    const bool read = next_++ >= writes_;
    if (!read || modbus_->state() != ModbusState::kDone) return;
    std::size_t at = 0;
    for (const auto i : exchange.fields) {
      const auto count = registersOf(received_.fields[i]);
      received_.set(i, valueOf(received_.fields[i], modbus_->values().subspan(at, count)),
                    modbus_->answered());
      at += count;
    }
  }

  // A register is a word; of two the first is the high one, unless the slave has it otherwise.
  [[nodiscard]] std::array<std::uint16_t, 2> wordsOf(const SerialLinkField& field,
                                                     double value) const noexcept {
    std::array<std::uint8_t, 4> bytes{};
    writeWire(field.type, value, bytes);
    const auto low = readLittleEndian<std::uint16_t>(bytes, 0);
    const auto high = readLittleEndian<std::uint16_t>(bytes, 2);
    const bool low_first = registersOf(field) == 1 || settings_.low_word_first;
    return low_first ? std::array{low, high} : std::array{high, low};
  }

  [[nodiscard]] double valueOf(const SerialLinkField& field,
                               std::span<const std::uint16_t> words) const noexcept {
    std::array<std::uint8_t, 4> bytes{};
    const bool two = words.size() > 1;
    const std::size_t low = two && !settings_.low_word_first ? 1 : 0;
    writeLittleEndian(bytes, 0, words[low]);
    if (two) writeLittleEndian(bytes, 2, words[1 - low]);
    return readWire(field.type, bytes);
  }

  ModbusSettings settings_;
  ReceivedFields received_;
  std::vector<SerialLinkField> sent_;
  std::vector<ModbusExchange> exchanges_;  ///< Writes first.
  std::size_t writes_ = 0;
  std::size_t next_ = 0;  ///< Next question of the round under way; at its end: over.
  bool asked_ = false;
  bool writes_first_ = false;
  MonotonicTime quiet_until_{};
  std::unique_ptr<ModbusRtu> owned_;
  ModbusRtu* modbus_;
};

}  // namespace

std::unique_ptr<SerialLinkCodec> makeModbusCodec(const ModbusSettings& settings,
                                                 std::vector<SerialLinkField> received,
                                                 std::vector<SerialLinkField> sent) {
  return std::make_unique<ModbusCodec>(settings, std::move(received), std::move(sent));
}

}  // namespace rc10
