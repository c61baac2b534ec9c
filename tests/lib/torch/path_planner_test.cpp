// SPDX-License-Identifier: Apache-2.0
#include "dseam/torch/path_planner.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "dseam/torch/torch_planner.hpp"
#include "support/allocation_counter.hpp"
#include "support/analytic_saddle.hpp"
#include "support/arena_owner.hpp"

namespace {

using dseam::test::Saddle;
using dseam::torch::PathPlanner;
using dseam::torch::PathPoint;
using dseam::torch::Segment;
using dseam::torch::TorchCurveView;
using dseam::torch::TorchPlanner;
using dseam::torch::TorchPoint;
using dseam::torch::TorchPose;
using dseam::torch::Weldable;
using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A torch curve over a saddle, planned once.
struct Curve {
  std::vector<TorchPoint> points;
  double length_mm = 0.0;
  bool closed = true;

  explicit Curve(const Saddle& saddle = {}) : points(2000) {
    dseam::test::ArenaOwner owner(TorchPlanner::bytes(1000));
    const auto seam = saddle.points(720);
    dseam::Buffer<TorchPoint> out(points);
    length_mm = TorchPlanner::make({}, 1000, owner.arena())
                    .value()
                    .run(dseam::test::view_of(seam), out)
                    .length_mm;
    points.resize(out.size());
  }
  [[nodiscard]] TorchCurveView view() const { return {points, length_mm, closed}; }
  /// The points between two shares of the way round are not weldable.
  void block(double from, double to) {
    for (TorchPoint& point : points) {
      if (point.s_mm >= from * length_mm && point.s_mm < to * length_mm) {
        point.weldable = Weldable::kInterpolated;
      }
    }
  }
};

struct Path {
  PathPlanner::Report report;
  std::vector<PathPoint> points;
};

Path plan(const PathPlanner::Config& config, const TorchCurveView& curve,
          const TorchPose* now = nullptr, std::size_t room = 40'000) {
  PathPlanner planner = PathPlanner::make(config).value();
  std::vector<PathPoint> storage(room);
  dseam::Buffer<PathPoint> out(storage);
  const dseam::test::AllocationCounter counter;
  Path path{now == nullptr ? planner.run(curve, out) : planner.run_from(*now, curve, out), {}};
  EXPECT_EQ(counter.count(), 0U);
  path.points.assign(out.view().begin(), out.view().end());
  return path;
}

/// Travel between path points that burn.
double burnt_mm(const Path& path) {
  double sum = 0.0;
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    sum += path.points[i - 1].arc ? path.points[i].s_mm - path.points[i - 1].s_mm : 0.0;
  }
  return sum;
}

std::vector<PathPoint> burning(const Path& path) {
  std::vector<PathPoint> points;
  std::copy_if(path.points.begin(), path.points.end(), std::back_inserter(points),
               [](const PathPoint& p) { return p.arc && p.dwell_s == 0.0; });
  return points;
}

TEST(PathPlanner, lays_every_segment_once_and_in_order) {
  const Curve curve;

  const Path path = plan({}, curve.view());

  ASSERT_EQ(path.report.state, PathPlanner::State::kPlanned);
  std::vector<Segment> order;
  for (const PathPoint& point : path.points) {
    if (order.empty() || order.back() != point.segment) {
      order.push_back(point.segment);
    }
  }
  EXPECT_EQ(order, (std::vector<Segment>{Segment::kApproach, Segment::kLeadIn, Segment::kWeld,
                                         Segment::kOverlap, Segment::kCrater, Segment::kLeadOut,
                                         Segment::kRetract}));
}

TEST(PathPlanner, the_overlap_passes_the_start_by_the_length_or_the_angle_asked_for) {
  const Curve curve;
  PathPlanner::Config by_angle;
  by_angle.overlap_rad = 20 * kDegree;

  EXPECT_NEAR(burnt_mm(plan({}, curve.view())), curve.length_mm + 10.0, 1e-3 * curve.length_mm);
  EXPECT_NEAR(burnt_mm(plan(by_angle, curve.view())), curve.length_mm * (1.0 + 20.0 / 360.0),
              1e-3 * curve.length_mm);
}

