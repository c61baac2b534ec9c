// SPDX-License-Identifier: Apache-2.0
#include "scan3d.hpp"

#include <array>
#include <string_view>

#include "dseam/depth/frame_decoder.hpp"
#include "dseam/depth/sample_layout.hpp"

namespace dseam::hal::aravis {
namespace {

constexpr double kMmPerMetre = 1000.0;
constexpr double kMmPerInch = 25.4;

/// The optional numbers and names of a device.
class Features {
 public:
  explicit Features(ArvCamera* camera) : camera_(camera) {}

  [[nodiscard]] bool has(const char* name) const {
    GlibError error;
    const bool available = arv_camera_is_feature_available(camera_, name, error.out()) != FALSE;
    return available && !error;
  }
  [[nodiscard]] double number(const char* name, double otherwise) const {
    if (!has(name)) {
      return otherwise;
    }
    GlibError error;
    const double value = arv_camera_get_float(camera_, name, error.out());
    return error ? otherwise : value;
  }
  [[nodiscard]] std::string text(const char* name) const {
    if (!has(name)) {
      return {};
    }
    GlibError error;
    const char* value = arv_camera_get_string(camera_, name, error.out());
    return error || value == nullptr ? std::string() : value;
  }
  [[nodiscard]] bool flag(const char* name, bool otherwise) const {
    if (!has(name)) {
      return otherwise;
    }
    GlibError error;
    const bool value = arv_camera_get_boolean(camera_, name, error.out()) != FALSE;
    return error ? otherwise : value;
  }
  bool select(const char* selector, const char* entry) const {
    GlibError error;
    if (!has(selector)) {
      return false;
    }
    arv_camera_set_string(camera_, selector, entry, error.out());
    return !error;
  }
  /// The unit that the device's description gives a number, in mm.
  [[nodiscard]] double mm_per_unit_of(const char* name) const {
    ArvGcNode* node = arv_device_get_feature(arv_camera_get_device(camera_), name);
    const char* unit = ARV_IS_GC_FLOAT(node) ? arv_gc_float_get_unit(ARV_GC_FLOAT(node)) : nullptr;
    return unit != nullptr && std::string_view(unit) == "mm" ? 1.0 : kMmPerMetre;
  }

 private:
  ArvCamera* camera_;
};

depth::Geometry geometry_of(std::string_view mode, const depth::DepthModel& assumed) {
  if (mode.find("Disparity") != mode.npos) {
    return depth::Geometry::kDisparity;
  }
  if (mode.find("Linescan") != mode.npos) {
    return depth::Geometry::kLineScan;
  }
  if (mode.starts_with("Rectified")) {
    return depth::Geometry::kRectified;
  }
  if (mode.starts_with("Projected")) {
    return depth::Geometry::kProjected;
  }
  return mode.starts_with("Calibrated") ? depth::Geometry::kCalibrated : assumed.geometry;
}

double unit_of(std::string_view name, double otherwise) {
  if (name == "Millimeter") {
    return 1.0;
  }
  if (name == "Meter") {
    return kMmPerMetre;
  }
  return name == "Inch" ? kMmPerInch : otherwise;
}

void read_axes(const Features& device, depth::DepthModel& model) {
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

void read_optics(const Features& device, depth::DepthModel& model) {
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

Result<> read_size(ArvCamera* camera, depth::DepthModel& model, std::string& problem) {
  GlibError error;
  gint width = 0;
  gint height = 0;
  arv_camera_get_region(camera, nullptr, nullptr, &width, &height, error.out());
  if (error) {
    problem = "the camera did not tell its image size: " + error.text();
    return Errc::kIo;
  }
  model.intrinsics.width = static_cast<std::uint32_t>(width);
  model.intrinsics.height = static_cast<std::uint32_t>(height);
  return {};
}

Result<> read_image(ArvCamera* camera, depth::DepthModel& model, std::string& problem) {
  if (const auto size = read_size(camera, model, problem); !size.ok()) {
    return size;
  }
  GlibError error;
  const ArvPixelFormat code = arv_camera_get_pixel_format(camera, error.out());
  const auto format = depth::format_from_pfnc(code);
  if (error || !format.ok()) {
    const char* name = arv_camera_get_pixel_format_as_string(camera, error.out());
    problem = "its pixel format " + std::string(name == nullptr ? "?" : name) +
              " is no depth format; ask for one with camera.pixel_format, such as Coord3D_C16";
    return Errc::kUnsupported;
  }
  model.format = format.value();
  return {};
}

}  // namespace

Result<depth::DepthModel> read_depth_model(ArvCamera* camera,
                                           const std::optional<depth::DepthModel>& assumed,
                                           std::string& problem) {
  depth::DepthModel model = assumed.value_or(depth::DepthModel{});
  if (const auto image = read_image(camera, model, problem); !image.ok()) {
    return image.error();
  }
  const Features device(camera);
  if (!device.has("Scan3dCoordinateScale") && !assumed.has_value()) {
    problem =
        "it does not describe its 3D data (no Scan3d features); give scale, unit and focal "
        "length in the configuration";
    return Errc::kUnsupported;
  }
  model.geometry = geometry_of(device.text("Scan3dOutputMode"), model);
  model.mm_per_unit = unit_of(device.text("Scan3dDistanceUnit"), model.mm_per_unit);
  read_axes(device, model);
  read_optics(device, model);
  if (!depth::FrameDecoder::make(model).ok()) {
    problem =
        "its 3D description is incomplete or contradicts itself (scale, focal length, "
        "baseline, output mode); give what is missing in the configuration";
    return Errc::kUnsupported;
  }
  return model;
}

Result<depth::DepthModel> read_gray_model(ArvCamera* camera, std::string& problem) {
  depth::DepthModel model;
  if (const auto size = read_size(camera, model, problem); !size.ok()) {
    return size.error();
  }
  GlibError error;
  if (arv_camera_get_pixel_format(camera, error.out()) != ARV_PIXEL_FORMAT_MONO_8 || error) {
    problem = "its image is not gray with one byte a pixel; ask for Mono8";
    return Errc::kUnsupported;
  }
  model.has_gray = true;
  return model;
}

}  // namespace dseam::hal::aravis
