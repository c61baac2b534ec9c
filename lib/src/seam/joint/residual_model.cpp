// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/joint/residual_model.hpp"

#include <algorithm>
#include <cmath>

namespace dseam::seam {
namespace {

constexpr double kRidge = 1e-7;
// In mm and rad: a larger change is a trade with a deviation that looks alike on a short arc.
constexpr double kMaxMove = 1.5;
constexpr double kExpectedMm = 1.0;  // Size of a deviation.
constexpr std::size_t kFirstHarmonic = kMaxSurfaceParameters + ResidualModel::kOvalColumns;

// Harmonics 0..K of an angle: 1, cos, sin, cos 2, sin 2, ...
void write_harmonics(double phi_rad, double scale, std::span<double> out) noexcept {
  const double c1 = std::cos(phi_rad);
  const double s1 = std::sin(phi_rad);
  double c = 1.0;
  double s = 0.0;
  out[0] = scale;
  for (std::size_t k = 1; k < out.size(); k += 2) {
    const double next = c * c1 - s * s1;
    s = s * c1 + c * s1;
    c = next;
    out[k] = scale * c;
    out[k + 1] = scale * s;
  }
}

void write_ovality(const Surface& surface, const Eigen::Vector3d& p,
                   std::span<double> out) noexcept {
  if (surface.kind != SurfaceKind::kCylinder && surface.kind != SurfaceKind::kCone) {
    std::fill(out.begin(), out.end(), 0.0);
    return;
  }
  const AcrossAxis frame = across(surface.axis);
  const double theta = angle_about(surface, {frame.u, frame.v}, p);
  out[0] = std::cos(2.0 * theta);
  out[1] = std::sin(2.0 * theta);
  out[2] = std::cos(3.0 * theta);
  out[3] = std::sin(3.0 * theta);
}

double dot(const ResidualModel::Row& a, const ResidualModel::Row& b) noexcept {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += a[i] * b[i];
  }
  return sum;
}

// Of what `count` patches tell that are no more than one. A fit takes as large a share of the
// squares as it has unknowns among the independent patches; of hardly any share little is told.
double variance_of(double squares, double num_patches, double num_columns, double count) noexcept {
  constexpr double kLeastShare = 0.25;
  const double left = std::max(kLeastShare, 1.0 - num_columns * count / num_patches);
  return count * squares / (num_patches * left);
}

}  // namespace

void ResidualModel::reset(const Surface& surface) noexcept {
  fitted_[0] = {};
  fitted_[0].surface = surface;
}

void ResidualModel::row_at(const Eigen::Vector3d& p, double phi_rad, double away,
                           Row& row) const noexcept {
  const SurfaceVector j = distance_jacobian(fitted_[0].surface, p);
  std::copy_n(j.data(), kMaxSurfaceParameters, row.begin());
  const std::span<double> all(row);
  write_ovality(fitted_[0].surface, p, all.subspan(kMaxSurfaceParameters, kOvalColumns));
  write_harmonics(phi_rad, 1.0, all.subspan(kFirstHarmonic, kHarmonicColumns));
  write_harmonics(phi_rad, away, all.subspan(kFirstHarmonic + kHarmonicColumns, kHarmonicColumns));
}

ResidualModel::Columns ResidualModel::columns_of(const Order& order) const noexcept {
  Columns columns;
  const auto take = [&](std::size_t first, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      columns.index[columns.count++] = first + i;
    }
  };
  take(0, static_cast<std::size_t>(num_parameters(fitted_[0].surface.kind)));
  if (order.oval) {
    take(kMaxSurfaceParameters, kOvalColumns);
  }
  if (order.constant >= 0) {
    take(kFirstHarmonic, static_cast<std::size_t>(2 * order.constant + 1));
  }
  if (order.linear >= 0) {
    take(kFirstHarmonic + kHarmonicColumns, static_cast<std::size_t>(2 * order.linear + 1));
  }
  return columns;
}

void ResidualModel::accumulate(std::span<const Patch> patches) noexcept {
  std::fill(normal_.begin(), normal_.end(), 0.0);
  fitted_[0].right = {};
  fitted_[0].squares = 0.0;
  Row row;
  for (const Patch& patch : patches) {
    row_at(patch.mean, patch.phi_rad, patch.away, row);
    fitted_[0].squares += patch.weight * patch.distance_mm * patch.distance_mm;
    for (std::size_t i = 0; i < kColumns; ++i) {
      const double scaled = patch.weight * row[i];
      fitted_[0].right[i] += scaled * patch.distance_mm;
      for (std::size_t k = 0; k <= i; ++k) {
        normal_[i * kColumns + k] += scaled * row[k];
      }
    }
  }
}

bool ResidualModel::solve(const Columns& columns, Row& solution) noexcept {
  LentSymmetric factor(factor_, columns.count);
  Row right{};
  for (std::size_t i = 0; i < columns.count; ++i) {
    right[i] = fitted_[0].right[columns.index[i]];
    for (std::size_t k = 0; k <= i; ++k) {
      factor.at(i, k) = normal_[columns.index[i] * kColumns + columns.index[k]];
    }
    factor.at(i, i) = factor.at(i, i) * (1.0 + kRidge) + 1e-12;
    factor.at(i, i) += columns.index[i] < kMaxSurfaceParameters ? 0.0 : fitted_[0].damping;
  }
  if (!factor.factorise()) {
    return false;
  }
  factor.solve(right);
  solution = {};
  for (std::size_t i = 0; i < columns.count; ++i) {
    solution[columns.index[i]] = right[i];
  }
  return true;
}

