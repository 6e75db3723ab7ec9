#include "module/serial_link.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bus/serial_device.hpp"
#include "fake_robot.hpp"
#include "module/link_field.hpp"
#include "module/modbus_rtu.hpp"
#include "serial_streams.hpp"
#include "support/heard_cobs.hpp"

namespace rc10::test::serial_link_test {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Sink : ByteSink {
  Bytes bytes;
  [[nodiscard]] bool push(std::span<const std::uint8_t> more) noexcept override {
    bytes.insert(bytes.end(), more.begin(), more.end());
    return true;
  }
  std::size_t waiting = 0;
  [[nodiscard]] std::size_t pending() const noexcept override { return waiting; }
};

struct Row {
  std::string name;
  std::string message = {};
  int place = 1;
  int reg = -1;
  std::string type = "f32";
  double scale = 1.0;
  double safe = 0.0;
  double low = -1e9;
  double high = 1e9;
  std::string on_estop = "safe";
  bool input_register = false;
};

OwnValues valuesOf(const Row& row, bool sent) {
  OwnValues own;
  own.set("name", row.name);
  if (!row.message.empty()) own.set("message", row.message);
  own.set("place", static_cast<double>(row.place));
  if (row.reg >= 0) own.set("register", static_cast<double>(row.reg));
  own.set("type", row.type);
  own.set("scale", row.scale);
  if (!sent) {
    own.set("input_register", row.input_register ? 1.0 : 0.0);
    return own;
  }
  own.set("safe_value", row.safe);
  own.set("min", row.low);
  own.set("max", row.high);
  own.set("on_estop", row.on_estop);
  return own;
}

ModuleSettings settingsOf(const std::string& protocol, const std::vector<Row>& receive,
                          const std::vector<Row>& send, double rate_hz = 50) {
  ModuleSettings settings;
  settings.name = "board";
  settings.own.set("port", std::string{"/dev/ttyUSB0"});
  settings.own.set("protocol", protocol);
  settings.own.set("baud", 115200.0);
  settings.own.set("format", std::string{"8N1"});
  settings.own.set("rate_hz", rate_hz);
  settings.own.set("max_age_ms", 200.0);
  settings.own.set("address", 3.0);
  settings.own.set("timeout_ms", 50.0);
  settings.own.set("word_order", std::string{"high_first"});
  std::vector<OwnValues> rows;
  for (const auto& row : receive) rows.push_back(valuesOf(row, false));
  settings.own.set("receive", rows);
  rows.clear();
  for (const auto& row : send) rows.push_back(valuesOf(row, true));
  settings.own.set("send", rows);
  return settings;
}

/// A module with its port, and the board at the other end.
class Board {
 public:
  explicit Board(const ModuleSettings& settings)
      : module_(std::move(serialLinkType().build(settings, outlineOf(1)).value())) {
    auto need = module_->takeSerialNeed();
    device_ = std::make_unique<SerialDevice>("board", std::move(need->protocol), sink_);
    module_->useSerial(*device_);
    device_->setState(SerialState::kOpen);
  }

  void run(int ticks = 1) {
    for (int i = 0; i < ticks; ++i) {
      robot_.update(*module_);
      events_.insert(events_.end(), robot_.events().begin(), robot_.events().end());
    }
  }
  void hear(std::string_view text) { hear(Bytes{text.begin(), text.end()}); }
  void hear(const Bytes& bytes) { device_->protocol().parse_stream(bytes, robot_.now()); }
  void command(std::initializer_list<double> values) {
    const std::vector<double> inputs{values};
    module_->setInputs(inputs);
  }
  /// The bytes sent since the last call.
  [[nodiscard]] std::string said() {
    const auto bytes = std::exchange(sink_.bytes, {});
    return {bytes.begin(), bytes.end()};
  }
  [[nodiscard]] Bytes saidBytes() { return std::exchange(sink_.bytes, {}); }
  [[nodiscard]] double output(std::string_view name) const {
    const auto& names = module_->signals().outputs;
    const auto found = std::find(names.begin(), names.end(), name);
    return module_->outputs()[static_cast<std::size_t>(found - names.begin())];
  }
  [[nodiscard]] FakeRobot& robot() { return robot_; }
  /// Bytes that the line has not taken yet.
  void jam(std::size_t bytes) { sink_.waiting = bytes; }
  void rest(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      now_ += 1ms;
      module_->rest({.index = 0, .now = robot_.now() + now_, .dt_s = 0.001F});
    }
  }
  [[nodiscard]] SerialDevice& device() { return *device_; }
  [[nodiscard]] std::vector<std::size_t> takeEvents() { return std::exchange(events_, {}); }

