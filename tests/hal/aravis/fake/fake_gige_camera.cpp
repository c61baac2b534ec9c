// SPDX-License-Identifier: Apache-2.0
#include "hal/aravis/fake/fake_gige_camera.hpp"

#include <dlfcn.h>
#include <net/if.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <bit>
#include <cstring>
#include <fstream>

namespace {

constexpr std::size_t kNarrowBytes = 1500;
std::atomic<bool> narrow_path{false};

}  // namespace

/// Stands before the C library's, for GLib too.
extern "C" ssize_t sendmsg(int fd, const msghdr* message, int flags) {
  using Send = ssize_t (*)(int, const msghdr*, int);
  static const Send send = reinterpret_cast<Send>(dlsym(RTLD_NEXT, "sendmsg"));  // NOLINT
  std::size_t size = 0;
  for (std::size_t i = 0; i < message->msg_iovlen; ++i) {
    size += message->msg_iov[i].iov_len;
  }
  return narrow_path && size > kNarrowBytes ? static_cast<ssize_t>(size) : send(fd, message, flags);
}

namespace dseam::test {

void narrow_the_path(bool narrow) { narrow_path = narrow; }

namespace {

constexpr std::uint32_t kScaleAddress = 0x1000;   // A, B, C, as 64-bit floats
constexpr std::uint32_t kOffsetAddress = 0x1020;  // the same
constexpr std::uint32_t kSilentAddress = 0x1100;  // Acquisition of which the fake knows nothing.
constexpr std::uint32_t kComponentAddress = 0x1104;
constexpr std::uint32_t kEnableAddress = 0x1108;       // Of two components,
constexpr std::uint32_t kPixelFormatAddress = 0x1110;  // and the formats of both.
constexpr std::uint32_t kCapabilityAddress = 0x0d20;   // GigE Vision: stream channel capability.

void fill_pattern(ArvBuffer* buffer, void* /*data*/, guint32 /*exposure_us*/, guint32 /*gain*/,
                  ArvPixelFormat format) {
  std::size_t size = 0;  // Aravis says 0 while it is filled.
  auto* bytes = static_cast<guint8*>(const_cast<void*>(arv_buffer_get_data(buffer, &size)));
  size = static_cast<std::size_t>(arv_buffer_get_image_width(buffer)) *
         static_cast<std::size_t>(arv_buffer_get_image_height(buffer)) *
         ARV_PIXEL_FORMAT_BIT_PER_PIXEL(format) / 8;
  const auto number = static_cast<std::uint32_t>(arv_buffer_get_frame_id(buffer));
  for (std::size_t i = 0; i + 1 < size; i += 2) {
    bytes[i] = 7;
    bytes[i + 1] = static_cast<guint8>(i / 2 + number);
  }
}

void bring_up_loopback() {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  ifreq request{};
  std::strcpy(request.ifr_name, "lo");
  request.ifr_flags = IFF_UP | IFF_RUNNING;
  (void)ioctl(fd, SIOCSIFFLAGS, &request);
  close(fd);
}

/// As root at once; else in a user namespace of its own, in which this user keeps his number.
bool leave_the_network() {
  if (unshare(CLONE_NEWNET) == 0) {
    return true;
  }
  const std::string user = std::to_string(geteuid());
  const std::string group = std::to_string(getegid());
  if (unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) {
    return false;
  }
  std::ofstream("/proc/self/setgroups") << "deny";
  std::ofstream("/proc/self/uid_map") << user + " " + user + " 1";
  std::ofstream("/proc/self/gid_map") << group + " " + group + " 1";
  return true;
}

std::string register_node(const std::string& name, unsigned address, const char* access = "RW") {
  return "<IntReg Name='" + name + "'><Address>" + std::to_string(address) +
         "</Address><Length>4</Length><AccessMode>" + access +
         "</AccessMode><pPort>Device</pPort><Sign>Unsigned</Sign>"
         "<Endianess>BigEndian</Endianess></IntReg>\n";
}

std::string command_node(const std::string& name, int value) {
  return "<Command Name='" + name + "'><pValue>AcquisitionRegister</pValue><CommandValue>" +
         std::to_string(value) + "</CommandValue></Command>\n";
}

std::string choice_node(const std::string& name, const std::string& entry, std::uint32_t value) {
  return "<Enumeration Name='" + name + "'><EnumEntry Name='" + entry + "'><Value>" +
         std::to_string(value) + "</Value></EnumEntry><Value>" + std::to_string(value) +
         "</Value></Enumeration>\n";
}

std::string constant_node(const std::string& name, double value) {
  return "<Float Name='" + name + "'><Value>" + std::to_string(value) + "</Value></Float>\n";
}

/// A number for each axis, behind the selector.
std::string axis_node(const std::string& name, unsigned address) {
  return "<FloatReg Name='" + name + "'><Address>" + std::to_string(address) +
         "</Address><pIndex Offset='8'>AxisIndex</pIndex><Length>8</Length>"
         "<AccessMode>RO</AccessMode><pPort>Device</pPort>"
         "<Endianess>BigEndian</Endianess></FloatReg>\n";
}

/// A register for each component, behind the selector.
std::string component_node(const std::string& name, unsigned address) {
  return "<IntReg Name='" + name + "'><Address>" + std::to_string(address) +
         "</Address><pIndex Offset='4'>ComponentIndex</pIndex><Length>4</Length>"
         "<AccessMode>RW</AccessMode><pPort>Device</pPort><Sign>Unsigned</Sign>"
         "<Endianess>BigEndian</Endianess></IntReg>\n";
}

std::string component_nodes() {
  return register_node("ComponentIndex", kComponentAddress) +
         "<Enumeration Name='ComponentSelector'>"
         "<EnumEntry Name='Intensity'><Value>0</Value></EnumEntry>"
         "<EnumEntry Name='Range'><Value>1</Value></EnumEntry>"
         "<pValue>ComponentIndex</pValue></Enumeration>\n"
         "<Boolean Name='ComponentEnable'><pValue>ComponentEnableRegister</pValue></Boolean>\n" +
         component_node("ComponentEnableRegister", kEnableAddress);
}

std::string scan3d_nodes(const FakeScan3d& scan) {
  return "<Integer Name='AxisIndex'><Value>0</Value></Integer>\n"
         "<Enumeration Name='Scan3dCoordinateSelector'>"
         "<EnumEntry Name='CoordinateA'><Value>0</Value></EnumEntry>"
         "<EnumEntry Name='CoordinateB'><Value>1</Value></EnumEntry>"
         "<EnumEntry Name='CoordinateC'><Value>2</Value></EnumEntry>"
         "<pValue>AxisIndex</pValue></Enumeration>\n" +
         axis_node("Scan3dCoordinateScale", kScaleAddress) +
         axis_node("Scan3dCoordinateOffset", kOffsetAddress) +
         choice_node("Scan3dOutputMode", scan.output_mode, 1) +
         choice_node("Scan3dDistanceUnit", scan.distance_unit, 1) +
         "<Boolean Name='Scan3dInvalidDataFlag'><Value>1</Value></Boolean>\n" +
         constant_node("Scan3dInvalidDataValue", 0.0) +
         (scan.whole_focal_length
              ? "<Integer Name='Scan3dFocalLength'><Value>" +
                    std::to_string(static_cast<int>(scan.focal_length_px)) + "</Value></Integer>\n"
              : constant_node("Scan3dFocalLength", scan.focal_length_px)) +
         constant_node("Scan3dPrincipalPointU", 0.5 * scan.width - 0.5) +
         constant_node("Scan3dPrincipalPointV", 0.5 * scan.height - 0.5);
}

}  // namespace

void enter_private_network() {
  static const bool entered = leave_the_network();
  if (entered) {
    bring_up_loopback();
  }
}

std::string genicam_description(const FakeScan3d& scan) {
  const std::uint32_t depth_bytes = ((scan.pixel_format >> 16U) & 0xFFU) / 8U;
  const std::uint32_t pixel_bytes = depth_bytes + (scan.multipart ? 2U : 0U);  // Gray, confidence.
  return "<?xml version='1.0' encoding='utf-8'?>\n"
         "<RegisterDescription ModelName='Fake3D' VendorName='dseam' StandardNameSpace='None' "
         "SchemaMajorVersion='1' SchemaMinorVersion='1' SchemaSubMinorVersion='0' "
         "MajorVersion='1' MinorVersion='0' SubMinorVersion='0' ProductGuid='0' VersionGuid='0' "
         "xmlns='http://www.genicam.org/GenApi/Version_1_1'>\n"
         "<Category Name='Root'><pFeature>Width</pFeature><pFeature>Height</pFeature>"
         "<pFeature>PixelFormat</pFeature><pFeature>PayloadSize</pFeature></Category>\n" +
         register_node("Width", ARV_FAKE_CAMERA_REGISTER_WIDTH) +
         register_node("Height", ARV_FAKE_CAMERA_REGISTER_HEIGHT) +
         register_node("SensorWidth", ARV_FAKE_CAMERA_REGISTER_SENSOR_WIDTH, "RO") +
         register_node("SensorHeight", ARV_FAKE_CAMERA_REGISTER_SENSOR_HEIGHT, "RO") +
         register_node("OffsetX", ARV_FAKE_CAMERA_REGISTER_X_OFFSET) +
         register_node("OffsetY", ARV_FAKE_CAMERA_REGISTER_Y_OFFSET) +
         (scan.multipart
              ? component_nodes() + component_node("PixelFormatRegister", kPixelFormatAddress)
              : register_node("PixelFormatRegister", ARV_FAKE_CAMERA_REGISTER_PIXEL_FORMAT)) +
         "<Enumeration Name='PixelFormat'><EnumEntry Name='Mono8'><Value>17301505</Value>"
         "</EnumEntry><EnumEntry Name='Depth'><Value>" +
         std::to_string(scan.pixel_format) +
         "</Value></EnumEntry><pValue>PixelFormatRegister</pValue></Enumeration>\n" +
         register_node("AcquisitionRegister",
                       scan.multipart ? kSilentAddress : ARV_FAKE_CAMERA_REGISTER_ACQUISITION) +
         command_node("AcquisitionStart", 1) + command_node("AcquisitionStop", 0) +
         register_node("FramePeriod", ARV_FAKE_CAMERA_REGISTER_ACQUISITION_FRAME_PERIOD_US) +
         "<Float Name='AcquisitionFrameRate'><pValue>FrameRate</pValue><Min>0.1</Min>"
         "<Max>1000</Max></Float><Converter Name='FrameRate'><FormulaTo>1000000 / FROM</FormulaTo>"
         "<FormulaFrom>1000000 / TO</FormulaFrom><pValue>FramePeriod</pValue></Converter>\n"
         "<IntSwissKnife Name='PayloadSize'><pVariable Name='W'>Width</pVariable>"
         "<pVariable Name='H'>Height</pVariable><Formula>W * H * " +
         std::to_string(pixel_bytes) + "</Formula></IntSwissKnife>\n" +
         (scan.described ? scan3d_nodes(scan) : std::string()) +
         "<Port Name='Device'></Port>\n</RegisterDescription>\n";
}

FakeGigeCamera::FakeGigeCamera(const FakeScan3d& scan, double lost_packet_ratio)
    : scan_(scan), lost_packet_ratio_(lost_packet_ratio) {
  enter_private_network();
  description_ = std::filesystem::temp_directory_path() /
                 ("dseam-fake3d-" + std::to_string(getpid()) + ".xml");
  std::ofstream(description_) << genicam_description(scan);
  plug_in();
}

FakeGigeCamera::~FakeGigeCamera() {
  unplug();
  std::filesystem::remove(description_);
}

void FakeGigeCamera::unplug() { g_clear_object(&camera_); }

void FakeGigeCamera::plug_in() {
  camera_ = arv_gv_fake_camera_new_full("127.0.0.1", serial(), description_.c_str());
  g_object_set(camera_, "gvsp-lost-ratio", lost_packet_ratio_, nullptr);
  set_up(arv_gv_fake_camera_get_fake_camera(camera_), scan_);
}

void set_up(ArvFakeCamera* fake, const FakeScan3d& scan) {
  arv_fake_camera_set_fill_pattern(fake, fill_pattern, nullptr);
  arv_fake_camera_write_register(fake, ARV_FAKE_CAMERA_REGISTER_WIDTH, scan.width);
  arv_fake_camera_write_register(fake, ARV_FAKE_CAMERA_REGISTER_HEIGHT, scan.height);
  arv_fake_camera_write_register(fake, ARV_FAKE_CAMERA_REGISTER_PIXEL_FORMAT, scan.pixel_format);
  arv_fake_camera_write_register(fake, ARV_FAKE_CAMERA_REGISTER_ACQUISITION_FRAME_PERIOD_US,
                                 static_cast<std::uint32_t>(1e6 / scan.frame_rate_hz));
  arv_fake_camera_write_register(fake, kCapabilityAddress, UINT32_MAX);
  arv_fake_camera_write_register(fake, kPixelFormatAddress + 4, scan.pixel_format);
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    const double scale = axis == 2 ? scan.scale_c : scan.scale_ab;
    const double offset = axis == 2 ? scan.offset_c : scan.offset_ab;
    const std::uint64_t be_scale = GUINT64_TO_BE(std::bit_cast<std::uint64_t>(scale));
    const std::uint64_t be_offset = GUINT64_TO_BE(std::bit_cast<std::uint64_t>(offset));
    arv_fake_camera_write_memory(fake, kScaleAddress + 8 * axis, 8, &be_scale);
    arv_fake_camera_write_memory(fake, kOffsetAddress + 8 * axis, 8, &be_offset);
  }
}

void FakeGigeCamera::write_register(std::uint32_t address, std::uint32_t value) {
  arv_fake_camera_write_register(arv_gv_fake_camera_get_fake_camera(camera_), address, value);
}

std::uint32_t FakeGigeCamera::component_format(std::uint32_t component) const {
  std::uint32_t format = 0;
  arv_fake_camera_read_register(fake(), kPixelFormatAddress + 4 * component, &format);
  return format;
}

}  // namespace dseam::test
