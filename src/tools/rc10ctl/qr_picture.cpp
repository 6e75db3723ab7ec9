#include "qr_picture.hpp"

#include <dlfcn.h>

#include <array>
#include <memory>
#include <string_view>

#include <qrencode.h>

namespace rc10::ctl {
namespace {

// Light modules around the code: ISO/IEC 18004.
constexpr int kQuietZone = 4;
// By the upper module, then the lower one; set: light.
constexpr std::array<std::array<std::string_view, 2>, 2> kBlocks{{{" ", "▄"}, {"▀", "█"}}};
constexpr const char* kLibrary = "libqrencode.so.4";

struct LibraryClose {
  void operator()(void* library) const noexcept { (void)::dlclose(library); }
};

}  // namespace

Result<QrPicture> qrPicture(const std::string& text, bool coloured) {
  // Here and not by the linker: every start of rc10ctl would load it.
  const std::unique_ptr<void, LibraryClose> library{::dlopen(kLibrary, RTLD_NOW | RTLD_LOCAL)};
  const auto encode = library ? ::dlsym(library.get(), "QRcode_encodeString8bit") : nullptr;
  const auto release = library ? ::dlsym(library.get(), "QRcode_free") : nullptr;
  if (encode == nullptr || release == nullptr)
    return fail(std::string{"it needs "} + kLibrary + ", of Debian's package libqrencode4");
  const std::unique_ptr<QRcode, decltype(&QRcode_free)> code{
      reinterpret_cast<decltype(&QRcode_encodeString8bit)>(encode)(text.c_str(), 0, QR_ECLEVEL_L),
      reinterpret_cast<decltype(&QRcode_free)>(release)};
  if (!code) return fail("the address is too long for one");
  const int width = code->width;
  const auto light = [&](int x, int y) {
    const bool inside = x >= 0 && y >= 0 && x < width && y < width;
    return !inside || (code->data[y * width + x] & 1U) == 0;
  };
  QrPicture picture{.columns = static_cast<std::size_t>(width + 2 * kQuietZone), .lines = {}};
  for (int y = -kQuietZone; y < width + kQuietZone; y += 2) {
    if (coloured) picture.lines += "\x1b[97;40m";
    for (int x = -kQuietZone; x < width + kQuietZone; ++x)
      picture.lines += kBlocks[light(x, y) ? 1 : 0][light(x, y + 1) ? 1 : 0];
    if (coloured) picture.lines += "\x1b[0m";
    picture.lines += '\n';
  }
  return picture;
}

}  // namespace rc10::ctl
