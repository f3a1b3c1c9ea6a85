// SPDX-License-Identifier: Apache-2.0
// Usage: fuzz_seeds DIR
// Writes DIR/mcap, DIR/json and DIR/cdr: inputs that our own writers make, for fuzzers to start
// from.
#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "idl/control_loop.h"
#include "idl/model.h"
#include "idl/session.h"
#include "services/cancellation/control_model_file.hpp"
#include "services/identification/model_file.hpp"
#include "services/recording/core/mcap/mcap_writer.hpp"
#include "services/recording/core/mcap/memory_bytes.hpp"

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

// As fuzz_cdr.cpp reads it: the place of the type, then the message.
template <typename Message>
std::string cdr_of(char place, const Message& message) {
  std::string bytes(4096, '\0');
  eprosima::fastcdr::FastBuffer buffer(bytes.data(), bytes.size());
  eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS,
                             eprosima::fastcdr::Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  message.serialize(cdr);
  return place + bytes.substr(0, cdr.getSerializedDataLength());
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
  model.adapts = cancellation::HandCompliance{1.5, 30.0, 900.0, 0.1};
  return model;
}

identification::FeedthroughModel linear() {
  identification::FeedthroughModel model;
  model.fit = {50.0, {3.0, 0.1, 0.2, 0.1, 0.0}, {1.0, -0.5, 0.1, 0.0, 0.0}};
  model.control = {1000.0, {3.0, 0.1}, {1.0, -0.5}};
  return model;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const fs::path out = argv[1];
  write(out / "mcap/none", mcap_of(recording::Compression::kNone));
  write(out / "mcap/lz4", mcap_of(recording::Compression::kLz4));
  write(out / "mcap/zstd", mcap_of(recording::Compression::kZstd));
  write(out / "json/linear", identification::model_json(linear()));
  write(out / "json/control", cancellation::control_model_json(every_part(), 1));
  write(out / "cdr/motor", cdr_of(0, stillhand_msgs::MotorCommand{}));
  write(out / "cdr/sensed", cdr_of(1, stillhand_msgs::Sensed{}));
  write(out / "cdr/trial", cdr_of(2, stillhand_msgs::TrialControl{}));
  stillhand_msgs::FeedthroughModel fit;
  fit.fit_numerator(std::vector<double>(5, 1.0));
  write(out / "cdr/model", cdr_of(3, fit));
  stillhand_msgs::AugmentedModel augmented;
  augmented.inputs().resize(2);
  augmented.inputs()[1].numerator({1.0, 2.0});
  write(out / "cdr/augmented", cdr_of(4, augmented));
  stillhand_msgs::ServiceStatus status;
  status.topics().resize(2);
  status.topics()[0].topic("stillhand/sensed");
  write(out / "cdr/status", cdr_of(5, status));
  write(out / "cdr/event", cdr_of(6, stillhand_msgs::Event{}));
  write(out / "http/get",
        "GET /snapshot?at=1.5 HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer token\r\n\r\n");
  write(out / "http/post",
        "POST /stop HTTP/1.1\r\nHost: localhost\r\nOrigin: http://localhost\r\n"
        "Authorization: Bearer token\r\nContent-Length: 2\r\n\r\n{}");
  write(out / "csv/recording",
        "t [s],a_y [m/s^2],\"f [N]\",temp [degC]\n0,0.1,-0.3,20\n0.01,0.2,-0.6,20.5\n"
        "0.02,0.3,-0.9,21\r\n0.05,-1e-3,0.003,21\n");
  return 0;
}
