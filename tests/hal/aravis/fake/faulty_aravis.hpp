// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arv.h>

#include <atomic>
#include <cstdint>
#include <filesystem>

#include "dseam/hal/aravis/aravis_sys.hpp"
#include "hal/aravis/fake/fake_gige_camera.hpp"

namespace dseam::test {

/// Aravis with its fake inside the process, of which any call can be made to fail. Cameras and
/// streams are counted until they are gone.
class FaultyAravis final : public hal::aravis::AravisSys {
 public:
  static constexpr const char* kCameraId = "Fake_1";

  explicit FaultyAravis(const FakeScan3d& scan);
  ~FaultyAravis();

  /// The n-th call from now on (0 is the next) fails with `code`, once or for ever.
  void fail_call(std::uint64_t n, ArvDeviceError code, bool for_ever);
  /// The n-th frame from now on has `status`, once or for ever.
  void spoil_frame(std::uint64_t n, ArvBufferStatus status, bool for_ever);
  /// The camera hands its control to nobody, as after a pulled cable.
  void lose_control() { lose_control_ = true; }

  [[nodiscard]] std::uint64_t num_calls() const { return calls_; }
  [[nodiscard]] std::uint64_t num_injected() const { return injected_; }
  [[nodiscard]] int num_alive() const { return alive_; }

 private:
  struct Fault {
    std::uint64_t at = UINT64_MAX;
    int code = 0;
    bool for_ever = false;

    [[nodiscard]] bool hits(std::uint64_t n) const { return for_ever ? n >= at : n == at; }
  };

  void find_devices() noexcept override;
  Camera* open(const char* id, Error** error) noexcept override;
  bool controls(Camera* camera) noexcept override;
  bool has(Camera* camera, const char* feature, Error** error) noexcept override;
  double number(Camera* camera, const char* feature, Error** error) noexcept override;
  std::int64_t integer(Camera* camera, const char* feature, Error** error) noexcept override;
  bool flag(Camera* camera, const char* feature, Error** error) noexcept override;
  const char* text(Camera* camera, const char* feature, Error** error) noexcept override;
  void set_flag(Camera* camera, const char* feature, bool on, Error** error) noexcept override;
  void set_text(Camera* camera, const char* feature, const char* value,
                Error** error) noexcept override;
  double frame_rate_hz(Camera* camera, Error** error) noexcept override;
  void set_frame_rate_hz(Camera* camera, double rate_hz, Error** error) noexcept override;
  void set_multipart(Camera* camera, Error** error) noexcept override;
  std::uint32_t set_packet_bytes(Camera* camera, std::uint32_t wanted,
                                 Error** error) noexcept override;
  Stream* make_stream(Camera* camera, const StreamSettings& settings,
                      Error** error) noexcept override;
  void start(Camera* camera, Error** error) noexcept override;
  void stop(Camera* camera, Error** error) noexcept override;
  std::uint64_t count(Stream* stream, const char* counter) noexcept override;
  Buffer* pop(Stream* stream, std::uint64_t timeout_us) noexcept override;
  void push(Stream* stream, Buffer* buffer) noexcept override;
  Arrival arrival(Buffer* buffer) noexcept override;
  std::size_t parts(Buffer* buffer, std::span<Part> out) noexcept override;

  [[nodiscard]] bool fails(Error** error) noexcept;
  template <typename Object>
  Object* watched(Object* object) noexcept;

  FakeScan3d scan_;
  std::filesystem::path description_;
  AravisSys& library_;
  Camera* camera_ = nullptr;
  Fault fault_;
  Fault spoilt_;
  std::atomic<std::uint64_t> calls_{0};
  std::atomic<std::uint64_t> frames_{0};
  std::atomic<std::uint64_t> injected_{0};
  std::atomic<int> alive_{0};
  std::atomic<bool> lose_control_{false};
};

}  // namespace dseam::test
