// SPDX-License-Identifier: Apache-2.0
#include "peers/pcl_registration.hpp"

#include <pcl/features/normal_3d.h>
#include <pcl/point_types.h>
#include <pcl/registration/gicp.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/ndt.h>
#include <pcl/search/kdtree.h>

#include <ctime>

namespace dseam::bench {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using CloudWithNormals = pcl::PointCloud<pcl::PointNormal>;

constexpr double kMaxPairMm = 10.0;
constexpr int kMaxIterations = 100;

// Of this process: others on the machine do not count.
double now_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

Cloud::Ptr cloud_of(const cloud::CloudView& in) {
  Cloud::Ptr out(new Cloud);
  for (std::size_t i = 0; i < in.size(); ++i) {
    out->emplace_back(in.x[i], in.y[i], in.z[i]);
  }
  return out;
}

CloudWithNormals::Ptr with_normals(const Cloud::Ptr& in) {
  pcl::NormalEstimation<pcl::PointXYZ, pcl::PointNormal> estimation;
  estimation.setInputCloud(in);
  estimation.setRadiusSearch(7.5);
  CloudWithNormals::Ptr out(new CloudWithNormals);
  estimation.compute(*out);
  for (std::size_t i = 0; i < in->size(); ++i) {
    (*out)[i].getVector3fMap() = (*in)[i].getVector3fMap();
  }
  return out;
}

Eigen::Matrix4f matrix_of(const geometry::RigidTransform& T) {
  Eigen::Matrix4f m = Eigen::Matrix4f::Identity();
  m.topLeftCorner<3, 3>() = T.rotation.cast<float>();
  m.topRightCorner<3, 1>() = T.translation_mm.cast<float>();
  return m;
}

template <typename Method, typename Point>
Registration run(const char* name, Method& method,
                 const typename pcl::PointCloud<Point>::Ptr& source,
                 const typename pcl::PointCloud<Point>::Ptr& target,
                 const geometry::RigidTransform& start) {
  method.setMaximumIterations(kMaxIterations);
  method.setInputSource(source);
  method.setInputTarget(target);
  pcl::PointCloud<Point> aligned;
  const double begun = now_ms();
  method.align(aligned, matrix_of(start));
  const double ms = now_ms() - begun;
  const Eigen::Matrix4d m = method.getFinalTransformation().template cast<double>();
  return {name, {m.topLeftCorner<3, 3>(), m.topRightCorner<3, 1>()}, method.hasConverged(), ms};
}

}  // namespace

std::vector<Registration> register_with_pcl(const cloud::CloudView& source,
                                            const cloud::CloudView& target,
                                            const geometry::RigidTransform& start) {
  const Cloud::Ptr a = cloud_of(source);
  const Cloud::Ptr b = cloud_of(target);
  std::vector<Registration> results;
  pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
  icp.setMaxCorrespondenceDistance(kMaxPairMm);
  results.push_back(run<decltype(icp), pcl::PointXYZ>("PCL ICP", icp, a, b, start));
  pcl::GeneralizedIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> gicp;
  gicp.setMaxCorrespondenceDistance(kMaxPairMm);
  results.push_back(run<decltype(gicp), pcl::PointXYZ>("PCL GICP", gicp, a, b, start));
  pcl::IterativeClosestPointWithNormals<pcl::PointNormal, pcl::PointNormal> plane;
  plane.setMaxCorrespondenceDistance(kMaxPairMm);
  results.push_back(run<decltype(plane), pcl::PointNormal>(
      "PCL point to plane", plane, with_normals(a), with_normals(b), start));
  pcl::NormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ> ndt;
  ndt.setResolution(20.0F);
  ndt.setStepSize(1.0);
  ndt.setTransformationEpsilon(1e-4);
  results.push_back(run<decltype(ndt), pcl::PointXYZ>("PCL NDT", ndt, a, b, start));
  return results;
}

}  // namespace dseam::bench