TEST(PathPlanner, the_weld_begins_where_it_was_asked_to) {
  const Curve curve;
  PathPlanner::Config config;
  config.start_mm = 0.25 * curve.length_mm;

  const Path path = plan(config, curve.view());

  const Vector3d begin = burning(path).front().pose.p_base;
  const Vector3d asked = curve.points[curve.points.size() / 4].pose.p_base;
  EXPECT_LT((begin - asked).norm(), 1.0);
}

TEST(PathPlanner, gas_flows_before_and_after_the_arc_and_the_wire_with_it) {
  const Path path = plan({}, Curve{}.view());

  const auto first_arc = std::find_if(path.points.begin(), path.points.end(),
                                      [](const PathPoint& p) { return p.arc; });
  const auto before = std::prev(first_arc);
  EXPECT_TRUE(before->gas && !before->wire && before->stop);
  EXPECT_DOUBLE_EQ(before->dwell_s, 0.3);
  EXPECT_DOUBLE_EQ(first_arc->dwell_s, 0.2);
  const auto crater = std::find_if(path.points.begin(), path.points.end(), [](const PathPoint& p) {
    return p.segment == Segment::kCrater;
  });
  EXPECT_TRUE(crater->arc && crater->stop);
  EXPECT_DOUBLE_EQ(crater->dwell_s, 0.5);
  EXPECT_TRUE(std::next(crater)->gas && !std::next(crater)->arc);
  EXPECT_DOUBLE_EQ(std::next(crater)->dwell_s, 0.5);
  for (const PathPoint& point : path.points) {
    EXPECT_EQ(point.arc, point.wire);
    EXPECT_TRUE(point.gas || !point.arc);
  }
}

TEST(PathPlanner, begins_where_the_torch_is) {
  const Curve curve;
  TorchPose now;
  now.p_base = Vector3d(200.0, -100.0, 300.0);
  now.q_base_torch = Eigen::AngleAxisd(2.5, Vector3d(1.0, 1.0, 0.0).normalized());

  const Path path = plan({}, curve.view(), &now);

  ASSERT_EQ(path.report.state, PathPlanner::State::kPlanned);
  EXPECT_LT((path.points.front().pose.p_base - now.p_base).norm(), 1e-9);
  EXPECT_LT(path.points.front().pose.q_base_torch.angularDistance(now.q_base_torch), 1e-9);
}

TEST(PathPlanner, a_start_pose_far_away_or_none_is_refused) {
  const Curve curve;
  TorchPose far;
  far.p_base.x() = 5000.0;
  TorchPose nowhere;
  nowhere.p_base.x() = kNan;
  TorchPose crooked;
  crooked.q_base_torch.coeffs().setZero();

  for (const TorchPose& pose : {far, nowhere, crooked}) {
    const Path path = plan({}, curve.view(), &pose);
    EXPECT_EQ(path.report.state, PathPlanner::State::kStartTooFar);
    EXPECT_TRUE(path.points.empty());
  }
}

TEST(PathPlanner, passes_by_what_is_not_weldable_with_the_arc_off_and_lifted) {
  Curve curve;
  curve.block(0.3, 0.45);
  curve.block(0.7, 0.8);

  const Path path = plan({}, curve.view());

  ASSERT_EQ(path.report.state, PathPlanner::State::kPlanned);
  EXPECT_EQ(path.report.beads, 3U);
  EXPECT_NEAR(burnt_mm(path), 0.75 * curve.length_mm + 10.0, 4.0);
  EXPECT_NEAR(path.report.skipped_mm, 0.25 * curve.length_mm, 4.0);
  for (const PathPoint& point : path.points) {
    const auto nearest = std::min_element(curve.points.begin(), curve.points.end(),
                                          [&](const TorchPoint& a, const TorchPoint& b) {
                                            return (a.pose.p_base - point.pose.p_base).norm() <
                                                   (b.pose.p_base - point.pose.p_base).norm();
                                          });
    if (nearest->weldable != Weldable::kYes) {
      EXPECT_FALSE(point.arc && (nearest->pose.p_base - point.pose.p_base).norm() < 0.1 &&
                   nearest->s_mm > 0.31 * curve.length_mm &&
                   nearest->s_mm < 0.44 * curve.length_mm);
    }
  }
}

TEST(PathPlanner, in_the_air_the_torch_goes_round_the_nozzle_and_not_through_it) {
  const Saddle saddle{100.0, 40.0, 90 * kDegree, 0.0};
  Curve curve(saddle);
  curve.block(0.2, 0.8);

  const Path path = plan({}, curve.view());

  for (const PathPoint& point : path.points) {
    const Vector3d& p = point.pose.p_base;
    EXPECT_GT(std::hypot(p.x(), p.y()), saddle.nozzle_mm - 0.1);
  }
}

