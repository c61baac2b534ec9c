// SPDX-License-Identifier: Apache-2.0
#include "support/allocation_counter.hpp"

#include <dlfcn.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cstddef>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define DSEAM_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || \
    __has_feature(realtime_sanitizer)
#define DSEAM_SANITIZED 1
#endif
#endif

namespace {
std::atomic<std::uint64_t> allocations{0};
thread_local std::uint64_t thread_allocations = 0;

[[maybe_unused]] void count_one() {
  ++allocations;
  ++thread_allocations;
}
}  // namespace

#ifndef DSEAM_SANITIZED
// A sanitizer has allocation functions of its own; there the counter stays at zero.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) {
  count_one();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  count_one();
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  count_one();
  return __libc_realloc(old, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  count_one();
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }
int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  *out = memalign(alignment, size);
  return *out == nullptr ? 12 : 0;
}
void* mmap(void* address, std::size_t length, int protection, int flags, int fd, off_t offset) {
  count_one();
  return reinterpret_cast<void*>(  // NOLINT: the system call returns an address as a number.
      syscall(SYS_mmap, address, length, protection, flags, fd, offset));
}
}
#endif

namespace dseam::test {

AllocationCounter::AllocationCounter() noexcept : start_(allocations.load()) {}

std::uint64_t AllocationCounter::count() const noexcept { return allocations.load() - start_; }

ThreadAllocationCounter::ThreadAllocationCounter() noexcept : start_(thread_allocations) {}

std::uint64_t ThreadAllocationCounter::count() const noexcept {
  return thread_allocations - start_;
}

}  // namespace dseam::test
