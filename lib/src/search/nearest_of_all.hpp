// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "least_distances.hpp"
#include "nearest_list.hpp"

namespace dseam::search {

/// The k nearest of every point, cell by cell; `Best` is what is wanted of them: LeastDistances or
/// LeastNeighbours.
///
/// How far to look for a block is a guess, learnt from the blocks before. What it covers is looked
/// at in straight loops; where it falls short, the ring beyond is looked at too, then the tree. The
/// guess decides how long that takes, never what is found.
template <typename Best>
class NearestOfAll {
 public:
  NearestOfAll(const CellTree& tree, NearPoints near, std::size_t k) noexcept
      : tree_(tree), near_(near), k_(k) {}

  /// `done(cell, best)`.
  template <typename Done>
  void run(const Done& done) noexcept {
    Best best;
    for (std::uint32_t block = 0; block < tree_.num_blocks(); ++block) {
      const Box around = tree_.box_of_block(block);
      if (is_one_place(around)) {
        look_from(block, best, done);
        continue;
      }
      const bool fits = collect(block);
      for (std::uint32_t at = CellTree::first_of(block); at < tree_.end_of(block); ++at) {
        const Cell& cell = tree_.cells()[at];
        const QueryCell query(cell);
        best.clear();
        best.insert_own(query, cell);
        if (fits) {
          look_around(at, query, best);
        } else {
          look_farther(at, query, best);
        }
        done(at, best);
      }
    }
  }

 private:
  static constexpr float kGrow = 1.2F;  ///< These two make one guess in ten fall short.
  static constexpr float kShrink = 0.98F;
  static constexpr float kWiden = 1.5F;  ///< Of the block beyond the guess for a cell.
  static constexpr float kStretched =
      64.0F;  ///< Cells this much larger than the guess hold a stray.
  static constexpr float kStray = 16.0F;
  static constexpr float kFarTooMuch = 16.0F;
  static constexpr float kInfinity = std::numeric_limits<float>::infinity();
  static constexpr std::size_t kCompany = 5;
  static constexpr float kLeastGuess = 1.0e-12F;
  static constexpr float kMostGuess = 1.0e15F;
  static constexpr std::uint32_t kAll = 0xFFU;

  /// The points of a cell that lie together.
  struct Group {
    Box box;
    std::uint32_t lanes;
  };

  [[nodiscard]] bool collect(std::uint32_t block) noexcept {
    Box around = kNothing;
    Node boxes;
    for (std::uint32_t i = 0; i < kLanes; ++i) {
      const std::uint32_t at = CellTree::first_of(block) + i;
      groups_[i] = at < tree_.end_of(block) ? group_of(at) : Group{kNothing, 0};
      boxes.set(i, groups_[i].box);
      around = both(around, groups_[i].box);
    }
    crowded_ = false;
    near_mm2_ = guess_mm2_;
    reach_mm2_ = kWiden * guess_mm2_;
    return near_.collect(block, boxes, around, reach_mm2_);
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
    const FloatLanes& company = own.squared_mm2(std::min(k_, kCompany) - 1);
    const std::uint32_t together = bits(company <= lanes::splat(kStray * guess_mm2_));
    return {box_of(cell, together & used_lanes(cell)), together};
  }

