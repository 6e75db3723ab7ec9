#include "module/modbus_rtu.hpp"

#include <algorithm>

#include "bus/byte_order.hpp"
#include "module/checksums.hpp"

namespace rc10 {
namespace {

constexpr std::uint8_t kBroadcast = 0;
constexpr std::uint8_t kLastAddress = 247;
constexpr std::uint8_t kExceptionBit = 0x80;
constexpr std::size_t kChecksumBytes = 2;
constexpr std::size_t kExceptionBytes = 5;
constexpr std::size_t kWriteAnswerBytes = 8;
constexpr std::size_t kReadHeadBytes = 3;  // address, function, number of bytes

[[nodiscard]] bool isRead(ModbusFunction function) noexcept {
  return function == ModbusFunction::kReadHolding || function == ModbusFunction::kReadInput;
}

[[nodiscard]] bool isAllowed(const ModbusRequest& request) noexcept {
  if (request.address > kLastAddress) return false;
  switch (request.function) {
    case ModbusFunction::kReadHolding:
    case ModbusFunction::kReadInput:
      return request.address != kBroadcast && request.count >= 1 && request.count <= ModbusRtu::kMostRead;
    case ModbusFunction::kWriteSingle: return request.values.size() == 1;
    case ModbusFunction::kWriteMultiple:
      return !request.values.empty() && request.values.size() <= ModbusRtu::kMostWritten;
  }
  return false;
}

}  // namespace

Duration ModbusRtu::frameGap(const SerialFormat& format) noexcept {
  if (format.baud > 19200) return std::chrono::microseconds{1750};
  return format.byteTime() * 7 / 2;
}

std::size_t ModbusRtu::begin(const ModbusRequest& request, MonotonicTime now, Duration timeout,
                             std::span<std::uint8_t> out) noexcept {
  update(now);
  if (state_ == ModbusState::kWaiting || now < quiet_from_ || !isAllowed(request)) return 0;

  // Address, function, first register, then what the function needs: value, or count, or count and values.
  std::array<std::uint8_t, kLongestFrame> payload{};
  std::size_t size = 6;
  payload[0] = request.address;
  payload[1] = static_cast<std::uint8_t>(request.function);
  writeBigEndian(payload, 2, request.first);
  if (isRead(request.function)) {
    writeBigEndian(payload, 4, request.count);
  } else if (request.function == ModbusFunction::kWriteSingle) {
    writeBigEndian(payload, 4, request.values[0]);
  } else {
    writeBigEndian(payload, 4, static_cast<std::uint16_t>(request.values.size()));
    payload[size++] = static_cast<std::uint8_t>(2 * request.values.size());
    for (const std::uint16_t value : request.values) {
      writeBigEndian(payload, size, value);
      size += 2;
    }
  }
  const std::size_t length = pack_frame(std::span(payload).first(size), out);
  if (length == 0) return 0;

  ++modbus_counters_.requests;
  scanner_.clear(counters_);
  std::copy_n(payload.begin(), head_.size(), head_.begin());
  count_ = request.count;
  deadline_ = now + timeout;
  quiet_from_ = now + frame_gap_;
  state_ = request.address == kBroadcast ? ModbusState::kDone : ModbusState::kWaiting;
  return length;
}

void ModbusRtu::update(MonotonicTime now) noexcept {
  if (state_ != ModbusState::kWaiting || now < deadline_) return;
  ++modbus_counters_.timeouts;
  state_ = ModbusState::kTimedOut;
  scanner_.clear(counters_);
}

void ModbusRtu::restart() noexcept {
  scanner_.clear(counters_);
  if (state_ != ModbusState::kWaiting) return;
  ++modbus_counters_.timeouts;
  state_ = ModbusState::kTimedOut;
}

void ModbusRtu::parse_stream(std::span<const std::uint8_t> bytes, MonotonicTime received) noexcept {
  if (!bytes.empty()) quiet_from_ = std::max(quiet_from_, received + frame_gap_);
  scanner_.scan(bytes, counters_, [&](std::span<const std::uint8_t> shown) {
    const auto verdict = judge(shown);
    if (verdict == ScanVerdict::kFrame) take(shown, received);
    return verdict;
  });
}

ScanVerdict ModbusRtu::judge(std::span<const std::uint8_t> shown) const noexcept {
  if (state_ != ModbusState::kWaiting || !matches(shown)) return ScanVerdict::kNoise;
  if (shown.size() < kReadHeadBytes || shown.size() < answerLength(shown)) return ScanVerdict::kMore;
  const auto checked = shown.first(shown.size() - kChecksumBytes);
  return crc16Modbus(checked) == readLittleEndian<std::uint16_t>(shown, checked.size())
             ? ScanVerdict::kFrame
             : ScanVerdict::kBadChecksum;
}

// Whether the last of these bytes may stand there in an answer to the question under way.
bool ModbusRtu::matches(std::span<const std::uint8_t> shown) const noexcept {
  const std::size_t at = shown.size() - 1;
  if (at == 0) return shown[0] == head_[0];
  if (at == 1) return (shown[1] & ~kExceptionBit) == head_[1];
  if ((shown[1] & kExceptionBit) != 0) return true;
  if (isRead(static_cast<ModbusFunction>(head_[1]))) return at > 2 || shown[2] == 2 * count_;
  return at >= head_.size() || shown[at] == head_[at];
}

std::size_t ModbusRtu::answerLength(std::span<const std::uint8_t> shown) const noexcept {
  if ((shown[1] & kExceptionBit) != 0) return kExceptionBytes;
  if (!isRead(static_cast<ModbusFunction>(head_[1]))) return kWriteAnswerBytes;
  return kReadHeadBytes + shown[2] + kChecksumBytes;
}

void ModbusRtu::take(std::span<const std::uint8_t> answer, MonotonicTime received) noexcept {
  answered_ = received;
  if ((answer[1] & kExceptionBit) != 0) {
    ++modbus_counters_.exceptions;
    exception_code_ = answer[2];
    state_ = ModbusState::kException;
    return;
  }
  ++modbus_counters_.answers;
  state_ = ModbusState::kDone;
  if (!isRead(static_cast<ModbusFunction>(answer[1]))) return;
  value_count_ = answer[2] / 2U;
  for (std::size_t i = 0; i < value_count_; ++i) {
    values_[i] = readBigEndian<std::uint16_t>(answer, kReadHeadBytes + 2 * i);
  }
}

std::size_t ModbusRtu::pack_frame(std::span<const std::uint8_t> payload,
                                  std::span<std::uint8_t> out) const noexcept {
  const std::size_t length = payload.size() + kChecksumBytes;
  if (payload.size() < 2 || length > kLongestFrame || length > out.size()) return 0;
  std::copy(payload.begin(), payload.end(), out.begin());
  writeLittleEndian(out, payload.size(), crc16Modbus(payload));
  return length;
}

}  // namespace rc10
