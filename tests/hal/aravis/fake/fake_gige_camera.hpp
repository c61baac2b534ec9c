// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arv.h>

#include <cstdint>
#include <filesystem>
#include <string>

namespace dseam::test {

/// Moves this process into a network of its own, so that tests that use GigE Vision's one port run
/// beside each other. Where that is not permitted, the computer's loopback is used.
void enter_private_network();

/// From now on packets of more than 1500 bytes vanish on their way, as on a path with a switch that
/// knows no jumbo frames; smaller ones arrive.
void narrow_the_path(bool narrow);

/// What the fake camera's description says of its 3D data.
struct FakeScan3d {
  std::uint32_t width = 320;
  std::uint32_t height = 240;
  std::uint32_t pixel_format = ARV_PIXEL_FORMAT_COORD3D_C_16;
  bool described = true;  ///< False: a camera without any Scan3d feature.
  std::string output_mode = "ProjectedC";
  std::string distance_unit = "Millimeter";
  double focal_length_px = 512.0;
  bool whole_focal_length = false;  ///< Described as an integer, which SFNC does not want.
  double scale_c = 0.05;
  double offset_c = 100.0;
  double scale_ab = 0.1;
  double offset_ab = -10.0;
  double frame_rate_hz = 50.0;
  /// Range and Intensity are components of a multipart frame. Aravis' fake does not know such
  /// frames and stays silent: a MultipartSender sends them.
  bool multipart = false;
};

/// A real GigE Vision device on the loopback, made of Aravis' fake and a description of our own.
/// Pixel i of frame n has the byte (i + n) modulo 256 as its high byte, and 7 as its low one.
class FakeGigeCamera {
 public:
  explicit FakeGigeCamera(const FakeScan3d& scan = {}, double lost_packet_ratio = 0.0);
  ~FakeGigeCamera();
  FakeGigeCamera(const FakeGigeCamera&) = delete;
  FakeGigeCamera& operator=(const FakeGigeCamera&) = delete;

  void unplug();
  void plug_in();
  void write_register(std::uint32_t address, std::uint32_t value);
  [[nodiscard]] ArvFakeCamera* fake() const { return arv_gv_fake_camera_get_fake_camera(camera_); }
  /// What a multipart camera was told: 0 is Intensity, 1 is Range.
  [[nodiscard]] std::uint32_t component_format(std::uint32_t component) const;
  [[nodiscard]] static const char* serial() { return "DSEAM3D"; }

 private:
  FakeScan3d scan_;
  double lost_packet_ratio_;
  std::filesystem::path description_;
  ArvGvFakeCamera* camera_ = nullptr;
};

/// Gives one of Aravis' fakes the registers and the picture that such a camera has.
void set_up(ArvFakeCamera* fake, const FakeScan3d& scan);

/// The description that such a camera serves.
[[nodiscard]] std::string genicam_description(const FakeScan3d& scan);

}  // namespace dseam::test
