// SPDX-License-Identifier: Apache-2.0
#include "page/seam_picture.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "page/svg_chart.hpp"
#include "picture/point_picture.hpp"
#include "report/loop_profile.hpp"
#include "report/text.hpp"

namespace dseam::program {
namespace {

const std::vector<Rgb> kPalette{{124, 154, 184}, {222, 164, 98}, {178, 180, 182}};

constexpr double kHiddenMm = 3.0;

/// What the pictures show: the seam and its surroundings, or the whole cloud without one.
struct Subject {
  Eigen::Vector3d centre_base = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis_base = Eigen::Vector3d::UnitZ();  ///< Towards the nozzle's free end.
  double radius_mm = 100.0;
};

/// The middle of all points, and the distance within which nine in ten lie.
Subject subject_of_cloud(const cloud::CloudView& cloud_base) {
  Subject subject;
  std::vector<double> distances;
  for (std::size_t i = 0; i < cloud_base.size(); ++i) {
    subject.centre_base += Eigen::Vector3d(cloud_base.x[i], cloud_base.y[i], cloud_base.z[i]);
  }
  subject.centre_base /= std::max<double>(1.0, static_cast<double>(cloud_base.size()));
  for (std::size_t i = 0; i < cloud_base.size(); ++i) {
    distances.push_back(
        (Eigen::Vector3d(cloud_base.x[i], cloud_base.y[i], cloud_base.z[i]) - subject.centre_base)
            .norm());
  }
  if (!distances.empty()) {
    const auto ninth = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() * 9 / 10);
    std::nth_element(distances.begin(), ninth, distances.end());
    subject.radius_mm = std::max(1e-3, *ninth);
  }
  return subject;
}

Subject subject_of(const JobReport& job) {
  const std::span<const seam::SeamPoint> points = job.seam_base.points;
  if (points.empty()) {
    return subject_of_cloud(job.cloud_base.points);
  }
  Subject subject;
  Eigen::Vector3d outward = Eigen::Vector3d::Zero();
  for (const seam::SeamPoint& point : points) {
    subject.centre_base += point.p_base / static_cast<double>(points.size());
    outward += point.n_shell;
  }
  const Eigen::Vector3d axis = job.seam_report.joint.nozzle.axis;
  subject.axis_base = (axis.dot(outward) < 0.0 ? -axis : axis).normalized();
  subject.radius_mm = 0.0;
  for (const seam::SeamPoint& point : points) {
    subject.radius_mm = std::max(subject.radius_mm, (point.p_base - subject.centre_base).norm());
  }
  return subject;
}

/// From `elevation` above the plane across the axis and `azimuth` about it.
Viewpoint viewpoint(const Subject& subject, double azimuth_rad, double elevation_rad) {
  const seam::AcrossAxis frame = seam::across(subject.axis_base);
  const Eigen::Vector3d level = std::cos(azimuth_rad) * frame.u + std::sin(azimuth_rad) * frame.v;
  const Eigen::Vector3d direction =
      -std::sin(elevation_rad) * subject.axis_base - std::cos(elevation_rad) * level;
  const bool from_above = elevation_rad > 1.5;
  Viewpoint view = looking_along(direction, from_above ? frame.v : subject.axis_base);
  view.px_per_mm = 0.5 * view.height / (1.75 * subject.radius_mm);
  view.centre_base =
      subject.centre_base + (from_above ? 0.0 : 0.25) * subject.radius_mm * subject.axis_base;
  return view;
}

class Overlay {
 public:
  /// Lines that lie deeper than `hidden_mm` behind the cloud are drawn as hidden.
  Overlay(const PointPicture& picture, double hidden_mm)
      : picture_(picture), hidden_mm_(hidden_mm) {}

