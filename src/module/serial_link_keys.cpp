#include "module/serial_link_keys.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include "module/serial_keys.hpp"
#include "module/text_protocol.hpp"

namespace rc10 {
namespace {

using enum OwnKey::Kind;

// Fields each way: with the three signals of the link they fit into a module's outputs.
constexpr double kMaxFields = 14;
// Numbers of a text line that fit into it at their longest.
constexpr std::size_t kMostSentInLine = 6;
// Share of the line's capacity that rounds may use: the rest is for a computer that was late.
constexpr double kMostOfLine = 0.7;

constexpr std::array<std::string_view, 3> kLinkProtocols{"text", "cobs", "modbus"};
constexpr std::array<std::string_view, 2> kWordOrders{"high_first", "low_first"};
constexpr std::array<std::string_view, 2> kLinkAtEstop{"safe", "keep"};

constexpr OwnKey kFieldName{
    .name = "name",
    .kind = kText,
    .required = true,
    .about = "Name of its signal, unique in the module; best with its unit at the end.",
    .pattern = "[a-z0-9_]{1,31}",
    .words = "a name of a-z, 0-9 and _, at most 31 characters"};
constexpr OwnKey kMessage{.name = "message",
                          .kind = kText,
                          .about =
                              "text: the name of the line that it stands in. cobs: the number of the "
                              "message, 0 to 255; its fields follow each other in the order of this list.",
                          .pattern = "[A-Za-z0-9_]{1,15}",
                          .words = "a name of letters, digits and _, at most 15 characters"};
constexpr OwnKey kPlace{.name = "place",
                        .kind = kInteger,
                        .min = 1,
                        .max = static_cast<double>(TextMessage::kMostValues),
                        .default_text = "1",
                        .about = "text: place of the number in its line."};
constexpr OwnKey kRegister{
    .name = "register",
    .kind = kInteger,
    .max = 65535,
    .about = "modbus: its register, counted from 0; types of four bytes take the next as well."};
constexpr OwnKey kType{.name = "type",
                       .kind = kChoice,
                       .choices = kWireTypes,
                       .default_text = "f32",
                       .about = "cobs, modbus: the number on the wire. modbus has no u8 and i8."};
constexpr OwnKey valueKey(std::string_view name, std::string_view default_text, std::string_view about) {
  return {
      .name = name, .kind = kNumber, .min = -1e9, .max = 1e9, .default_text = default_text, .about = about};
}
constexpr OwnKey kScale = valueKey("scale", "1", "Value of the signal for 1 on the wire; not 0.");

constexpr std::array kReceiveKeys{
    kFieldName,
    kMessage,
    kPlace,
    kRegister,
    OwnKey{.name = "input_register",
           .kind = kFlag,
           .default_text = "false",
           .about = "modbus: an input register (function 4), not a holding register (function 3)."},
    kType,
    kScale};

constexpr std::array kSendKeys{
    kFieldName,
    kMessage,
    kPlace,
    kRegister,
    kType,
    kScale,
    valueKey("min", "-1e9", "The signal is cut off below."),
    valueKey("max", "1e9", "The signal is cut off above."),
    valueKey("safe_value", "0", "What is sent at the start, while nobody commands it, and during an e-stop."),
    OwnKey{.name = "on_estop",
           .kind = kChoice,
           .choices = kLinkAtEstop,
           .default_text = "safe",
           .about =
               "safe: the safe value from the e-stop on, until it was commanded safe once after it. keep: "
               "obeys all the same, as a gripper that must not drop what it holds."}};

constexpr std::array kLinkKeys{
    kPortKey,
    OwnKey{.name = "protocol",
           .kind = kChoice,
           .choices = kLinkProtocols,
           .required = true,
           .about = "text: lines that a person can read and type. cobs: binary messages with a CRC. modbus: "
                    "Modbus RTU, rc10d is the master."},
    baudKey("Baud rate, as set on the board."),
    OwnKey{.name = "format",
           .kind = kText,
           .default_text = "8N1",
           .about = "Data bits, parity, stop bits.",
           .pattern = "[5-8][NEO][12]",
           .words = "8N1, 8E1 or the like"},
    OwnKey{.name = "rate_hz",
           .kind = kInteger,
           .unit = "Hz",
           .min = 1,
           .max = 500,
           .default_text = "50",
           .about = "How often all fields are sent; modbus: how often all registers are written and read."},
    OwnKey{.name = "max_age_ms",
           .kind = kInteger,
           .unit = "ms",
           .min = 5,
           .max = 60'000,
           .default_text = "200",
           .about = "Older values mean nothing: the output is NaN."},
    OwnKey{.name = "address",
           .kind = kInteger,
           .min = 1,
           .max = 247,
           .default_text = "1",
           .about = "modbus: address of the slave."},
    OwnKey{.name = "timeout_ms",
           .kind = kInteger,
           .unit = "ms",
           .min = 5,
           .max = 5000,
           .default_text = "50",
           .about =
               "modbus: time that the slave may take before it answers; the bytes on the wire come on top."},
    OwnKey{.name = "word_order",
           .kind = kChoice,
           .choices = kWordOrders,
           .default_text = "high_first",
           .about = "modbus: order of the two registers of one value."},
    OwnKey{.name = "receive",
           .kind = kRows,
           .max = kMaxFields,
           .about = "What the board sends.",
           .keys = kReceiveKeys},
    OwnKey{.name = "send",
           .kind = kRows,
           .max = kMaxFields,
           .about = "What the board is sent.",
           .keys = kSendKeys}};

[[nodiscard]] SerialLinkField fieldOf(const OwnValues& row) {
  SerialLinkField field;
  field.name = row.text("name");
  field.message = row.text("message");
  field.place = static_cast<std::size_t>(row.integer("place") - 1);
  field.reg = static_cast<std::uint16_t>(row.integer("register"));
  field.input_register = row.given("input_register") && row.flag("input_register");
  const auto type = std::find(kWireTypes.begin(), kWireTypes.end(), row.text("type"));
  field.type = static_cast<WireType>(type - kWireTypes.begin());
  field.scale = row.number("scale");
  return field;
}

[[nodiscard]] std::string brief(double value) {
  std::array<char, 32> text{};
  (void)std::snprintf(text.data(), text.size(), "%g", value);
  return text.data();
}

[[nodiscard]] std::string placeOf(std::string_view list, std::size_t row, std::string_view key) {
  return std::string{list} + "[" + std::to_string(row) + "]." + std::string{key} + ": ";
}

[[nodiscard]] Result<void> checkRow(const OwnValues& row, std::string_view protocol, std::string_view list,
                                    std::size_t index) {
  const auto wrong = [&](std::string_view key, const std::string& why) {
    return fail(placeOf(list, index, key) + why);
  };
  if (row.number("scale") == 0.0) return wrong("scale", "0 makes every value 0; use another");
  if (protocol == "modbus") {
    if (!row.given("register"))
      return wrong("register", "missing: protocol: modbus needs the register of each field");
    const auto type = row.text("type");
    if (type == "u8" || type == "i8")
      return wrong("type", type + " is no register; use u16, i16, u32, i32 or f32");
    const bool two = type != "u16" && type != "i16";
    if (two && row.integer("register") == 65535)
      return wrong("register", "65535 is the last, and " + type + " takes two");
    return {};
  }
  if (!row.given("message"))
    return wrong("message",
                 "missing: protocol: " + std::string{protocol} + " needs the message of each field");
  const auto message = row.text("message");
  if (protocol == "cobs") {
    const bool digits =
        std::all_of(message.begin(), message.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (!digits || message.size() > 3 || std::stoi(message) > 255)
      return wrong("message", "'" + message + "' is no number of a message; use 0 to 255");
    return {};
  }
  if (list == "send" && row.integer("place") > static_cast<int>(kMostSentInLine))
    return wrong("place", "a line that is sent has room for " + std::to_string(kMostSentInLine) +
                              " numbers; use another message");
  return {};
}

// Two fields in one place, and numbers of a line that no field gives.
[[nodiscard]] Result<void> checkPlaces(const OwnValues& own, std::string_view protocol,
                                       std::string_view list) {
  const auto fields = linkFields(own, list);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const bool same_line = protocol == "text" && fields[k].message == fields[i].message;
      if (same_line && fields[k].place == fields[i].place) {
        return fail(placeOf(list, i, "place") + "'" + fields[k].name + "' has it already");
      }
      const auto words = [](const SerialLinkField& field) { return bytesOf(field.type) > 2 ? 2 : 1; };
      const bool overlap = protocol == "modbus" && fields[k].input_register == fields[i].input_register &&
                           fields[k].reg < fields[i].reg + words(fields[i]) &&
                           fields[i].reg < fields[k].reg + words(fields[k]);
      if (overlap) return fail(placeOf(list, i, "register") + "'" + fields[k].name + "' has it already");
    }
    if (protocol != "text" || list != "send") continue;
    for (std::size_t place = 0; place < fields[i].place; ++place) {
      const bool given = std::any_of(fields.begin(), fields.end(), [&](const SerialLinkField& other) {
        return other.message == fields[i].message && other.place == place;
      });
      if (!given) {
        return fail(placeOf(list, i, "place") + "no field is number " + std::to_string(place + 1) + " of '" +
                    fields[i].message + "'");
      }
    }
  }
  return {};
}

[[nodiscard]] Result<void> checkLimits(const OwnValues& own, std::string_view protocol) {
  const auto& rows = own.rows("send");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double low = rows[i].number("min");
    const double high = rows[i].number("max");
    const double safe = rows[i].number("safe_value");
    if (low > high) return fail(placeOf("send", i, "min") + "it is above max");
    const auto range = linkRange(rows[i], protocol);
    if (safe < range.low || safe > range.high) {
      return fail(placeOf("send", i, "safe_value") + "the field can say " + brief(range.low) + " to " +
                  brief(range.high) + "; use another type or scale");
    }
    if (safe < low || safe > high)
      return fail(placeOf("send", i, "safe_value") + "it is not between min and max");
  }
  return {};
}

