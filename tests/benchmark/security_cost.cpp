// SPDX-License-Identifier: Apache-2.0
// The cost of DDS Security, next to the same without (qos/README.md).
// build/tests/security_cost [ROUNDS]
// Each round, 5 by default: 4000 samples at 1 kHz from sensing's bus to another process
// and back as motor commands, then the start of a whole session's nine processes at once; without
// security, as configured, and with everything encrypted.  Every process asks for SCHED_FIFO, as a
// lab's do.  Medians over the rounds; ratios are of one round.
#include <algorithm>
#include <array>
#include <cstdio>
#include <iostream>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "idl/clock.h"
#include "idl/control_loop.h"
#include "idl/model.h"
#include "idl/session.h"
#include "places.hpp"
#include "services/bus/bus.hpp"
#include "services/system/process/real_time.hpp"
#include "services/system/process/stop.hpp"
#include "tests/support/child.hpp"
#include "tests/support/motion_and_rig.hpp"
#include "tests/support/security_folder.hpp"
#include "tests/support/wait.hpp"

namespace {

using namespace stillhand;  // NOLINT(google-build-using-namespace): a program of one file
namespace fs = std::filesystem;

constexpr std::size_t kSamples = 4000;
constexpr std::int64_t kPeriod_ns = 1'000'000;

runtime::Bus::Options options_of(const std::string& service, const fs::path& security,
                                 const std::string& domain) {
  runtime::Bus::Options options;
  options.service = service;
  options.domain = static_cast<std::uint32_t>(std::stoul(domain));
  options.profiles = STILLHAND_SOURCE "/qos/profiles.xml";
  options.security = security;
  return options;
}

/// The canceller's place: answers every sample at once.
int echo(const std::string& domain, const fs::path& security) {
  runtime::Stop stop;
  runtime::Bus bus(options_of("cancellation", security, domain));
  auto commands = bus.publisher<stillhand_msgs::MotorCommand>(topics::kMotorCommand);
  bus.subscribe<stillhand_msgs::Sensed>(topics::kSensed,
                                        [&](const stillhand_msgs::Sensed& sample, const auto&) {
                                          stillhand_msgs::MotorCommand command;
                                          command.tick(sample.tick());
                                          command.acquired_ns(sample.acquired_ns());
                                          commands.write(command);
                                        });
  bus.start();
  stop.wait();
  bus.stop_receiving();
  return 0;
}

template <typename Message>
void open(runtime::Bus& bus, const topics::Topic& topic) {
  const auto has = [&bus](std::span<const std::string_view> names) {
    return std::find(names.begin(), names.end(), bus.options().service) != names.end();
  };
  if (has(topic.writers)) bus.publisher<Message>(topic);
  if (has(topic.readers)) bus.subscribe<Message>(topic, [](const auto&, const auto&) {});
}

/// One service of a session, without its work: says when every peer has matched.
int member(const std::string& service, const std::string& domain, const fs::path& security) {
  using namespace stillhand_msgs;  // NOLINT(google-build-using-namespace): as above
  runtime::Stop stop;
  auto options = options_of(service, security, domain);
  options.serialized = service == "recorder";
  runtime::Bus bus(options);
  open<PlatformCommand>(bus, topics::kPlatformCommand);
  open<RawSample>(bus, topics::kRawSample);
  open<RigTruth>(bus, topics::kRigTruth);
  open<Sensed>(bus, topics::kSensed);
  open<MotorCommand>(bus, topics::kMotorCommand);
  open<TrackingSample>(bus, topics::kTrackingSample);
  open<OperatorForce>(bus, topics::kOperatorForce);
  open<Pointer>(bus, topics::kPointer);
  open<TrialControl>(bus, topics::kTrialControl);
  open<TrialAssignment>(bus, topics::kTrialAssignment);
  open<FeedthroughModel>(bus, topics::kFeedthroughModel);
  open<AugmentedModel>(bus, topics::kAugmentedModel);
  open<Event>(bus, topics::kEvent);
  open<ServiceStatus>(bus, topics::kServiceStatus);
  open<ClockQuestion>(bus, topics::kClockQuestion);
  open<ClockAnswer>(bus, topics::kClockAnswer);
  open<ClockOffset>(bus, topics::kClockOffset);
  open<HostStatus>(bus, topics::kHostStatus);
  bus.start();
  if (!support::eventually([&] { return stop.requested() || bus.missing_peers().empty(); },
                           std::chrono::minutes(2))) {
    std::fprintf(stderr, "security_cost: a peer is missing after 2 minutes\n");
    return 1;
  }
  std::printf("%lld\n", static_cast<long long>(runtime::monotonic_ns()));
  std::fflush(stdout);
  stop.wait();
  return 0;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

struct RoundTrip {
  double p50_us = 0.0, p99_us = 0.0;
};

/// The rig's and sensing's place: prints the round trip's p50 and p99 [us].
int clock_it(const std::string& domain, const fs::path& security) {
  runtime::Bus sensing(options_of("sensing", security, domain));
  runtime::Bus rig(options_of("rig", security, domain));
  auto samples = sensing.publisher<stillhand_msgs::Sensed>(topics::kSensed);
  std::array<std::atomic<std::int64_t>, kSamples> trips_ns{};
  std::atomic<int> answered{0};
  rig.subscribe<stillhand_msgs::MotorCommand>(
      topics::kMotorCommand, [&](const stillhand_msgs::MotorCommand& command, const auto& arrival) {
        const auto tick = static_cast<std::size_t>(command.tick());
        if (tick < kSamples) trips_ns[tick] = arrival.received_ns - command.acquired_ns();
        ++answered;
      });
  sensing.start();
  rig.start();
  stillhand_msgs::Sensed sample;
  sample.tick(static_cast<Tick>(kSamples));
  if (!support::eventually([&] {
        samples.write(sample);
        return answered > 0;
      })) {
    throw std::runtime_error("the echo did not answer within 20 s");
  }
  std::int64_t due_ns = runtime::monotonic_ns();
  for (std::size_t tick = 0; tick < kSamples; ++tick) {
    due_ns += kPeriod_ns;
    runtime::sleep_until_ns(due_ns);
    sample.tick(static_cast<Tick>(tick));
    sample.acquired_ns(runtime::monotonic_ns());
    samples.write(sample);
  }
  // The last answers; one lost on its way is no reason to wait longer.
  support::eventually([&] { return trips_ns[kSamples - 1] != 0; }, std::chrono::seconds(1));
  std::vector<std::int64_t> trips;
  for (const auto& trip_ns : trips_ns) {
    if (trip_ns != 0) trips.push_back(trip_ns);
  }
  if (trips.size() < kSamples / 2) throw std::runtime_error("most answers were lost");
  std::sort(trips.begin(), trips.end());
  const auto at = [&trips](double share) {
    const auto index = static_cast<std::size_t>(share * static_cast<double>(trips.size()));
    return static_cast<double>(trips[index]) * 1e-3;
  };
  std::printf("%f %f\n", at(0.5), at(0.99));
  return 0;
}

// Processes of its own: others find a secured process's first participants alone (qos/profiles.xml,
// maxInitialPeersRange).
RoundTrip round_trip(const fs::path& self, const fs::path& security, const fs::path& scratch) {
  const std::string domain = std::to_string(support::own_domain());
  const support::Child canceller({self, "--echo", domain, security}, scratch / "echo");
  const support::Child rig({self, "--clock", domain, security}, scratch / "clock");
  RoundTrip trip;
  const bool told =
      support::eventually([&] { return rig.output().ends_with('\n'); }, std::chrono::seconds(40));
  if (!told || !(std::istringstream(rig.output()) >> trip.p50_us >> trip.p99_us)) {
    throw std::runtime_error("no round trip was measured");
  }
  return trip;
}

/// [s] infinite when not all had matched within 20 s.
double matching_s(const fs::path& self, const fs::path& security, const fs::path& scratch) {
  const std::string domain = std::to_string(support::own_domain());
  const std::int64_t began_ns = runtime::monotonic_ns();
  std::vector<std::unique_ptr<support::Child>> members;
  for (const std::string_view service : topics::kServices) {
    members.push_back(std::make_unique<support::Child>(
        std::vector<std::string>{self, "--member", std::string(service), domain, security},
        scratch / service));
  }
  std::int64_t last_ns = 0;
  for (const auto& each : members) {
    if (!support::eventually([&] { return each->output().ends_with('\n'); },
                             std::chrono::seconds(20))) {
      return std::numeric_limits<double>::infinity();
    }
    last_ns = std::max<std::int64_t>(last_ns, std::stoll(each->output()));
  }
  return static_cast<double>(last_ns - began_ns) * 1e-9;
}

int measure(const fs::path& self, int rounds) {
  const auto& folders = support::SecurityFolders::get();
  const fs::path all_encrypted = folders.copy_of_lab("all-encrypted");
  support::SecurityFolders::shell(
      "cd " + all_encrypted.string() +
      " && openssl smime -verify -text -in governance.p7s -CAfile authority.pem -out rules.xml "
      "2>log && "
      "sed -i 's/>SIGN</>ENCRYPT</' rules.xml && openssl smime -sign -text -in rules.xml -out "
      "governance.p7s -signer authority.pem -inkey " +
      folders.authority_key(all_encrypted).string());
  const std::vector<std::pair<const char*, fs::path>> kinds{
      {"without", ""}, {"as configured", folders.lab()}, {"all encrypted", all_encrypted}};
  const fs::path scratch = all_encrypted.parent_path() / "output";
  fs::create_directory(scratch);
  std::map<std::string, std::vector<double>> figures;
  for (int round = 0; round < rounds; ++round) {
    RoundTrip plain;
    double plain_s = 0.0;
    for (const auto& [name, folder] : kinds) {
      const RoundTrip trip = round_trip(self, folder, scratch);
      const double matched_s = matching_s(self, folder, scratch);
      if (folder.empty()) {
        plain = trip;
        plain_s = matched_s;
      }
      const std::string kind(name);
      figures[kind + " p50"].push_back(trip.p50_us);
      figures[kind + " p99"].push_back(trip.p99_us);
      figures[kind + " ratio"].push_back(trip.p50_us / plain.p50_us);
      figures[kind + " match"].push_back(matched_s);
      figures[kind + " match ratio"].push_back(matched_s / plain_s);
    }
  }
  std::printf("%-14s %10s %10s %8s %12s %8s %12s\n", "security", "p50 [us]", "p99 [us]", "ratio",
              "matched [s]", "ratio", "worst [s]");
  for (const auto& [name, folder] : kinds) {
    const std::string kind(name);
    const auto& matched = figures[kind + " match"];
    std::printf(
        "%-14s %10.0f %10.0f %8.2f %12.2f %8.2f %12.2f\n", name, median(figures[kind + " p50"]),
        median(figures[kind + " p99"]), median(figures[kind + " ratio"]), median(matched),
        median(figures[kind + " match ratio"]), *std::max_element(matched.begin(), matched.end()));
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> given(argv + 1, argv + argc);
  try {
    if (!runtime::become_real_time()) std::cerr << "security_cost: without SCHED_FIFO\n";
    if (given.size() == 3 && given[0] == "--echo") return echo(given[1], given[2]);
    if (given.size() == 3 && given[0] == "--clock") return clock_it(given[1], given[2]);
    if (given.size() == 4 && given[0] == "--member") return member(given[1], given[2], given[3]);
    return measure(fs::canonical("/proc/self/exe"), given.empty() ? 5 : std::stoi(given[0]));
  } catch (const std::exception& error) {
    std::cerr << "security_cost: " << error.what() << '\n';
    return 1;
  }
}
