#pragma once

// Sanitizers of the build: GCC defines a macro for each, clang has a feature test.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define RC10_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define RC10_SANITIZED 1
#endif
#endif
#ifndef RC10_SANITIZED
#define RC10_SANITIZED 0
#endif

namespace rc10 {

/// Shadow memory, larger stacks and a malloc of its own: limits of memory do not hold.
inline constexpr bool kSanitized = RC10_SANITIZED == 1;

}  // namespace rc10
