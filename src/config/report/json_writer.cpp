#include "config/report/json_writer.hpp"

#include "config/yaml/number_text.hpp"

namespace rc10 {
namespace {

/// The tables hold printable ASCII, so these two are all there is to escape.
std::string jsonString(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace

JsonWriter& JsonWriter::key(std::string_view name) {
  beginValue();
  json_ += jsonString(name) + ": ";
  after_key_ = true;
  return *this;
}

JsonWriter& JsonWriter::text(std::string_view value) { return literal(jsonString(value)); }

JsonWriter& JsonWriter::number(double value) { return literal(numberText(value)); }

JsonWriter& JsonWriter::literal(std::string_view json) {
  beginValue();
  json_ += json;
  return *this;
}

JsonWriter& JsonWriter::open(char bracket) {
  beginValue();
  json_ += bracket;
  ++depth_;
  first_ = true;
  return *this;
}

JsonWriter& JsonWriter::close(char bracket) {
  --depth_;
  if (!first_) newLine();
  json_ += bracket;
  first_ = false;
  return *this;
}

void JsonWriter::beginValue() {
  if (!after_key_ && depth_ > 0) {
    if (!first_) json_ += ',';
    newLine();
  }
  after_key_ = false;
  first_ = false;
}

void JsonWriter::newLine() { json_ += "\n" + std::string(static_cast<std::size_t>(2 * depth_), ' '); }

}  // namespace rc10