[[nodiscard]] Result<void> checkNames(const OwnValues& own) {
  std::vector<std::string> names{kLinkSignals.begin(), kLinkSignals.end()};
  for (const auto* list : {"receive", "send"}) {
    const auto& rows = own.rows(list);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto name = rows[i].text("name");
      if (std::find(names.begin(), names.end(), name) != names.end()) {
        return fail(placeOf(list, i, "name") + "there is a signal '" + name +
                    "' already; give each field another name");
      }
      names.push_back(name);
    }
  }
  if (names.size() == kLinkSignals.size())
    return fail("receive: there is no field; name at least one in receive or send");
  return {};
}

// Bytes of all messages, each number as long as it may be.
[[nodiscard]] std::size_t bytesOfRound(const OwnValues& own, std::string_view protocol) {
  constexpr std::size_t kAround = 5;  // $*00 and the line feed; or number, CRC, stuffing and 0
  std::vector<std::string> messages;
  std::size_t bytes = 0;
  for (const auto& field : linkFields(own, "send")) {
    const bool text = protocol == "text";
    bytes += text ? 1 + kLongestNumberInText : bytesOf(field.type);
    if (std::find(messages.begin(), messages.end(), field.message) != messages.end()) continue;
    messages.push_back(field.message);
    bytes += kAround + (text ? field.message.size() : 0);
  }
  return bytes;
}

