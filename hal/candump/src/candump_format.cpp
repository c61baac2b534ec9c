// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/candump/candump_format.hpp"

#include <array>
#include <charconv>
#include <cstdio>

namespace dseam::hal::candump {
namespace {

constexpr std::int64_t kNsPerS = 1'000'000'000;
constexpr std::int64_t kNsPerUs = 1000;
constexpr std::size_t kShortIdDigits = 3;
constexpr std::size_t kLongIdDigits = 8;

template <typename Number>
bool parse(std::string_view text, int base, Number& out) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out, base);
  return !text.empty() && error == std::errc() && end == text.data() + text.size();
}

bool parse_stamp(std::string_view text, std::int64_t& stamp_ns) {
  const std::size_t dot = text.find('.');
  std::int64_t seconds = 0;
  std::int64_t micros = 0;
  if (dot == std::string_view::npos || text.size() - dot != 7 ||
      !parse(text.substr(0, dot), 10, seconds) || !parse(text.substr(dot + 1), 10, micros) ||
      seconds < 0 || seconds > INT64_MAX / kNsPerS - 1 || micros < 0) {
    return false;
  }
  stamp_ns = seconds * kNsPerS + micros * kNsPerUs;
  return true;
}

bool parse_data(std::string_view text, CanFrame& frame) {
  if (text.size() % 2 != 0 || text.size() / 2 > frame.data.size()) {
    return false;
  }
  frame.size_bytes = static_cast<std::uint8_t>(text.size() / 2);
  for (std::size_t i = 0; i < frame.size_bytes; ++i) {
    std::uint8_t byte = 0;
    if (!parse(text.substr(2 * i, 2), 16, byte)) {
      return false;
    }
    frame.data[i] = std::byte{byte};
  }
  return true;
}

bool parse_frame(std::string_view text, CanFrame& frame) {
  const std::size_t hash = text.find('#');
  if (hash != kShortIdDigits && hash != kLongIdDigits) {
    return false;
  }
  frame.extended = hash == kLongIdDigits;
  frame.fd = text.substr(hash).starts_with("##");
  const std::size_t flags_and_marks = frame.fd ? 3 : 1;  // "##" and one digit of flags, or "#".
  return parse(text.substr(0, hash), 16, frame.id) && text.size() >= hash + flags_and_marks &&
         parse_data(text.substr(hash + flags_and_marks), frame) && is_can_frame(frame);
}

}  // namespace

std::string to_line(const CanFrame& frame, std::string_view interface) {
  std::array<char, 32> head{};
  std::snprintf(head.data(), head.size(), "(%010lld.%06lld) ",
                static_cast<long long>(frame.stamp_ns / kNsPerS),
                static_cast<long long>(frame.stamp_ns % kNsPerS / kNsPerUs));
  // By hand: a weld has some hundred thousand frames, and they are written once the torch stands.
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string line = head.data();
  line += interface;
  std::snprintf(head.data(), head.size(), frame.extended ? " %08X#" : " %03X#", frame.id);
  line += head.data();
  line += frame.fd ? "#1" : "";  // 1: the data was sent at the data bit rate.
  for (std::size_t i = 0; i < frame.size_bytes; ++i) {
    const auto byte = std::to_integer<std::size_t>(frame.data[i]);
    line += kDigits[byte >> 4U];
    line += kDigits[byte & 0xFU];
  }
  return line;
}

Result<CanFrame> from_line(std::string_view line) {
  const std::size_t closing = line.find(')');
  const std::size_t last_space = line.rfind(' ');
  CanFrame frame;
  if (!line.starts_with('(') || closing == std::string_view::npos ||
      !line.substr(closing + 1).starts_with(' ') || last_space <= closing + 2 ||
      !parse_stamp(line.substr(1, closing - 1), frame.stamp_ns) ||
      !parse_frame(line.substr(last_space + 1), frame)) {
    return Errc::kBadData;
  }
  return frame;
}

}  // namespace dseam::hal::candump
