// SPDX-License-Identifier: Apache-2.0
// Usage: fuzz_seeds DIR
// Writes a folder for each reader: inputs that our own writers make, for fuzzers to start from.
#include <filesystem>
#include <fstream>
#include <string>

#include "apps/experiment/folder/sealed_assignment.hpp"
#include "apps/libraries/experiment/file/experiment_file.hpp"
#include "apps/libraries/experiment/file/journal.hpp"
#include "idl/model.h"
#include "services/core/recording/mcap/mcap_writer.hpp"
#include "services/core/recording/messages/schema_types.hpp"
#include "services/files/cancellation/control_model_file.hpp"
#include "services/files/identification/model_file.hpp"
#include "services/messages/cancellation/codec.hpp"
#include "tests/support/cdr_bytes.hpp"
#include "tests/support/memory_bytes.hpp"
#include "tests/support/session_file.hpp"

namespace {

using namespace stillhand;
namespace fs = std::filesystem;

void write(const fs::path& file, std::string_view bytes) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << bytes;
}

std::string mcap_of(recording::Compression compression) {
  using namespace recording;
  MemorySink sink;
  McapWriter writer(sink, {.chunk_bytes = 512, .compression = compression});
  static_cast<void>(writer.add_metadata("session", {{"seed", "1"}}));
  const auto schema =
      writer.add_schema("m::S", kSchemaEncoding, "module m { struct S { double x; }; };");
  const auto channel = writer.add_channel("s", schema, kMessageEncoding, {{"rig", "1"}});
  for (std::uint32_t n = 0; n < 40; ++n) {
    const std::array<std::byte, 12> message{std::byte{0}, std::byte{1}};
    static_cast<void>(writer.write(channel, n, 1000u * n, 1000u * n + 1, message));
  }
  static_cast<void>(writer.close());
  return {reinterpret_cast<const char*>(sink.bytes().data()), sink.bytes().size()};
}

std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// As fuzz_cdr.cpp and fuzz_model.cpp read it: the place of the type, then the message.
template <typename Message>
std::string cdr_of(char place, const Message& message) {
  return place + text_of(to_cdr(message));
}

// The definition of sensor_msgs/msg/Imu, and one message of it.
const std::string kImu = tests::imu_definition();
tests::CdrBytes imu(std::int32_t second) {
  tests::CdrBytes message;
  message.put(second).put(std::uint32_t{250}).text("imu");
  for (int i = 0; i < 4 + 9 + 3 + 9 + 3 + 9; ++i) message.put(0.5 + i);
  return message;
}

std::string bag() {
  using namespace recording;
  MemorySink sink;
  McapWriter writer(sink,
                    {.chunk_bytes = 512, .compression = Compression::kNone, .profile = "ros2"});
  const auto schema = writer.add_schema("sensor_msgs/msg/Imu", kRos2SchemaEncoding, kImu);
  const auto channel = writer.add_channel("/imu", schema, kMessageEncoding);
  for (std::int32_t n = 0; n < 4; ++n) {
    const auto time_ns = static_cast<std::uint64_t>(n) * 1'000'000'000;
    static_cast<void>(writer.write(channel, 0, time_ns, time_ns, imu(n).bytes()));
  }
  static_cast<void>(writer.close());
  return text_of(sink.bytes());
}

// A pegged trial and one of tracking.
std::string session_recording() {
  tests::SessionFile file(2048, recording::Compression::kNone);
  file.assignment(0, stillhand_msgs::MOTION_BAND_NOISE, false);
  file.control(0, stillhand_msgs::PHASE_PEGGED, 0, 60);
  for (int tick = 0; tick < 60; ++tick) file.sensed(tick);
  file.assignment(1, stillhand_msgs::MOTION_STILL, true);
  file.control(1, stillhand_msgs::PHASE_TRACKING, 60, 60);
  for (int tick = 60; tick < 120; ++tick) {
    file.sensed(tick);
    file.tracking(tick);
  }
  return text_of(file.close());
}

std::string table() {
  std::string text =
      "map:\n  - zeit=t [ms]\n  - 'Kraft [mV]=f [mV] / 22.5 [mV/N]'\n  - '#2=a_y [g]'\n"
      "separator: semicolon\ndecimal: comma\n";
  text += '\0';
  text += "zeit;acc;Kraft [mV]\n";
  for (int n = 0; n < 60; ++n) text += std::to_string(10 * n) + ";0,5;-1,25e1\n";
  return text;
}

std::string design() {
  experiment::Design design;
  design.instructions = {"Keep the cursor in the box."};
  design.questions = {
      {"effort", experiment::Question::After::kBlock, "How hard was it?", "easy", "hard", 7}};
  return experiment::yaml_of(design);
}