[[nodiscard]] Result<void> checkLoad(const OwnValues& own, std::string_view protocol,
                                     const SerialFormat& format) {
  if (protocol == "modbus") return {};  // each question waits for its answer
  const std::size_t bytes = bytesOfRound(own, protocol);
  const double round_s =
      std::chrono::duration<double>(format.byteTime()).count() * static_cast<double>(bytes);
  const double most_hz = bytes == 0 ? 1e9 : kMostOfLine / round_s;
  if (own.integer("rate_hz") <= most_hz) return {};
  return fail("rate_hz: the fields are up to " + std::to_string(bytes) + " bytes, and " + format.text() +
              " carries them " + std::to_string(static_cast<int>(most_hz)) +
              " times a second with some room; use a lower rate or a higher baud rate");
}

}  // namespace

std::span<const OwnKey> serialLinkKeys() noexcept { return kLinkKeys; }

std::vector<SerialLinkField> linkFields(const OwnValues& own, std::string_view key) {
  std::vector<SerialLinkField> fields;
  for (const auto& row : own.rows(key)) fields.push_back(fieldOf(row));
  return fields;
}

WireRange linkRange(const OwnValues& row, std::string_view protocol) {
  const double scale = row.number("scale");
  const auto wire = protocol == "text" ? WireRange{-kMostInText, kMostInText} : wireRange(fieldOf(row).type);
  return {std::min(wire.low * scale, wire.high * scale), std::max(wire.low * scale, wire.high * scale)};
}

Result<SerialFormat> checkSerialLink(const OwnValues& own, int tick_hz) {
  const auto protocol = own.text("protocol");
  if (auto names = checkNames(own); !names) return tl::unexpected(names.error());
  for (const auto* list : {"receive", "send"}) {
    const auto& rows = own.rows(list);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (auto row = checkRow(rows[i], protocol, list, i); !row) return tl::unexpected(row.error());
    }
    if (auto places = checkPlaces(own, protocol, list); !places) return tl::unexpected(places.error());
  }
  if (auto limits = checkLimits(own, protocol); !limits) return tl::unexpected(limits.error());
  auto format = SerialFormat::make(own.integer("baud"), own.text("format"));
  if (!format) return fail("format: " + format.error().message);
  if (own.integer("rate_hz") > tick_hz)
    return fail("rate_hz: there are " + std::to_string(tick_hz) + " ticks a second");
  if (auto load = checkLoad(own, protocol, *format); !load) return tl::unexpected(load.error());
  return format;
}

}  // namespace rc10
