// SPDX-License-Identifier: Apache-2.0
#include "scan/live_scan.hpp"

#include <utility>

#include "failure.hpp"
#ifdef DSEAM_HAS_ARAVIS
#include "dseam/hal/aravis/aravis_camera.hpp"
#endif
#ifdef DSEAM_HAS_V4L2
#include "dseam/hal/v4l2/v4l2_camera.hpp"
#include "dseam/hal/v4l2/v4l2_sys.hpp"
#endif

namespace dseam::program {
namespace {

template <typename Camera>
class LiveScan final : public ScanSource {
 public:
  LiveScan(std::unique_ptr<Camera> camera, std::string name, std::size_t num_views)
      : camera_(std::move(camera)), name_(std::move(name)), num_views_(num_views) {}

  hal::DepthCamera& camera() override { return *camera_; }
  hal::RobotState* robot_state() override { return nullptr; }
  [[nodiscard]] std::size_t num_views() const override { return num_views_; }
  [[nodiscard]] std::string description() const override { return name_; }

 private:
  std::unique_ptr<Camera> camera_;
  std::string name_;
  std::size_t num_views_;
};

template <typename Camera>
std::unique_ptr<ScanSource> scan_of(Result<std::unique_ptr<Camera>> camera, const std::string& name,
                                    const std::string& problem, std::size_t num_views) {
  if (!camera.ok()) {
    throw Failure(ExitCode::kDevice, name + ": " + problem);
  }
  return std::make_unique<LiveScan<Camera>>(std::move(camera.value()), name, num_views);
}

}  // namespace

std::unique_ptr<ScanSource> open_live_scan(const std::string& kind, const std::string& id,
                                           std::size_t num_views) {
  [[maybe_unused]] std::string problem;
  const std::string name = kind + ":" + id;
#ifdef DSEAM_HAS_ARAVIS
  if (kind == "aravis") {
    hal::aravis::AravisConfig config;
    config.id = id;
    auto camera = hal::aravis::AravisCamera::open(config, problem);
    return scan_of(std::move(camera), name, problem, num_views);
  }
#endif
#ifdef DSEAM_HAS_V4L2
  if (kind == "v4l2") {
    hal::v4l2::V4l2Config config;
    config.device = id;
    auto camera = hal::v4l2::V4l2Camera::open(config, hal::v4l2::linux_v4l2_sys(), problem);
    return scan_of(std::move(camera), name, problem, num_views);
  }
#endif
  throw Failure(ExitCode::kUsage, name + ": this backend was not built (" +
                                      std::to_string(num_views) + " views asked for)");
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
