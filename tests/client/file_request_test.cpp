#include "client/file_request.hpp"

#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <string>

#include <gmock/gmock.h>

#include "client/fake_rc10d.hpp"
#include "link/unix_address.hpp"

namespace rc10::client::test::file_request_test {
namespace {

using rc10::test::TemporaryRunDir;
using ::testing::HasSubstr;

const std::string kHash(64, 'a');

TEST(FileRequest, IsReadAsItWasWritten) {
  const FileRequest sent{
      .verb = FileVerb::kInstall, .robot = "left_arm", .replaces = kHash, .text = "robot: a\n\nbuses: []\n"};
  const auto bytes = bytesOf(sent);
  ASSERT_TRUE(bytes);
  const auto read = parseFileRequest(*bytes);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->verb, sent.verb);
  EXPECT_EQ(read->robot, sent.robot);
  EXPECT_EQ(read->replaces, sent.replaces);
  EXPECT_EQ(read->text, sent.text);
  const auto restart = parseFileRequest("restart robot -\n");
  ASSERT_TRUE(restart);
  EXPECT_EQ(restart->replaces, "");
  EXPECT_EQ(restart->text, "");
}

TEST(FileRequest, NoNameLeadsOutOfTheFolder) {
  for (const std::string name : {"", "..", "../shadow", "a/b", "a.yaml", ".hidden", "a b", "a\nb"}) {
    EXPECT_FALSE(parseFileRequest("check " + name + " -\n")) << name;
    EXPECT_FALSE(bytesOf(FileRequest{.verb = FileVerb::kCheck, .robot = name, .replaces = {}, .text = {}}))
        << name;
  }
  EXPECT_FALSE(parseFileRequest("check " + std::string(32, 'a') + " -\n"));
}

TEST(FileRequest, NothingElseIsARequest) {
  const std::string no_hash(64, 'G');
  for (const std::string& bytes : {std::string{}, std::string{"check"}, std::string{"check robot"},
                                   std::string{"remove robot -\n"}, std::string{"check robot -  more\n"},
                                   std::string{"check robot 00\n"}, "install robot " + no_hash + "\n"})
    EXPECT_FALSE(parseFileRequest(bytes)) << bytes;
}

TEST(FileRequest, ATextAbove128KiBIsRefusedOnBothSides) {
  const std::string text(FileRequest::kMostTextBytes + 1, '#');
  EXPECT_FALSE(bytesOf(FileRequest{.verb = FileVerb::kCheck, .robot = "hero", .replaces = {}, .text = text}));
  EXPECT_FALSE(parseFileRequest("check hero -\n" + text));
  EXPECT_TRUE(parseFileRequest("check hero -\n" + text.substr(1)));
}

TEST(FileAnswer, IsReadAsItWasWrittenAndCutWhereItIsTooLong) {
  const auto read = parseFileAnswer(bytesOf(FileAnswer{.done = false, .message = "line 1\nline 2"}));
  ASSERT_TRUE(read);
  EXPECT_FALSE(read->done);
  EXPECT_EQ(read->message, "line 1\nline 2");
  EXPECT_EQ(bytesOf(FileAnswer{.done = true, .message = std::string(200'000, 'x')}).size(),
            FileAnswer::kMostBytes);
  EXPECT_FALSE(parseFileAnswer("HTTP/1.1 200 OK\n"));
}

TEST(FileCall, WithoutAHelperTheRemedyIsNamed) {
  TemporaryRunDir dir;
  const FileRequest request{.verb = FileVerb::kRestart, .robot = "hero", .replaces = {}, .text = {}};
  const auto call = FileCall::send(request, MonotonicTime{}, dir.path() + "/config.socket");
  ASSERT_FALSE(call);
  EXPECT_THAT(call.error().message, HasSubstr("lets nobody change its file"));
}

TEST(FileCall, CarriesTheLargestFileAndTheAnswer) {
  TemporaryRunDir dir;
  const auto listener = dir.listen("hero");
  const FileRequest request{.verb = FileVerb::kInstall,
                            .robot = "hero",
                            .replaces = {},
                            .text = std::string(FileRequest::kMostTextBytes, '#')};
  auto call = FileCall::send(request, MonotonicTime{}, dir.path() + "/hero.sock");
  ASSERT_TRUE(call) << call.error().message;
  EXPECT_FALSE(call->poll(MonotonicTime{}));
  const UniqueFd helper{::accept(listener.get(), nullptr, nullptr)};
  std::string bytes(FileRequest::kMostBytes, '\0');
  const auto size = ::recv(helper.get(), bytes.data(), bytes.size(), 0);
  ASSERT_GT(size, 0);
  const auto read = parseFileRequest(std::string_view{bytes}.substr(0, static_cast<std::size_t>(size)));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->text, request.text);
  const auto answer = bytesOf(FileAnswer{.done = true, .message = "written"});
  ASSERT_GT(::send(helper.get(), answer.data(), answer.size(), MSG_NOSIGNAL), 0);
  const auto got = call->poll(MonotonicTime{});
  ASSERT_TRUE(got && *got);
  EXPECT_EQ((*got)->message, "written");
}

TEST(FileCall, AHelperThatEndsOrIsSilentIsTold) {
  TemporaryRunDir dir;
  const auto listener = dir.listen("hero");
  const FileRequest request{.verb = FileVerb::kRestart, .robot = "hero", .replaces = {}, .text = {}};
  auto silent = FileCall::send(request, MonotonicTime{}, dir.path() + "/hero.sock");
  ASSERT_TRUE(silent);
  EXPECT_THAT(silent->poll(MonotonicTime{} + FileCall::kPatience).value().error().message,
              HasSubstr("does not answer"));
  UniqueFd helper{::accept(listener.get(), nullptr, nullptr)};
  helper.reset();
  EXPECT_THAT(silent->poll(MonotonicTime{}).value().error().message, HasSubstr("without an answer"));
}

}  // namespace
}  // namespace rc10::client::test::file_request_test
