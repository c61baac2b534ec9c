// SPDX-License-Identifier: Apache-2.0
#include "device/scan3d.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "device/glib_ptr.hpp"
#include "dseam/depth/frame_decoder.hpp"
#include "dseam/depth/sample_layout.hpp"

namespace dseam::hal::aravis {
namespace {

constexpr double kMmPerMetre = 1000.0;
constexpr double kMmPerInch = 25.4;

/// What a device says of itself. What it does not have is left as it was; once a question was left
/// without an answer, nothing that was said may be used.
class Features {
 public:
  Features(ArvCamera* camera, AravisSys& sys) : camera_(camera), sys_(sys) {}

  [[nodiscard]] bool has(const char* name) {
    return answered(name, sys_.has(camera_, name, error_.out()), false);
  }
  /// Also of a feature that the device describes as an integer.
  [[nodiscard]] double number(const char* name, double otherwise) {
    if (!has(name)) {
      return otherwise;
    }
    const double value = sys_.number(camera_, name, error_.out());
    return error_.is(ARV_DEVICE_ERROR_WRONG_FEATURE) ? static_cast<double>(integer(name))
                                                     : answered(name, value, otherwise);
  }
  [[nodiscard]] std::int64_t integer(const char* name) {
    return answered(name, sys_.integer(camera_, name, error_.out()), std::int64_t{0});
  }
  [[nodiscard]] std::string text(const char* name) {
    if (!has(name)) {
      return {};
    }
    const char* value = sys_.text(camera_, name, error_.out());
    return answered(name, std::string(value == nullptr ? "" : value), std::string());
  }
  [[nodiscard]] bool flag(const char* name, bool otherwise) {
    return has(name) ? answered(name, sys_.flag(camera_, name, error_.out()), otherwise)
                     : otherwise;
  }
  /// False: the selector has no such entry.
  bool select(const char* selector, const char* entry) {
    sys_.set_text(camera_, selector, entry, error_.out());
    const bool selected = !error_;
    if (error_.is_of_device()) {
      (void)answered(selector, false, false);
    }
    return selected;
  }
  /// The unit that the device's description gives a number, in mm.
  [[nodiscard]] double mm_per_unit_of(const char* name) const {
    ArvGcNode* node = arv_device_get_feature(arv_camera_get_device(camera_), name);
    const char* unit = ARV_IS_GC_FLOAT(node) ? arv_gc_float_get_unit(ARV_GC_FLOAT(node)) : nullptr;
    return unit != nullptr && std::string_view(unit) == "mm" ? 1.0 : kMmPerMetre;
  }
  /// What was asked for first without an answer, and why there was none; empty for nothing.
  [[nodiscard]] const std::string& unanswered() const { return unanswered_; }

 private:
  template <typename T>
  T answered(const char* name, T value, T otherwise) {
    if (error_ && unanswered_.empty()) {
      unanswered_ = std::string(name) + " (" + error_.text() + ")";
    }
    return error_ ? otherwise : value;
  }

