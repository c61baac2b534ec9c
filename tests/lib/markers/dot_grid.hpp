// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace dseam::test {

using GridPlace = std::pair<int, int>;
using DotGrid = std::map<GridPlace, std::size_t>;

/// The largest set of points that hang together as neighbours on a slowly changing grid: an oracle
/// that knows the target but not where it is.
class GridGrower {
 public:
  explicit GridGrower(const std::vector<Eigen::Vector2d>& points) : points_(points) {}

  DotGrid largest() {
    DotGrid best;
    for (std::size_t seed = 0; seed < points_.size() && best.size() < 100; ++seed) {
      DotGrid grid = from(seed);
      if (grid.size() > best.size()) {
        best = std::move(grid);
      }
    }
    return best;
  }

 private:
  using Steps = std::array<Eigen::Vector2d, 2>;

  std::size_t nearest(const Eigen::Vector2d& p, std::size_t except) const {
    std::size_t best = except == 0 ? 1 : 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (i != except && (points_[i] - p).norm() < (points_[best] - p).norm()) {
        best = i;
      }
    }
    return best;
  }

  DotGrid from(std::size_t seed) {
    const Eigen::Vector2d& origin = points_[seed];
    const Eigen::Vector2d along = points_[nearest(origin, seed)] - origin;
    const Eigen::Vector2d across(-along.y(), along.x());
    const std::size_t side = nearest(origin + across, seed);
    if ((points_[side] - origin - across).norm() > 0.6 * along.norm()) {
      return {};
    }
    DotGrid grid{{{0, 0}, seed}};
    std::map<GridPlace, Steps> steps{{{0, 0}, {along, points_[side] - origin}}};
    std::vector<bool> used(points_.size());
    used[seed] = true;
    std::vector<GridPlace> front{{0, 0}};
    for (std::size_t i = 0; i < front.size(); ++i) {
      grow(front[i], grid, steps, used, front);
    }
    return grid;
  }

  void grow(GridPlace at, DotGrid& grid, std::map<GridPlace, Steps>& steps, std::vector<bool>& used,
            std::vector<GridPlace>& front) {
    constexpr std::array<GridPlace, 4> kSides{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
    for (const auto& [di, dj] : kSides) {
      const GridPlace next{at.first + di, at.second + dj};
      Steps step = steps[at];
      const Eigen::Vector2d expected = points_[grid[at]] + di * step[0] + dj * step[1];
      const std::size_t k = nearest(expected, points_.size());
      const double reach = 0.3 * std::min(step[0].norm(), step[1].norm());
      if (grid.count(next) != 0 || used[k] || (points_[k] - expected).norm() > reach) {
        continue;
      }
      const Eigen::Vector2d moved = points_[k] - points_[grid[at]];
      Eigen::Vector2d& changed = step[di != 0 ? 0 : 1];
      changed = 0.5 * (changed + (di + dj) * moved);
      grid[next] = k;
      steps[next] = step;
      used[k] = true;
      front.push_back(next);
    }
  }

  const std::vector<Eigen::Vector2d>& points_;
};

/// Squared residuals of the grid under its best homography (least squares in the image), summed.
inline double homography_squares(const DotGrid& grid, const std::vector<Eigen::Vector2d>& points) {
  Eigen::Matrix<double, 8, 1> h;
  h << 18.0, 0.0, 320.0, 0.0, 18.0, 240.0, 0.0, 0.0;
  double squares = 0.0;
  for (int round = 0; round < 50; ++round) {
    Eigen::Matrix<double, 8, 8> normal = Eigen::Matrix<double, 8, 8>::Zero();
    Eigen::Matrix<double, 8, 1> gradient = Eigen::Matrix<double, 8, 1>::Zero();
    squares = 0.0;
    for (const auto& [place, index] : grid) {
      const double x = place.first;
      const double y = place.second;
      const double w = h(6) * x + h(7) * y + 1.0;
      const Eigen::Vector2d q((h(0) * x + h(1) * y + h(2)) / w, (h(3) * x + h(4) * y + h(5)) / w);
      Eigen::Matrix<double, 2, 8> j;
      j << x, y, 1.0, 0.0, 0.0, 0.0, -q.x() * x, -q.x() * y,  //
          0.0, 0.0, 0.0, x, y, 1.0, -q.y() * x, -q.y() * y;
      j /= w;
      const Eigen::Vector2d r = q - points[index];
      normal += j.transpose() * j;
      gradient += j.transpose() * r;
      squares += r.squaredNorm();
    }
    h -= normal.ldlt().solve(gradient);
  }
  return squares;
}

}  // namespace dseam::test
