#include "bus/interface_names.hpp"

#include <gtest/gtest.h>

namespace rc10::test::interface_names_test {
namespace {

// Each network namespace has the loopback interface.
TEST(InterfaceNames, OfThisComputerAreSuggested) {
  EXPECT_EQ(similarInterface("ol"), "; did you mean lo?");
  EXPECT_EQ(similarInterface("nothing_like_it"), "");
}

}  // namespace
}  // namespace rc10::test::interface_names_test
