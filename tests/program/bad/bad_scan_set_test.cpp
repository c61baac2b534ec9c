// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <ostream>
#include <vector>

#include "dseam/base/random.hpp"
#include "dseam/hal/replay/png.hpp"
#include "program/support/run_program.hpp"

namespace dseam::program {
namespace {

using test::Outcome;
using test::run_program;

/// A small scan set as `dseam record` writes it, once for all tests.
const std::string& good_set() {
  static const test::ScratchFolder kScratch;
  static const std::string kSet = [] {
    const Outcome outcome =
        run_program({"record", "--camera", "sim", "--set", "cell.width=216", "--set",
                     "cell.height=161", "--set", "cell.views=2", "--out", kScratch.path("set")});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    return kScratch.path("set");
  }();
  return kSet;
}

void cut(const std::string& file, std::uintmax_t bytes) {
  std::filesystem::resize_file(file, bytes);
}

void edit(const std::string& set, const std::function<void(nlohmann::json&)>& change) {
  const std::string file = set + "/scene_camera.json";
  std::ifstream in(file);
  auto json = nlohmann::json::parse(in);
  change(json);
  std::ofstream(file) << json.dump();
}

/// One way to spoil a scan set, and what the program's line must name.
struct BadSet {
  const char* name;
  void (*spoil)(const std::string& set);
  const char* file;
};

void PrintTo(const BadSet& bad, std::ostream* out) { *out << bad.name; }

class BadScanSetTest : public ::testing::TestWithParam<BadSet> {
 protected:
  test::ScratchFolder scratch_;
};

TEST_P(BadScanSetTest, is_named_in_one_line_and_leaves_nothing) {
  const std::string set = scratch_.path("set");
  std::filesystem::copy(good_set(), set, std::filesystem::copy_options::recursive);
  GetParam().spoil(set);

  const Outcome outcome =
      run_program({"weld", "--camera", "replay:" + set, "--out", scratch_.path("out")});

  EXPECT_EQ(outcome.exit_code, 3) << outcome.text;
  EXPECT_NE(outcome.text.find(GetParam().file), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find("dseam: "), std::string::npos) << outcome.text;
  EXPECT_EQ(scratch_.names_in("out"), std::set<std::string>{});
}

INSTANTIATE_TEST_SUITE_P(
    Sets, BadScanSetTest,
    ::testing::Values(
        BadSet{"no_json",
               [](const std::string& s) { std::filesystem::remove(s + "/scene_camera.json"); },
               "scene_camera.json"},
        BadSet{"truncated_json", [](const std::string& s) { cut(s + "/scene_camera.json", 100); },
               "scene_camera.json"},
        BadSet{"no_depth",
               [](const std::string& s) { std::filesystem::remove(s + "/depth/000001.png"); },
               "000001.png"},
        BadSet{"truncated_depth", [](const std::string& s) { cut(s + "/depth/000001.png", 300); },
               "000001.png"},
        BadSet{"empty_depth", [](const std::string& s) { cut(s + "/depth/000000.png", 0); },
               "000000.png"},
        BadSet{"gray_as_depth",
               [](const std::string& s) {
                 std::filesystem::copy_file(s + "/gray/000000.png", s + "/depth/000000.png",
                                            std::filesystem::copy_options::overwrite_existing);
               },
               "000000.png"},
        BadSet{"zero_cam_k",
               [](const std::string& s) {
                 edit(s, [](nlohmann::json& j) { j["0"]["cam_K"] = std::vector<double>(9, 0.0); });
               },
               "cam_K"},
        BadSet{"short_cam_k",
               [](const std::string& s) {
                 edit(s, [](nlohmann::json& j) { j["1"]["cam_K"].erase(8); });
               },
               "cam_K"},
        BadSet{"zero_depth_scale",
               [](const std::string& s) {
                 edit(s, [](nlohmann::json& j) { j["0"]["depth_scale"] = 0.0; });
               },
               "depth_scale"},
        BadSet{"no_rotation",
               [](const std::string& s) {
                 edit(s, [](nlohmann::json& j) { j["0"]["cam_R_w2c"][0] = 3.0; });
               },
               "cam_R_w2c"},
        BadSet{"word_as_number",
               [](const std::string& s) {
                 edit(s, [](nlohmann::json& j) { j["0"]["cam_t_w2c"][1] = "far"; });
               },
               "cam_t_w2c"}),
    [](const auto& bad) { return std::string(bad.param.name); });

/// What a camera gives that sees nothing, and so cannot say where the work is.
struct BlindView {
  const char* name;
  std::uint8_t shade;
  std::uint16_t (*depth)(Pcg32& random);
};

void PrintTo(const BlindView& view, std::ostream* out) { *out << view.name; }

class BlindCameraTest : public ::testing::TestWithParam<BlindView> {
 protected:
  void blind(const std::string& set) const {
    constexpr std::uint32_t kWidth = 216;
    constexpr std::uint32_t kHeight = 161;
    const std::vector<std::uint8_t> shades(kWidth * kHeight, GetParam().shade);
    std::vector<std::uint16_t> counts(kWidth * kHeight);
    Pcg32 random(1);
    std::ranges::generate(counts, [&] { return GetParam().depth(random); });
    for (const char* view : {"000000.png", "000001.png"}) {
      ASSERT_FALSE(hal::replay::write_png8(set + "/gray/" + view, kWidth, kHeight, shades));
      ASSERT_FALSE(hal::replay::write_png16(set + "/depth/" + view, kWidth, kHeight, counts));
    }
  }

