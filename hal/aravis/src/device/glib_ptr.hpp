// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arv.h>

#include <memory>
#include <string>

namespace dseam::hal::aravis {

struct ObjectUnref {
  void operator()(gpointer object) const noexcept { g_object_unref(object); }
};
template <typename T>
using ObjectPtr = std::unique_ptr<T, ObjectUnref>;

/// Receives a GError and frees it: `arv_call(..., error.out())`.
class GlibError {
 public:
  GlibError() = default;
  GlibError(const GlibError&) = delete;
  GlibError& operator=(const GlibError&) = delete;
  ~GlibError() { g_clear_error(&error_); }

  /// Clears what is there; one object serves several calls.
  GError** out() noexcept {
    g_clear_error(&error_);
    return &error_;
  }
  explicit operator bool() const noexcept { return error_ != nullptr; }
  [[nodiscard]] std::string text() const { return error_ == nullptr ? "" : error_->message; }
  /// The device's own or that of the way to it, not one of its description.
  [[nodiscard]] bool is_of_device() const noexcept {
    return error_ != nullptr && error_->domain == ARV_DEVICE_ERROR;
  }
  [[nodiscard]] bool is(ArvDeviceError code) const noexcept {
    return error_ != nullptr && g_error_matches(error_, ARV_DEVICE_ERROR, code);
  }

 private:
  GError* error_ = nullptr;
};

}  // namespace dseam::hal::aravis
