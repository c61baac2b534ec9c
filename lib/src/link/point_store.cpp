// SPDX-License-Identifier: Apache-2.0
#include "dseam/link/point_store.hpp"

#include "dseam/link/codec.hpp"
#include "dseam/link/crc.hpp"

namespace dseam::link {

void PointStore::begin(std::uint32_t total) noexcept {
  *this = PointStore(slots_);
  total_ = total;
}

PointStore::Take PointStore::take(const Point& point, const Frame& frame) noexcept {
  const auto ahead = static_cast<std::int16_t>(
      static_cast<std::uint16_t>(point.seq - static_cast<std::uint16_t>(received_)));
  if (ahead != 0) {
    return ahead < 0 ? Take::kRepeated : Take::kGap;
  }
  const bool late_enough = received_ == 0 || point.set_point.t_us > received_until_us_;
  if (received_ == total_ || !late_enough || point.last != (received_ + 1 == total_)) {
    return Take::kContradiction;
  }
  if (free() == 0) {
    return Take::kNoRoom;
  }
  received_crc_ = crc32(covered_by_crc(frame), received_crc_);
  received_until_us_ = point.set_point.t_us;
  slot(received_) = {point.set_point, received_crc_};
  ++received_;
  const bool awaited = received_ == waiting_count_;
  return awaited && confirm(waiting_count_, waiting_crc_) == Confirm::kMismatch ? Take::kBadMark
                                                                                : Take::kStored;
}

PointStore::Confirm PointStore::confirm(std::uint32_t count, std::uint32_t crc) noexcept {
  if (count <= verified_ || count > total_) {
    return Confirm::kNothingNew;
  }
  if (count > received_) {
    waiting_count_ = count;
    waiting_crc_ = crc;
    return Confirm::kWaiting;
  }
  const Slot& last = slot(count - 1);
  if (last.crc == crc) {
    verified_ = count;
    verified_crc_ = crc;
    verified_until_us_ = last.point.t_us;
    return Confirm::kConfirmed;
  }
  waiting_count_ = 0;
  received_ = verified_;
  received_crc_ = verified_crc_;
  received_until_us_ = verified_until_us_;
  return Confirm::kMismatch;
}

const trajectory::SetPoint* PointStore::front() const noexcept {
  return executed_ == verified_ ? nullptr : &slot(executed_).point;
}

}  // namespace dseam::link
