// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/base/random.hpp"
#include "dseam/base/result.hpp"
#include "dseam/splice/pipes/pipe_pair.hpp"
#include "dseam/splice/surface_patches.hpp"

namespace dseam::splice {

/// Finds shell and nozzle among one view's surface patches.
///
/// Two patches whose normals differ make a cylinder; the one on which most patches lie is fitted to
/// them, they are put aside, and the next is sought. Insides are sought after all outsides.
///
/// Frame:   camera.
/// Memory:  `bytes()` from the arena; nothing is kept between two calls.
/// Time:    O(trials x samples), both bounded; seeded, the same each time.
class PipeFinder {
 public:
  struct Config {
    double tolerance_mm = 1.0;  ///< Of a patch off its pipe,
    double min_cosine = 0.98;   ///< and between their normals.
    double min_radius_mm = 8.0;
    double max_radius_mm = 600.0;
    std::uint32_t min_patches = 30;
    double rival_share = 0.4;  ///< Of the lesser pipe's patches: a third pipe with more is a rival.
    double min_axis_sine = 0.3;
    double min_lead_mm = 1.0;       ///< Between the radii.
    double ovality_sigma_mm = 0.3;  ///< Of a pipe's half-axes about its radius, beforehand.
    double max_ovality_mm = 1.2;
    double max_rms_mm = 0.2;          ///< Of the patches about their pipe.
    double max_shift_sigma_mm = 1.0;  ///< Of axis and radius.
    double max_tilt_sigma_rad = 0.01;
  };
  static constexpr std::size_t kMaxSamples = 6144;
  static constexpr std::uint32_t kTrials = 300;   ///< Cylinders judged for each pipe, of
  static constexpr std::uint32_t kDraws = 20000;  ///< that many pairs of patches at most.

  [[nodiscard]] static constexpr std::size_t bytes() noexcept {
    return 9 * Arena::bytes<float>(kMaxSamples) + Arena::bytes<bool>(kMaxSamples);
  }
  /// Errors:  kInvalidArgument, kOutOfMemory.
  [[nodiscard]] static Result<PipeFinder> make(const Config& config, Arena& arena) noexcept;

  PipePair run(const PatchField& field) noexcept;

 private:
  struct Coordinates {
    std::span<float> x;
    std::span<float> y;
    std::span<float> z;
    void set(std::size_t i, const Eigen::Vector3d& v) noexcept;
    [[nodiscard]] geometry::PointSpans first(std::size_t n) const noexcept {
      return {x.first(n), y.first(n), z.first(n)};
    }
  };

  explicit PipeFinder(const Config& config) noexcept : config_(config) {}
  void sample(const PatchField& field) noexcept;
  [[nodiscard]] bool fit(const depth::Intrinsics& k, const geometry::Cylinder& start,
                         Pipe& pipe) noexcept;
  [[nodiscard]] bool next_pipe(const depth::Intrinsics& k, Pipe& pipe) noexcept;
  [[nodiscard]] bool best_trial(geometry::Cylinder& best) noexcept;
  [[nodiscard]] bool trial(Pcg32& random, geometry::Cylinder& out) const noexcept;
  [[nodiscard]] std::uint32_t votes(const geometry::Cylinder& c, std::size_t stride) const noexcept;
  [[nodiscard]] bool lies_on(const geometry::Cylinder& c, std::size_t i, double tolerance_mm,
                             double cosine) const noexcept;
  std::size_t collect(const geometry::Cylinder& c, double tolerance_mm, double cosine) noexcept;
  void put_aside(const geometry::Cylinder& c) noexcept;
  [[nodiscard]] PipePairState seek_outsides(const depth::Intrinsics& k, PipePair& pair) noexcept;
  PipePairState seek_bore(const depth::Intrinsics& k, PipePair& pair) noexcept;
  [[nodiscard]] PipePairState judge(const Pipe& shell, Pipe& other) const noexcept;
  [[nodiscard]] PipePairState judge(const Pipe& pipe) const noexcept;

  Config config_;
  Coordinates points_;
  Coordinates normals_;
  Coordinates chosen_;  ///< Points of the pipe that is being fitted, in their order.
  std::span<bool> aside_;
  std::size_t num_samples_ = 0;
  double facing_ = 1.0;  ///< 1: outsides are sought, -1: insides.
};

}  // namespace dseam::splice
