#include "web/access.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rc10::web::test::access_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const HostNames kNames{"robot", "robot.local"};

std::string refusalOf(std::string_view host, std::optional<std::string_view> origin = {}) {
  return refusal({.host = host, .origin = origin, .loopback = true}, kNames);
}

TEST(WebAccess, TheComputersOwnNamesAndAddressesAreServed) {
  for (const auto* host : {"localhost:8010", "LOCALHOST", "127.0.0.1:8010", "[::1]:8010", "192.168.1.7",
                           "robot:8010", "Robot.Local:8010", "[fe80::1]"})
    EXPECT_THAT(refusalOf(host), IsEmpty()) << host;
}

TEST(WebAccess, ANameThatSomebodyElseLetsPointHereIsRefusedAndTheRemedyNamed) {
  for (const auto* host : {"evil.example:8010", "localhost.evil.example", "127.0.0.1.evil.example", "",
                           ":8010", "[::1", "robot.local.", "1.2.3"})
    EXPECT_THAT(refusalOf(host), HasSubstr("--name")) << host;
}

TEST(WebAccess, APageOfAnotherOriginIsRefused) {
  EXPECT_THAT(refusalOf("localhost:8010", "http://localhost:8010"), IsEmpty());
  EXPECT_THAT(refusalOf("robot:443", "https://robot:443"), IsEmpty());
  for (const auto* origin : {"http://evil.example", "http://localhost:8011", "http://localhost", "null", "",
                             "file://localhost:8010", "http://localhost:8010.evil.example"})
    EXPECT_THAT(refusalOf("localhost:8010", origin), Not(IsEmpty())) << origin;
}

TEST(WebAccess, TextOfAStrangerIsMadePrintable) {
  EXPECT_THAT(refusalOf("a\x1b[2J\nb"), Not(HasSubstr("\x1b")));
}

TEST(WebAccess, FromThisComputerEverythingIsAllowedFromOthersTheTokenAllowsToLook) {
  EXPECT_EQ(rightOf(true, "", ""), PageRight::kCommand);
  EXPECT_EQ(rightOf(false, "secret", "secret"), PageRight::kLook);
  for (const auto* shown : {"", "secre", "secret ", "Secret", "secrets"})
    EXPECT_EQ(rightOf(false, shown, "secret"), PageRight::kNothing) << shown;
  EXPECT_EQ(rightOf(false, "", ""), PageRight::kNothing);  // without a token nobody else gets in
}

}  // namespace
}  // namespace rc10::web::test::access_test
