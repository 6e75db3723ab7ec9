#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "app/time.hpp"
#include "bus/i_protocol.hpp"
#include "bus/serial_device.hpp"
#include "module/serial_link_field.hpp"

namespace rc10 {

/// The protocol of a serial link on its port: one of text, cobs, modbus. Scheduler thread only.
class SerialLinkCodec {
 public:
  SerialLinkCodec() = default;
  SerialLinkCodec(const SerialLinkCodec&) = delete;
  SerialLinkCodec& operator=(const SerialLinkCodec&) = delete;
  virtual ~SerialLinkCodec() = default;

  /// The protocol for the port; called once. The codec outlives it.
  [[nodiscard]] virtual std::unique_ptr<I_Protocol> takeProtocol() = 0;
  [[nodiscard]] virtual const ReceivedFields& received() const noexcept = 0;
  enum class Round : std::uint8_t {
    kGoesOn,
    kBegins,  ///< It is time to send all fields.
    kUrgent,  ///< A field has become safe: writes come first.
  };
  /// One tick. `values` of the fields that are sent, in their order.
  virtual void step(SerialDevice& device, std::span<const double> values, Round round,
                    MonotonicTime now) noexcept = 0;
  /// Frames that were wrong, refused or not answered.
  [[nodiscard]] virtual std::uint64_t errors() const noexcept = 0;
};

/// `received` and `sent`: checked by the module's type. Fields of one text or cobs message are sent together,
/// a cobs message in the order of its fields.
[[nodiscard]] std::unique_ptr<SerialLinkCodec> makeTextCodec(std::vector<SerialLinkField> received,
                                                             std::vector<SerialLinkField> sent);
[[nodiscard]] std::unique_ptr<SerialLinkCodec> makeCobsCodec(std::vector<SerialLinkField> received,
                                                             std::vector<SerialLinkField> sent);

struct ModbusSettings {
  std::uint8_t address = 1;
  Duration byte_time{};
  Duration frame_gap{};
  Duration timeout{};           ///< From the end of a question to the start of its answer.
  bool low_word_first = false;  ///< Word order of values in two registers.
};
[[nodiscard]] std::unique_ptr<SerialLinkCodec> makeModbusCodec(const ModbusSettings& settings,
                                                               std::vector<SerialLinkField> received,
                                                               std::vector<SerialLinkField> sent);

}  // namespace rc10
