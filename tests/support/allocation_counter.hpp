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

}  // namespace dseam::test
