#pragma once

#include <cstdint>
#include <initializer_list>

#include <seccomp.h>

#include "app/result.hpp"

namespace rc10::sandbox {

/// A condition on an argument that the kernel takes for 32 bits: it is compared as 32 bits, and the upper
/// half may be anything.
[[nodiscard]] constexpr scmp_arg_cmp argument(unsigned place, std::uint32_t value,
                                              std::uint32_t mask = ~std::uint32_t{0}) noexcept {
  return {.arg = place, .op = SCMP_CMP_MASKED_EQ, .datum_a = mask, .datum_b = value};
}

/// System calls of a process from here on. At first those that libc takes in a program of one thread that
/// reads and writes open descriptors: none of them opens a file, starts a program, makes code or names
/// another process.
class SystemCalls {
 public:
  SystemCalls();
  SystemCalls(const SystemCalls&) = delete;
  SystemCalls& operator=(const SystemCalls&) = delete;
  ~SystemCalls();

  /// Those that this architecture has not are left out.
  void allow(std::initializer_list<int> calls);
  template <typename... Conditions>
  void allow(int call, Conditions... conditions) {
    if (status_ == 0)
      status_ = seccomp_rule_add(context_, SCMP_ACT_ALLOW, call, sizeof...(conditions), conditions...);
  }

  /// For good. Any other call fails with EACCES, like one without the right: so a libc of another version
  /// than the tested one loses a message and not the process.
  [[nodiscard]] Result<void> keepToThese();

 private:
  scmp_filter_ctx context_;
  int status_;  ///< The first error.
};

}  // namespace rc10::sandbox
