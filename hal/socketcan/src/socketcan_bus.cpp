// SPDX-License-Identifier: Apache-2.0
// Opening, presence and sending. socketcan_receive.cpp has what comes in.
#include "dseam/hal/socketcan/socketcan_bus.hpp"

#include <linux/can.h>

#include <algorithm>
#include <cerrno>

namespace dseam::hal::socketcan {

SocketCanBus::SocketCanBus(std::string_view interface, const Config& config, CanSys& sys)
    : config_(config),
      sys_(sys),
      frames_(sys),
      errors_(sys),
      slots_(config.send_queue),
      queue_(slots_) {
  std::ranges::copy(interface.substr(0, interface_.size() - 1), interface_.begin());
}

Result<std::unique_ptr<SocketCanBus>> SocketCanBus::open(std::string_view interface,
                                                         const Config& config, CanSys& sys) {
  if (config.send_queue == 0 || config.most_in_kernel == 0 ||
      config.filter_count > config.filters.size() || interface.size() >= 16) {
    return Errc::kInvalidArgument;
  }
  std::unique_ptr<SocketCanBus> bus(new SocketCanBus(interface, config, sys));
  if (const Result<> opened = bus->open_sockets(); !opened.ok()) {
    return opened.error();
  }
  return bus;
}

Result<> SocketCanBus::open_sockets() noexcept {
  std::array<can_filter, std::tuple_size_v<decltype(Config::filters)>> filters{};
  for (std::size_t i = 0; i < config_.filter_count; ++i) {
    filters[i] = {config_.filters[i].match, config_.filters[i].mask};
  }
  const auto used = std::span(filters).first(config_.filter_count);
  if (const auto opened = frames_.open_for_frames(interface_.data(), config_.fd, used);
      !opened.ok()) {
    return opened;
  }
  if (const auto opened = errors_.open_for_errors(interface_.data()); !opened.ok()) {
    frames_.close();
    return opened;
  }
  presence_ = frames_.is_up() == 0 ? Presence::kDown : Presence::kUp;
  health_.state = presence_ == Presence::kUp ? BusState::kErrorActive : BusState::kDown;
  return {};
}

ErrorCounts SocketCanBus::error_counts() const noexcept {
  const std::lock_guard lock(mutex_);
  return error_counts_;
}

std::uint64_t SocketCanBus::reconnects() const noexcept {
  const std::lock_guard lock(mutex_);
  return reconnects_;
}

BusHealth SocketCanBus::do_health() const noexcept {
  const std::lock_guard lock(mutex_);
  BusHealth health = health_;
  health.send_dropped += queue_.dropped();
  return health;
}

/// What was queued for a bus that is gone must not come out when it is back.
void SocketCanBus::lose(Presence presence, std::int64_t now_ns) noexcept {
  presence_ = presence;
  health_.state = BusState::kDown;
  queue_.clear();
  in_kernel_ = 0;
  next_retry_ns_ = now_ns + config_.retry_ns;
}

void SocketCanBus::failed(int error, std::int64_t now_ns) noexcept {
  if (error == ENODEV || error == ENXIO || error == EBADF) {
    lose(Presence::kGone, now_ns);
  } else if (error == ENETDOWN) {
    lose(Presence::kDown, now_ns);
  }
}

bool SocketCanBus::usable(std::int64_t now_ns) noexcept {
  if (presence_ != Presence::kUp && now_ns >= next_retry_ns_) {
    recover(now_ns);
  }
  return presence_ == Presence::kUp && health_.state != BusState::kBusOff;
}

void SocketCanBus::recover(std::int64_t now_ns) noexcept {
  next_retry_ns_ = now_ns + config_.retry_ns;
  if (presence_ == Presence::kGone) {
    // A bus that reappears is another one to the kernel: old sockets stay dead.
    frames_.close();
    errors_.close();
    if (open_sockets().ok() && presence_ == Presence::kUp) {
      come_back();
    }
    return;
  }
  const int up = frames_.is_up();
  if (up > 0) {
    come_back();
  } else if (up < 0) {
    presence_ = Presence::kGone;
  }
}

void SocketCanBus::come_back() noexcept {
  presence_ = Presence::kUp;
  health_.state = BusState::kErrorActive;
  in_kernel_ = 0;
  ++reconnects_;
}

Result<> SocketCanBus::do_send(const CanFrame& frame) noexcept {
  if (frame.fd && !config_.fd) {
    return Errc::kUnsupported;
  }
  const std::lock_guard lock(mutex_);
  const std::int64_t now_ns = sys_.now_ns();
  if (!usable(now_ns)) {
    ++health_.send_dropped;
    return Errc::kDisconnected;
  }
  const bool queued = queue_.push(frame, now_ns, now_ns + config_.send_deadline_ns);
  pump(now_ns);
  if (!usable(now_ns)) {
    return Errc::kDisconnected;
  }
  return queued ? Result<>() : Errc::kQueueFull;
}

void SocketCanBus::pump(std::int64_t now_ns) noexcept {
  judge_confirmations(now_ns);
  while (presence_ == Presence::kUp && in_kernel_ < config_.most_in_kernel) {
    SendQueue::Slot* next = queue_.front(now_ns);
    if (next == nullptr || !write_frame(next->frame, now_ns)) {
      return;
    }
    queue_.erase(*next);
  }
}

/// ENOBUFS alone may be a moment's shortage; no confirmation for long is a dead bus.
void SocketCanBus::judge_confirmations(std::int64_t now_ns) noexcept {
  if (in_kernel_ == 0) {
    last_confirm_ns_ = now_ns;
    return;
  }
  if (now_ns - last_confirm_ns_ <= config_.confirm_limit_ns) {
    return;
  }
  if (health_.receive_overflow != overflow_seen_) {
    overflow_seen_ = health_.receive_overflow;  // The confirmations may be among what was lost.
    in_kernel_ = 0;
    last_confirm_ns_ = now_ns;
    return;
  }
  lose(Presence::kDown, now_ns);
}

bool SocketCanBus::write_frame(const CanFrame& frame, std::int64_t now_ns) noexcept {
  canfd_frame raw{};
  raw.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0U);
  raw.len = frame.size_bytes;
  raw.flags = frame.fd && config_.bit_rate_switch ? CANFD_BRS : 0;
  std::transform(frame.data.begin(), frame.data.begin() + frame.size_bytes, raw.data,
                 [](std::byte byte) { return std::to_integer<std::uint8_t>(byte); });
  const std::size_t size = frame.fd ? CANFD_MTU : CAN_MTU;
  const std::int64_t written = sys_.send_bytes(frames_.fd(), &raw, size);
  if (written == static_cast<std::int64_t>(size)) {
    ++health_.sent;
    ++in_kernel_;
    return true;
  }
  failed(written < 0 ? static_cast<int>(-written) : EIO, now_ns);
  return false;  // EAGAIN, ENOBUFS, EINTR: it stays queued until its deadline.
}

Result<> SocketCanBus::do_purge() noexcept {
  const std::lock_guard lock(mutex_);
  queue_.clear();
  if (in_kernel_ == 0) {
    return {};
  }
  if (config_.purge_hook == nullptr || !config_.purge_hook(config_.purge_context)) {
    return Errc::kUnavailable;  // Frames lie in the kernel that only the interface can drop.
  }
  in_kernel_ = 0;
  return {};
}

}  // namespace dseam::hal::socketcan
