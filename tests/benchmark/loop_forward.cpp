// SPDX-License-Identifier: Apache-2.0
// loop_forward SECONDS DOMAIN [PROFILES]: the control loop without its content, on plain Fast DDS.
// Three processes with the QoS profiles, types and threads of rig, sensing and
// cancellation: a raw sample at 1 kHz becomes a sensed sample and a motor command, and comes back.
// Prints latencies from the raw sample's stamp as one JSON object [us].  Used by loop_latency.py.
#include <semaphore.h>

#include <array>
#include <atomic>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "fast_dds/names.hpp"
#include "idl/control_loopPubSubTypes.h"
#include "idl/topics.hpp"
#include "places.hpp"
#include "services/bus/participant.hpp"
#include "services/system/process/clock.hpp"
#include "services/system/process/real_time.hpp"
#include "services/system/process/stop.hpp"
#include "tests/benchmark/loop_figures.hpp"
#include "tests/support/child.hpp"
#include "tests/support/wait.hpp"

namespace {

using namespace stillhand;  // NOLINT(google-build-using-namespace): a program of one file
namespace edds = runtime::edds;
using runtime::monotonic_ns;
using runtime::ok;

constexpr std::int64_t kPeriod_ns = 1'000'000;
constexpr std::int64_t kWait_ns = 900'000;  // of the rig for its answer, from the tick on

/// A participant of the lab's profile.
class Participant {
 public:
  Participant(std::uint32_t domain, const std::string& profiles) {
    runtime::load_profiles(profiles);
    auto* factory = edds::DomainParticipantFactory::get_instance();
    participant_ = factory->create_participant_with_profile(domain, "stillhand_participant");
    if (participant_ == nullptr) throw std::runtime_error("Fast DDS created no participant");
  }
  ~Participant() {
    participant_->delete_contained_entities();
    edds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  edds::DataWriter* writer(const topics::Topic& topic, const edds::TypeSupport& type,
                           edds::DataWriterListener& listener) {
    auto* publisher = participant_->create_publisher(edds::PUBLISHER_QOS_DEFAULT);
    return publisher->create_datawriter_with_profile(
        dds_topic(topic, type), std::string(topics::profile_of(topic)), &listener);
  }
  void reader(const topics::Topic& topic, const edds::TypeSupport& type,
              edds::DataReaderListener& listener) {
    auto* subscriber = participant_->create_subscriber(edds::SUBSCRIBER_QOS_DEFAULT);
    subscriber->create_datareader_with_profile(
        dds_topic(topic, type), std::string(topics::profile_of(topic, "rig")), &listener);
  }

 private:
  edds::Topic* dds_topic(const topics::Topic& topic, const edds::TypeSupport& type) {
    type.register_type(participant_);
    return participant_->create_topic(std::string(topic.name), std::string(topic.type),
                                      edds::TOPIC_QOS_DEFAULT);
  }
  edds::DomainParticipant* participant_ = nullptr;
};

template <typename Message, typename Call>
struct OnSample final : edds::DataReaderListener {
  explicit OnSample(Call then) : call(std::move(then)) {}
  void on_data_available(edds::DataReader* reader) override {
    edds::SampleInfo info;
    while (ok(reader->take_next_sample(&message, &info))) {
      if (info.valid_data) call(message);
    }
  }
  Call call;
  Message message;
};

/// A process that answers each In with an Out at once.
template <typename In, typename InType, typename Out, typename OutType>
int forward(std::uint32_t domain, const std::string& profiles, const topics::Topic& from,
            const topics::Topic& to) {
  runtime::Stop stop;
  Participant participant(domain, profiles);
  edds::DataWriterListener quiet;
  edds::DataWriter* out = participant.writer(to, edds::TypeSupport(new OutType()), quiet);
  Out answer;
  answer.rig(1);
  const auto call = [&](const In& message) {
    answer.tick(message.tick());
    if constexpr (requires { message.acquired_ns(); }) {
      answer.acquired_ns(message.acquired_ns());
    } else {
      answer.acquired_ns(message.stamp_ns());
    }
    answer.stamp_ns(monotonic_ns());
    out->write(&answer);
  };
  OnSample<In, decltype(call)> listener(call);
  participant.reader(from, edds::TypeSupport(new InType()), listener);
  stop.wait();
  return 0;
}

/// The rig's place: its loop waits for each answer, as the rig's does.
class Clock {
 public:
  Clock(std::uint32_t domain, const std::string& profiles, std::size_t ticks)
      : participant_(domain, profiles), answers_(ticks + 1) {
    sem_init(&arrived_, 0, 0);
    raw_ = participant_.writer(
        topics::kRawSample, edds::TypeSupport(new stillhand_msgs::RawSamplePubSubType()), quiet_);
    participant_.reader(topics::kMotorCommand,
                        edds::TypeSupport(new stillhand_msgs::MotorCommandPubSubType()), listener_);
  }