 private:
  Sink sink_;
  FakeRobot robot_{1};
  std::unique_ptr<Module_Base> module_;
  std::unique_ptr<SerialDevice> device_;
  std::vector<std::size_t> events_;
  Duration now_{};
};

/// "$range,1250*29\n" of "range,1250".
std::string line(const std::string& content) {
  unsigned sum = 0;
  for (const char c : content) sum ^= static_cast<unsigned char>(c);
  constexpr std::string_view kHex = "0123456789ABCDEF";
  return "$" + content + "*" + kHex[sum / 16] + kHex[sum % 16] + "\n";
}

ModuleSettings textLink() {
  return settingsOf("text",
                    {{.name = "range_m", .message = "range", .scale = 0.001},
                     {.name = "load_a", .message = "power", .place = 2}},
                    {{.name = "claw_deg", .message = "claw", .low = 0, .high = 90},
                     {.name = "claw_speed", .message = "claw", .place = 2, .safe = 1.0},
                     {.name = "lamp", .message = "lamp", .scale = 2.0, .on_estop = "keep"}});
}

// ---- text

TEST(SerialLinkText, EveryLineOfATickIsHeard) {
  Board board{textLink()};
  EXPECT_TRUE(std::isnan(board.output("range_m")));
  board.run();
  board.hear(line("range,1250") + line("power,12,-0.5"));
  board.run();
  EXPECT_DOUBLE_EQ(board.output("range_m"), 1.25);
  EXPECT_DOUBLE_EQ(board.output("load_a"), -0.5);
  EXPECT_DOUBLE_EQ(board.output("connected"), 1.0);
  EXPECT_DOUBLE_EQ(board.output("age_ms"), 1.0);
  EXPECT_DOUBLE_EQ(board.output("errors"), 0.0);
}

TEST(SerialLinkText, OldValuesMeanNothingAndTheSilenceIsToldOnce) {
  Board board{textLink()};
  board.run();
  board.hear(line("range,1250") + line("power,12,-0.5"));
  board.run(200);
  EXPECT_DOUBLE_EQ(board.output("range_m"), 1.25);
  EXPECT_THAT(board.takeEvents(), IsEmpty());
  board.run(100);
  EXPECT_TRUE(std::isnan(board.output("range_m")));
  EXPECT_EQ(board.takeEvents(), (std::vector<std::size_t>{0}));
  board.hear(line("range,1250") + line("power,12,-0.5"));
  board.run();
  EXPECT_EQ(board.takeEvents(), (std::vector<std::size_t>{1}));
}

TEST(SerialLinkText, AWrongChecksumIsAnErrorAndNoValue) {
  Board board{textLink()};
  board.hear("$range,1250*28\n");
  board.run();
  EXPECT_TRUE(std::isnan(board.output("range_m")));
  EXPECT_DOUBLE_EQ(board.output("errors"), 1.0);
}

TEST(SerialLinkText, SendsSafeValuesAtItsRateUntilItIsCommanded) {
  Board board{textLink()};
  board.run(20);
  EXPECT_EQ(board.said(), line("claw,0.0000,1.0000") + line("lamp,0.0000"));
  board.run(20);
  EXPECT_EQ(board.said(), line("claw,0.0000,1.0000") + line("lamp,0.0000"));
  EXPECT_DOUBLE_EQ(board.output("claw_speed"), 1.0);
}

