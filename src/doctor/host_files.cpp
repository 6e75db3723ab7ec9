#include "doctor/host_files.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <sstream>
#include <system_error>

#include "app/whole_file.hpp"

namespace rc10::doctor {
namespace {

namespace fs = std::filesystem;

// The kernel has at most a few thousand; a strange text must not make us fill the memory.
constexpr int kMostCpus = 8192;

template <typename Number>
std::optional<Number> numberIn(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<std::string> HostFiles::read(const std::string& path) const {
  auto text = readWholeFile(root_ + path);
  if (text) text->erase(text->find_last_not_of(" \t\n\r") + 1);
  return text;
}

std::optional<long long> HostFiles::number(const std::string& path) const {
  const auto text = read(path);
  return text ? numberIn<long long>(*text) : std::nullopt;
}

bool HostFiles::exists(const std::string& path) const {
  std::error_code error;
  return fs::exists(root_ + path, error);
}

std::vector<std::string> HostFiles::list(const std::string& path) const {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(root_ + path, error), end; !error && entry != end;
       entry.increment(error)) {
    names.push_back(entry->path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string HostFiles::linkedName(const std::string& path) const {
  std::error_code error;
  const auto target = fs::read_symlink(root_ + path, error);
  return error ? std::string{} : target.filename().string();
}

std::vector<int> cpuList(const std::string& text) {
  std::vector<int> cpus;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const auto dash = part.find('-');
    const auto first = numberIn<int>(part.substr(0, dash));
    const auto last = dash == std::string::npos ? first : numberIn<int>(part.substr(dash + 1));
    if (!first || !last || *first < 0 || *last >= kMostCpus) continue;
    for (int cpu = *first; cpu <= *last; ++cpu) cpus.push_back(cpu);
  }
  return cpus;
}

}  // namespace rc10::doctor
