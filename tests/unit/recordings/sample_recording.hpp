// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <string>

#include "idl/control_loop.h"
#include "idl/idl_text.hpp"
#include "idl/session.h"
#include "services/core/recording/mcap/mcap_writer.hpp"
#include "services/files/recording/file_io.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/session_file.hpp"

namespace stillhand::recordings {

/// Tests with a folder of their own, gone afterwards.
class FolderTest : public testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] std::size_t file_count() const { return folder_.entries(); }
  const support::Folder folder_;
};

inline constexpr std::uint64_t kSampleStart_ns = 1'795'272'703'845'833'285;
inline constexpr std::int64_t kSampleMessages = 200;

/// Sample number `n`, values that binary fractions hold.
inline stillhand_msgs::Sensed sample(std::int64_t n) {
  stillhand_msgs::Sensed message;
  message.rig(1);
  message.tick(n);
  message.force_n(0.25 * static_cast<double>(n));
  message.accel_y_m_s2(-0.5);
  return message;
}

inline stillhand_msgs::Event event(const std::string& text) {
  stillhand_msgs::Event message;
  message.kind(stillhand_msgs::EVENT_TICKS_LOST);
  message.source("recorder");
  message.text(text);
  return message;
}

/// 200 samples, 1 ms apart, without ticks 50 and 51; an event every 50; in chunks of about 1 kB.
/// @param close  false: as a crash leaves it
inline void write_sample(const std::string& path, bool close = true) {
  using namespace recording;
  FileSink sink(path, Existing::kReplace);
  McapWriter writer(sink, {1024, Compression::kZstd});
  bool ok = writer.add_metadata("stillhand.session", {{"seed", "7"}}).ok();
  const auto loop = writer.add_schema("stillhand_msgs::Sensed", "omgidl",
                                      topics::idl_of("stillhand_msgs::Sensed"));
  const auto session =
      writer.add_schema("stillhand_msgs::Event", "omgidl", topics::idl_of("stillhand_msgs::Event"));
  const auto sensed =
      writer.add_channel("stillhand/sensed", loop, "cdr", {{"qos_profile", "stream_1khz"}});
  const auto events = writer.add_channel("stillhand/event", session, "cdr");
  for (std::int64_t n = 0; n < kSampleMessages; ++n) {
    const auto time_ns = kSampleStart_ns + 1'000'000 * static_cast<std::uint64_t>(n);
    const auto number = static_cast<std::uint32_t>(n);
    const std::int64_t tick = n < 50 ? n : n + 2;
    ok = ok && writer.write(sensed, number, time_ns, time_ns - 5, to_cdr(sample(tick))).ok();
    if (n % 50 != 0) continue;
    const std::string text = n == 0 ? "plain" : "a \"quoted\", split\ntext";
    ok = ok && writer.write(events, number / 50, time_ns, time_ns, to_cdr(event(text))).ok();
  }
  ok = ok && (close ? writer.close() : writer.flush_chunk()).ok();
  ASSERT_TRUE(ok);
}

/// One topic of two writers, a channel each, taking turns; of each tick 2 is missing.
/// @param second_texts  metadata of the second one's channel
inline void write_two_writers(const std::string& path,
                              const recording::TextMap& second_texts = {{"writer", "second"}}) {
  using namespace recording;
  FileSink sink(path, Existing::kReplace);
  McapWriter writer(sink);
  const auto schema = writer.add_schema("stillhand_msgs::Sensed", "omgidl",
                                        topics::idl_of("stillhand_msgs::Sensed"));
  const auto first = writer.add_channel("stillhand/sensed", schema, "cdr", {{"writer", "first"}});
  const auto second = writer.add_channel("stillhand/sensed", schema, "cdr", second_texts);
  bool ok = true;
  std::uint64_t time_ns = kSampleStart_ns;
  for (const std::int64_t tick : {0, 1, 3}) {
    for (const auto channel : {first, second}) {
      ok = ok && writer.write(channel, 0, time_ns, time_ns, to_cdr(sample(tick))).ok();
      time_ns += 500'000;
    }
  }
  ASSERT_TRUE(ok && writer.close().ok());
}

}  // namespace stillhand::recordings
