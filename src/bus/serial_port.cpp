#include "bus/serial_port.hpp"

// termios2 and BOTHER, for any baud rate, are the kernel's: <termios.h> does not have them, and cannot be
// included beside.
#include <asm/termbits.h>
#include <fcntl.h>
#include <linux/serial.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "app/errno_text.hpp"

namespace rc10 {
namespace {

// UNIX98 pseudo terminals: they have no wire, and keep 8N1 whatever is asked.
constexpr unsigned kFirstPtyMajor = 136;
constexpr unsigned kLastPtyMajor = 143;

// A receiver tolerates 2 to 5 % together with the sender; what a divider cannot reach better is no use.
constexpr int kTolerancePercent = 3;

constexpr tcflag_t kFormatBits = CSIZE | PARENB | PARODD | CSTOPB;

std::string place(const std::string& path) { return "serial port '" + path + "': "; }

// Ports that exist: the hint for a typing error, or for a cable that is not plugged in.
std::string presentNames() {
  std::string names;
  std::error_code error;
  for (std::filesystem::directory_iterator it(kSerialNames, error), end; !error && it != end;
       it.increment(error)) {
    names += (names.empty() ? "" : ", ") + it->path().string();
  }
  return names.empty() ? "no serial adapter is plugged in (" + std::string(kSerialNames) + " is empty)"
                       : "there are: " + names;
}

std::string adviceForOpen(int error) {
  switch (error) {
    case ENOENT:
    case ENODEV:
    case ENXIO: return "; " + presentNames();
    case EACCES:
    case EPERM:
      return "; add the user to the group of the device, usually `sudo usermod -aG dialout $USER`, and "
             "log in again (the service has that group already; a container needs the device passed in)";
    case EBUSY: return "; another program has it for itself: `fuser` with this path shows which";
    default: return "";
  }
}

Result<UniqueFd> openForUsAlone(const std::string& path) {
  UniqueFd fd{::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)};
  if (!fd) return fail(place(path) + errnoText(errno) + adviceForOpen(errno));
  // TIOCEXCL does not keep root out, and flock only those who ask.
  if (::ioctl(fd.get(), TIOCEXCL) != 0) {
    return fail(place(path) +
                (errno == ENOTTY || errno == EINVAL ? "it is no serial port" : errnoText(errno)));
  }
  if (::flock(fd.get(), LOCK_EX | LOCK_NB) != 0)
    return fail(place(path) + errnoText(EBUSY) + adviceForOpen(EBUSY));
  return fd;
}

tcflag_t formatBits(const SerialFormat& format) {
  constexpr std::array<tcflag_t, 4> kSizes{CS5, CS6, CS7, CS8};
  constexpr std::array<tcflag_t, 3> kParities{0, PARENB, PARENB | PARODD};
  return kSizes[static_cast<std::size_t>(format.data_bits - 5)] |
         kParities[static_cast<std::size_t>(format.parity)] | (format.stop_bits == 2 ? tcflag_t{CSTOPB} : 0);
}

// Raw; no modem lines, no flow control, and DTR stays when the port is closed: boards that reset on it keep
// running.
void setRaw(termios2& settings, const SerialFormat& format) {
  settings.c_iflag = IGNBRK | (format.parity == Parity::kNone ? 0 : INPCK) | IGNPAR;
  settings.c_oflag = 0;
  settings.c_lflag = 0;
  settings.c_cflag = CREAD | CLOCAL | formatBits(format) | BOTHER | BOTHER << IBSHIFT;
  settings.c_ispeed = settings.c_ospeed = static_cast<speed_t>(format.baud);
  // With VMIN 0, read() says 0 for "nothing now", as it does for "gone".
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
}

bool isPty(int fd) {
  struct stat status {};
  if (::fstat(fd, &status) != 0) return false;
  return major(status.st_rdev) >= kFirstPtyMajor && major(status.st_rdev) <= kLastPtyMajor;
}

bool near(speed_t got, int wanted) {
  return std::abs(static_cast<double>(got) - wanted) * 100.0 <=
         static_cast<double>(kTolerancePercent) * wanted;
}

Result<void> setFormat(int fd, const std::string& path, const SerialFormat& format) {
  termios2 settings{};
  if (::ioctl(fd, TCGETS2, &settings) != 0)
    return fail(place(path) + "it is no serial port: " + errnoText(errno));
  setRaw(settings, format);
  termios2 got{};
  if (::ioctl(fd, TCSETS2, &settings) != 0 || ::ioctl(fd, TCGETS2, &got) != 0) {
    return fail(place(path) + "cannot set " + format.text() + ": " + errnoText(errno));
  }
  if (!near(got.c_ospeed, format.baud)) {
    return fail(place(path) + "asked for " + std::to_string(format.baud) + " baud, the adapter gives " +
                std::to_string(got.c_ospeed) + "; use an adapter that can (FTDI FT232, CP2102N, CH343)");
  }
  if ((got.c_cflag & kFormatBits) != formatBits(format) && !isPty(fd)) {
    return fail(place(path) + "the adapter does not have the format " + format.text());
  }
  return {};
}

// Low latency: on FTDI adapters a latency timer of 1 ms instead of 16; on UARTs it wakes the reader at once.
// Other drivers do not know it, and are quick.
void askForLowLatency(int fd) {
  serial_struct settings{};
  if (::ioctl(fd, TIOCGSERIAL, &settings) != 0) return;
  settings.flags |= static_cast<int>(ASYNC_LOW_LATENCY);
  (void)::ioctl(fd, TIOCSSERIAL, &settings);
}

}  // namespace

Result<UniqueFd> openSerialPort(const std::string& path, const SerialFormat& format) {
  auto fd = openForUsAlone(path);
  if (!fd) return fd;
  if (auto set = setFormat(fd->get(), path, format); !set) return tl::unexpected(set.error());
  askForLowLatency(fd->get());
  (void)::ioctl(fd->get(), TCFLSH, TCIOFLUSH);
  return fd;
}

std::string steadySerialName(const std::string& path, const std::string& names) {
  std::error_code error;
  const auto device = std::filesystem::canonical(path, error);
  if (error) return {};
  for (std::filesystem::directory_iterator it(names, error), end; !error && it != end; it.increment(error)) {
    std::error_code dangling;
    if (std::filesystem::canonical(it->path(), dangling) == device && !dangling) {
      return it->path() == std::filesystem::path(path) ? std::string{} : it->path().string();
    }
  }
  return {};
}

}  // namespace rc10
