// SPDX-License-Identifier: Apache-2.0
#include "pcl_peer.hpp"

#include <pcl/common/transforms.h>
#include <pcl/features/boundary.h>
#include <pcl/features/normal_3d.h>
#include <pcl/filters/crop_box.h>
#include <pcl/filters/passthrough.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>

#include <limits>

namespace dseam::bench {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Normals = pcl::PointCloud<pcl::Normal>;

struct PclPeer::State {
  Cloud::Ptr input{new Cloud};
  Cloud::Ptr cropped{new Cloud};
  Cloud::Ptr cleaned{new Cloud};
  Cloud::Ptr cells{new Cloud};
  Normals::Ptr normals{new Normals};
  pcl::PointCloud<pcl::Boundary> boundary;
  pcl::Indices kept;
  Cloud::Ptr current;
};

PclPeer::PclPeer(std::span<const float> x, std::span<const float> y, std::span<const float> z)
    : state_(std::make_unique<State>()) {
  for (std::size_t i = 0; i < x.size(); ++i) {
    state_->input->emplace_back(x[i], y[i], z[i]);
  }
  use_input();
}
PclPeer::~PclPeer() = default;

void PclPeer::use_input() { state_->current = state_->input; }
void PclPeer::use_cropped() { state_->current = state_->cropped; }
void PclPeer::use_cleaned() { state_->current = state_->cleaned; }
void PclPeer::use_cells() { state_->current = state_->cells; }

void PclPeer::passthrough(float low_z_mm, float high_z_mm) {
  pcl::PassThrough<pcl::PointXYZ> filter;
  filter.setInputCloud(state_->current);
  filter.setFilterFieldName("z");
  filter.setFilterLimits(low_z_mm, high_z_mm);
  filter.filter(*state_->cropped);
}

void PclPeer::remove_outliers(int num_neighbours, double alpha) {
  pcl::StatisticalOutlierRemoval<pcl::PointXYZ> filter;
  filter.setInputCloud(state_->current);
  filter.setMeanK(num_neighbours);
  filter.setStddevMulThresh(alpha);
  filter.filter(state_->kept);
  pcl::copyPointCloud(*state_->current, state_->kept, *state_->cleaned);
}

void PclPeer::downsample(float cell_mm) {
  pcl::VoxelGrid<pcl::PointXYZ> filter;
  filter.setInputCloud(state_->current);
  filter.setLeafSize(cell_mm, cell_mm, cell_mm);
  filter.filter(*state_->cells);
}

void PclPeer::estimate_normals(double radius_mm) {
  pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> stage;
  stage.setInputCloud(state_->current);
  stage.setSearchMethod(
      pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>(false)));
  stage.setRadiusSearch(radius_mm);
  stage.compute(*state_->normals);
}

void PclPeer::find_boundary(double radius_mm, float min_gap_rad) {
  pcl::BoundaryEstimation<pcl::PointXYZ, pcl::Normal, pcl::Boundary> stage;
  stage.setInputCloud(state_->current);
  stage.setInputNormals(state_->normals);
  stage.setSearchMethod(
      pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>(false)));
  stage.setRadiusSearch(radius_mm);
  stage.setAngleThreshold(min_gap_rad);
  stage.compute(state_->boundary);
}

std::vector<int> PclPeer::kept() const { return {state_->kept.begin(), state_->kept.end()}; }
std::size_t PclPeer::num_cells() const { return state_->cells->size(); }

std::vector<float> PclPeer::cells_xyz() const {
  std::vector<float> xyz;
  for (const auto& p : *state_->cells) {
    xyz.insert(xyz.end(), {p.x, p.y, p.z});
  }
  return xyz;
}

std::vector<float> PclPeer::normals_xyz() const {
  std::vector<float> xyz;
  for (const auto& n : *state_->normals) {
    xyz.insert(xyz.end(), {n.normal_x, n.normal_y, n.normal_z});
  }
  return xyz;
}

std::vector<std::uint8_t> PclPeer::boundary() const {
  std::vector<std::uint8_t> flags;
  for (const auto& b : state_->boundary) {
    flags.push_back(b.boundary_point);
  }
  return flags;
}

std::size_t PclPeer::fuse_frame(std::span<const std::uint16_t> counts, std::uint32_t width,
                                double f, double cx, double cy, float mm_per_count,
                                std::span<const float, 16> T_base_camera, float half_box_mm,
                                float cell_mm) {
  Cloud::Ptr camera(new Cloud);
  camera->reserve(counts.size());
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] != 0) {
      const float z = static_cast<float>(counts[i]) * mm_per_count;
      const auto u = static_cast<float>(i % width);
      const auto v = static_cast<float>(i / width);
      camera->emplace_back((u - static_cast<float>(cx)) * z / static_cast<float>(f),
                           (v - static_cast<float>(cy)) * z / static_cast<float>(f), z);
    }
  }
  const Eigen::Matrix4f transform =
      Eigen::Map<const Eigen::Matrix<float, 4, 4, Eigen::RowMajor>>(T_base_camera.data());
  Cloud::Ptr base(new Cloud);
  pcl::transformPointCloud(*camera, *base, transform);
  pcl::CropBox<pcl::PointXYZ> crop;
  crop.setInputCloud(base);
  crop.setMin({-half_box_mm, -half_box_mm, -half_box_mm, 1.0F});
  crop.setMax({half_box_mm, half_box_mm, half_box_mm, 1.0F});
  Cloud::Ptr inside(new Cloud);
  crop.filter(*inside);
  pcl::VoxelGrid<pcl::PointXYZ> grid;
  grid.setInputCloud(inside);
  grid.setLeafSize(cell_mm, cell_mm, cell_mm);
  Cloud cells;
  grid.filter(cells);
  return cells.size();
}

}  // namespace dseam::bench
