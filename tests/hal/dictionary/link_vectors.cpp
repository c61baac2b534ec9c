// SPDX-License-Identifier: Apache-2.0
// Writes what check_dictionary.py compares with weld-link.dbc: random messages as the codec encodes
// them, one JSON object a line, and the log of a simulated weld.
//   link_vectors messages OUT.jsonl | link_vectors weld OUT.log [classic]
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iomanip>
#include <string>
#include <vector>

#include "dseam/base/random.hpp"
#include "dseam/hal/candump/recording_bus.hpp"
#include "dseam/link/codec.hpp"
#include "hal/sim_robot/cell.hpp"

namespace dseam {
namespace {

using Signals = std::vector<std::pair<std::string, double>>;

/// Protects and writes messages through one transmitter, as a running link does.
class Writer {
 public:
  explicit Writer(const char* path) : out_(path) { out_ << std::setprecision(17); }

  void write(link::MessageId message, const link::Frame& payload, const Signals& signals) {
    frames_.clear();
    if (!transmitter_.send(message, payload, frames_)) {
      return;
    }
    const link::Frame& frame = frames_[0];
    out_ << "{\"id\": " << frame.id << ", \"data\": \"" << std::hex << std::setfill('0');
    for (const std::byte byte : frame.bytes()) {
      out_ << std::setw(2) << std::to_integer<int>(byte);
    }
    out_ << std::dec << "\", \"signals\": {";
    for (const auto& [name, value] : signals) {
      out_ << (name == signals.front().first ? "" : ", ") << '"' << name << "\": " << value;
    }
    out_ << "}}\n";
  }

 private:
  std::ofstream out_;
  link::Transmitter transmitter_{{}};
  std::vector<link::Frame> storage_ = std::vector<link::Frame>(4);
  Buffer<link::Frame> frames_{storage_};
};

/// One random value of each kind.
class Dice {
 public:
  std::uint32_t u32() { return random_.next(); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(random_.below(0x10000)); }
  std::uint8_t u8() { return static_cast<std::uint8_t>(random_.below(0x100)); }
  std::uint64_t u48() { return (std::uint64_t{u16()} << 32U) | u32(); }
  bool coin() { return random_.below(2) == 1; }
  template <typename Enum>
  Enum one_of(std::uint32_t count) {
    return static_cast<Enum>(random_.below(count));
  }
  double real(double low, double high) { return low + (high - low) * random_.uniform(); }
  torch::TorchPose pose() {
    torch::TorchPose pose;
    pose.p_base = {real(-2e6, 2e6), real(-3000, 3000), real(-3000, 3000)};
    pose.q_base_torch =
        Eigen::Quaterniond(real(-1, 1), real(-1, 1), real(-1, 1), real(-1, 1)).normalized();
    return pose;
  }

