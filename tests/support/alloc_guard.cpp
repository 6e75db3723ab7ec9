#include "support/alloc_guard.hpp"

#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <new>

#include "app/sanitizers.hpp"

// A sanitizer's run-time library replaces malloc itself; a second replacement would break it.
#if RC10_SANITIZED || !defined(__GLIBC__) || !defined(__LP64__)
#define RC10_COUNT_MALLOC 0
#else
#define RC10_COUNT_MALLOC 1
#endif

#if RC10_COUNT_MALLOC
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>
#endif

namespace rc10::test {
namespace {

// initial-exec: reached without a call, since what the call would do is to allocate.
__attribute__((tls_model("initial-exec"))) thread_local constinit std::uint64_t allocations_of_thread = 0;

}  // namespace

AllocGuard::AllocGuard() noexcept : at_construction_(allocations_of_thread) {}

std::uint64_t AllocGuard::allocations() const noexcept { return allocations_of_thread - at_construction_; }

bool AllocGuard::countsMalloc() noexcept { return RC10_COUNT_MALLOC != 0; }

}  // namespace rc10::test

#if RC10_COUNT_MALLOC

// glibc's allocator under the names that stay reachable when malloc is replaced. free() needs no
// replacement: the memory is glibc's own. operator new calls malloc.
extern "C" {
void* __libc_malloc(std::size_t size);                           // NOLINT(bugprone-reserved-identifier)
void* __libc_calloc(std::size_t count, std::size_t size);        // NOLINT(bugprone-reserved-identifier)
void* __libc_realloc(void* memory, std::size_t size);            // NOLINT(bugprone-reserved-identifier)
void* __libc_memalign(std::size_t alignment, std::size_t size);  // NOLINT(bugprone-reserved-identifier)

void* malloc(std::size_t size) noexcept {
  ++rc10::test::allocations_of_thread;
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) noexcept {
  ++rc10::test::allocations_of_thread;
  return __libc_calloc(count, size);
}

void* realloc(void* memory, std::size_t size) noexcept {
  ++rc10::test::allocations_of_thread;
  return __libc_realloc(memory, size);
}

void* memalign(std::size_t alignment, std::size_t size) noexcept {
  ++rc10::test::allocations_of_thread;
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  ++rc10::test::allocations_of_thread;
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** memory, std::size_t alignment, std::size_t size) noexcept {
  ++rc10::test::allocations_of_thread;
  const bool power_of_two = alignment != 0 && (alignment & (alignment - 1)) == 0;
  if (!power_of_two || alignment % sizeof(void*) != 0) return EINVAL;
  void* const allocated = __libc_memalign(alignment, size);
  if (allocated == nullptr) return ENOMEM;
  *memory = allocated;
  return 0;
}

void* mmap(void* address, std::size_t length, int protection, int flags, int fd, off_t offset) noexcept {
  ++rc10::test::allocations_of_thread;
  // NOLINTNEXTLINE(performance-no-int-to-ptr): that is how the kernel returns it.
  return reinterpret_cast<void*>(::syscall(SYS_mmap, address, length, protection, flags, fd, offset));
}
}

#else

namespace {

void* allocate(std::size_t size) noexcept {
  ++rc10::test::allocations_of_thread;
  return std::malloc(size != 0 ? size : 1);
}

void* allocate(std::size_t size, std::align_val_t alignment) noexcept {
  ++rc10::test::allocations_of_thread;
  const auto bytes = static_cast<std::size_t>(alignment);
  return std::aligned_alloc(bytes, (size + bytes - 1) / bytes * bytes);
}

void* orThrow(void* memory) {
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

// Every form: a sanitizer has its own of each, and would find that what one allocated the other freed.
void* operator new(std::size_t size) { return orThrow(allocate(size)); }
void* operator new[](std::size_t size) { return orThrow(allocate(size)); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return orThrow(allocate(size, alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return orThrow(allocate(size, alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return allocate(size); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return allocate(size); }
void* operator new(std::size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return allocate(size, alignment);
}
void* operator new[](std::size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return allocate(size, alignment);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete[](void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t, const std::nothrow_t&) noexcept { std::free(memory); }

#endif
