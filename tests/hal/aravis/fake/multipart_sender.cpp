// SPDX-License-Identifier: Apache-2.0
#include "hal/aravis/fake/multipart_sender.hpp"

#include <gio/gio.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <numeric>

namespace dseam::test {
namespace {

constexpr std::uint8_t kLeader = 1;
constexpr std::uint8_t kTrailer = 2;
constexpr std::uint8_t kMultipartData = 7;
constexpr std::uint8_t kExtendedIds = 0x80;
constexpr std::size_t kDataBytes = 1400;  // Of a packet.

/// Appends the lowest `bytes` bytes of `value`, the highest first.
void put(std::vector<std::uint8_t>& packet, std::uint64_t value, unsigned bytes) {
  for (unsigned i = bytes; i-- > 0;) {
    packet.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
}

void put_part(std::vector<std::uint8_t>& packet, const SentPart& part) {
  put(packet, static_cast<std::uint64_t>(part.type), 2);
  put(packet, part.bytes.size(), 6);
  put(packet, part.pixel_format, 4);
  put(packet, 0, 2);  // Reserved,
  put(packet, 0, 2);  // source and zones,
  put(packet, 0, 4);  // their directions,
  put(packet, 0, 4);  // purpose and region.
  put(packet, part.width, 4);
  put(packet, part.height, 4);
  put(packet, 0, 8);  // Offset of the image.
  put(packet, part.row_padding_bytes, 2);
  put(packet, 0, 2);  // Padding of the image,
  put(packet, 0, 4);  // reserved.
}

}  // namespace

MultipartSender::MultipartSender(ArvFakeCamera* camera)
    : camera_(camera), socket_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}

MultipartSender::~MultipartSender() { close(socket_); }

MultipartSender::Packet MultipartSender::header(std::uint8_t content, std::uint8_t parts) const {
  Packet packet;
  put(packet, 0, 2);  // Status.
  put(packet, 0, 2);  // Flags.
  put(packet, content | kExtendedIds, 1);
  put(packet, 0, 2);
  put(packet, parts, 1);
  put(packet, frame_id_, 8);
  put(packet, packet_id_, 4);
  return packet;
}

MultipartSender::Packet MultipartSender::leader(std::span<const SentPart> parts) const {
  Packet packet = header(kLeader, static_cast<std::uint8_t>(parts.size()));
  put(packet, 0, 2);
  put(packet, ARV_BUFFER_PAYLOAD_TYPE_MULTIPART, 2);
  put(packet, 1'000'000 * frame_id_, 8);  // Time stamp.
  for (const SentPart& part : parts) {
    put_part(packet, part);
  }
  return packet;
}

void MultipartSender::send_packet(const Packet& packet) {
  GSocketAddress* to = arv_fake_camera_get_stream_address(camera_);
  sockaddr_storage address{};
  const auto size = static_cast<socklen_t>(g_socket_address_get_native_size(to));
  g_socket_address_to_native(to, &address, sizeof address, nullptr);
  g_object_unref(to);
  (void)sendto(socket_, packet.data(), packet.size(), 0,
               reinterpret_cast<const sockaddr*>(&address), size);  // NOLINT: POSIX
  ++packet_id_;
}

void MultipartSender::send_data(std::uint8_t part, std::uint64_t offset,
                                std::span<const std::uint8_t> bytes) {
  Packet packet = header(kMultipartData, 0);
  put(packet, part, 1);
  put(packet, 0, 1);  // Zone.
  put(packet, offset, 6);
  packet.insert(packet.end(), bytes.begin(), bytes.end());
  send_packet(packet);
}

void MultipartSender::send(std::span<const SentPart> parts) {
  ++frame_id_;
  packet_id_ = 0;
  send_packet(leader(parts));
  std::uint64_t part_offset = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::span<const std::uint8_t> bytes = parts[i].bytes;
    for (std::size_t at = 0; at < bytes.size(); at += kDataBytes) {
      send_data(static_cast<std::uint8_t>(i), part_offset + at,
                bytes.subspan(at, std::min(kDataBytes, bytes.size() - at)));
    }
    part_offset += bytes.size();
  }
  Packet trailer = header(kTrailer, 0);
  put(trailer, ARV_BUFFER_PAYLOAD_TYPE_MULTIPART, 4);
  put(trailer, 0, 4);
  send_packet(trailer);
}

}  // namespace dseam::test
