// SPDX-License-Identifier: Apache-2.0
// stranger DOMAIN reads|writes|pushes|forges|misleads|conducts [NAME]
// A program that belongs to no lab, next to a session: plain Fast DDS, without a certificate.  It
// reads topics of the catalogue, every one with "reads".  With "writes" it writes two of them: it
// asks the motor for 40 N and announces the end of the session, a hundred times a second.  With
// "pushes" it asks for 25 N, the motor's limit, a thousand times a second, each time in answer to
// the newest sample.  With "forges" it reports a hundred times a second, in the rig's name, a tick
// far behind the end of every trial and an open interlock.  With "misleads" it says in the
// recorder's name that another file is the recording.  With "conducts" it names the sources of
// every process of a session, itself as the experiment.  NAME is that of its participant
// [stranger].  After SIGTERM it prints how many messages it received, and how many readers its
// writers have had.
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <deque>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "idl/control_loop.h"
#include "idl/session.h"
#include "idl/topics.hpp"
#include "places.hpp"
#include "services/bus/participant.hpp"
#include "services/bus/source.hpp"
#include "services/bus/sources_codec.hpp"
#include "services/bus/type_tag.hpp"
#include "services/system/process/clock.hpp"
#include "services/system/process/stop.hpp"
#include "tests/support/wait.hpp"

namespace {

namespace runtime = stillhand::runtime;
namespace edds = runtime::edds;
namespace topics = stillhand::topics;

std::atomic<long> received{0};
std::atomic<long> readers{0};
std::atomic<std::int64_t> newest_tick{-1};

struct Reading final : edds::DataReaderListener {
  explicit Reading(edds::TypeSupport type_) : type(std::move(type_)), data(type.create_data()) {}
  ~Reading() override { type.delete_data(data); }
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;
  void on_data_available(edds::DataReader* reader) override {
    edds::SampleInfo info;
    while (runtime::ok(reader->take_next_sample(data, &info))) {
      if (!info.valid_data) continue;
      ++received;
      if (type.get_type_name() == topics::kRawSample.type) {
        newest_tick = static_cast<stillhand_msgs::RawSample*>(data)->tick();
      }
    }
  }
  edds::TypeSupport type;
  void* data;
};

struct Writing final : edds::DataWriterListener {
  void on_publication_matched(edds::DataWriter* /*writer*/,
                              const edds::PublicationMatchedStatus& status) override {
    if (status.current_count_change > 0) readers += status.current_count_change;
  }
};

struct Stranger {
  Stranger(std::uint32_t domain, const std::string& name)
      : participant(runtime::create_participant(STILLHAND_SOURCE "/qos/profiles.xml", domain, name,
                                                false, {}, nullptr)),
        subscriber(participant->create_subscriber(edds::SUBSCRIBER_QOS_DEFAULT)),
        publisher(participant->create_publisher(edds::PUBLISHER_QOS_DEFAULT)) {}
  ~Stranger() {
    participant->delete_contained_entities();
    edds::DomainParticipantFactory::get_instance()->delete_participant(participant);
  }
  Stranger(const Stranger&) = delete;
  Stranger& operator=(const Stranger&) = delete;

  edds::Topic* topic(const topics::Topic& row) {
    const std::string name(row.name);
    if (edds::TopicDescription* known = participant->lookup_topicdescription(name)) {
      return static_cast<edds::Topic*>(known);
    }
    runtime::find_type(row.type)->support.register_type(participant);
    return participant->create_topic(name, std::string(row.type), edds::TOPIC_QOS_DEFAULT);
  }
  void read(const topics::Topic& row) {
    Reading& listener = listening.emplace_back(runtime::find_type(row.type)->support);
    subscriber->create_datareader_with_profile(topic(row), std::string(topics::profile_of(row)),
                                               &listener);
  }
  edds::DataWriter* writer(const topics::Topic& row) {
    return publisher->create_datawriter_with_profile(
        topic(row), std::string(topics::profile_of(row)), &telling);
  }