  /// Lines of one class are joined while class and visibility stay the same.
  void add(const Eigen::Vector3d& p_base, const std::string& css) {
    const bool hidden = picture_.hides(p_base, hidden_mm_);
    const std::string full = css + (hidden ? " hidden" : "");
    const Eigen::Vector3d p = picture_.viewpoint().project(p_base);
    const std::string place = fixed(p.x(), 1) + ' ' + fixed(p.y(), 1);
    if (full != css_) {
      if (!path_.empty()) {
        path_ += 'L' + place;
      }
      flush();
      css_ = full;
    }
    path_ += (path_.empty() ? 'M' : 'L') + place;
  }
  void lift() {
    flush();
    css_.clear();
  }
  void dot(const Eigen::Vector3d& p_base, const std::string& css) {
    const Eigen::Vector3d p = picture_.viewpoint().project(p_base);
    svg_ += "<circle class=\"" + css + "\" r=\"5\" cx=\"" + fixed(p.x(), 1) + "\" cy=\"" +
            fixed(p.y(), 1) + "\"/>";
  }
  [[nodiscard]] const std::string& svg() const { return svg_; }

 private:
  void flush() {
    if (!path_.empty()) {
      svg_ += "<path class=\"" + css_ + "\" d=\"" + path_ + "\"/>";
      path_.clear();
    }
  }

  const PointPicture& picture_;
  double hidden_mm_;
  std::string css_;
  std::string path_;
  std::string svg_;
};

void draw_path(trajectory::SetPointView path, Overlay& overlay) {
  const std::size_t stride = std::max<std::size_t>(1, path.size() / 1500);
  for (std::size_t i = 0; i < path.size(); i += stride) {
    if (!path[i].arc) {
      overlay.add(path[i].pose.p_base, "travel");
    } else {
      overlay.lift();
    }
  }
  overlay.lift();
}

void draw_seam(const seam::SeamView& seam_base, Overlay& overlay) {
  const auto css = [](const seam::SeamPoint& point) {
    return point.source == seam::Source::kMeasured ? "seam" : "seam bridged";
  };
  for (const seam::SeamPoint& point : seam_base.points) {
    overlay.add(point.p_base, css(point));
  }
  if (seam_base.closed && !seam_base.points.empty()) {
    overlay.add(seam_base.points.front().p_base, css(seam_base.points.front()));
  }
  overlay.lift();
  if (!seam_base.points.empty()) {
    overlay.dot(seam_base.points.front().p_base, "start");
  }
}

/// A bar of a round length in the lower left corner.
std::string scale_bar(double px_per_mm) {
  double length_mm = 1.0;
  for (const double candidate : {2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0}) {
    length_mm = candidate * px_per_mm < 130.0 ? candidate : length_mm;
  }
  return "<path class=\"scale\" d=\"M16 462h" + fixed(length_mm * px_per_mm, 1) +
         "\"/><text x=\"16\" y=\"454\">" + fixed(length_mm, 0) + " mm</text>";
}

std::string picture_svg(const JobReport& job, const Viewpoint& view,
                        const std::vector<std::uint8_t>& tint, double hidden_mm) {
  const double spacing = job.seam_report.spacing_mm > 0.0 ? job.seam_report.spacing_mm : 1.0;
  const PointPicture picture(view, job.cloud_base.points, tint, kPalette, 0.9 * spacing);
  Overlay overlay(picture, hidden_mm);
  draw_path(job.path, overlay);
  draw_seam(job.seam_base, overlay);
  return "<svg class=\"picture\" viewBox=\"0 0 640 480\" role=\"img\"><image width=\"640\" "
         "height=\"480\" href=\"" +
         png_data_uri(picture.image()) + "\"/>" + overlay.svg() + scale_bar(view.px_per_mm) +
         "</svg>";
}

}  // namespace

std::array<SeamPicture, 3> seam_pictures(const JobReport& job) {
  const Subject subject = subject_of(job);
  const std::vector<std::uint8_t> tint =
      job.seam_base.points.empty()
          ? std::vector<std::uint8_t>(job.cloud_base.points.size(), 2)
          : surface_of_points(job.cloud_base.points, job.seam_report.joint, 1.5);
  // Along the axis the nozzle's own rim would hide all of the seam: there it is drawn over it.
  return {SeamPicture{"Along the nozzle's axis",
                      picture_svg(job, viewpoint(subject, 0.0, 1.5707), tint, 1e9)},
          SeamPicture{"From one side",
                      picture_svg(job, viewpoint(subject, -0.9, 0.6), tint, kHiddenMm)},
          SeamPicture{"From the other side",
                      picture_svg(job, viewpoint(subject, 2.2, 0.6), tint, kHiddenMm)}};
}

}  // namespace dseam::program