 private:
  Pcg32 random_{2};
};

double number(auto value) { return static_cast<double>(value); }

void add_pose(Signals& signals, const std::string& prefix, const torch::TorchPose& pose) {
  const Eigen::Quaterniond& q = pose.q_base_torch;
  const Signals more = {{prefix + "X", pose.p_base.x()}, {prefix + "Y", pose.p_base.y()},
                        {prefix + "Z", pose.p_base.z()}, {prefix + "Qw", q.w()},
                        {prefix + "Qx", q.x()},          {prefix + "Qy", q.y()},
                        {prefix + "Qz", q.z()}};
  signals.insert(signals.end(), more.begin(), more.end());
}

void write_orders(Writer& out, Dice& dice) {
  const link::Abort abort{dice.u32(), dice.one_of<link::Fault>(link::kFaultCount)};
  out.write(link::MessageId::kAbort, link::encode(abort),
            {{"AB_Reason", number(abort.reason)}, {"AB_Session", abort.session}});
  const link::Command command{dice.u32(), dice.one_of<link::Request>(link::kRequestCount),
                              dice.coin(), dice.u16(), dice.u48()};
  out.write(link::MessageId::kCommand, link::encode(command),
            {{"CMD_Request", number(command.request)},
             {"CMD_WeldPermit", number(command.weld_permit)},
             {"CMD_TrajId", command.trajectory},
             {"CMD_Session", command.session},
             {"CMD_HostTime", number(command.host_time_us)}});
  const link::TrajectoryMark mark{dice.u32(),       dice.one_of<link::TrajectoryKind>(2),
                                  dice.u16(),       dice.u32(),
                                  dice.u32(),       dice.u32(),
                                  dice.real(0, 4e6)};
  out.write(link::MessageId::kTrajectory, link::encode(mark),
            {{"TR_Kind", number(mark.kind)},
             {"TR_TrajId", mark.trajectory},
             {"TR_Session", mark.session},
             {"TR_Count", mark.count},
             {"TR_PointCrc", mark.crc},
             {"TR_Duration", mark.duration_us},
             {"TR_Length", mark.length_mm}});
}

void write_answers(Writer& out, Dice& dice) {
  const link::Status status{dice.u32(),  dice.one_of<link::RobotState>(link::kRobotStateCount),
                            dice.coin(), dice.u16(),
                            dice.u16(),  dice.u16(),
                            dice.u16(),  dice.u16(),
                            dice.u16(),  dice.one_of<link::Fault>(link::kFaultCount),
                            dice.u48(),  {dice.coin(), dice.coin(), dice.coin()}};
  out.write(link::MessageId::kStatus, link::encode(status),
            {{"ST_State", number(status.state)},
             {"ST_ArcOn", number(status.arc_on)},
             {"ST_Enabled", number(status.condition.enabled)},
             {"ST_ProtectiveStop", number(status.condition.protective_stop)},
             {"ST_EmergencyStop", number(status.condition.emergency_stop)},
             {"ST_AckSeq", status.ack_seq},
             {"ST_VerifiedSeq", status.verified_seq},
             {"ST_ExecSeq", status.exec_seq},
             {"ST_Credit", status.credit},
             {"ST_BufferMs", status.buffer_ms},
             {"ST_TrajId", status.trajectory},
             {"ST_Fault", number(status.fault)},
             {"ST_RobotTime", number(status.robot_time_us)},
             {"ST_Session", status.session}});
  const link::Nack nack{dice.u32(), dice.u16(), dice.u16(),
                        dice.one_of<link::NackReason>(link::kNackReasonCount)};
  out.write(link::MessageId::kNack, link::encode(nack),
            {{"NK_Reason", number(nack.reason)},
             {"NK_TrajId", nack.trajectory},
             {"NK_ExpectedSeq", nack.expected_seq},
             {"NK_Session", nack.session}});
  link::PoseReport pose{dice.u32(),        dice.u48(), dice.pose(),
                        dice.real(0, 655), dice.u16(), dice.coin()};
  Signals signals = {{"PO_ArcOn", number(pose.arc_on)},
                     {"PO_RobotTime", number(pose.robot_time_us)},
                     {"PO_ExecSeq", pose.exec_seq},
                     {"PO_Speed", pose.speed_mm_s},
                     {"PO_Session", pose.session}};
  add_pose(signals, "PO_", pose.pose);
  out.write(link::MessageId::kPose, link::encode(pose).value(), signals);
}

void write_point(Writer& out, Dice& dice) {
  link::Point point{dice.u32(), dice.u16(), dice.u16(), dice.coin(), dice.coin(), {}};
  trajectory::SetPoint& p = point.set_point;
  p.t_us = dice.u32();
  p.pose = dice.pose();
  p.s_mm = dice.real(0, 4e6);
  p.speed_mm_s = dice.real(0, 655);
  p.wire_feed_m_min = dice.real(0, 655);
  p.voltage_v = dice.real(0, 655);
  p.segment = dice.one_of<torch::Segment>(7);
  p.arc = dice.coin();
  p.gas = dice.coin();
  p.wire = dice.coin();
  p.pass = dice.u8();
  p.schedule = dice.u8();
  Signals signals = {{"PT_First", number(point.first)},
                     {"PT_Last", number(point.last)},
                     {"PT_Arc", number(p.arc)},
                     {"PT_Gas", number(p.gas)},
                     {"PT_Wire", number(p.wire)},
                     {"PT_Segment", number(p.segment)},
                     {"PT_TrajId", point.trajectory},
                     {"PT_Seq", point.seq},
                     {"PT_Time", p.t_us},
                     {"PT_Speed", p.speed_mm_s},
                     {"PT_WireFeed", p.wire_feed_m_min},
                     {"PT_Voltage", p.voltage_v},
                     {"PT_Schedule", p.schedule},
                     {"PT_Pass", p.pass},
                     {"PT_ArcLength", p.s_mm},
                     {"PT_Session", point.session}};
  add_pose(signals, "PT_", p.pose);
  out.write(link::MessageId::kPoint, link::encode(point).value(), signals);
}

void write_greetings(Writer& out, Dice& dice) {
  for (const bool robot : {false, true}) {
    const std::string prefix = robot ? "HR_" : "HH_";
    const link::Hello hello{dice.u32(), dice.u8(), dice.u32(),       dice.u16(),
                            dice.u16(), dice.u8(), dice.real(0, 655)};
    out.write(robot ? link::MessageId::kHelloRobot : link::MessageId::kHelloHost,
              link::encode(hello),
              {{prefix + "Version", hello.version},
               {prefix + "Session", hello.session},
               {prefix + "DictionaryCrc", hello.dictionary_crc},
               {prefix + "BufferPoints", hello.buffer_points},
               {prefix + "MinPeriod", hello.min_period_us},
               {prefix + "SilenceLimit", hello.silence_limit_ms},
               {prefix + "MaxSpeed", hello.max_speed_mm_s}});
  }
}

int write_messages(const char* path) {
  Writer out(path);
  Dice dice;
  for (int i = 0; i < 300; ++i) {
    write_orders(out, dice);
    write_answers(out, dice);
    write_point(out, dice);
    write_greetings(out, dice);
  }
  return 0;
}

int write_weld(const char* path, bool classic) {
  hal::fake::ManualClock clock(1'000'000'000);
  hal::sim::SimBus::Config bus_config;
  bus_config.fd = !classic;
  hal::sim::SimBus bus(bus_config, clock);
  hal::candump::RecordingBus recorded(bus.connect(), clock, "sim0");
  link::Sender::Config host;
  host.addressing.classic = classic;
  hal::sim::SimRobot::Config robot_config;
  robot_config.receiver.addressing.classic = classic;
  hal::sim::SimRobot robot(robot_config, bus.connect());
  hal::LinkPort port(recorded);
  link::Sender sender = link::Sender::make(host).value();
  const auto points = test::round_weld(300, 10'000);

  auto progress = link::WeldProgress::kUnderWay;
  while (progress == link::WeldProgress::kUnderWay) {
    clock.advance(test::LinkCell::kStepNs);
    progress = link::give_next_order(sender, {5, 1, points, true}, clock.now_ns());
    port.turn(sender, clock.now_ns());
    robot.step(clock.now_ns());
  }
  sender.abort(link::Fault::kAborted, clock.now_ns());
  port.turn(sender, clock.now_ns());
  std::FILE* log = std::fopen(path, "w");
  const bool written = log != nullptr && recorded.flush(log).ok();
  return written && std::fclose(log) == 0 && progress == link::WeldProgress::kDone ? 0 : 1;
}

}  // namespace
}  // namespace dseam

int main(int argc, char** argv) {
  if (argc == 3 && std::strcmp(argv[1], "messages") == 0) {
    return dseam::write_messages(argv[2]);
  }
  if (argc >= 3 && std::strcmp(argv[1], "weld") == 0) {
    return dseam::write_weld(argv[2], argc == 4);
  }
  return 2;
}
