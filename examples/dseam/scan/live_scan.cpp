// SPDX-License-Identifier: Apache-2.0
#include "scan/live_scan.hpp"

#include <chrono>
#include <utility>

#include "dseam/hal/camera/paired_camera.hpp"
#include "failure.hpp"
#include "scan/pose/link_poses.hpp"
#include "scan/pose/taught_poses.hpp"
#ifdef DSEAM_HAS_ARAVIS
#include "dseam/hal/aravis/aravis_camera.hpp"
#endif
#ifdef DSEAM_HAS_V4L2
#include "dseam/hal/v4l2/v4l2_camera.hpp"
#include "dseam/hal/v4l2/v4l2_sys.hpp"
#endif

namespace dseam::program {
namespace {

using namespace std::chrono_literals;

template <typename Camera>
class LiveScan final : public ScanSource {
 public:
  LiveScan(std::unique_ptr<Camera> camera, std::unique_ptr<Camera> gray, std::string name,
           const LiveSettings& settings, const link::Sender::Config& link)
      : camera_(std::move(camera)),
        gray_(std::move(gray)),
        name_(std::move(name)),
        poses_(settings.poses) {
    num_views_ = settings.views;
    settle_ = std::chrono::duration<double>(settings.settle_s);
    if (!poses_.known() && !settings.pose_interface.empty()) {
      robot_.emplace(settings.pose_interface, link);
    }
    if (gray_ != nullptr) {
      constexpr std::int64_t kApartNs = 20'000'000;
      both_.emplace(*camera_, *gray_, kApartNs);
    }
  }

  hal::DepthCamera& camera() override {
    return both_ ? static_cast<hal::DepthCamera&>(*both_) : *camera_;
  }
  hal::RobotState* robot_state() override {
    if (robot_) {
      return &robot_->state();
    }
    return poses_.known() ? &poses_ : nullptr;
  }
  void await_report(std::int64_t stamp_ns) override {
    if (robot_) {
      robot_->await(stamp_ns);
    }
  }
  [[nodiscard]] std::size_t num_views() const override { return num_views_; }
  [[nodiscard]] std::string description() const override { return name_; }

  /// Takes frames all the time, so that none of the view before is left in the driver.
  void await_view() override {
    const auto until = std::chrono::steady_clock::now() + settle_;
    while (std::chrono::steady_clock::now() < until) {
      (void)camera().next(10ms);
    }
    poses_.advance();
  }

