#include "qr_picture.hpp"

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

struct CodeFree {
  void operator()(QRcode* code) const noexcept { QRcode_free(code); }
};

}  // namespace

std::optional<QrPicture> qrPicture(const std::string& text, bool coloured) {
  const std::unique_ptr<QRcode, CodeFree> code{QRcode_encodeString8bit(text.c_str(), 0, QR_ECLEVEL_L)};
  if (!code) return std::nullopt;
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