  // Listeners outlive the readers and writers that call them.
  std::deque<Reading> listening;
  Writing telling;
  edds::DomainParticipant* participant;
  edds::Subscriber* subscriber;
  edds::Publisher* publisher;
};

void write_two_topics(Stranger& stranger, const runtime::Stop& stop) {
  edds::DataWriter* motor = stranger.writer(topics::kMotorCommand);
  edds::DataWriter* control = stranger.writer(topics::kTrialControl);
  stillhand_msgs::MotorCommand push;
  push.rig(1);
  push.force_n(40.0);
  stillhand_msgs::TrialControl end;
  end.rig(1);
  end.session(stillhand_msgs::SESSION_ENDING);
  while (!stop.requested()) {
    push.tick(push.tick() + 1);
    motor->write(&push);
    control->write(&end);
    stillhand::support::eventually([&] { return stop.requested(); }, std::chrono::milliseconds(10));
  }
}

void forge_the_rig(Stranger& stranger, const runtime::Stop& stop) {
  edds::DataWriter* statuses = stranger.writer(topics::kServiceStatus);
  edds::DataWriter* events = stranger.writer(topics::kEvent);
  stillhand_msgs::ServiceStatus status;
  status.rig(1);
  status.service("rig");
  status.state(stillhand_msgs::SERVICE_RUNNING);
  status.tick(1'000'000'000);
  stillhand_msgs::Event opened;
  opened.rig(1);
  opened.source("rig");
  opened.kind(stillhand_msgs::EVENT_INTERLOCK_OPENED);
  opened.text("a forged reason");
  while (!stop.requested()) {
    statuses->write(&status);
    events->write(&opened);
    stillhand::support::eventually([&] { return stop.requested(); }, std::chrono::milliseconds(10));
  }
}

void mislead_about_the_recording(Stranger& stranger, const runtime::Stop& stop) {
  edds::DataWriter* events = stranger.writer(topics::kEvent);
  stillhand_msgs::Event note;
  note.rig(1);
  note.source("recorder");
  note.kind(stillhand_msgs::EVENT_NOTE);
  note.text(std::string(topics::kRecordingNote) + "/etc/hostname");
  while (!stop.requested()) {
    events->write(&note);
    stillhand::support::eventually([&] { return stop.requested(); }, std::chrono::milliseconds(10));
  }
}

void conduct(Stranger& stranger, const runtime::Stop& stop) {
  edds::DataWriter* sources = stranger.writer(topics::kSessionSources);
  std::vector<runtime::Source> named;
  for (const std::string_view service : topics::kServices) {
    named.push_back({std::string(service), {}});
  }
  runtime::Source& experiment = named.back();
  std::copy_n(&stranger.participant->guid().guidPrefix.value[0], experiment.participant.size(),
              experiment.participant.begin());
  auto message = runtime::to_idl(named);
  message.rig(1);
  sources->write(&message);
  stop.wait();
}

void push_the_motor(Stranger& stranger, const runtime::Stop& stop) {
  constexpr std::int64_t kPeriod_ns = 1'000'000;
  edds::DataWriter* motor = stranger.writer(topics::kMotorCommand);
  stillhand_msgs::MotorCommand push;
  push.rig(1);
  push.force_n(25.0);
  for (std::int64_t due_ns = runtime::monotonic_ns(); !stop.requested(); due_ns += kPeriod_ns) {
    runtime::sleep_until_ns(due_ns);
    push.tick(newest_tick);
    push.stamp_ns(runtime::monotonic_ns());
    motor->write(&push);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  runtime::Stop stop;
  {
    const std::string_view what = argv[2];
    Stranger stranger(static_cast<std::uint32_t>(std::stoul(argv[1])),
                      argc > 3 ? argv[3] : "stranger");
    const bool writes = what == "writes";
    const bool pushes = what == "pushes";
    for (const topics::Topic* row : topics::kCatalogue) {
      const bool its_own = (row == &topics::kMotorCommand && (writes || pushes)) ||
                           (row == &topics::kTrialControl && writes);
      if (what == "reads" || ((writes || pushes) && !its_own)) stranger.read(*row);
    }
    if (writes) {
      write_two_topics(stranger, stop);
    } else if (what == "forges") {
      forge_the_rig(stranger, stop);
    } else if (what == "misleads") {
      mislead_about_the_recording(stranger, stop);
    } else if (what == "conducts") {
      conduct(stranger, stop);
    } else if (pushes) {
      push_the_motor(stranger, stop);
    } else {
      stop.wait();
    }
  }
  std::printf("received %ld, heard by %ld\n", received.load(), readers.load());
  return 0;
}
