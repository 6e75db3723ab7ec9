#include "web/hidden_tokens.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <set>

#include "client/page_token.hpp"
#include "config/load_config.hpp"
#include "config/sha256.hpp"

namespace rc10::web {
namespace {

static_assert(kHiddenWords.size() == 64);
constexpr std::size_t kNumberAt = kHiddenWords.find("00");
constexpr std::string_view kTokenKey = "token";
constexpr std::string_view kEndOfValue = " \t\r\n,}]'\"#";

bool isToken(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; }

// As long as the hash that it replaces: columns of messages stay right.
std::string wordsFor(int number) {
  std::string words{kHiddenWords};
  words[kNumberAt] = static_cast<char>('0' + number / 10 % 10);
  words[kNumberAt + 1] = static_cast<char>('0' + number % 10);
  return words;
}

/// Where the value of a key `token` begins at or after `from`.
std::size_t valueOfToken(std::string_view text, std::size_t from) {
  for (auto at = text.find(kTokenKey, from); at != std::string_view::npos; at = text.find(kTokenKey, at)) {
    at += kTokenKey.size();
    auto value = std::min(text.find_first_not_of("'\"", at), text.size());
    value = std::min(text.find_first_not_of(" \t", value), text.size());
    if (value == text.size() || text[value] != ':') continue;
    value = std::min(text.find_first_not_of(" \t'\"", value + 1), text.size());
    // Anchors, aliases and blocks: their hash is found by its length.
    if (value == text.size() || std::string_view{"&*|>\r\n"}.find(text[value]) != std::string_view::npos)
      continue;
    return value;
  }
  return std::string_view::npos;
}

/// Values of `token`, and all that is as long as a token, also in comments.
ShownConfig withoutTokens(std::string_view text) {
  ShownConfig shown;
  std::size_t value = valueOfToken(text, 0);
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = at;
    if (at == value) {
      end = std::min(text.find_first_of(kEndOfValue, at), text.size());
      value = valueOfToken(text, end);
    } else {
      while (end < text.size() && end != value && isToken(text[end])) ++end;
      if (end - at < client::kPageTokenLength) {
        end = std::max(end, at + 1);
        shown.text += text.substr(at, end - at);
        at = end;
        continue;
      }
    }
    shown.text += wordsFor(++shown.hidden);
    at = end;
  }
  return shown;
}

std::set<std::string> hashesOf(const RobotConfig& config) {
  std::set<std::string> hashes;
  if (!config.clients) return hashes;
  for (const auto& entry : config.clients->entries)
    if (entry.by == ClientConfig::By::kToken) hashes.insert(entry.who);
  return hashes;
}

bool mayConfigure(const RobotConfig& config, std::string_view token) {
  if (token.empty() || !config.clients) return false;
  const auto hash = sha256(token);
  const auto& entries = config.clients->entries;
  return std::any_of(entries.begin(), entries.end(), [&](const ClientConfig& entry) {
    return entry.by == ClientConfig::By::kToken && entry.who == hash && entry.has(Right::kConfigure);
  });
}

}  // namespace

ShownConfig showConfig(std::string_view text, std::string_view token) {
  const auto before = parseRobotConfig(text, "").config;
  const bool sound = before.has_value();
  const auto hashes = sound ? hashesOf(*before) : std::set<std::string>{};
  if (sound && (hashes.empty() || mayConfigure(*before, token)))
    return {.text = std::string{text}, .hidden = 0, .why = {}};
  auto shown = withoutTokens(text);
  // A hash may be written in ways that only a reader of YAML understands.
  bool left =
      !sound && text.find(kTokenKey) != std::string_view::npos && text.find('\\') != std::string_view::npos;
  if (sound) {
    const auto after = parseRobotConfig(withHashes(shown.text), "").config;
    const auto still = after ? hashesOf(*after) : hashes;
    left = std::any_of(hashes.begin(), hashes.end(), [&](const std::string& hash) {
      return still.count(hash) > 0 || shown.text.find(hash) != std::string::npos;
    });
  }
  if (!left) return shown;
  return {
      .text = {},
      .hidden = 0,
      .why =
          "tokens of `clients` stand in this file, and cannot be told from the rest: open the file itself"};
}

bool mayReplace(std::string_view text, std::string_view token) {
  const auto config = parseRobotConfig(text, "").config;
  return config && (!config->clients || mayConfigure(*config, token));
}

std::string withHashes(std::string text) {
  const auto begin = kHiddenWords.substr(0, kNumberAt);
  for (auto at = text.find(begin); at != std::string::npos; at = text.find(begin, at + 1)) {
    const auto words = std::string_view{text}.substr(at, kHiddenWords.size());
    if (words.substr(std::min(kNumberAt + 2, words.size())) == kHiddenWords.substr(kNumberAt + 2))
      text.replace(at, kHiddenWords.size(), sha256(words));
  }
  return text;
}

}  // namespace rc10::web
