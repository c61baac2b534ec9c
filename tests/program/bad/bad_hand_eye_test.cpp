// SPDX-License-Identifier: Apache-2.0
// A calibration that went wrong on its way: it is refused by name, and nothing moves.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <span>

#include "dseam/link/crc.hpp"
#include "failure.hpp"
#include "files/hand_eye_file.hpp"
#include "program/support/run_program.hpp"

namespace dseam::program {
namespace {

using nlohmann::json;

calibration::HandEye calibrated() {
  calibration::HandEye hand_eye;
  hand_eye.verdict = calibration::HandEyeVerdict::kGood;
  hand_eye.T_flange_camera = {geometry::rotation_exp({0.1, 0.2, 1.5}), {50.0, 20.0, 80.0}};
  hand_eye.expected_tool_mm = 0.25;
  return hand_eye;
}

std::string text_of(const calibration::HandEye& hand_eye) {
  return hand_eye_json(hand_eye).dump(1) + "\n";
}

/// As whoever changes the file on purpose leaves it: with the right checksum.
std::string signed_again(json content) {
  content.erase("checksum");
  const std::string text = content.dump();
  char digits[16];
  (void)std::snprintf(digits, sizeof(digits), "%08x", link::crc32(std::as_bytes(std::span(text))));
  content["checksum"] = digits;
  return content.dump();
}

template <typename F>
std::string changed(F change) {
  json content = json::parse(text_of(calibrated()));
  change(content);
  return signed_again(content);
}

template <typename F>
std::string with_transform(F change) {
  calibration::HandEye hand_eye = calibrated();
  change(hand_eye.T_flange_camera);
  return text_of(hand_eye);
}

struct BadFile {
  std::string bytes;
  std::string fault;
};

std::vector<BadFile> bad_files() {
  const std::string whole = text_of(calibrated());
  return {
      {"", "empty"},
      {whole.substr(0, whole.size() / 2), "not JSON, or truncated"},
      {"[1, 2]", "damaged: its checksum does not match"},
      {"{}", "damaged: its checksum does not match"},
      {changed([](json& j) { j["units"]["length"] = "m"; }), "its units are not mm and rad"},
      {changed([](json& j) { j["units"]["angle"] = "deg"; }), "its units are not mm and rad"},
      {changed([](json& j) { j.erase("units"); }), "its units are not mm and rad"},
      {changed([](json& j) { j.erase("expected_error"); }), "no expected_error.tool_mm"},
      {changed([](json& j) { j["expected_error"]["tool_mm"] = -1.0; }),
       "no expected_error.tool_mm"},
      {changed([](json& j) { j.erase("T_flange_camera"); }), "no T_flange_camera"},
      {changed([](json& j) { j["T_flange_camera"].erase(0); }), "is not 16 numbers"},
      {changed([](json& j) { j["T_flange_camera"][5] = nullptr; }), "is not a rigid transform"},
      {with_transform([](auto& T) { T.rotation *= 1.01; }), "is not a rigid transform"},
      {with_transform([](auto& T) { T.rotation.col(0) += 0.01 * T.rotation.col(1); }),
       "is not a rigid transform"},
      {with_transform([](auto& T) { T.rotation.col(2) *= -1.0; }),  // The other hand.
       "is not a rigid transform (finite, orthonormal, right-handed"},
      {with_transform([](auto& T) { T.rotation.col(0).swap(T.rotation.col(1)); }),
       "is not a rigid transform (finite, orthonormal, right-handed"},
      {with_transform([](auto& T) { T.translation_mm /= 1000.0; }), "in metres?"},
  };
}

TEST(BadHandEye, the_file_that_is_not_bad_is_read) {
  const HandEyeFile read = parse_hand_eye(text_of(calibrated()), "hand_eye.json");

  EXPECT_EQ(read.T_flange_camera.translation_mm, calibrated().T_flange_camera.translation_mm);
  EXPECT_EQ(read.expected_tool_mm, 0.25);
}

TEST(BadHandEye, each_fault_ends_the_weld_under_its_name_before_anything_moves) {
  const test::ScratchFolder scratch;
  std::vector<BadFile> files = bad_files();
  for (const BadFile& bad : files) {
    const std::string file = scratch.write("hand_eye.json", bad.bytes);

    const test::Outcome outcome =
        test::run_program({"weld", "--camera", "sim", "--robot", "sim", "--hand-eye", file, "--out",
                           scratch.path("out")});

    EXPECT_EQ(outcome.exit_code, 3) << outcome.text;
    EXPECT_EQ(outcome.text.find("dseam: " + file), 0U) << outcome.text;
    EXPECT_NE(outcome.text.find(bad.fault), std::string::npos) << bad.fault << ": " << outcome.text;
    EXPECT_TRUE(scratch.names_in("out").empty()) << bad.fault;
  }
}

TEST(BadHandEye, a_file_that_is_not_there_ends_the_weld_before_anything_moves) {
  const test::ScratchFolder scratch;

  const test::Outcome outcome =
      test::run_program({"weld", "--camera", "sim", "--robot", "sim", "--hand-eye",
                         scratch.path("none.json"), "--out", scratch.path("out")});

  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.text.find("none.json"), std::string::npos) << outcome.text;
  EXPECT_TRUE(scratch.names_in("out").empty());
}

TEST(BadHandEye, cut_off_anywhere_it_is_refused) {
  const std::string whole = text_of(calibrated());
  const std::size_t end = whole.find_last_of('}');
  for (std::size_t size = 0; size <= end; ++size) {
    EXPECT_THROW((void)parse_hand_eye(whole.substr(0, size), "hand_eye.json"), Failure) << size;
  }
}

TEST(BadHandEye, with_any_one_bit_flipped_it_is_refused_or_says_the_very_same) {
  const std::string whole = text_of(calibrated());
  const json truth = json::parse(whole);
  std::size_t refused = 0;
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    std::string flipped = whole;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << (bit % 8)));
    try {
      (void)parse_hand_eye(flipped, "hand_eye.json");
      // 1e-17 and 1E-17 are the same number, and so are some last digits.
      EXPECT_EQ(json::parse(flipped), truth) << "bit " << bit;
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.code(), ExitCode::kInput);
      EXPECT_EQ(std::string(failure.what()).find("hand_eye.json"), 0U) << failure.what();
      ++refused;
    }
  }

  EXPECT_GE(refused, 8 * whole.size() - 32);
}

}  // namespace
}  // namespace dseam::program