  nlohmann::json run() {
    stillhand_msgs::RawSample raw;
    raw.rig(1);
    const auto write = [&](std::int64_t tick) {
      raw.tick(tick);
      raw.stamp_ns(monotonic_ns());
      raw_->write(&raw);
    };
    if (!support::eventually([&] { return write(0), answered_.load() >= 0; })) {
      throw std::runtime_error("no answer within 20 s");
    }
    std::vector<std::int64_t> used;
    std::int64_t due_ns = monotonic_ns();
    for (std::size_t tick = 1; tick < answers_.size(); ++tick) {
      due_ns += kPeriod_ns;
      runtime::sleep_until_ns(due_ns);
      write(static_cast<std::int64_t>(tick));
      if (wait_for(static_cast<std::int64_t>(tick), due_ns + kWait_ns)) {
        used.push_back(monotonic_ns() - raw.stamp_ns());
      }
    }
    std::vector<std::int64_t> command, received;
    for (const Answer& answer : answers_) {
      if (answer.received_ns == 0) continue;
      command.push_back(answer.command_ns);
      received.push_back(answer.received_ns);
    }
    return {{"ticks", answers_.size() - 1},
            {"command", benchmark::figures(command)},
            {"received", benchmark::figures(received)},
            {"used", benchmark::figures(used)}};
  }

 private:
  struct Answer {
    std::int64_t command_ns = 0, received_ns = 0;  ///< after the raw sample's stamp
  };

  void on_command(const stillhand_msgs::MotorCommand& command) {
    const auto tick = static_cast<std::size_t>(command.tick());
    if (tick > 0 && tick < answers_.size()) {
      answers_[tick] = {command.stamp_ns() - command.acquired_ns(),
                        monotonic_ns() - command.acquired_ns()};
    }
    answered_.store(command.tick());
    sem_post(&arrived_);
  }
  bool wait_for(std::int64_t tick, std::int64_t until_ns) {
    const timespec until{until_ns / runtime::kNsPerSecond, until_ns % runtime::kNsPerSecond};
    while (answered_.load() < tick) {
      if (sem_clockwait(&arrived_, CLOCK_MONOTONIC, &until) != 0) return false;
    }
    return true;
  }

  struct Call {
    Clock& clock;
    void operator()(const stillhand_msgs::MotorCommand& command) const {
      clock.on_command(command);
    }
  };

  edds::DataWriterListener quiet_;
  OnSample<stillhand_msgs::MotorCommand, Call> listener_{Call{*this}};
  Participant participant_;
  edds::DataWriter* raw_ = nullptr;
  std::vector<Answer> answers_;
  std::atomic<std::int64_t> answered_{-1};
  sem_t arrived_{};
};

int measure(const std::string& seconds, const std::string& domain, const std::string& profiles) {
  using namespace stillhand_msgs;  // NOLINT(google-build-using-namespace): as above
  const std::filesystem::path self = std::filesystem::canonical("/proc/self/exe");
  const support::Child sensing({self, "--sensing", domain, profiles}, "/dev/null");
  const support::Child cancellation({self, "--cancellation", domain, profiles}, "/dev/null");
  Clock clock(static_cast<std::uint32_t>(std::stoul(domain)), profiles,
              static_cast<std::size_t>(std::stod(seconds) * 1000.0));
  std::cout << clock.run() << '\n';
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace stillhand_msgs;  // NOLINT(google-build-using-namespace): as above
  const std::vector<std::string> given(argv + 1, argv + argc);
  try {
    if (given.size() < 2) {
      std::cerr << "usage: loop_forward SECONDS DOMAIN [PROFILES]\n";
      return 2;
    }
    const std::string profiles =
        given.size() > 2 ? given[2] : std::string(STILLHAND_SOURCE "/qos/profiles.xml");
    if (!runtime::become_real_time()) std::cerr << "loop_forward: without SCHED_FIFO\n";
    const auto domain = static_cast<std::uint32_t>(std::stoul(given[1]));
    if (given[0] == "--sensing") {
      return forward<RawSample, RawSamplePubSubType, Sensed, SensedPubSubType>(
          domain, profiles, topics::kRawSample, topics::kSensed);
    }
    if (given[0] == "--cancellation") {
      return forward<Sensed, SensedPubSubType, MotorCommand, MotorCommandPubSubType>(
          domain, profiles, topics::kSensed, topics::kMotorCommand);
    }
    return measure(given[0], given[1], profiles);
  } catch (const std::exception& error) {
    std::cerr << "loop_forward: " << error.what() << '\n';
    return 1;
  }
}
