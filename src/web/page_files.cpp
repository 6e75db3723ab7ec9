#include "web/page_files.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>
#include <utility>

#include "app/whole_file.hpp"

namespace rc10::web {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kTypes{{
    {".html", "text/html; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".json", "application/json"},
    {".svg", "image/svg+xml"},
    {".png", "image/png"},
    {".txt", "text/plain; charset=utf-8"},
    {".webmanifest", "application/manifest+json"},
}};

}  // namespace

Result<PageFiles> PageFiles::read(const std::string& folder) {
  PageFiles page;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code ignored;
    if (!entry->is_regular_file(ignored)) continue;
    const auto ending = entry->path().extension().string();
    const auto type =
        std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& known) { return known.first == ending; });
    if (type == kTypes.end()) continue;
    auto bytes = readWholeFile(entry->path().string());
    if (!bytes) return fail("the page cannot be read: " + entry->path().string());
    page.files_["/" + entry->path().lexically_relative(folder).generic_string()] = {std::move(*bytes),
                                                                                    type->second};
  }
  if (page.find("/") == nullptr) {
    return fail(
        "there is no page in " + folder + (error ? " (" + error.message() + ")" : "") +
        ": `scripts/web.sh` makes build/web; packages have it in /usr/share/rc10d/web. Choose with --page");
  }
  return page;
}

void PageFiles::add(std::string path, PageFile file) {
  files_.insert_or_assign(std::move(path), std::move(file));
}

const PageFile* PageFiles::find(std::string_view path) const {
  const auto file = files_.find(path == "/" ? std::string_view{"/index.html"} : path);
  return file == files_.end() ? nullptr : &file->second;
}

}  // namespace rc10::web