// What a solution leaves of the patches' squares, from the sums alone.
double ResidualModel::squares(const Columns& columns, const Row& solution) const noexcept {
  double sum = fitted_[0].squares;
  for (std::size_t i = 0; i < columns.count; ++i) {
    const std::size_t a = columns.index[i];
    double product = -2.0 * fitted_[0].right[a];
    for (std::size_t k = 0; k < columns.count; ++k) {
      const std::size_t b = columns.index[k];
      product += solution[b] * normal_[std::max(a, b) * kColumns + std::min(a, b)];
    }
    sum += solution[a] * product;
  }
  return std::max(0.0, sum);
}

Surface ResidualModel::move_into(const Surface& surface) noexcept {
  SurfaceVector step;
  std::copy_n(fitted_[0].solution.begin(), kMaxSurfaceParameters, step.data());
  if (!(step.cwiseAbs().maxCoeff() < kMaxMove)) {
    return surface;
  }
  fitted_[0].surface = stepped(surface, -step);
  std::fill_n(fitted_[0].solution.begin(), kMaxSurfaceParameters, 0.0);
  return fitted_[0].surface;
}

// From the rests of a moderate order, which follows most parts but not their noise.
ResidualModel::InOne ResidualModel::patches_in_one(std::span<const Patch> patches,
                                                   const PatchGrid& grid) noexcept {
  std::array<float, kMaxPatches> rests;
  Columns columns = columns_of({true, 2, 1});
  if (patches.size() < 2 * columns.count) {
    columns = columns_of({});
  }
  Row solution;
  if (!solve(columns, solution)) {
    return {};
  }
  Row row;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    row_at(patches[i].mean, patches[i].phi_rad, patches[i].away, row);
    rests[i] = static_cast<float>(patches[i].distance_mm - dot(row, solution));
  }
  const auto of = [&](Neighbours neighbours) {
    return seam::patches_in_one(patches, std::span(rests).first(patches.size()), grid,
                                columns.count, neighbours);
  };
  return {of(Neighbours::kRound), of(Neighbours::kAllAround)};
}

bool ResidualModel::fit(std::span<const Patch> patches, const PatchGrid& grid) noexcept {
  constexpr std::array<Order, 9> kOrders = {{{false, -1, -1},
                                             {true, -1, -1},
                                             {false, 2, -1},
                                             {false, 2, 1},
                                             {true, 2, 1},
                                             {false, 4, -1},
                                             {false, 4, 2},
                                             {true, 4, 4},
                                             {true, 6, 4}}};
  accumulate(patches);
  Fitted& f = fitted_[0];
  f.valid = false;
  f.damping = 0.0;
  const auto [in_one, in_one_of_errors] = patches_in_one(patches, grid);
  const double n = static_cast<double>(patches.size()) / in_one;
  double best = 1e300;
  for (const Order& order : kOrders) {
    const Columns columns = columns_of(order);
    const double p = static_cast<double>(columns.count);
    Row solution;
    const bool simplest = &order == &kOrders.front();
    const bool enough = simplest ? in_one * n >= 2.0 * p + 4.0 : n >= 1.5 * p + 4.0;
    if (!enough || !solve(columns, solution)) {
      continue;
    }
    const double rest = squares(columns, solution) / in_one + 1e-12;
    const double free = std::max(1.0, n - p - 2.0);
    const double criterion = n * std::log(rest / n) + p * std::log(n) * n / free;
    if (simplest) {
      f.damping = in_one * rest / n / (kExpectedMm * kExpectedMm);
    }
    if (criterion < best) {
      best = criterion;
      f.valid = true;
      f.columns = columns;
      f.harmonics = std::max(order.constant, order.oval ? 3 : -1);
      f.variance_mm2 = variance_of(in_one * rest, in_one * n, p, in_one_of_errors);
    }
  }
  return f.valid && solve(f.columns, f.solution);
}

double ResidualModel::at(const Eigen::Vector3d& p, double phi_rad, double away) const noexcept {
  if (!fitted_[0].valid) {
    return 0.0;
  }
  if (fitted_[0].harmonics < 0) {  // The model alone, by far the most frequent case.
    const SurfaceVector j = distance_jacobian(fitted_[0].surface, p);
    double sum = 0.0;
    for (std::size_t i = 0; i < kMaxSurfaceParameters; ++i) {
      sum += j[static_cast<Eigen::Index>(i)] * fitted_[0].solution[i];
    }
    return sum;
  }
  Row row;
  row_at(p, phi_rad, away, row);
  return dot(row, fitted_[0].solution);
}

ResidualModel::Row ResidualModel::errors_at(const Eigen::Vector3d& p, double phi_rad,
                                            double away) const noexcept {
  Row errors{};
  if (!fitted_[0].valid) {
    return errors;
  }
  Row row;
  row_at(p, phi_rad, away, row);
  const double sigma_mm = std::sqrt(fitted_[0].variance_mm2);
  const std::size_t count = fitted_[0].columns.count;
  for (std::size_t i = 0; i < count; ++i) {
    errors[i] = sigma_mm * row[fitted_[0].columns.index[i]];
  }
  LentSymmetric(factor_, count).forward(std::span<double>(errors).first(count));
  return errors;
}

double ResidualModel::variance_at(const Eigen::Vector3d& p, double phi_rad,
                                  double away) const noexcept {
  const Row errors = errors_at(p, phi_rad, away);
  return dot(errors, errors);
}

}  // namespace dseam::seam
