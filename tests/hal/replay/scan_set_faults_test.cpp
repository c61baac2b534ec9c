// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <iterator>

#include "dseam/hal/replay/png.hpp"
#include "dseam/hal/replay/scan_set.hpp"
#include "small_set.hpp"

namespace dseam::test {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void put(const fs::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << text;
}

void replace_in(const fs::path& file, const std::string& from, const std::string& to) {
  std::string text = text_of(file);
  const std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  put(file, text.replace(at, from.size(), to));
}

struct Case {
  const char* name;
  std::function<void(const fs::path& set)> spoil;
  const char* file;   ///< What the fault must name...
  const char* fault;  ///< ...and say.
};

const char kIndex[] = "scene_camera.json";

std::string index_with(const std::string& name, const std::string& value) {
  std::string text = R"({"0": {"cam_K": [40,0,7,0,40,5,0,0,1], "depth_scale": 0.1)";
  return text + ", \"" + name + "\": " + value + "}}";
}

std::vector<Case> image_cases() {
  return {{"no depth", [](const fs::path& s) { fs::remove(s / "depth/000001.png"); },
           "depth/000001.png", "is missing"},
          {"no gray", [](const fs::path& s) { fs::remove(s / "gray/000001.png"); },
           "gray/000001.png", "is missing"},
          {"cut depth", [](const fs::path& s) { fs::resize_file(s / "depth/000000.png", 90); },
           "depth/000000.png", "is damaged"},
          {"cut header", [](const fs::path& s) { fs::resize_file(s / "depth/000000.png", 12); },
           "depth/000000.png", "is not a PNG image"},
          {"empty depth", [](const fs::path& s) { fs::resize_file(s / "depth/000000.png", 0); },
           "depth/000000.png", "is not a PNG image"},
          {"gray for depth",
           [](const fs::path& s) {
             fs::copy_file(s / "gray/000000.png", s / "depth/000000.png",
                           fs::copy_options::overwrite_existing);
           },
           "depth/000000.png", "is not a gray image of 16 bits"},
          {"other size",
           [](const fs::path& s) {
             const std::vector<std::uint8_t> pixels(8 * 6);
             ASSERT_FALSE(hal::replay::write_png8(s / "gray/000001.png", 8, 6, pixels));
           },
           "gray/000001.png", "is 8 x 6 pixels, its depth image 16 x 12"}};
}

std::vector<Case> index_cases() {
  const auto index = [](std::string text) {
    return [text](const fs::path& s) { put(s / kIndex, text); };
  };
  return {
      {"no index", [](const fs::path& s) { fs::remove(s / kIndex); }, kIndex, "is missing"},
      {"cut index", [](const fs::path& s) { fs::resize_file(s / kIndex, 100); }, kIndex,
       "parse error"},
      {"no views", index("{}"), kIndex, "does not hold 1 to 1000 views"},
      {"no object", index("[1, 2]"), kIndex, "does not hold 1 to 1000 views"},
      {"odd key", index(R"({"first": {}})"), kIndex, "view \"first\" is not a number"},
      {"zero matrix",
       [](const fs::path& s) { replace_in(s / kIndex, "40.0,\n   0.0", "0.0,\n   0.0"); }, kIndex,
       "view 0: cam_K is not the matrix of a pinhole camera"},
      {"short matrix", index(index_with("cam_K", "[1, 2, 3]")), kIndex, "cam_K is not a list of 9"},
      {"text in matrix", index(index_with("cam_K", R"(["40",0,7,0,40,5,0,0,1])")), kIndex,
       "cam_K is not a finite number"},
      {"not a number", index(index_with("depth_scale", "NaN")), kIndex, "parse error"},
      {"infinite", index(index_with("cam_t_w2c", "[1e999, 0, 0]")), kIndex, "number overflow"},
      {"zero scale", index(index_with("depth_scale", "0")), kIndex,
       "depth_scale is missing or not"},
      {"no rotation", index(index_with("cam_R_w2c", "[2,0,0,0,1,0,0,0,1], \"cam_t_w2c\": [0,0,0]")),
       kIndex, "view 0: cam_R_w2c is not a rotation"},
      {"mirrored", index(index_with("cam_R_w2c", "[-1,0,0,0,1,0,0,0,1], \"cam_t_w2c\": [0,0,0]")),
       kIndex, "cam_R_w2c is not a rotation"},
      {"half a pose", index(index_with("cam_t_w2c", "[0,0,0]")), kIndex,
       "cam_R_w2c is not a list of 9"},
      {"scaled flange", index(index_with("T_base_flange", "[2,0,0,0,0,2,0,0,0,0,2,0,0,0,0,1]")),
       kIndex, "T_base_flange is not a rigid transform"},
      {"text stamp", index(index_with("stamp_ns", "\"now\"")), kIndex,
       "stamp_ns is not a whole number"}};
}

void expect_each_named(const std::vector<Case>& cases) {
  for (const Case& bad : cases) {
    const ScratchFolder folder("scan_set_faults");
    ASSERT_TRUE(write_set(small_set(2), folder / "set"));
    bad.spoil(folder / "set");

    const auto read = hal::replay::read_scan_set(folder / "set");

    ASSERT_FALSE(read.ok()) << bad.name;
    EXPECT_NE(read.fault().find((folder / "set" / bad.file).string() + ": "), std::string::npos)
        << bad.name << ": " << read.fault();
    EXPECT_NE(read.fault().find(bad.fault), std::string::npos) << bad.name << ": " << read.fault();
    EXPECT_EQ(read.fault().find('\n'), std::string::npos) << bad.name;
  }
}

TEST(ScanSetFaults, each_bad_image_is_named_with_its_fault) { expect_each_named(image_cases()); }

TEST(ScanSetFaults, each_bad_index_is_named_with_its_fault) { expect_each_named(index_cases()); }

TEST(ScanSetFaults, a_set_that_is_not_there_or_is_a_file_is_named) {
  const ScratchFolder folder("scan_set_faults");
  put(folder / "file", "x");

  EXPECT_EQ(hal::replay::read_scan_set(folder / "none").fault(),
            (folder / "none").string() + ": is not a folder");
  EXPECT_EQ(hal::replay::read_scan_set(folder / "file").fault(),
            (folder / "file").string() + ": is not a folder");
}

TEST(ScanSetFaults, a_depth_image_cut_at_any_byte_is_refused) {
  const ScratchFolder folder("scan_set_faults");
  ASSERT_TRUE(write_set(small_set(1), folder / "set"));
  const std::string whole = text_of(folder / "set" / "depth/000000.png");
  const auto bytes = std::as_bytes(std::span(whole));
  ASSERT_TRUE(hal::replay::parse_png16(bytes).ok());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(hal::replay::parse_png16(bytes.first(size)).ok()) << size;
  }
}

TEST(ScanSetFaults, a_depth_image_with_any_flipped_bit_is_refused) {
  const ScratchFolder folder("scan_set_faults");
  ASSERT_TRUE(write_set(small_set(1), folder / "set"));
  std::string image = text_of(folder / "set" / "depth/000000.png");
  for (std::size_t bit = 0; bit < 8 * image.size(); ++bit) {
    const auto flip = static_cast<char>(1U << (bit % 8));
    image[bit / 8] = static_cast<char>(image[bit / 8] ^ flip);

    EXPECT_FALSE(hal::replay::parse_png16(std::as_bytes(std::span(image))).ok()) << bit;

    image[bit / 8] = static_cast<char>(image[bit / 8] ^ flip);
  }
}

}  // namespace
}  // namespace dseam::test