  test::ScratchFolder scratch_;
};

TEST_P(BlindCameraTest, is_refused_with_a_reason_and_nothing_is_planned) {
  const std::string set = scratch_.path("set");
  std::filesystem::copy(good_set(), set, std::filesystem::copy_options::recursive);
  blind(set);

  const Outcome outcome =
      run_program({"weld", "--camera", "replay:" + set, "--out", scratch_.path("out")});

  EXPECT_EQ(outcome.exit_code, 4) << outcome.text;
  EXPECT_NE(outcome.text.find("refused: "), std::string::npos) << outcome.text;
  EXPECT_EQ(scratch_.names_in("out").count("path.csv"), 0U);
}

INSTANTIATE_TEST_SUITE_P(
    Views, BlindCameraTest,
    ::testing::Values(BlindView{"black", 0, [](Pcg32&) { return std::uint16_t{0}; }},
                      BlindView{"saturated", 255, [](Pcg32&) { return std::uint16_t{0}; }},
                      BlindView{"glare", 255,
                                [](Pcg32& random) {
                                  return static_cast<std::uint16_t>(random.below(65536));
                                }}),
    [](const auto& view) { return std::string(view.param.name); });

TEST(BadScanSet, gray_of_another_size_is_named) {
  const test::ScratchFolder scratch;
  const std::string set = scratch.path("set");
  std::filesystem::copy(good_set(), set, std::filesystem::copy_options::recursive);
  const Outcome other =
      run_program({"record", "--camera", "sim", "--set", "cell.width=108", "--set",
                   "cell.height=80", "--set", "cell.views=1", "--out", scratch.path("other")});
  ASSERT_EQ(other.exit_code, 0) << other.text;
  std::filesystem::copy_file(scratch.path("other") + "/gray/000000.png", set + "/gray/000000.png",
                             std::filesystem::copy_options::overwrite_existing);

  const Outcome outcome =
      run_program({"weld", "--camera", "replay:" + set, "--out", scratch.path("out")});

  EXPECT_EQ(outcome.exit_code, 3) << outcome.text;
  EXPECT_NE(outcome.text.find("000000.png"), std::string::npos) << outcome.text;
}

TEST(BadScanSet, a_folder_that_is_not_there_is_named) {
  const test::ScratchFolder scratch;

  const Outcome outcome = run_program(
      {"weld", "--camera", "replay:" + scratch.path("none"), "--out", scratch.path("out")});

  EXPECT_EQ(outcome.exit_code, 3) << outcome.text;
  EXPECT_NE(outcome.text.find(scratch.path("none")), std::string::npos) << outcome.text;
}

}  // namespace
}  // namespace dseam::program
