// SPDX-License-Identifier: Apache-2.0
// Usage: publish_samples --domain N
// Four 1 kHz topics on the bus until SIGTERM: what tests/benchmark/kill_recorder.py records. Prints
// the monotonic time of tick 0 [ns]; tick n is written n ms later, by an absolute schedule.
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "idl/control_loop.h"
#include "places.hpp"
#include "services/bus/bus.hpp"
#include "services/system/process/clock.hpp"
#include "services/system/process/stop.hpp"

int main(int argc, char** argv) {
  using namespace stillhand;
  if (argc != 3 || std::strcmp(argv[1], "--domain") != 0) {
    std::fputs("usage: publish_samples --domain N\n", stderr);
    return 2;
  }
  try {
    runtime::Stop stop;
    runtime::Bus::Options options;
    options.service = "rig";
    options.domain = static_cast<std::uint32_t>(std::strtoul(argv[2], nullptr, 10));
    options.profiles = STILLHAND_SOURCE "/qos/profiles.xml";
    runtime::Bus bus(options);
    auto raw = bus.publisher<stillhand_msgs::RawSample>(topics::kRawSample);
    auto truth = bus.publisher<stillhand_msgs::RigTruth>(topics::kRigTruth);
    auto sensed = bus.publisher<stillhand_msgs::Sensed>(topics::kSensed);
    auto command = bus.publisher<stillhand_msgs::MotorCommand>(topics::kMotorCommand);
    bus.start();
    const std::int64_t start_ns = runtime::monotonic_ns();
    std::printf("%lld\n", static_cast<long long>(start_ns));
    std::fflush(stdout);
    const auto write = [](auto& publisher, auto message, Tick tick) {
      message.tick(tick);
      publisher.write(message);
    };
    for (Tick tick = 0; !stop.requested(); ++tick) {
      runtime::sleep_until_ns(start_ns + tick * 1'000'000);
      write(raw, stillhand_msgs::RawSample{}, tick);
      write(truth, stillhand_msgs::RigTruth{}, tick);
      write(sensed, stillhand_msgs::Sensed{}, tick);
      write(command, stillhand_msgs::MotorCommand{}, tick);
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "publish_samples: %s\n", error.what());
    return 1;
  }
}
