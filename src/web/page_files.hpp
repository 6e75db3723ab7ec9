#pragma once

#include <map>
#include <string>
#include <string_view>

#include "app/result.hpp"

namespace rc10::web {

struct PageFile {
  std::string bytes;
  std::string_view type;  ///< Content-Type.
};

/// The files of the page, read once: a request chooses among them and reaches no file system.
class PageFiles {
 public:
  [[nodiscard]] static Result<PageFiles> read(const std::string& folder);

  /// One that is made, and in no folder.
  void add(std::string path, PageFile file);
  /// By the path of a URL, "/" for index.html; null: there is none.
  [[nodiscard]] const PageFile* find(std::string_view path) const;

 private:
  std::map<std::string, PageFile, std::less<>> files_;
};

}  // namespace rc10::web
