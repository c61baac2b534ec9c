// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "least_distances.hpp"
#include "nearest_list.hpp"

namespace dseam::search {

/// The distances to the k nearest of every point, cell by cell.
///
/// How far to look for a block is a guess, learnt from the blocks before. What it covers is looked
/// at in straight loops; where it falls short, the ring beyond is looked at too, then the tree. The
/// guess decides how long that takes, never what is found.
template <std::size_t kRoom>
class NearestOfAll {
 public:
  NearestOfAll(const CellTree& tree, NearPoints near, std::size_t k) noexcept
      : tree_(tree), near_(near), k_(k) {}

  /// `done(cell, distances, covered)`: with `covered` all that is as near lies in near().
  template <typename Done>
  void run(const Done& done) noexcept {
    for (std::uint32_t block = 0; block < tree_.num_blocks(); ++block) {
      const bool fits = collect(block);
      crowded_ = false;
      for (std::uint32_t at = CellTree::first_of(block); at < tree_.end_of(block); ++at) {
        const Cell& cell = tree_.cells()[at];
        const QueryCell query(cell);
        LeastDistances<kRoom> best;
        best.insert_own(query, cell);
        if (fits) {
          look_around(at, query, best);
        } else {
          look_farther(at, query, best);
        }
        const bool covered =
            fits && groups_[at % kLanes].lanes == kAll && largest(best.least[k_ - 1]) <= reach_mm2_;
        done(at, best, covered);
      }
    }
  }
  [[nodiscard]] NearPoints& near() noexcept { return near_; }

 private:
  static constexpr float kGrow = 1.2F;  ///< These two make one guess in ten fall short.
  static constexpr float kShrink = 0.98F;
  static constexpr float kWiden = 1.5F;  ///< Of the block beyond the guess for a cell.
  static constexpr float kStretched =
      64.0F;  ///< Cells this much larger than the guess hold a stray.
  static constexpr float kStray = 16.0F;
  static constexpr float kFarTooMuch = 16.0F;
  static constexpr float kInfinity = std::numeric_limits<float>::infinity();
  static constexpr std::size_t kCompany = 4;
  static constexpr float kLeastGuess = 1.0e-12F;
  static constexpr float kMostGuess = 1.0e15F;
  static constexpr std::uint32_t kAll = 0xFFU;

  /// The points of a cell that lie together.
  struct Group {
    Box box;
    std::uint32_t lanes;
  };

  [[nodiscard]] bool collect(std::uint32_t block) noexcept {
    Box box = kNothing;
    for (std::uint32_t at = CellTree::first_of(block); at < tree_.end_of(block); ++at) {
      groups_[at % kLanes] = group_of(at);
      box = both(box, groups_[at % kLanes].box);
    }
    reach_mm2_ = kWiden * guess_mm2_;
    return near_.collect(block, box, reach_mm2_);
  }

  [[nodiscard]] Group group_of(std::uint32_t at) const noexcept {
    const Box box = tree_.box_of(at);
    const float x = box.high_x - box.low_x;
    const float y = box.high_y - box.low_y;
    const float z = box.high_z - box.low_z;
    return x * x + y * y + z * z <= kStretched * guess_mm2_ ? Group{box, kAll} : without_strays(at);
  }
  // A stray point would stretch the box so that it is near everything.
  [[nodiscard]] Group without_strays(std::uint32_t at) const noexcept {
    const Cell& cell = tree_.cells()[at];
    LeastDistances<kCompany> own;
    own.insert_own(QueryCell(cell), cell);
    const FloatLanes& company = own.least[std::min(k_, kCompany) - 1];
    Group group{kNothing, bits(company <= lanes::splat(kStray * guess_mm2_))};
    for (std::size_t i = 0; i < kLanes && cell.index[i] != kNoPoint; ++i) {
      if ((group.lanes >> i & 1U) != 0) {
        group.box = both(group.box, box_at({cell.x[i], cell.y[i], cell.z[i]}));
      }
    }
    return group;
  }