  ArvCamera* camera_;
  AravisSys& sys_;
  GlibError error_;
  std::string unanswered_;
};

double unit_of(std::string_view name, double otherwise) {
  if (name == "Millimeter") {
    return 1.0;
  }
  if (name == "Meter") {
    return kMmPerMetre;
  }
  return name == "Inch" ? kMmPerInch : otherwise;
}

struct OutputMode {
  std::string_view name;
  depth::Geometry geometry;
};

/// The output modes from which a point's place follows. Not among them: the uncalibrated one, which
/// has no unit, and those that give z without saying where.
constexpr std::array<OutputMode, 7> kOutputModes{{
    {"ProjectedC", depth::Geometry::kProjected},
    {"CalibratedABC_Grid", depth::Geometry::kCalibrated},
    {"CalibratedABC_PointCloud", depth::Geometry::kCalibrated},
    {"CalibratedAC_Linescan", depth::Geometry::kLineScan},
    {"RectifiedC", depth::Geometry::kRectified},
    {"RectifiedC_Linescan", depth::Geometry::kLineScan},
    {"DisparityC", depth::Geometry::kDisparity},
}};

/// False: the mode is named and not one of these, and nothing is assumed instead.
bool read_geometry(Features& device, bool assumed, depth::DepthModel& model, std::string& problem) {
  const std::string mode = device.text("Scan3dOutputMode");
  const auto* known = std::ranges::find(kOutputModes, std::string_view(mode), &OutputMode::name);
  if (known != kOutputModes.end()) {
    model.geometry = known->geometry;
  }
  const std::string unit = device.text("Scan3dDistanceUnit");
  model.mm_per_unit = unit_of(unit, model.mm_per_unit);
  const bool pixels = unit == "Pixel" && model.geometry != depth::Geometry::kDisparity;
  const bool placed = mode.empty() || known != kOutputModes.end();
  if (!assumed && (!placed || pixels)) {
    problem = "its output mode " + mode + " in units of " + unit +
              " does not say where points lie; set another Scan3dOutputMode or Scan3dDistanceUnit";
    return false;
  }
  return true;
}

void read_axes(Features& device, depth::DepthModel& model) {
  constexpr std::array<const char*, 3> kAxes{"CoordinateA", "CoordinateB", "CoordinateC"};
  const bool selectable = device.has("Scan3dCoordinateSelector");
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
    if (selectable && !device.select("Scan3dCoordinateSelector", kAxes[axis])) {
      continue;  // The device has no such axis.
    }
    model.scale[axis] = device.number("Scan3dCoordinateScale", model.scale[axis]);
    model.offset[axis] = device.number("Scan3dCoordinateOffset", model.offset[axis]);
  }
  // The selector now stands on C, whose invalid value is the one of the whole point.
  model.has_invalid_value = device.flag("Scan3dInvalidDataFlag", model.has_invalid_value);
  model.invalid_value = device.number("Scan3dInvalidDataValue", model.invalid_value);
}

void read_optics(Features& device, depth::DepthModel& model) {
  depth::Intrinsics& k = model.intrinsics;
  k.fx = device.number("Scan3dFocalLength", k.fx);
  k.fy = device.has("Scan3dFocalLength") ? k.fx * device.number("Scan3dAspectRatio", 1.0) : k.fy;
  k.cx = device.number("Scan3dPrincipalPointU", k.cx);
  k.cy = device.number("Scan3dPrincipalPointV", k.cy);
  if (device.has("Scan3dBaseline")) {
    model.baseline_mm =
        device.number("Scan3dBaseline", 0.0) * device.mm_per_unit_of("Scan3dBaseline");
  }
}

Errc not_answered(const Features& device, std::string& problem) {
  problem = "the camera did not tell its " + device.unanswered() + "; check its cable";
  return Errc::kIo;
}

void read_size(Features& device, depth::DepthModel& model) {
  model.intrinsics.width = static_cast<std::uint32_t>(device.integer("Width"));
  model.intrinsics.height = static_cast<std::uint32_t>(device.integer("Height"));
}

Result<> read_image(Features& device, depth::DepthModel& model, std::string& problem) {
  read_size(device, model);
  const auto code = static_cast<std::uint32_t>(device.integer("PixelFormat"));
  const auto format = depth::format_from_pfnc(code);
  if (device.unanswered().empty() && !format.ok()) {
    problem = "its pixel format " + device.text("PixelFormat") +
              " is no depth format; set its PixelFormat to one, such as Coord3D_C16";
    return Errc::kUnsupported;
  }
  if (!device.unanswered().empty()) {
    return not_answered(device, problem);
  }
  model.format = format.value();
  if (device.has("LinePitch")) {
    model.row_stride_bytes = static_cast<std::uint32_t>(device.integer("LinePitch"));
  }
  return {};
}

}  // namespace

Result<depth::DepthModel> read_depth_model(ArvCamera* camera, AravisSys& sys,
                                           const std::optional<depth::DepthModel>& assumed,
                                           std::string& problem) {
  depth::DepthModel model = assumed.value_or(depth::DepthModel{});
  Features device(camera, sys);
  if (const auto image = read_image(device, model, problem); !image.ok()) {
    return image.error();
  }
  const bool described = device.has("Scan3dCoordinateScale");
  const bool placed = read_geometry(device, assumed.has_value(), model, problem);
  read_axes(device, model);
  read_optics(device, model);
  if (!device.unanswered().empty()) {
    return not_answered(device, problem);
  }
  if (!described && !assumed.has_value()) {
    problem =
        "it does not describe its 3D data (no Scan3d features); give camera.mm_per_count, "
        "camera.focal_px, camera.width and camera.height";
    return Errc::kUnsupported;
  }
  if (!placed) {
    return Errc::kUnsupported;
  }
  if (!depth::FrameDecoder::make(model).ok()) {
    problem =
        "its 3D description is incomplete or contradicts itself (scale, focal length, "
        "baseline, output mode); give what is missing: camera.mm_per_count, camera.focal_px";
    return Errc::kUnsupported;
  }
  return model;
}

Result<depth::DepthModel> read_gray_model(ArvCamera* camera, AravisSys& sys, std::string& problem) {
  depth::DepthModel model;
  Features device(camera, sys);
  read_size(device, model);
  const bool is_mono8 = device.integer("PixelFormat") == ARV_PIXEL_FORMAT_MONO_8;
  if (!device.unanswered().empty()) {
    return not_answered(device, problem);
  }
  if (!is_mono8) {
    problem = "its image is not gray with one byte a pixel; ask for Mono8";
    return Errc::kUnsupported;
  }
  return model;
}

}  // namespace dseam::hal::aravis
