// SPDX-License-Identifier: Apache-2.0
// The real bus on loopback: nothing that the loop carries depends on a system clock.  A writer's
// host has one of its own, which may be wrong and may be set at any time; DDS puts it into each
// sample.
#include <gtest/gtest.h>

#include <atomic>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>

#include "idl/control_loop.h"
#include "places.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/participant.hpp"
#include "services/bus/type_tag.hpp"
#include "tests/support/bus_options.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/wait.hpp"

namespace stillhand::runtime {
namespace {

using stillhand_msgs::MotorCommand;
using support::eventually;

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kHour = 3600 * kNsPerSecond;

/// Writes motor commands of rig 1, with the profile and a system clock that is wrong.
class Writer : public edds::DataWriterListener {
 public:
  Writer()
      : participant_(create_participant(STILLHAND_SOURCE "/qos/profiles.xml", support::own_domain(),
                                        "stillhand/1/cancellation", false, {}, nullptr)) {
    const topics::Topic& row = topics::kMotorCommand;
    type_tag<MotorCommand>().support.register_type(participant_);
    edds::Topic* topic = participant_->create_topic(std::string(row.name), std::string(row.type),
                                                    edds::TOPIC_QOS_DEFAULT);
    writer_ =
        participant_->create_publisher(edds::PUBLISHER_QOS_DEFAULT)
            ->create_datawriter_with_profile(topic, std::string(topics::profile_of(row)), this);
  }
  ~Writer() override {
    participant_->delete_contained_entities();
    edds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  void write(Tick tick, std::int64_t ahead_ns) {
    MotorCommand command;
    command.rig(1);
    command.tick(tick);
    const std::int64_t stamp_ns = system_ns() + ahead_ns;
    writer_->write_w_timestamp(&command, edds::HANDLE_NIL,
                               edds::Time_t(static_cast<std::int32_t>(stamp_ns / kNsPerSecond),
                                            static_cast<std::uint32_t>(stamp_ns % kNsPerSecond)));
  }

 private:
  edds::DomainParticipant* participant_;
  edds::DataWriter* writer_ = nullptr;
};

TEST(ClockStepsTest, ASampleArrivesWhateverTheClockOfItsWriterSays) {
  std::atomic<Tick> newest{-1};
  std::atomic<std::int64_t> stamped_ns{0};
  Bus reader(support::bus_options("rig"));
  reader.subscribe<MotorCommand>(topics::kMotorCommand,
                                 [&](const MotorCommand& message, const Arrival& arrival) {
                                   newest = message.tick();
                                   stamped_ns = arrival.source_ns;
                                 });
  reader.start();
  Writer writer;
  ASSERT_TRUE(eventually([&] { return reader.report().front().matched == 1; }));
  Tick tick = 0;
  // Right, then each step of a clock: behind, far behind, far ahead, and back.
  for (const std::int64_t ahead_ns : {std::int64_t{0}, -25 * kMs, -kHour, kHour, -25 * kMs}) {
    const Tick first = tick;
    EXPECT_TRUE(eventually([&] {
      writer.write(++tick, ahead_ns);
      return newest > first;
    })) << ahead_ns;
    // The stamp was the wrong clock's: to a minute, which no test takes.
    EXPECT_LT(std::abs(stamped_ns - system_ns() - ahead_ns), 60 * kNsPerSecond) << ahead_ns;
  }
}

}  // namespace
}  // namespace stillhand::runtime