std::string journal() {
  using experiment::EntryKind;
  std::string lines;
  for (const EntryKind kind : {EntryKind::kSessionBegan, EntryKind::kTrialEnded,
                               EntryKind::kQuestionAnswered, EntryKind::kSessionEnded}) {
    experiment::Entry entry{.kind = kind, .time = "2026-11-25T05:50:00Z", .session = 1};
    entry.answer = 3;
    entry.dwell_ratio = 0.25;
    lines += experiment::line_of(entry) + "\n";
  }
  return lines;
}

cancellation::ControlModel every_part() {
  cancellation::ControlModel model;
  model.rate_hz = 1000.0;
  model.denominator = {1.0, -0.9};
  model.inputs = {{cancellation::Channel::kAccelY, {}, {0.3, 0.0}},
                  {cancellation::Channel::kAccelX, {-1.0, 1.0, {-1.0, 1.0}}, {0.1, 0.0}}};
  model.loop = cancellation::LoopPath{{0.0, 0.1}, {}, {}, {-1.0, 1.0, {-0.1, 0.1}}};
  model.paths = {{cancellation::Channel::kOmega, 0.01, {-1.0, 1.0, {-1.0, 1.0}}, 0.5}};
  model.waves = {{std::nullopt, 3.0, 0.2, 0.1}};
  model.hysteresis = {{std::nullopt, signal::HysteresisOperator::kStop, 0.2, -1.0, 1.0},
                      {0, signal::HysteresisOperator::kDahl, 0.5, -2.0, 2.0}};
  model.adapts = cancellation::HandCompliance{1.5, 30.0, 900.0, 0.1};
  return model;
}

identification::FeedthroughModel linear() {
  identification::FeedthroughModel model;
  model.fit = {50.0, {3.0, 0.1, 0.2, 0.1, 0.0}, {1.0, -0.5, 0.1, 0.0, 0.0}};
  model.control = {1000.0, {3.0, 0.1}, {1.0, -0.5}};
  return model;
}

void write_messages(const fs::path& cdr) {
  write(cdr / "motor", cdr_of(0, stillhand_msgs::MotorCommand{}));
  write(cdr / "sensed", cdr_of(1, stillhand_msgs::Sensed{}));
  write(cdr / "trial", cdr_of(2, stillhand_msgs::TrialControl{}));
  stillhand_msgs::FeedthroughModel fit;
  fit.fit_numerator(std::vector<double>(5, 1.0));
  write(cdr / "model", cdr_of(3, fit));
  write(cdr / "augmented", cdr_of(4, cancellation::to_idl(every_part(), 1)));
  stillhand_msgs::ServiceStatus status;
  status.topics().resize(2);
  status.topics()[0].topic("stillhand/sensed");
  write(cdr / "status", cdr_of(5, status));
  write(cdr / "event", cdr_of(6, stillhand_msgs::Event{}));
}

void write_models(const fs::path& model) {
  write(model / "augmented", cdr_of(0, cancellation::to_idl(every_part(), 1)));
  const auto plain = linear();
  stillhand_msgs::FeedthroughModel identified;
  identified.control_rate_hz(plain.control.rate_hz);
  identified.control_numerator(plain.control.numerator);
  identified.control_denominator(plain.control.denominator);
  write(model / "identified", cdr_of(1, identified));
}

void write_requests(const fs::path& http) {
  write(http / "get",
        "GET /snapshot?at=1.5 HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer "
        "token-to-act\r\n\r\n");
  write(http / "post",
        "POST /stop HTTP/1.1\r\nHost: localhost\r\nOrigin: http://localhost\r\n"
        "Authorization: Bearer token-to-act\r\nContent-Length: 2\r\n\r\n{}");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const fs::path out = argv[1];
  write(out / "mcap/none", mcap_of(recording::Compression::kNone));
  write(out / "mcap/lz4", mcap_of(recording::Compression::kLz4));
  write(out / "mcap/zstd", mcap_of(recording::Compression::kZstd));
  write(out / "bag/ros2", bag());
  write(out / "bag/session", session_recording());
  write(out / "json/linear", identification::model_json(linear()));
  write(out / "json/control", cancellation::control_model_json(every_part(), 1));
  write_messages(out / "cdr");
  write_models(out / "model");
  write_requests(out / "http");
  write(out / "csv/recording",
        "t [s],a_y [m/s^2],\"f [N]\",temp [degC]\n0,0.1,-0.3,20\n0.01,0.2,-0.6,20.5\n"
        "0.02,0.3,-0.9,21\r\n0.05,-1e-3,0.003,21\n");
  write(out / "table/mapped", table());
  write(out / "ros2msg/imu", kImu + '\0' + text_of(imu(7).bytes()));
  write(out / "experiment/design", design());
  write(out / "experiment/journal", journal());
  write(out / "experiment/sealed", experiment::sealed_text(424242));
  write(out / "device/line", "rcv 100 2404000a005000000170ff230d181400 *19\nOK\n");
  return 0;
}