TEST(SerialLinkText, ACommandIsCutOffAtItsLimitsAndScaled) {
  Board board{textLink()};
  board.run(1001);  // a program that begins some time after the start
  (void)board.said();
  board.command({1000.0, 0.25, 3.0});
  board.run(20);
  EXPECT_EQ(board.said(), line("claw,90.0000,0.2500") + line("lamp,1.5000"));
  EXPECT_DOUBLE_EQ(board.output("claw_deg"), 90.0);
  EXPECT_DOUBLE_EQ(board.output("lamp"), 3.0);
}

TEST(SerialLinkText, WhoCommandedThroughAnEstopHasToCommandTheSafeValueOnce) {
  Board board{textLink()};
  board.run(1001);
  board.command({45.0, 2.0, 1.0});
  board.run();
  EXPECT_DOUBLE_EQ(board.output("claw_deg"), 45.0);
  board.robot().setState(RobotStatus::kEstop);
  board.run();
  EXPECT_DOUBLE_EQ(board.output("claw_deg"), 0.0);
  EXPECT_DOUBLE_EQ(board.output("lamp"), 1.0) << "on_estop: keep";
  board.robot().setState(RobotStatus::kRun);
  board.run(5);
  EXPECT_DOUBLE_EQ(board.output("claw_deg"), 0.0);
  EXPECT_EQ(board.takeEvents(), (std::vector<std::size_t>{2}));
  board.command({0.0, 1.0, 1.0});
  board.run();
  board.command({45.0, 1.0, 1.0});
  board.run();
  EXPECT_DOUBLE_EQ(board.output("claw_deg"), 45.0);
}

TEST(SerialLinkText, APortThatWasLostStartsWithSafeValues) {
  Board board{textLink()};
  board.run(1001);
  board.command({45.0, 2.0, 1.0});
  board.run();
  board.device().setState(SerialState::kAbsent);
  board.run();
  (void)board.said();
  board.run(20);
  EXPECT_EQ(board.said(), "");
  EXPECT_DOUBLE_EQ(board.output("connected"), 0.0);
  EXPECT_TRUE(std::isnan(board.output("claw_deg")));
  board.device().setState(SerialState::kOpen);
  board.run(20);
  EXPECT_THAT(board.said(), HasSubstr(line("claw,0.0000,1.0000")));
}

TEST(SerialLinkText, ASafeValueIsSentAtOnceWhateverTheRate) {
  Board board{settingsOf("text", {}, {{.name = "a", .message = "m"}}, 1)};
  board.run(1001);
  board.command({5.0});
  board.run(1001);
  EXPECT_THAT(board.said(), HasSubstr(line("m,5.0000")));
  board.run(100);
  EXPECT_EQ(board.said(), "");
  board.robot().setState(RobotStatus::kEstop);
  board.run();
  EXPECT_EQ(board.said(), line("m,0.0000"));
}

TEST(SerialLinkText, ALineThatIsBehindGetsNoMoreAndThenWhatIsNew) {
  Board board{settingsOf("text", {}, {{.name = "a", .message = "m"}})};
  board.run(1001);
  board.command({5.0});
  board.run(20);
  (void)board.said();
  board.jam(200);
  board.run(200);
  EXPECT_EQ(board.said(), "") << "nothing is queued behind what waits";
  EXPECT_GE(board.output("errors"), 9.0);
  board.robot().setState(RobotStatus::kEstop);
  board.run(5);
  EXPECT_EQ(board.said(), "");
  board.jam(0);
  board.run();
  EXPECT_EQ(board.said(), line("m,0.0000")) << "what is safe comes first";
}

TEST(SerialLinkText, AtTheEndOfTheProgramEveryFieldIsSafe) {
  Board board{textLink()};
  board.run(1001);
  board.command({45.0, 2.0, 3.0});
  board.run(20);
  (void)board.said();
  board.rest(1);
  EXPECT_EQ(board.said(), line("claw,0.0000,1.0000") + line("lamp,0.0000"));
}

