// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arv.h>

#include <cstdint>
#include <span>
#include <vector>

namespace dseam::test {

/// One image of a multipart frame.
struct SentPart {
  ArvBufferPartDataType type = ARV_BUFFER_PART_DATA_TYPE_2D_IMAGE;
  std::uint32_t pixel_format = ARV_PIXEL_FORMAT_MONO_8;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint16_t row_padding_bytes = 0;
  std::vector<std::uint8_t> bytes;
};

/// The sending side of GigE Vision's multipart frames, to the stream that a client opened on a fake
/// camera.
///
/// Source:  GigE Vision 2.0, GVSP: multi-part payload, extended block identifiers.
class MultipartSender {
 public:
  explicit MultipartSender(ArvFakeCamera* camera);
  ~MultipartSender();
  MultipartSender(const MultipartSender&) = delete;
  MultipartSender& operator=(const MultipartSender&) = delete;

  void send(std::span<const SentPart> parts);

 private:
  using Packet = std::vector<std::uint8_t>;

  [[nodiscard]] Packet header(std::uint8_t content, std::uint8_t parts) const;
  [[nodiscard]] Packet leader(std::span<const SentPart> parts) const;
  void send_packet(const Packet& packet);
  void send_data(std::uint8_t part, std::uint64_t offset, std::span<const std::uint8_t> bytes);

  ArvFakeCamera* camera_;
  int socket_;
  std::uint64_t frame_id_ = 0;
  std::uint32_t packet_id_ = 0;
};

}  // namespace dseam::test
