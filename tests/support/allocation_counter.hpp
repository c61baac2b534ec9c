// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dseam::test {

/// Counts malloc, calloc, realloc, the aligned forms and mmap in every thread since construction.
/// Every test program that links dseam_test_support has the counting functions in it.
class AllocationCounter {
 public:
  AllocationCounter() noexcept;
  [[nodiscard]] std::uint64_t count() const noexcept;

 private:
  std::uint64_t start_;
};

/// The same for the calling thread alone: for code beside a library whose own threads allocate.
class ThreadAllocationCounter {
 public:
  ThreadAllocationCounter() noexcept;
  [[nodiscard]] std::uint64_t count() const noexcept;

 private:
  std::uint64_t start_;
};

}  // namespace dseam::test
