#pragma once

#include <string>

namespace rc10::client {

/// Layout of a recording and the words of its numbers as one JSON object, for readers in other languages: the
/// page of rc10-web. Made of blackbox/format.hpp itself, so that there is no other description of it.
[[nodiscard]] std::string recordingFormatJson();

}  // namespace rc10::client