  // Among the points collected for the block.
  void look_around(std::uint32_t at, const QueryCell& query, Best& best) noexcept {
    const Group& group = groups_[at % kLanes];
    float seen_mm2 = near_mm2_;
    look_in_ring(at, query, {-1.0F, seen_mm2}, best);
    const float wanted_mm2 = farthest_of(group.lanes, best);
    if (wanted_mm2 > seen_mm2) {
      look_in_ring(at, query, {seen_mm2, reach_mm2_}, best);
      seen_mm2 = reach_mm2_;
    }
    finish(at, seen_mm2, best);
  }
  void look_in_ring(std::uint32_t at, const QueryCell& query, Ring ring, Best& best) noexcept {
    const Box& box = groups_[at % kLanes].box;
    best.insert_all(query, near_.template others_of<Best::kIndices>(at, box, ring));
  }
  // The block had too many; a cell alone may not.
  void look_farther(std::uint32_t at, const QueryCell& query, Best& best) noexcept {
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
  void finish(std::uint32_t at, float seen_mm2, Best& best) noexcept {
    const std::uint32_t group = groups_[at % kLanes].lanes;
    const std::uint32_t beyond =
        bits(lanes::splat(seen_mm2) < best.squared_mm2(k_ - 1)) | (kAll & ~group);
    if (seen_mm2 < kInfinity && beyond != 0) {
      look_apart(at, beyond & used_lanes(tree_.cells()[at]), best);
    }
    learn(group, best);
  }
  // In small steps, since a few strays say little; at once where all eight say so.
  void learn(std::uint32_t group, const Best& best) noexcept {
    const float nearest_mm2 = least(best.squared_mm2(k_ - 1));
    const float farthest_mm2 = largest(best.squared_mm2(k_ - 1));
    if (nearest_mm2 > guess_mm2_ * kFarTooMuch) {
      guess_mm2_ = nearest_mm2;
    } else if (nearest_mm2 > guess_mm2_) {
      guess_mm2_ *= kGrow;
    } else if (farthest_mm2 * kFarTooMuch < guess_mm2_) {
      guess_mm2_ = farthest_mm2 * kFarTooMuch;
    } else {
      guess_mm2_ *= farthest_of(group, best) > guess_mm2_ ? kGrow : kShrink;
    }
    guess_mm2_ = std::clamp(guess_mm2_, kLeastGuess, kMostGuess);
  }
  [[nodiscard]] float farthest_of(std::uint32_t group, const Best& best) const noexcept {
    const FloatLanes farthest = best.squared_mm2(k_ - 1);
    if (group == kAll) {
      return largest(farthest);
    }
    float most = 0.0F;
    for (; group != 0; group &= group - 1) {
      most = std::max(most, farthest[static_cast<std::size_t>(std::countr_zero(group))]);
    }
    return most;
  }

  // A cell may hold the end of one surface and the beginning of another: for each such part what
  // lies around it, then for what still misses some one point at a time.
  [[gnu::noinline]] void look_apart(std::uint32_t at, std::uint32_t lanes, Best& best) noexcept {
    const Cell& cell = tree_.cells()[at];
    const QueryCell query(cell);
    while (lanes != 0) {
      const auto first = static_cast<std::size_t>(std::countr_zero(lanes));
      const std::uint32_t part = lanes & part_of(query, cell, first);
      lanes &= ~part;
      Best its;
      its.insert_own(query, cell);
      const NearView others = near_.others_around(at, box_of(cell, part), reach_mm2_);
      its.insert_all(query, others);
      const FloatLanes known = its.squared_mm2(k_ - 1);
      const float seen_mm2 = others.count > 0 ? reach_mm2_ : -1.0F;  // None may be too many.
      for (std::uint32_t left = part; left != 0; left &= left - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(left));
        if (known[i] <= seen_mm2) {
          best.take(its, i);
        } else {
          look_alone(cell, i, known[i], best);
        }
      }
    }
  }
  [[nodiscard]] std::uint32_t part_of(const QueryCell& query, const Cell& cell,
                                      std::size_t i) const noexcept {
    return bits(query.squared_distances(cell, i) <= lanes::splat(kStray * reach_mm2_)) | 1U << i;
  }
  [[nodiscard]] static Box box_of(const Cell& cell, std::uint32_t lanes) noexcept {
    Box box = kNothing;
    for (; lanes != 0; lanes &= lanes - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(lanes));
      box = both(box, box_at({cell.x[i], cell.y[i], cell.z[i]}));
    }
    return box;
  }
  [[nodiscard]] static std::uint32_t used_lanes(const Cell& cell) noexcept {
    const IntLanes unused = lanes::load_lanes<IntLanes>(cell.index) ==
                            lanes::splat(static_cast<std::int32_t>(kNoPoint));
    return kAll & ~bits(unused);
  }
  // No farther than the k-th that is known.
  void look_alone(const Cell& cell, std::size_t i, float known_mm2, Best& best) const noexcept {
    std::array<Neighbour, Best::kMost + 1> room;
    NearestList list({room.data(), k_ + 1}, known_mm2);
    offer_all(tree_, {cell.x[i], cell.y[i], cell.z[i]}, list);
    take_others(room, cell.index[i], i, best);
  }
  // Of the k + 1 nearest in a place those that are not the point itself; among many in one place it
  // may not be there.
  void take_others(std::span<const Neighbour> found, std::uint32_t self, std::size_t lane,
                   Best& best) const noexcept {
    std::size_t place = 0;
    for (std::size_t i = 0; i <= k_ && place < k_; ++i) {
      if (found[i].index != self) {
        best.set(lane, place++, found[i]);
      }
    }
  }
  // All points of the block lie in one place: what is nearest to one of them is so to all.
  template <typename Done>
  void look_from(std::uint32_t block, Best& best, const Done& done) noexcept {
    const Cell& first = tree_.cells()[CellTree::first_of(block)];
    std::array<Neighbour, Best::kMost + 1> room;
    room.fill(Neighbour{kNoPoint, kInfinity});
    best.clear();
    NearestList list({room.data(), k_ + 1}, kInfinity);
    offer_all(tree_, {first.x[0], first.y[0], first.z[0]}, list);
    for (std::uint32_t at = CellTree::first_of(block); at < tree_.end_of(block); ++at) {
      const Cell& cell = tree_.cells()[at];
      for (std::size_t i = 0; i < kLanes && cell.index[i] != kNoPoint; ++i) {
        take_others(room, cell.index[i], i, best);
      }
      done(at, best);
    }
  }
  [[nodiscard]] static bool is_one_place(const Box& box) noexcept {
    return box.low_x == box.high_x && box.low_y == box.high_y && box.low_z == box.high_z;
  }