TEST(PathPlanner, nothing_weldable_no_curve_and_a_full_buffer_have_names) {
  Curve blocked;
  blocked.block(-1.0, 2.0);
  const Curve good;

  EXPECT_EQ(plan({}, blocked.view()).report.state, PathPlanner::State::kNothingWeldable);
  EXPECT_EQ(plan({}, {}).report.state, PathPlanner::State::kNoCurve);
  const Path full = plan({}, good.view(), nullptr, 300);
  EXPECT_EQ(full.report.state, PathPlanner::State::kFull);
  EXPECT_TRUE(full.points.empty());
}

TEST(PathPlanner, a_pass_lies_where_its_offsets_say_and_turns_by_its_angle) {
  const Curve curve;
  PathPlanner::Config config;
  config.num_passes = 2;
  config.passes[1].across_mm = 3.0;
  config.passes[1].out_mm = 4.0;
  config.passes[1].work_offset_rad = 10 * kDegree;
  config.passes[1].start_shift_mm = 30.0;
  config.passes[1].schedule = 2;

  const Path path = plan(config, curve.view());

  ASSERT_EQ(path.report.beads, 2U);
  for (const PathPoint& point : burning(path)) {
    const auto nearest = std::min_element(
        curve.points.begin(), curve.points.end(), [&](const TorchPoint& a, const TorchPoint& b) {
          const auto far = [&](const TorchPoint& t) {
            return (t.pose.p_base +
                    (point.pass == 1 ? 3.0 * t.across + 4.0 * t.out : Vector3d::Zero().eval()) -
                    point.pose.p_base)
                .norm();
          };
          return far(a) < far(b);
        });
    const Vector3d offset = point.pose.p_base - nearest->pose.p_base;
    EXPECT_NEAR(offset.dot(nearest->across), point.pass == 1 ? 3.0 : 0.0, 0.05);
    EXPECT_NEAR(offset.dot(nearest->out), point.pass == 1 ? 4.0 : 0.0, 0.05);
    EXPECT_EQ(point.schedule, point.pass == 1 ? 2 : 0);
    const double turned =
        point.pose.q_base_torch.angularDistance(nearest->pose.q_base_torch) / kDegree;
    EXPECT_NEAR(turned, point.pass == 1 ? 10.0 : 0.0, 1.0);
  }
}

TEST(PathPlanner, resumes_before_the_stop_after_a_run_up_and_in_phase) {
  const Curve curve;
  PathPlanner::Config whole;
  whole.passes[0].weave = {dseam::torch::WeaveShape::kSine, 2.0, 5.0};
  PathPlanner::Config rest = whole;
  rest.resume = {true, 0, 100.0, 10.0, 5.0};

  const Path before = plan(whole, curve.view());
  const Path after = plan(rest, curve.view());

  EXPECT_NEAR(after.report.weld_mm, before.report.weld_mm - 95.0, 1e-6);
  const auto burnt = burning(after);
  const auto all = burning(before);
  // Every point of the rest lies on the whole weave.
  for (std::size_t i = 0; i < burnt.size(); i += 50) {
    double nearest_mm = 1e9;
    for (const PathPoint& point : all) {
      nearest_mm = std::min(nearest_mm, (point.pose.p_base - burnt[i].pose.p_base).norm());
    }
    EXPECT_LT(nearest_mm, 0.2);
  }
  const auto run_up =
      std::count_if(after.points.begin(), after.points.end(), [](const PathPoint& p) {
        return p.segment == Segment::kLeadIn && p.gas && !p.arc && p.dwell_s == 0.0;
      });
  EXPECT_GT(run_up, 10);
}

TEST(PathPlanner, nothing_is_left_to_resume_after_the_last_bead) {
  PathPlanner::Config config;
  config.resume = {true, 0, 1e4, 10.0, 5.0};

  EXPECT_EQ(plan(config, Curve{}.view()).report.state, PathPlanner::State::kNothingLeft);
}

