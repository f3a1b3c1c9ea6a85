// SPDX-License-Identifier: Apache-2.0
// dashboard_load DOMAIN RIGS SECONDS: the seven 1 kHz topics of RIGS rigs, each rig a participant
// of its own, as sessions that run; prints how many messages of them were
// sent and by how much the worst tick was late.  Waits until everything has a reader.
// Used by dashboard_load.py.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "idl/control_loop.h"
#include "idl/session.h"
#include "places.hpp"
#include "services/bus/bus.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/system/process/real_time.hpp"
#include "tests/support/wait.hpp"

namespace {

using namespace stillhand;  // NOLINT(google-build-using-namespace): a program of one file

constexpr std::int64_t kPeriod_ns = 1'000'000;
constexpr std::int64_t kTopics = 7;
constexpr std::uint32_t kPhases = 4;  // the rigs of a phase write one after the other
constexpr Tick kStatusEvery = 100;

/// Without deadline, lifespan and liveliness, whose timers would wake a thread of this process at
/// each write: in a lab these are nine processes' on several machines.  A listener sees no other
/// samples.
const topics::Topic& plain(const topics::Topic& topic) {
  static std::map<std::string_view, topics::Topic> all;
  topics::Topic& row = all.emplace(topic.name, topic).first->second;
  row.pattern = topics::Pattern::kExchange;
  return row;
}

/// One rig's processes, as a listener sees them.
class Rig {
 public:
  Rig(std::uint32_t number, std::uint32_t domain) : bus_(options(number, domain)) { bus_.start(); }

  [[nodiscard]] bool heard() const {
    for (const auto& report : bus_.report()) {
      if (report.written && report.matched == 0) return false;
    }
    return true;
  }

  void begin() {
    stillhand_msgs::TrialControl running;
    running.session(stillhand_msgs::SESSION_RUNNING);
    running.trial(-1);
    control_.write(running);
  }

  void step(Tick tick) {
    stillhand_msgs::RawSample raw;
    raw.tick(tick);
    raw_.write(raw);
    stillhand_msgs::Sensed sensed;
    sensed.tick(tick);
    sensed.acquired_ns(raw.stamp_ns());
    sensed_.write(sensed);
    stillhand_msgs::MotorCommand command;
    command.tick(tick);
    command.acquired_ns(raw.stamp_ns());
    motor_.write(command);
    stillhand_msgs::TrackingSample tracking;
    tracking.tick(tick);
    tracking_.write(tracking);
    stillhand_msgs::OperatorForce force;
    force.tick(tick);
    operator_.write(force);
    stillhand_msgs::PlatformCommand platform;
    platform.tick(tick);
    platform_.write(platform);
    stillhand_msgs::RigTruth truth;
    truth.tick(tick);
    truth.motor_tick(tick - 1);
    truth_.write(truth);
    if (tick % kStatusEvery == 0) {
      stillhand_msgs::ServiceStatus status;
      status.service("rig");
      status.state(stillhand_msgs::SERVICE_RUNNING);
      status_.write(status);
    }
  }

 private:
  static runtime::Bus::Options options(std::uint32_t number, std::uint32_t domain) {
    runtime::Bus::Options options;
    options.service = "rig";
    options.rig = number;
    options.domain = domain;
    options.profiles =
        std::getenv("LOADXML") ? std::getenv("LOADXML") : STILLHAND_SOURCE "/qos/profiles.xml";
    return options;
  }

  runtime::Bus bus_;
  runtime::Publisher<stillhand_msgs::RawSample> raw_ =
      bus_.publisher<stillhand_msgs::RawSample>(plain(topics::kRawSample));
  runtime::Publisher<stillhand_msgs::Sensed> sensed_ =
      bus_.publisher<stillhand_msgs::Sensed>(plain(topics::kSensed));
  runtime::Publisher<stillhand_msgs::MotorCommand> motor_ =
      bus_.publisher<stillhand_msgs::MotorCommand>(plain(topics::kMotorCommand));
  runtime::Publisher<stillhand_msgs::TrackingSample> tracking_ =
      bus_.publisher<stillhand_msgs::TrackingSample>(plain(topics::kTrackingSample));
  runtime::Publisher<stillhand_msgs::OperatorForce> operator_ =
      bus_.publisher<stillhand_msgs::OperatorForce>(plain(topics::kOperatorForce));
  runtime::Publisher<stillhand_msgs::PlatformCommand> platform_ =
      bus_.publisher<stillhand_msgs::PlatformCommand>(plain(topics::kPlatformCommand));
  runtime::Publisher<stillhand_msgs::RigTruth> truth_ =
      bus_.publisher<stillhand_msgs::RigTruth>(plain(topics::kRigTruth));
  runtime::Publisher<stillhand_msgs::ServiceStatus> status_ =
      bus_.publisher<stillhand_msgs::ServiceStatus>(topics::kServiceStatus);
  runtime::Publisher<stillhand_msgs::TrialControl> control_ =
      bus_.publisher<stillhand_msgs::TrialControl>(topics::kTrialControl);
};

int publish(std::uint32_t domain, std::uint32_t rigs, Tick ticks) {
  std::vector<std::unique_ptr<Rig>> all;
  for (std::uint32_t rig = 1; rig <= rigs; ++rig) all.push_back(std::make_unique<Rig>(rig, domain));
  const auto heard = [](const auto& rig) { return rig->heard(); };
  if (!support::eventually([&] { return std::ranges::all_of(all, heard); })) {
    throw std::runtime_error("no dashboard on the domain within 20 s");
  }
  for (const auto& rig : all) rig->begin();
  // Made after its own threads, which keep their ordinary priority.
  runtime::become_real_time();
  const std::int64_t begin_ns = runtime::monotonic_ns();
  std::int64_t worst_ns = 0;
  for (Tick tick = 0; tick < ticks; ++tick) {
    for (std::uint32_t phase = 0; phase < kPhases; ++phase) {
      const std::int64_t due_ns = begin_ns + tick * kPeriod_ns + phase * kPeriod_ns / kPhases;
      runtime::sleep_until_ns(due_ns);
      worst_ns = std::max(worst_ns, runtime::monotonic_ns() - due_ns);
      for (std::uint32_t rig = phase; rig < rigs; rig += kPhases) all[rig]->step(tick);
    }
  }
  const double took_s = static_cast<double>(runtime::monotonic_ns() - begin_ns) / 1e9;
  std::cout << "sent " << ticks * rigs * kTopics << " messages in " << took_s
            << " s, worst tick late by " << worst_ns / 1000 << " us" << std::endl;
  // The writers stay until the count has been read.
  std::cin.get();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 4) {
      std::cerr << "dashboard_load: want DOMAIN RIGS SECONDS\n";
      return 2;
    }
    return publish(static_cast<std::uint32_t>(std::stoul(argv[1])),
                   static_cast<std::uint32_t>(std::stoul(argv[2])), std::stoll(argv[3]) * 1000);
  } catch (const std::exception& error) {
    std::cerr << "dashboard_load: " << error.what() << '\n';
    return 1;
  }
}