  // Among the points collected for the block.
  void look_around(std::uint32_t at, const QueryCell& query, LeastDistances<kRoom>& best) noexcept {
    const Group& group = groups_[at % kLanes];
    float seen_mm2 = std::min(guess_mm2_, reach_mm2_);
    best.insert_all(query, near_.others_of(at, group.box, {-1.0F, seen_mm2}));
    const float wanted_mm2 = farthest_of(group.lanes, best);
    if (wanted_mm2 > seen_mm2) {
      const Ring ring{seen_mm2, std::min(wanted_mm2, reach_mm2_)};
      best.insert_all(query, near_.others_of(at, group.box, ring));
      seen_mm2 = ring.upto_mm2;
    }
    finish(at, seen_mm2, best);
  }
  // The block had too many; a cell alone may not.
  void look_farther(std::uint32_t at, const QueryCell& query,
                    LeastDistances<kRoom>& best) noexcept {
    const Group& group = groups_[at % kLanes];
    if (!crowded_ && group.lanes != 0) {
      const NearView points = near_.others_around(at, group.box, reach_mm2_);
      best.insert_all(query, points);
      crowded_ = points.count == 0;
    }
    if (crowded_) {
      look_through_tree(at, query, best);
    }
    finish(at, crowded_ ? kInfinity : reach_mm2_, best);
  }
  // `best` knows of all within `seen_mm2` of the cell's group.
  void finish(std::uint32_t at, float seen_mm2, LeastDistances<kRoom>& best) noexcept {
    const std::uint32_t group = groups_[at % kLanes].lanes;
    const std::uint32_t beyond = bits(lanes::splat(seen_mm2) < best.least[k_ - 1]) | ~group;
    if (seen_mm2 < kInfinity && (beyond & kAll) != 0) {
      look_alone(at, beyond & kAll, best);
    }
    learn(group, best);
  }
  // Upwards in small steps, since a few strays say little; down at once where all eight say so.
  void learn(std::uint32_t group, const LeastDistances<kRoom>& best) noexcept {
    const float nearest_mm2 = least(best.least[k_ - 1]);
    const float farthest_mm2 = largest(best.least[k_ - 1]);
    if (nearest_mm2 > guess_mm2_) {
      guess_mm2_ *= kGrow;
    } else if (farthest_mm2 * kFarTooMuch < guess_mm2_) {
      guess_mm2_ = farthest_mm2 * kFarTooMuch;
    } else {
      guess_mm2_ *= farthest_of(group, best) > guess_mm2_ ? kGrow : kShrink;
    }
    guess_mm2_ = std::clamp(guess_mm2_, kLeastGuess, kMostGuess);
  }
  [[nodiscard]] float farthest_of(std::uint32_t group,
                                  const LeastDistances<kRoom>& best) const noexcept {
    const FloatLanes& farthest = best.least[k_ - 1];
    if (group == kAll) {
      return largest(farthest);
    }
    float most = 0.0F;
    for (; group != 0; group &= group - 1) {
      most = std::max(most, farthest[static_cast<std::size_t>(std::countr_zero(group))]);
    }
    return most;
  }

  // One point at a time; it finds itself too.
  void look_alone(std::uint32_t at, std::uint32_t alone, LeastDistances<kRoom>& best) noexcept {
    const Cell& cell = tree_.cells()[at];
    for (; alone != 0; alone &= alone - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(alone));
      if (cell.index[i] == kNoPoint) {
        continue;
      }
      std::array<Neighbour, kRoom + 1> found;
      look_alone(at, i, {found.data(), k_ + 1});
      for (std::size_t j = 0; j < k_; ++j) {
        const FloatLanes its = lanes::splat(found[j + 1].squared_mm2);
        best.least[j] = select(lanes::is_lane(i), its, best.least[j]);
      }
    }
  }
  // Most lie as close to others as all do, only not to those of their cell.
  void look_alone(std::uint32_t at, std::size_t lane, std::span<Neighbour> found) noexcept {
    const Cell& cell = tree_.cells()[at];
    const geometry::Vec3f point{cell.x[lane], cell.y[lane], cell.z[lane]};
    NearestList near(found, reach_mm2_);
    near.offer(EightPoints::of(cell), point);
    const NearView others = near_.others_around(at, box_at(point), reach_mm2_);
    for (std::size_t i = 0; i < others.count; i += kLanes) {
      near.offer(EightPoints::of(others, i), point);
    }
    if (others.count == 0 || near.size() < found.size()) {
      NearestList all(found, kInfinity);
      offer_all(tree_, point, all);
    }
  }

  // All eight at once; `best` knows its own cell.
  void look_through_tree(std::uint32_t at, const QueryCell& query,
                         LeastDistances<kRoom>& best) noexcept {
    const Cell& own = tree_.cells()[at];
    FloatLanes farthest = best.least[k_ - 1];
    Reach of_all{largest(farthest), 0};
    const auto reach = [&]() noexcept { return of_all; };
    tree_.visit_around(at, tree_.box_of(at), reach, [&](std::uint32_t other) noexcept {
      const Cell& cell = tree_.cells()[other];
      if (&cell != &own && query.any_nearer(tree_.box_of(other), farthest)) {
        best.insert_cell(query, cell);
        farthest = best.least[k_ - 1];
        of_all.squared_mm2 = largest(farthest);
      }
    });
  }

  static constexpr float kFar = std::numeric_limits<float>::max();
  static constexpr Box kNothing{kFar, kFar, kFar, -kFar, -kFar, -kFar};

  const CellTree& tree_;
  NearPoints near_;
  std::size_t k_;
  float guess_mm2_ = 1.0F;
  float reach_mm2_ = 0.0F;
  bool crowded_ = false;  ///< Even around one cell of the block there are too many.
  std::array<Group, kLanes> groups_;
};

}  // namespace dseam::search