/// Turn about the wire from the first burning point on.
double greatest_turn(const Path& path) {
  double turn = 0.0;
  double most = 0.0;
  bool begun = false;
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    begun = begun || path.points[i - 1].arc;
    const Eigen::Quaterniond d =
        path.points[i - 1].pose.q_base_torch.conjugate() * path.points[i].pose.q_base_torch;
    turn += begun ? 2.0 * std::atan2(d.w() < 0 ? -d.z() : d.z(), std::abs(d.w())) : 0.0;
    most = std::max(most, std::abs(turn));
  }
  return most;
}

TEST(PathPlanner, the_wrist_turns_back_between_passes_rather_than_beyond_its_limit) {
  const Curve curve;
  PathPlanner::Config config;
  config.num_passes = 4;
  config.max_wrist_turn_rad = 300 * kDegree;

  const Path path = plan(config, curve.view());

  EXPECT_EQ(path.report.beads, 4U);
  EXPECT_LT(path.report.wrist_turn_rad, 300 * kDegree);
  EXPECT_LT(greatest_turn(path), 301 * kDegree);
  EXPECT_DOUBLE_EQ(path.report.unwound_rad, 0.0);
}

TEST(PathPlanner, a_limit_under_one_turn_is_kept_by_turning_about_the_wire) {
  const Curve curve;
  PathPlanner::Config config;
  config.num_passes = 2;
  config.max_wrist_turn_rad = 180 * kDegree;

  const Path path = plan(config, curve.view());

  EXPECT_LT(greatest_turn(path), 181 * kDegree);
  EXPECT_GT(path.report.unwound_rad, 60 * kDegree);
  for (const PathPoint& point : burning(path)) {  // The wire itself does not move.
    const auto nearest = std::min_element(curve.points.begin(), curve.points.end(),
                                          [&](const TorchPoint& a, const TorchPoint& b) {
                                            return (a.pose.p_base - point.pose.p_base).norm() <
                                                   (b.pose.p_base - point.pose.p_base).norm();
                                          });
    const Vector3d wire = point.pose.q_base_torch * Vector3d::UnitZ();
    const Vector3d asked = nearest->pose.q_base_torch * Vector3d::UnitZ();
    EXPECT_LT(std::acos(std::min(1.0, wire.dot(asked))), 1.0 * kDegree);
  }
}

TEST(PathPlanner, length_never_falls_and_the_torch_never_jumps) {
  PathPlanner::Config config;
  config.num_passes = 3;
  Curve curve;
  curve.block(0.4, 0.6);

  const Path path = plan(config, curve.view());

  for (std::size_t i = 1; i < path.points.size(); ++i) {
    const double step_mm = (path.points[i].pose.p_base - path.points[i - 1].pose.p_base).norm();
    EXPECT_GE(path.points[i].s_mm, path.points[i - 1].s_mm);
    EXPECT_LT(step_mm, 6.0);
    EXPECT_LT(
        path.points[i].pose.q_base_torch.angularDistance(path.points[i - 1].pose.q_base_torch),
        0.3);
  }
}

TEST(PathPlanner, values_out_of_range_are_refused) {
  const auto refused = [](auto set) {
    PathPlanner::Config config;
    set(config);
    return !PathPlanner::make(config).ok();
  };

  EXPECT_TRUE(refused([](auto& c) { c.num_passes = 0; }));
  EXPECT_TRUE(refused([](auto& c) { c.num_passes = 9; }));
  EXPECT_TRUE(refused([](auto& c) { c.overlap_mm = kNan; }));
  EXPECT_TRUE(refused([](auto& c) { c.step_mm = 0.0; }));
  EXPECT_TRUE(refused([](auto& c) { c.approach_mm = 1.0; }));
  EXPECT_TRUE(refused([](auto& c) { c.travel_mm_s = -5.0; }));
  EXPECT_TRUE(refused([](auto& c) { c.preflow_s = -0.1; }));
  EXPECT_TRUE(refused([](auto& c) { c.max_wrist_turn_rad = 0.0; }));
  EXPECT_TRUE(refused([](auto& c) { c.passes[0].speed_mm_s = 0.0; }));
  EXPECT_TRUE(refused([](auto& c) { c.passes[0].across_mm = kNan; }));
  EXPECT_TRUE(refused([](auto& c) {
    c.passes[0].weave = {dseam::torch::WeaveShape::kSine, 1.0, 0.0};
  }));
  EXPECT_TRUE(refused([](auto& c) { c.resume.run_up_mm = -1.0; }));
}

}  // namespace
