#include "bus/spi_port.hpp"

#include <fcntl.h>
#include <linux/spi/spidev.h>
#include <sys/ioctl.h>

#include <cerrno>
#include <utility>

#include "app/errno_text.hpp"

namespace rc10 {
namespace {

constexpr std::uint8_t kBitsPerWord = 8;

std::string adviceFor(int error) {
  switch (error) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
      return "; switch the SPI bus on (Raspberry Pi: `dtparam=spi=on` in config.txt; Jetson: jetson-io.py), "
             "then `ls /dev/spidev*` shows it";
    case EACCES:
    case EPERM:
      return "; this user may not use it: join the group that owns /dev/spidev* (`spi` on Raspberry Pi OS), "
             "and let the unit have it: the drop-in spi.conf, docs/installing.md";
    case ENOTTY: return "; it is no SPI device; name one that `ls /dev/spidev*` shows";
    default: return "";
  }
}

tl::unexpected<Error> refusal(const std::string& path, const std::string& what, int error) {
  return fail("SPI device '" + path + "': " + what + errnoText(error) + adviceFor(error));
}

class Spidev final : public SpiPort {
 public:
  Spidev(UniqueFd fd, std::uint32_t speed_hz, IoctlCall ioctl)
      : fd_(std::move(fd)), speed_hz_(speed_hz), ioctl_(ioctl) {}

  [[nodiscard]] int send(std::span<const std::uint8_t> bytes) noexcept override {
    spi_ioc_transfer transfer{};
    // The kernel's interface has addresses as numbers.
    transfer.tx_buf = reinterpret_cast<std::uintptr_t>(bytes.data());
    transfer.len = static_cast<std::uint32_t>(bytes.size());
    transfer.speed_hz = speed_hz_;
    transfer.bits_per_word = kBitsPerWord;
    return ioctl_(fd_.get(), SPI_IOC_MESSAGE(1), &transfer) < 0 ? errno : 0;
  }

 private:
  UniqueFd fd_;
  std::uint32_t speed_hz_;
  IoctlCall ioctl_;
};

}  // namespace

int systemIoctl(int fd, unsigned long request, void* argument) noexcept {
  return ::ioctl(fd, request, argument);
}

Result<std::unique_ptr<SpiPort>> openSpiPort(const std::string& path, std::uint32_t speed_hz,
                                             IoctlCall ioctl) {
  UniqueFd fd{::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK)};
  if (!fd) return refusal(path, "", errno);
  std::uint8_t mode = SPI_MODE_0;
  std::uint8_t bits = kBitsPerWord;
  std::uint32_t speed = speed_hz;
  if (ioctl(fd.get(), SPI_IOC_WR_MODE, &mode) < 0) return refusal(path, "mode 0: ", errno);
  if (ioctl(fd.get(), SPI_IOC_WR_BITS_PER_WORD, &bits) < 0) return refusal(path, "8 bits a word: ", errno);
  if (ioctl(fd.get(), SPI_IOC_WR_MAX_SPEED_HZ, &speed) < 0)
    return refusal(path, std::to_string(speed_hz) + " Hz: ", errno);
  const bool read = ioctl(fd.get(), SPI_IOC_RD_MODE, &mode) >= 0 &&
                    ioctl(fd.get(), SPI_IOC_RD_BITS_PER_WORD, &bits) >= 0 &&
                    ioctl(fd.get(), SPI_IOC_RD_MAX_SPEED_HZ, &speed) >= 0;
  if (!read) return refusal(path, "reading its settings: ", errno);
  // Older kernels add SPI_CS_HIGH by themselves where chip select is a GPIO.
  constexpr std::uint8_t kOfTheBits = SPI_CPHA | SPI_CPOL | SPI_LSB_FIRST;
  if ((mode & kOfTheBits) != SPI_MODE_0 || bits != kBitsPerWord || speed != speed_hz) {
    return fail("SPI device '" + path + "': asked for mode 0, 8 bits, " + std::to_string(speed_hz) +
                " Hz, it has mode " + std::to_string(mode) + ", " + std::to_string(bits) + " bits, " +
                std::to_string(speed) + " Hz; use another SPI bus");
  }
  return std::make_unique<Spidev>(std::move(fd), speed_hz, ioctl);
}

}  // namespace rc10