TEST(SerialLinkText, NumbersAreWrittenInFull) {
  Board board{settingsOf("text", {}, {{.name = "a", .message = "m"}}, 250)};
  board.run(1001);
  for (const auto& [value, text] :
       {std::pair{-0.00004, "-0.0000"}, std::pair{123456.78915, "123456.7892"},
        std::pair{-1e9, "-999999999.0000"}, std::pair{9.99996, "10.0000"}, std::pair{-0.5, "-0.5000"}}) {
    (void)board.said();
    board.command({value});
    board.run(4);
    EXPECT_THAT(board.said(), HasSubstr("$m," + std::string{text} + "*")) << value;
  }
}

// ---- cobs

Bytes frameOf(const Bytes& content) { return HeardCobs::packed(content); }

TEST(SerialLinkCobs, FieldsFollowEachOtherInTheOrderOfTheList) {
  Board board{settingsOf("cobs",
                         {{.name = "a", .message = "7", .type = "i16", .scale = 0.1},
                          {.name = "other", .message = "8", .type = "u8"},
                          {.name = "b", .message = "7", .type = "f32"}},
                         {{.name = "x", .message = "1", .type = "u8"},
                          {.name = "y", .message = "1", .type = "i32", .scale = 0.001}})};
  board.run(1001);
  (void)board.said();
  // -2 and 1.0F, lowest byte first.
  board.hear(joined({frameOf({7, 0xFE, 0xFF, 0x00, 0x00, 0x80, 0x3F}), frameOf({8, 200})}));
  board.command({300.0, -1.5});
  board.run(20);
  EXPECT_DOUBLE_EQ(board.output("a"), -0.2);
  EXPECT_DOUBLE_EQ(board.output("b"), 1.0);
  EXPECT_DOUBLE_EQ(board.output("other"), 200.0);
  // 300 is cut off at 255; -1500.
  EXPECT_EQ(board.saidBytes(), frameOf({1, 255, 0x24, 0xFA, 0xFF, 0xFF}));
}

TEST(SerialLinkCobs, AMessageOfAnotherSizeIsAnErrorAndOfAnotherNumberNothing) {
  Board board{settingsOf("cobs", {{.name = "a", .message = "7", .type = "i16"}}, {})};
  board.hear(frameOf({7, 1}));
  board.hear(frameOf({6, 1, 2}));
  board.run();
  EXPECT_TRUE(std::isnan(board.output("a")));
  EXPECT_DOUBLE_EQ(board.output("errors"), 1.0);
}

TEST(LinkField, EveryTypeKeepsWhatItCanSayAndCutsOffTheRest) {
  constexpr std::array<std::pair<WireType, std::pair<double, double>>, 6> kRanges{
      {{WireType::kU8, {0, 255}},
       {WireType::kI8, {-128, 127}},
       {WireType::kU16, {0, 65535}},
       {WireType::kI16, {-32768, 32767}},
       {WireType::kU32, {0, 4294967295.0}},
       {WireType::kI32, {-2147483648.0, 2147483647.0}}}};
  std::array<std::uint8_t, 4> bytes{};
  for (const auto& [type, range] : kRanges) {
    for (const double value : {range.first, range.second, 0.0, 7.0}) {
      writeWire(type, value, bytes);
      EXPECT_EQ(readWire(type, bytes), value);
    }
    writeWire(type, 1e300, bytes);
    EXPECT_EQ(readWire(type, bytes), range.second);
    writeWire(type, -1e300, bytes);
    EXPECT_EQ(readWire(type, bytes), range.first);
    writeWire(type, kNoSignal, bytes);
    EXPECT_EQ(readWire(type, bytes), 0.0);
  }
  writeWire(WireType::kF32, -0.5, bytes);
  EXPECT_EQ(readWire(WireType::kF32, bytes), -0.5);
  writeWire(WireType::kF32, 1e300, bytes);
  EXPECT_TRUE(std::isfinite(readWire(WireType::kF32, bytes)));
}

// ---- modbus

ModuleSettings modbusLink() {
  return settingsOf("modbus",
                    {{.name = "temperature_c", .reg = 10, .type = "i16", .scale = 0.1},
                     {.name = "energy", .reg = 11, .type = "u32"},
                     {.name = "level", .reg = 2, .type = "u16", .input_register = true}},
                    {{.name = "pump", .reg = 100, .type = "u16"}});
}