 private:
  std::unique_ptr<Camera> camera_;
  std::unique_ptr<Camera> gray_;
  std::optional<hal::PairedCamera> both_;
  std::string name_;
  TaughtPoses poses_;
  std::optional<ListeningToRobot> robot_;
  std::size_t num_views_ = 0;
  std::chrono::duration<double> settle_{0.0};
};

template <typename Camera>
std::unique_ptr<Camera> camera_of(Result<std::unique_ptr<Camera>> camera, const std::string& name,
                                  const std::string& problem) {
  if (!camera.ok()) {
    throw Failure(ExitCode::kDevice, name + ": " + problem);
  }
  return std::move(camera.value());
}

void check_pair(const hal::DepthCamera& camera, const hal::DepthCamera& gray,
                const std::string& name) {
  if (!hal::PairedCamera::check(camera, gray).ok()) {
    throw Failure(ExitCode::kDevice, name + ": its image is not of the size of the depth's");
  }
}

/// What the settings say of a camera that does not describe itself.
depth::DepthModel assumed_model(const LiveSettings& settings) {
  depth::DepthModel model;
  model.scale[2] = settings.mm_per_count;
  model.intrinsics.fx = settings.focal_px;
  model.intrinsics.fy = settings.focal_px;
  model.intrinsics.cx = 0.5 * (settings.width - 1.0);
  model.intrinsics.cy = 0.5 * (settings.height - 1.0);
  return model;
}

#ifdef DSEAM_HAS_ARAVIS
std::unique_ptr<hal::aravis::AravisCamera> open_genicam(const hal::aravis::AravisConfig& config) {
  std::string problem;
  return camera_of(hal::aravis::AravisCamera::open(config, problem), "aravis:" + config.id,
                   problem);
}

/// The depth camera; with a description of ours when it has none of its own.
hal::aravis::AravisConfig genicam_depth(const std::string& id, const LiveSettings& settings) {
  hal::aravis::AravisConfig config;
  config.id = id;
  config.gray_beside_depth = settings.gray_device == id;
  if (settings.mm_per_count > 0.0) {
    config.assumed_model = assumed_model(settings);
  }
  return config;
}

std::unique_ptr<ScanSource> open_aravis(const std::string& id, const LiveSettings& settings,
                                        const link::Sender::Config& link) {
  using hal::aravis::AravisCamera;
  auto camera = open_genicam(genicam_depth(id, settings));
  std::unique_ptr<AravisCamera> gray;
  if (!settings.gray_device.empty() && settings.gray_device != id) {
    hal::aravis::AravisConfig config;
    config.id = settings.gray_device;
    config.gray = true;
    gray = open_genicam(config);
    check_pair(*camera, *gray, "aravis:" + settings.gray_device);
  }
  return std::make_unique<LiveScan<AravisCamera>>(std::move(camera), std::move(gray),
                                                  "aravis:" + id, settings, link);
}
#endif

#ifdef DSEAM_HAS_V4L2
std::unique_ptr<hal::v4l2::V4l2Camera> open_node(const std::string& device, bool gray,
                                                 const LiveSettings& settings) {
  hal::v4l2::V4l2Config config;
  config.device = device;
  config.gray = gray;
  config.width = settings.width;
  config.height = settings.height;
  std::string code = gray ? "GREY" : settings.format;
  code.resize(4, ' ');
  config.fourcc = depth::fourcc(code[0], code[1], code[2], code[3]);
  config.model = assumed_model(settings);
  std::string problem;
  return camera_of(hal::v4l2::V4l2Camera::open(config, hal::v4l2::linux_v4l2_sys(), problem),
                   "v4l2:" + device, problem);
}

std::unique_ptr<ScanSource> open_v4l2(const std::string& device, const LiveSettings& settings,
                                      const link::Sender::Config& link) {
  using hal::v4l2::V4l2Camera;
  auto camera = open_node(device, false, settings);
  std::unique_ptr<V4l2Camera> gray;
  if (!settings.gray_device.empty()) {
    gray = open_node(settings.gray_device, true, settings);
    check_pair(*camera, *gray, "v4l2:" + settings.gray_device);
  }
  return std::make_unique<LiveScan<V4l2Camera>>(std::move(camera), std::move(gray),
                                                "v4l2:" + device, settings, link);
}
#endif

}  // namespace

std::unique_ptr<ScanSource> open_live_scan(const std::string& kind, const std::string& id,
                                           const LiveSettings& settings,
                                           const link::Sender::Config& link) {
#ifdef DSEAM_HAS_ARAVIS
  if (kind == "aravis") {
    return open_aravis(id, settings, link);
  }
#endif
#ifdef DSEAM_HAS_V4L2
  if (kind == "v4l2") {
    return open_v4l2(id, settings, link);
  }
#endif
  throw Failure(ExitCode::kUsage, kind + ":" + id + ": this backend was not built (" +
                                      std::to_string(settings.views) + " views asked for, link " +
                                      std::to_string(link.addressing.base_id) + ")");
}

std::vector<hal::CameraInfo> list_all_cameras() {
  std::vector<hal::CameraInfo> all;
  const auto add = [&all](const std::vector<hal::CameraInfo>& some) {
    all.insert(all.end(), some.begin(), some.end());
  };
#ifdef DSEAM_HAS_ARAVIS
  add(hal::aravis::list_cameras());
#endif
#ifdef DSEAM_HAS_V4L2
  add(hal::v4l2::list_cameras(hal::v4l2::linux_v4l2_sys()));
#endif
  return all;
}

}  // namespace dseam::program
