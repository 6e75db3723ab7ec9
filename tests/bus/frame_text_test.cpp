#include "bus/frame_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

namespace rc10::test::frame_text_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using ::testing::StrEq;

constexpr std::array<std::uint8_t, 3> kBytes{0x01, 0xAB, 0xFF};

TEST(FrameText, IsWhatCansendTakes) {
  EXPECT_EQ(frameText(makeClassicFrame({0x200, false}, kBytes)), "200#01ABFF");
  EXPECT_EQ(frameText(makeClassicFrame({0x1, true}, {})), "00000001#");
  EXPECT_EQ(frameText(makeFdFrame({0x8001, true}, kBytes, true)), "00008001##101ABFF");
  EXPECT_EQ(frameText(makeFdFrame({0x7FF, false}, {}, false)), "7FF##0");
}

TEST(FrameText, ComesBackAsTheFrameItWas) {
  std::array<std::uint8_t, 64> long_payload{};
  for (std::size_t i = 0; i < long_payload.size(); ++i) long_payload[i] = static_cast<std::uint8_t>(i * 5);
  for (const auto& frame :
       {makeClassicFrame({0x7FF, false}, kBytes), makeClassicFrame({0x7FF, true}, {}),
        makeFdFrame({0x1FFFFFFF, true}, long_payload, true), makeFdFrame({0, false}, kBytes, false)}) {
    const auto back = parseFrameText(frameText(frame));
    ASSERT_TRUE(back) << frameText(frame);
    EXPECT_EQ(back->id, frame.id);
    EXPECT_EQ(back->fd, frame.fd);
    EXPECT_EQ(back->bit_rate_switch, frame.bit_rate_switch);
    EXPECT_EQ(back->length, frame.length);
    EXPECT_EQ(back->data, frame.data);
  }
}

TEST(FrameText, RefusesWhatIsNoFrame) {
  for (const char* text : {"",
                           "200",
                           "#00",
                           "20#00",
                           "0200#00",
                           "800#00",
                           "20000000#00",
                           "2G0#00",
                           "200#0",
                           "200#0G",
                           "200#R",
                           "200#001122334455667788",
                           "200##",
                           "200##2",
                           "200##1001122334455667788",
                           "+20#00",
                           "200# 00",
                           "200#00 ",
                           "-00#00",
                           "123456789#00"}) {
    EXPECT_FALSE(parseFrameText(text)) << text;
  }
}

TEST(FrameList, KeepsInterfacesAndOrder) {
  const std::vector<AddressedFrame> frames{{"can0", makeClassicFrame({0x200, false}, kBytes)},
                                           {"can1", makeClassicFrame({0x1FF, false}, kBytes)}};
  const auto text = frameListText(frames);
  EXPECT_THAT(text, StrEq("can0 200#01ABFF\ncan1 1FF#01ABFF\n"));
  const auto back = parseFrameList(text);
  ASSERT_TRUE(back);
  ASSERT_EQ(back->size(), 2U);
  EXPECT_EQ((*back)[1].interface, "can1");
  EXPECT_EQ((*back)[1].frame.id.value, 0x1FFU);
}

TEST(FrameList, CommentsAndEmptyLinesSayNothing) {
  const auto frames = parseFrameList("# nothing here\n\n#\n");
  ASSERT_TRUE(frames);
  EXPECT_TRUE(frames->empty());
  EXPECT_TRUE(parseFrameList("")->empty());
  EXPECT_EQ(parseFrameList("can0 200#00")->size(), 1U);  // without the last line's end
}

TEST(FrameList, NamesTheLineThatIsWrong) {
  const auto missing = parseFrameList("# head\ncan0 200#00\ncan0\n");
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, StartsWith("line 3: "));
  EXPECT_THAT(parseFrameList(" 200#00\n").error().message, HasSubstr("interface"));
  EXPECT_THAT(parseFrameList("an_interface_too_long 200#00\n").error().message, StartsWith("line 1: "));
  EXPECT_THAT(parseFrameList("can0 200#0\n").error().message, HasSubstr("two digits a byte"));
  // As after a copy that was cut off, or through a Windows editor.
  EXPECT_FALSE(parseFrameList("can0 200#0000000000000000\ncan0 1FF#000000000"));
  EXPECT_FALSE(parseFrameList("can0 200#00\r\n"));
}

}  // namespace
}  // namespace rc10::test::frame_text_test
