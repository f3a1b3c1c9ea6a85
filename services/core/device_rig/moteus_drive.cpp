// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/moteus_drive.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace stillhand::device_rig::moteus {
namespace {

constexpr double kNone = DriveReply::kNone;

// What every frame asks for: 9 bytes.
void put_query(FrameWriter& writer) noexcept {
  writer.read(Resolution::kInt8, kMode, 1);
  writer.read(Resolution::kInt32, kPosition, 3);
  writer.read(Resolution::kInt8, kVoltage, 3);
  writer.read(Resolution::kInt16, kAnalog1, 1);
  writer.read(Resolution::kInt16, kAnalog2, 1);
  writer.read(Resolution::kInt16, kMilliseconds, 1);
}

// A register that counts; nothing for a number that no int holds, which a float can be.
std::optional<int> whole_number(double value) noexcept {
  constexpr double kMost = std::numeric_limits<int>::max();
  if (!(std::abs(value) <= kMost)) return std::nullopt;
  return static_cast<int>(value);
}

DriveMode mode_of(int number) noexcept {
  switch (number) {
    case kStopped:
      return DriveMode::kOff;
    case kFaulted:
      return DriveMode::kFault;
    case kInPosition:
      return DriveMode::kTorque;
    case kTimedOut:
      return DriveMode::kTimedOut;
    default:
      return DriveMode::kOther;
  }
}

// The drive's mode and fault: without a number, the reply is not whole.
void take_mode(double value, DriveReply& reply, unsigned bit, unsigned& seen) noexcept {
  const auto number = whole_number(value);
  if (!number) return;
  reply.mode = mode_of(*number);
  seen |= bit;
}

void take_fault(double value, DriveReply& reply, unsigned bit, unsigned& seen) noexcept {
  const auto number = whole_number(value);
  reply.fault = number.value_or(0);
  if (number) seen |= bit;
}

void take(const FrameReader::Item& item, DriveReply& reply, unsigned& seen) noexcept {
  switch (item.address) {
    case kMode:
      take_mode(item.value, reply, 1u, seen);
      break;
    case kPosition:
      reply.position_rev = item.value;
      seen |= 2u;
      break;
    case kVelocity:
      reply.velocity_rev_s = item.value;
      seen |= 4u;
      break;
    case kTorque:
      reply.torque_n_m = item.value;
      seen |= 8u;
      break;
    case kVoltage:
      reply.voltage_v = item.value;
      break;
    case kTemperature:
      reply.temperature_c = item.value;
      break;
    case kFault:
      take_fault(item.value, reply, 16u, seen);
      break;
    case kAnalog1:
      reply.analog1 = item.value;
      break;
    case kAnalog2:
      reply.analog2 = item.value;
      break;
    case kMilliseconds:
      reply.milliseconds = whole_number(item.value).value_or(0);
      break;
    default:
      break;
  }
}

}  // namespace

Frame torque_frame(const TorqueCommand& command) noexcept {
  const double most_n_m =
      std::isfinite(command.max_torque_n_m) ? std::max(command.max_torque_n_m, 0.0) : 0.0;
  const double torque_n_m =
      std::isfinite(command.torque_n_m) ? std::clamp(command.torque_n_m, -most_n_m, most_n_m) : 0.0;
  Frame frame;
  FrameWriter writer(frame);
  // The mode comes first (registers.md); what is not written has a default that is not zero.
  writer.write(Resolution::kInt8, kMode, {kInPosition});
  writer.write(Resolution::kInt16, kCommandPosition, {kNone, 0.0});
  writer.write(Resolution::kFloat, kCommandTorque, {torque_n_m});
  writer.write(Resolution::kInt8, kCommandKpScale, {0.0, 0.0});
  writer.write(Resolution::kFloat, kCommandMaxTorque, {most_n_m});
  writer.write(Resolution::kFloat, kCommandTimeout, {command.watchdog_s});
  writer.write(Resolution::kInt8, kCommandIlimitScale, {0.0});
  put_query(writer);
  writer.pad();
  return frame;
}

Frame stop_frame() noexcept {
  Frame frame;
  FrameWriter writer(frame);
  writer.write(Resolution::kInt8, kMode, {kStopped});
  put_query(writer);
  writer.pad();
  return frame;
}

Frame query_frame() noexcept {
  Frame frame;
  FrameWriter writer(frame);
  put_query(writer);
  writer.pad();
  return frame;
}

DriveReply read_reply(std::span<const std::uint8_t> payload) noexcept {
  constexpr unsigned kAll = 31u;
  DriveReply reply;
  FrameReader reader(payload);
  unsigned seen = 0;
  while (const auto item = reader.next()) {
    if (item->kind == FrameReader::Kind::kValue) take(*item, reply, seen);
    if (item->kind == FrameReader::Kind::kWriteError ||
        item->kind == FrameReader::Kind::kReadError) {
      reply.refused = true;
    }
  }
  reply.whole = reader.sound() && seen == kAll && std::isfinite(reply.position_rev);
  return reply;
}

Frame serial_frame() noexcept {
  Frame frame;
  FrameWriter writer(frame);
  writer.read(Resolution::kInt32, kSerialNumber, SerialNumber{}.size());
  writer.pad();
  return frame;
}

std::optional<SerialNumber> read_serial(std::span<const std::uint8_t> payload) noexcept {
  SerialNumber serial{};
  unsigned seen = 0;
  FrameReader reader(payload);
  while (const auto item = reader.next()) {
    const std::uint32_t word = item->address - kSerialNumber;
    if (item->kind != FrameReader::Kind::kValue || word >= serial.size()) return std::nullopt;
    constexpr double kMost = 2147483648.0;  // all bits of a word are its own
    if (!(std::abs(item->value) <= kMost)) return std::nullopt;
    serial[word] = static_cast<std::uint32_t>(static_cast<std::int64_t>(item->value));
    seen |= 1u << word;
  }
  if (!reader.sound() || seen != 7u) return std::nullopt;
  return serial;
}

}  // namespace stillhand::device_rig::moteus