/// A frame with its checksum, which the protocol of another module computes.
Bytes modbusFrame(const Bytes& content) {
  Bytes out(content.size() + 2);
  out.resize(ModbusRtu{}.pack_frame(content, out));
  return out;
}

TEST(SerialLinkModbus, WritesAndReadsItsRegistersInTurn) {
  Board board{modbusLink()};
  board.run(1001);
  board.hear(modbusFrame({3, 6, 0, 100, 0, 0}));  // the answer to the first write
  board.command({7.0});
  (void)board.said();
  Bytes said;
  std::vector<Bytes> questions;
  for (int i = 0; i < 400 && questions.size() < 3; ++i) {
    board.run();
    const auto bytes = board.saidBytes();
    if (bytes.empty()) continue;
    if (bytes[1] == 6 && bytes[5] == 7) {
      questions.push_back(bytes);
      board.hear(bytes);  // a write is answered by itself
    } else if (bytes[1] == 6) {
      board.hear(bytes);
    } else if (bytes[1] == 3) {
      if (!questions.empty()) questions.push_back(bytes);
      board.hear(modbusFrame({3, 3, 6, 0xFF, 0x9C, 0x00, 0x01, 0x00, 0x02}));
    } else {
      if (questions.size() == 2) questions.push_back(bytes);
      board.hear(modbusFrame({3, 4, 2, 0x12, 0x34}));
    }
  }
  board.run(2);
  ASSERT_EQ(questions.size(), 3U);
  EXPECT_EQ(questions[0], modbusFrame({3, 6, 0, 100, 0, 7}));
  EXPECT_EQ(questions[1], modbusFrame({3, 3, 0, 10, 0, 3})) << "neighbours in one question";
  EXPECT_EQ(questions[2], modbusFrame({3, 4, 0, 2, 0, 1}));
  EXPECT_DOUBLE_EQ(board.output("temperature_c"), -10.0);
  EXPECT_DOUBLE_EQ(board.output("energy"), 65538.0);
  EXPECT_DOUBLE_EQ(board.output("level"), 0x1234);
}

// Two questions that look alike: an answer does not say to which it belongs.
TEST(SerialLinkModbus, ALateAnswerIsNotTakenForThatToTheNextQuestion) {
  Board board{settingsOf(
      "modbus", {{.name = "a", .reg = 0, .type = "u16"}, {.name = "b", .reg = 10, .type = "u16"}}, {})};
  const auto question_a = modbusFrame({3, 3, 0, 0, 0, 1});
  for (int i = 0; i < 100 && board.saidBytes() != question_a; ++i) board.run();
  board.run(58);  // its time is over
  board.hear(modbusFrame({3, 3, 2, 0x11, 0x11}));
  board.run(1);
  EXPECT_TRUE(std::isnan(board.output("a")));
  board.run(100);
  EXPECT_TRUE(std::isnan(board.output("b")));
  EXPECT_EQ(board.saidBytes(), modbusFrame({3, 3, 0, 10, 0, 1})) << "asked when the late one has passed";
  board.hear(modbusFrame({3, 3, 2, 0x22, 0x22}));
  board.run(2);
  EXPECT_DOUBLE_EQ(board.output("b"), 0x2222);
  EXPECT_GE(board.output("errors"), 1.0);
}

TEST(SerialLinkModbus, AnEstopIsWrittenBeforeTheRoundGoesOn) {
  Board board{modbusLink()};
  board.run(1001);
  const auto answerTo = [&](const Bytes& question) {
    if (question[1] == 6) board.hear(question);
    if (question[1] == 3) board.hear(modbusFrame({3, 3, 6, 0, 0, 0, 0, 0, 0}));
    if (question[1] == 4) board.hear(modbusFrame({3, 4, 2, 0, 0}));
  };
  const auto next = [&] {
    for (int i = 0; i < 200; ++i) {
      const auto said = board.saidBytes();
      if (!said.empty()) return said;
      board.run();
    }
    return Bytes{0, 0};
  };
  board.command({7.0});
  Bytes question;
  for (int i = 0; i < 20 && question != modbusFrame({3, 6, 0, 100, 0, 7}); ++i) answerTo(question = next());
  question = next();
  ASSERT_EQ(question[1], 3);  // the round goes on with its reading
  board.robot().setState(RobotStatus::kEstop);
  board.run();
  answerTo(question);
  EXPECT_EQ(next(), modbusFrame({3, 6, 0, 100, 0, 0}));
}

