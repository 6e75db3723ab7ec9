// The system calls of spidev, on a file that takes none: the kernel's part is played by the test.
#include "bus/spi_port.hpp"

#include <linux/spi/spidev.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <vector>

#include <gmock/gmock.h>

namespace rc10::test::spi_port_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

struct Kernel {
  std::uint8_t mode = 0xFF;
  std::uint8_t bits = 0;
  std::uint32_t speed_hz = 0;
  std::uint32_t slowest_hz = 0;  ///< It gives no less.
  std::vector<unsigned long> calls;
  std::vector<std::uint8_t> sent;
  spi_ioc_transfer transfer{};
  unsigned long refused = 0;  ///< A request.
  int error = 0;
};

Kernel kernel;

int fakeIoctl(int, unsigned long request, void* argument) {
  kernel.calls.push_back(request);
  if (request == kernel.refused) {
    errno = kernel.error;
    return -1;
  }
  const auto get = [argument](auto& value) { std::memcpy(&value, argument, sizeof value); };
  const auto give = [argument](const auto& value) { std::memcpy(argument, &value, sizeof value); };
  switch (request) {
    case SPI_IOC_WR_MODE: get(kernel.mode); break;
    case SPI_IOC_RD_MODE: give(kernel.mode); break;
    case SPI_IOC_WR_BITS_PER_WORD: get(kernel.bits); break;
    case SPI_IOC_RD_BITS_PER_WORD: give(kernel.bits); break;
    case SPI_IOC_WR_MAX_SPEED_HZ:
      get(kernel.speed_hz);
      kernel.speed_hz = std::max(kernel.speed_hz, kernel.slowest_hz);
      break;
    case SPI_IOC_RD_MAX_SPEED_HZ: give(kernel.speed_hz); break;
    case SPI_IOC_MESSAGE(1): {
      get(kernel.transfer);
      const auto* bytes = reinterpret_cast<const std::uint8_t*>(kernel.transfer.tx_buf);
      kernel.sent.assign(bytes, bytes + kernel.transfer.len);
      break;
    }
    default: ADD_FAILURE() << "unknown request " << request; return -1;
  }
  return 0;
}

class SpiPortTest : public ::testing::Test {
 protected:
  SpiPortTest() { kernel = {}; }
  static Result<std::unique_ptr<SpiPort>> open() { return openSpiPort("/dev/null", 3'200'000, fakeIoctl); }
  static std::string refusal(unsigned long request, int error) {
    kernel.refused = request;
    kernel.error = error;
    return open().error().message;
  }
};

TEST_F(SpiPortTest, ModeBitsAndSpeedAreSetAndReadBack) {
  ASSERT_TRUE(open());
  EXPECT_EQ(kernel.mode, SPI_MODE_0);
  EXPECT_EQ(kernel.bits, 8);
  EXPECT_EQ(kernel.speed_hz, 3'200'000U);
  EXPECT_THAT(kernel.calls, ElementsAre(SPI_IOC_WR_MODE, SPI_IOC_WR_BITS_PER_WORD, SPI_IOC_WR_MAX_SPEED_HZ,
                                        SPI_IOC_RD_MODE, SPI_IOC_RD_BITS_PER_WORD, SPI_IOC_RD_MAX_SPEED_HZ));
}

TEST_F(SpiPortTest, AllBytesGoInOneTransfer) {
  const auto port = std::move(*open());
  const std::array<std::uint8_t, 4> bytes{1, 2, 0xFF, 4};
  EXPECT_EQ(port->send(bytes), 0);
  EXPECT_THAT(kernel.sent, ElementsAre(1, 2, 0xFF, 4));
  EXPECT_EQ(kernel.transfer.speed_hz, 3'200'000U);
  EXPECT_EQ(kernel.transfer.bits_per_word, 8);
  EXPECT_EQ(kernel.transfer.rx_buf, 0U);
}

TEST_F(SpiPortTest, ATransferThatIsRefusedSaysWhy) {
  const auto port = std::move(*open());
  kernel.refused = SPI_IOC_MESSAGE(1);
  kernel.error = EMSGSIZE;
  EXPECT_EQ(port->send({}), EMSGSIZE);
}

TEST_F(SpiPortTest, AnErrorNamesThePathTheCauseAndTheRemedy) {
  EXPECT_THAT(
      openSpiPort("/dev/no_such_spidev", 3'200'000).error().message,
      AllOf(HasSubstr("SPI device '/dev/no_such_spidev': No such file"), HasSubstr("dtparam=spi=on")));
  EXPECT_THAT(openSpiPort("/dev/null", 3'200'000).error().message, HasSubstr("it is no SPI device"));
  EXPECT_THAT(refusal(SPI_IOC_WR_MAX_SPEED_HZ, EINVAL), HasSubstr("3200000 Hz: Invalid argument"));
  EXPECT_THAT(refusal(SPI_IOC_WR_MODE, EACCES), HasSubstr("the group that owns /dev/spidev*"));
  EXPECT_THAT(refusal(SPI_IOC_RD_MODE, EIO), HasSubstr("reading its settings: "));
}

TEST_F(SpiPortTest, ASpeedThatTheBusDoesNotGiveIsRefused) {
  kernel.slowest_hz = 5'000'000;
  EXPECT_THAT(open().error().message,
              HasSubstr("asked for mode 0, 8 bits, 3200000 Hz, it has mode 0, 8 bits, "
                        "5000000 Hz"));
}

}  // namespace
}  // namespace rc10::test::spi_port_test
