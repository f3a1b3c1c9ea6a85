// SPDX-License-Identifier: Apache-2.0
// rig_probe DOMAIN FILE: a witness next to a session, outside of it.  Writes each sample of the
// rig's truth to FILE, one line of text each, with the number of its writer, whatever the session's
// own recorder does.  Prints on standard output what the campaign waits for:
//
//   tick N                                 every 10 ticks
//   state S trial N start T duration D ramp R    each trial control; S: waiting, running, ...
//
// A line "pause", "start" or "stop" on its standard input is a request to the session, as the
// dashboard's buttons send it.  Ends with its standard input.
#include <array>
#include <cstdio>
#include <exception>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>

#include "idl/cdr.hpp"
#include "idl/control_loop.h"
#include "idl/session.h"
#include "idl/topics.hpp"
#include "places.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/remote_control.hpp"
#include "services/bus/tap.hpp"
#include "services/system/process/clock.hpp"
#include "services/system/process/real_time.hpp"

namespace {

using namespace stillhand;  // NOLINT(google-build-using-namespace): a program of one file

constexpr const char* kProfiles = STILLHAND_SOURCE "/qos/profiles.xml";
constexpr Tick kPrintEvery = 10;
constexpr std::array kStates{"waiting", "running", "ending", "paused"};

/// Each topic has a reader of its own, and one call runs at a time in each.
class Witness {
 public:
  Witness(std::uint32_t domain, const std::string& path) : file_(std::fopen(path.c_str(), "w")) {
    if (file_ == nullptr) throw std::runtime_error("cannot write " + path);
    std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);
    runtime::Tap::Options options;
    options.name = "rig_probe";
    options.domain = domain;
    options.profiles = kProfiles;
    options.wanted = [](const std::string& topic) {
      return topic == topics::kRigTruth.name || topic == topics::kTrialControl.name;
    };
    options.on_sample = [this](const runtime::FoundWriter& writer,
                               const runtime::TappedSample& sample) {
      if (writer.topic == topics::kRigTruth.name) {
        note_truth(sample);
      } else {
        print_control(sample);
      }
    };
    tap_ = std::make_unique<runtime::Tap>(std::move(options));
    tap_->start();
  }
  ~Witness() {
    tap_->stop();
    std::fclose(file_);
  }
  Witness(const Witness&) = delete;
  Witness& operator=(const Witness&) = delete;

 private:
  void note_truth(const runtime::TappedSample& sample) {
    stillhand_msgs::RigTruth m;
    if (!from_cdr(sample.bytes, m)) return;
    std::fprintf(file_, "%zu %lld %lld %.17g %lld %d %lld %.9g %.9g %.9g\n", sample.writer,
                 static_cast<long long>(m.tick()), static_cast<long long>(m.stamp_ns()),
                 m.motor_force_n(), static_cast<long long>(m.motor_tick()),
                 m.motor_permitted() ? 1 : 0, static_cast<long long>(m.command_tick()),
                 m.platform_position_m(), m.platform_velocity_m_s(),
                 m.platform_acceleration_m_s2());
    if (m.tick() % kPrintEvery != 0) return;
    std::fflush(file_);
    std::printf("tick %lld\n", static_cast<long long>(m.tick()));
  }

  static void print_control(const runtime::TappedSample& sample) {
    stillhand_msgs::TrialControl m;
    if (!from_cdr(sample.bytes, m)) return;
    const auto state = static_cast<std::size_t>(m.session());
    std::printf("state %s trial %d start %lld duration %lld ramp %lld\n",
                state < kStates.size() ? kStates.at(state) : "unknown", m.trial(),
                static_cast<long long>(m.start_tick()), static_cast<long long>(m.duration_ticks()),
                static_cast<long long>(m.ramp_ticks()));
  }

  std::FILE* file_;
  std::unique_ptr<runtime::Tap> tap_;
};

void follow_requests(std::uint32_t domain) {
  runtime::Bus bus(runtime::outsider("probe", domain, kProfiles, false));
  auto requests = bus.publisher<stillhand_msgs::SessionCommand>(topics::kSessionCommand);
  bus.start();
  for (std::string line; std::getline(std::cin, line);) {
    stillhand_msgs::SessionCommand command;
    command.request(static_cast<std::uint64_t>(runtime::monotonic_ns()));
    command.action(line == "pause"  ? stillhand_msgs::SESSION_PAUSE
                   : line == "stop" ? stillhand_msgs::SESSION_STOP
                                    : stillhand_msgs::SESSION_START);
    command.asker("campaign");
    requests.write(command);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "rig_probe: want DOMAIN FILE\n";
    return 2;
  }
  try {
    runtime::become_real_time();  // as the session, if it may
    const auto domain = static_cast<std::uint32_t>(std::stoul(argv[1]));
    const Witness witness(domain, argv[2]);
    follow_requests(domain);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "rig_probe: " << error.what() << '\n';
    return 1;
  }
}
