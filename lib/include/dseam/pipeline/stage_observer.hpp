// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace dseam::pipeline {

/// The stages in the order in which the data passes them.
enum class Stage : std::uint8_t {
  kTakeIn,
  kAdjust,
  kCoarseFuse,
  kCoarseSeam,
  kFineFuse,
  kSeam,
  kMotion
};
inline constexpr std::size_t kNumStages = 7;

[[nodiscard]] constexpr const char* name(Stage stage) noexcept {
  constexpr const char* kNames[] = {"take_in",   "adjust", "coarse_fuse", "coarse_seam",
                                    "fine_fuse", "seam",   "motion"};
  return kNames[static_cast<std::uint8_t>(stage)];
}

/// Told of every stage that ends. lib/ has no clock: whoever wants milliseconds reads one here.
class StageObserver {
 public:
  StageObserver() = default;
  StageObserver(const StageObserver&) = delete;
  StageObserver& operator=(const StageObserver&) = delete;

  void ended(Stage stage) noexcept { do_ended(stage); }

 protected:
  ~StageObserver() = default;  // Owners hold the concrete type: no delete through a base.

 private:
  virtual void do_ended(Stage stage) noexcept = 0;
};

}  // namespace dseam::pipeline