TEST(SerialLinkModbus, ASlaveThatDoesNotAnswerIsAskedAgainAndCounted) {
  Board board{modbusLink()};
  board.run(600);
  EXPECT_GE(board.output("errors"), 3.0);
  EXPECT_TRUE(std::isnan(board.output("level")));
  EXPECT_FALSE(board.said().empty());
}

// ---- what the configuration may say

std::string errorOf(const ModuleSettings& settings) {
  const auto built = serialLinkType().build(settings, outlineOf(1));
  return built ? "" : built.error().message;
}

TEST(SerialLinkKeys, EachMistakeIsNamedWithItsPlace) {
  using Rows = std::vector<Row>;
  struct Wrong {
    std::string protocol;
    Rows receive;
    Rows send;
    std::string error;
  };
  for (const auto& wrong : std::vector<Wrong>{
           {"text", {}, {}, "receive: there is no field"},
           {"text", {{.name = "a"}}, {}, "receive[0].message: missing"},
           {"text",
            {{.name = "a", .message = "m"}},
            {{.name = "a", .message = "n"}},
            "send[0].name: there is a signal 'a'"},
           {"text", {{.name = "errors", .message = "m"}}, {}, "receive[0].name: there is a signal 'errors'"},
           {"text",
            {{.name = "a", .message = "m"}, {.name = "b", .message = "m"}},
            {},
            "receive[1].place: 'a' has it"},
           {"text",
            {},
            {{.name = "a", .message = "m", .place = 2}},
            "send[0].place: no field is number 1 of 'm'"},
           {"text",
            {},
            {{.name = "a", .message = "m", .place = 7}},
            "send[0].place: a line that is sent has room"},
           {"text", {{.name = "a", .message = "m", .scale = 0.0}}, {}, "receive[0].scale: 0"},
           {"cobs", {{.name = "a", .message = "256"}}, {}, "receive[0].message: '256' is no number"},
           {"cobs", {{.name = "a", .message = "x"}}, {}, "receive[0].message: 'x' is no number"},
           {"modbus", {{.name = "a"}}, {}, "receive[0].register: missing"},
           {"modbus", {{.name = "a", .reg = 1, .type = "u8"}}, {}, "receive[0].type: u8 is no register"},
           {"modbus", {{.name = "a", .reg = 65535}}, {}, "receive[0].register: 65535 is the last"},
           {"modbus",
            {{.name = "a", .reg = 1, .type = "u32"}, {.name = "b", .reg = 2, .type = "u16"}},
            {},
            "receive[1].register: 'a' has it"},
           {"text", {}, {{.name = "a", .message = "m", .low = 2, .high = 1}}, "send[0].min: it is above max"},
           {"text",
            {},
            {{.name = "a", .message = "m", .safe = 5, .high = 1}},
            "send[0].safe_value: it is not between"}}) {
    EXPECT_THAT(errorOf(settingsOf(wrong.protocol, wrong.receive, wrong.send)), HasSubstr(wrong.error));
  }
  EXPECT_THAT(errorOf(settingsOf("cobs", {}, {{.name = "a", .message = "1", .type = "u16", .safe = -10}})),
              HasSubstr("send[0].safe_value: the field can say 0 to 65535"));
  EXPECT_THAT(errorOf(settingsOf("text", {}, {{.name = "a", .message = "m"}}, 500)),
              HasSubstr("rate_hz: the fields are up to 22 bytes, and 115200 8N1 carries them 366 times"));
  EXPECT_EQ(errorOf(settingsOf("modbus",
                               {{.name = "a", .reg = 1, .type = "u16"},
                                {.name = "b", .reg = 1, .type = "u16", .input_register = true}},
                               {})),
            "");
}

}  // namespace
}  // namespace rc10::test::serial_link_test
