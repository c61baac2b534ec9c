// SPDX-License-Identifier: Apache-2.0
#include "peers/sgm_peer.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

namespace dseam::bench {
namespace {

constexpr int kBlockPx = 5;
constexpr int kSmallStep = 8 * kBlockPx * kBlockPx;  // The library's own advice.
constexpr int kLargeStep = 32 * kBlockPx * kBlockPx;
constexpr int kLeftRightPx = 1;
constexpr int kUniquenessPercent = 10;
constexpr int kSpecklePx = 100;
constexpr int kSpeckleRange = 2;
constexpr int kPreFilterCap = 31;
constexpr float kPerCount = 1.0F / 16.0F;

cv::Mat image_over(std::span<const std::uint8_t> gray, std::uint32_t width) {
  const int rows = static_cast<int>(gray.size() / width);
  cv::Mat image(rows, static_cast<int>(width), CV_8U);
  std::copy(gray.begin(), gray.end(), image.data);
  return image;
}

}  // namespace

std::vector<float> match_semi_globally(std::span<const std::uint8_t> left,
                                       std::span<const std::uint8_t> right, std::uint32_t width,
                                       const SgmRange& range) {
  cv::setNumThreads(1);
  const auto matcher = cv::StereoSGBM::create(
      range.min_disparity_px, range.num_disparities, kBlockPx, kSmallStep, kLargeStep, kLeftRightPx,
      kPreFilterCap, kUniquenessPercent, kSpecklePx, kSpeckleRange, cv::StereoSGBM::MODE_SGBM);
  cv::Mat counts;
  matcher->compute(image_over(left, width), image_over(right, width), counts);
  std::vector<float> disparity;
  disparity.reserve(left.size());
  const auto low = static_cast<std::int16_t>(16 * range.min_disparity_px);
  for (int v = 0; v < counts.rows; ++v) {
    for (int u = 0; u < counts.cols; ++u) {
      const std::int16_t count = counts.at<std::int16_t>(v, u);
      disparity.push_back(count < low ? -1.0F : static_cast<float>(count) * kPerCount);
    }
  }
  return disparity;
}

}  // namespace dseam::bench
