// SPDX-License-Identifier: Apache-2.0
#include "hal/aravis/fake/faulty_aravis.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

namespace dseam::test {
namespace {

void on_gone(gpointer alive, GObject* /*object*/) { --*static_cast<std::atomic<int>*>(alive); }

}  // namespace

FaultyAravis::FaultyAravis(const FakeScan3d& scan)
    : scan_(scan),
      description_(std::filesystem::temp_directory_path() /
                   ("dseam-faulty-" + std::to_string(getpid()) + ".xml")),
      library_(hal::aravis::aravis_library()) {
  std::ofstream(description_) << genicam_description(scan);
  arv_set_fake_camera_genicam_filename(description_.c_str());
  arv_disable_interface("GigEVision");  // Their discovery takes a second each time.
  arv_disable_interface("USB3Vision");
}

FaultyAravis::~FaultyAravis() {
  arv_enable_interface("GigEVision");
  arv_enable_interface("USB3Vision");
  std::filesystem::remove(description_);
}

void FaultyAravis::fail_call(std::uint64_t n, ArvDeviceError code, bool for_ever) {
  fault_ = {calls_ + n, code, for_ever};
}

void FaultyAravis::spoil_frame(std::uint64_t n, ArvBufferStatus status, bool for_ever) {
  spoilt_ = {frames_ + n, status, for_ever};
}

bool FaultyAravis::fails(Error** error) noexcept {
  if (!fault_.hits(calls_++)) {
    return false;
  }
  ++injected_;
  if (error != nullptr) {
    g_set_error(error, ARV_DEVICE_ERROR, fault_.code, "injected");
  }
  return true;
}

template <typename Object>
Object* FaultyAravis::watched(Object* object) noexcept {
  if (object != nullptr) {
    ++alive_;
    g_object_weak_ref(G_OBJECT(object), on_gone, &alive_);
  }
  return object;
}

void FaultyAravis::find_devices() noexcept {
  if (!fails(nullptr)) {
    library_.find_devices();
  }
}

hal::aravis::AravisSys::Camera* FaultyAravis::open(const char* id, Error** error) noexcept {
  if (fails(error)) {
    return nullptr;
  }
  camera_ = watched(library_.open(id, error));
  if (camera_ != nullptr) {
    set_up(arv_fake_device_get_fake_camera(ARV_FAKE_DEVICE(arv_camera_get_device(camera_))), scan_);
  }
  return camera_;
}

bool FaultyAravis::controls(Camera* camera) noexcept {
  return !fails(nullptr) && library_.controls(camera);
}

bool FaultyAravis::has(Camera* camera, const char* feature, Error** error) noexcept {
  return !fails(error) && library_.has(camera, feature, error);
}

double FaultyAravis::number(Camera* camera, const char* feature, Error** error) noexcept {
  return fails(error) ? 0.0 : library_.number(camera, feature, error);
}

std::int64_t FaultyAravis::integer(Camera* camera, const char* feature, Error** error) noexcept {
  return fails(error) ? 0 : library_.integer(camera, feature, error);
}

bool FaultyAravis::flag(Camera* camera, const char* feature, Error** error) noexcept {
  return !fails(error) && library_.flag(camera, feature, error);
}

const char* FaultyAravis::text(Camera* camera, const char* feature, Error** error) noexcept {
  return fails(error) ? nullptr : library_.text(camera, feature, error);
}

void FaultyAravis::set_flag(Camera* camera, const char* feature, bool on, Error** error) noexcept {
  if (!fails(error)) {
    library_.set_flag(camera, feature, on, error);
  }
}

void FaultyAravis::set_text(Camera* camera, const char* feature, const char* value,
                            Error** error) noexcept {
  if (!fails(error)) {
    library_.set_text(camera, feature, value, error);
  }
}

double FaultyAravis::frame_rate_hz(Camera* camera, Error** error) noexcept {
  return fails(error) ? 0.0 : library_.frame_rate_hz(camera, error);
}

void FaultyAravis::set_frame_rate_hz(Camera* camera, double rate_hz, Error** error) noexcept {
  if (!fails(error)) {
    library_.set_frame_rate_hz(camera, rate_hz, error);
  }
}

void FaultyAravis::set_multipart(Camera* camera, Error** error) noexcept {
  if (!fails(error)) {
    library_.set_multipart(camera, error);
  }
}

std::uint32_t FaultyAravis::set_packet_bytes(Camera* camera, std::uint32_t wanted,
                                             Error** error) noexcept {
  return fails(error) ? 0 : library_.set_packet_bytes(camera, wanted, error);
}

hal::aravis::AravisSys::Stream* FaultyAravis::make_stream(Camera* camera,
                                                          const StreamSettings& settings,
                                                          Error** error) noexcept {
  return fails(error) ? nullptr : watched(library_.make_stream(camera, settings, error));
}

void FaultyAravis::start(Camera* camera, Error** error) noexcept {
  if (!fails(error)) {
    library_.start(camera, error);
  }
}

void FaultyAravis::stop(Camera* camera, Error** error) noexcept {
  if (!fails(error)) {
    library_.stop(camera, error);
  }
}

std::uint64_t FaultyAravis::count(Stream* stream, const char* counter) noexcept {
  if (lose_control_.exchange(false)) {  // Here the camera is alive: its own thread asks.
    g_signal_emit_by_name(arv_camera_get_device(camera_), "control-lost");
  }
  return fails(nullptr) ? 0 : library_.count(stream, counter);
}

hal::aravis::AravisSys::Buffer* FaultyAravis::pop(Stream* stream,
                                                  std::uint64_t timeout_us) noexcept {
  if (!fails(nullptr)) {
    return library_.pop(stream, timeout_us);
  }
  std::this_thread::sleep_for(std::chrono::microseconds(timeout_us));
  return nullptr;
}

void FaultyAravis::push(Stream* stream, Buffer* buffer) noexcept { library_.push(stream, buffer); }

hal::aravis::AravisSys::Arrival FaultyAravis::arrival(Buffer* buffer) noexcept {
  Arrival arrival = library_.arrival(buffer);
  if (spoilt_.hits(frames_++)) {
    ++injected_;
    arrival.status = spoilt_.code;
  }
  return arrival;
}

std::size_t FaultyAravis::parts(Buffer* buffer, std::span<Part> out) noexcept {
  return fails(nullptr) ? 0 : library_.parts(buffer, out);
}

}  // namespace dseam::test