  // All eight at once; `best` knows its own cell. Each of the eight has its say on whole blocks
  // first: their box may reach across a surface that none of them is near to.
  void look_through_tree(std::uint32_t at, const QueryCell& query, Best& best) noexcept {
    const Box box = tree_.box_of(at);
    Reach reach = best.reach(k_);
    const auto reach_of = [&]() noexcept { return reach; };
    const auto may_take = [&](const Box& its) noexcept { return best.may_take(query, its, k_); };
    const auto visit = [&](std::uint32_t block) noexcept {
      if (!may_take(tree_.box_of_block(block))) {
        return;
      }
      std::uint32_t cells = tree_.near_cells(block, box, reach.squared_mm2);
      for (; cells != 0; cells &= cells - 1) {
        const std::uint32_t other =
            CellTree::first_of(block) + static_cast<std::uint32_t>(std::countr_zero(cells));
        if (other != at && may_take(tree_.box_of(other))) {
          best.insert_cell(query, tree_.cells()[other]);
          reach = best.reach(k_);
        }
      }
    };
    tree_.visit_blocks_around(CellTree::block_of(at), box, reach_of, visit);
  }

  static constexpr float kFar = std::numeric_limits<float>::max();
  static constexpr Box kNothing{kFar, kFar, kFar, -kFar, -kFar, -kFar};

  const CellTree& tree_;
  NearPoints near_;
  std::size_t k_;
  float guess_mm2_ = 1.0F;
  float near_mm2_ = 0.0F;  ///< Of the block: the guess, and what it is widened to.
  float reach_mm2_ = 0.0F;
  bool crowded_ = false;  ///< Even around one cell of the block there are too many.
  std::array<Group, kLanes> groups_;
};

}  // namespace dseam::search
