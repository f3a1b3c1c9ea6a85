// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "idl/control_loop.h"
#include "idl/model.h"
#include "idl/session.h"
#include "places.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/sources_codec.hpp"
#include "services/core/cancellation/parts/recipe.hpp"
#include "services/messages/cancellation/codec.hpp"
#include "services/system/process/clock.hpp"
#include "tests/support/bus_options.hpp"
#include "tests/support/child.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/wait.hpp"

namespace stillhand {

inline constexpr const char* kProfiles = STILLHAND_SOURCE "/qos/profiles.xml";
inline constexpr std::int32_t kTrial = 1;
inline constexpr std::int32_t kModel = 3;
inline constexpr double kPosition_s2 = -0.003;  // m per m/s^2

inline std::vector<std::string> words_of(const std::string& service) {
  std::vector<std::string> words{STILLHAND_BUILD "/bin/stillhand-" + service,
                                 "--domain",
                                 std::to_string(support::own_domain()),
                                 "--profiles",
                                 kProfiles,
                                 "--config",
                                 STILLHAND_SOURCE "/deploy/config"};
  if (service == "display") words.emplace_back("--headless");
  return words;
}

inline std::filesystem::path output_of(const std::string& service) {
  return std::filesystem::temp_directory_path() /
         ("stillhand-mitigation-" + service + std::to_string(getpid()));
}

// A process that is not there, but shows its life sign.
struct Stand {
  explicit Stand(const std::string& name) : bus(support::bus_options(name)) {
    status.service(name);
    status.state(stillhand_msgs::SERVICE_RUNNING);
    life = bus.publisher<stillhand_msgs::ServiceStatus>(topics::kServiceStatus);
  }
  runtime::Bus bus;
  stillhand_msgs::ServiceStatus status;
  runtime::Publisher<stillhand_msgs::ServiceStatus> life;
};

/// Cancellation and display on the real bus; the test stands for all other processes.
class MitigationProcessTest : public testing::Test {
 protected:
  MitigationProcessTest() {
    for (const std::string_view name : topics::kServices) {
      if (name == "cancellation" || name == "display") continue;
      stands_[std::string(name)] = std::make_unique<Stand>(std::string(name));
    }
    control_ = of("experiment").publisher<stillhand_msgs::TrialControl>(topics::kTrialControl);
    sources_ = of("experiment").publisher<stillhand_msgs::SessionSources>(topics::kSessionSources);
    assignment_ =
        of("experiment").publisher<stillhand_msgs::TrialAssignment>(topics::kTrialAssignment);
    model_ =
        of("identification").publisher<stillhand_msgs::FeedthroughModel>(topics::kFeedthroughModel);
    sensed_ = of("sensing").publisher<stillhand_msgs::Sensed>(topics::kSensed);
    of("recorder")
        .subscribe<stillhand_msgs::MotorCommand>(topics::kMotorCommand,
                                                 [this](const auto& message, const auto&) {
                                                   const std::lock_guard lock(mutex_);
                                                   commands_.push_back(message);
                                                 });
    of("recorder")
        .subscribe<stillhand_msgs::TrackingSample>(topics::kTrackingSample,
                                                   [this](const auto& message, const auto&) {
                                                     const std::lock_guard lock(mutex_);
                                                     tracking_.push_back(message);
                                                   });
    of("recorder")
        .subscribe<stillhand_msgs::ServiceStatus>(topics::kServiceStatus,
                                                  [this](const auto& message, const auto&) {
                                                    if (message.service() != "cancellation") return;
                                                    const std::lock_guard lock(mutex_);
                                                    armed_ = message.armed_trial();
                                                  });
    of("recorder")
        .subscribe<stillhand_msgs::Event>(topics::kEvent, [this](const auto& message, const auto&) {
          const bool note = message.kind() == stillhand_msgs::EVENT_NOTE;
          if (!note || message.source() != "cancellation") return;
          const std::lock_guard lock(mutex_);
          notes_.insert(message.text().c_str());
        });
    for (auto& [name, stand] : stands_) stand->bus.start();
  }
  ~MitigationProcessTest() override {
    cancellation_.finish();
    display_.finish();
    of("recorder").stop_receiving();
  }

  runtime::Bus& of(const std::string& name) { return stands_.at(name)->bus; }

  // Both children are found, and everybody's source is named.
  bool name_sources() {
    const std::vector<runtime::Source> found = of("experiment").sources_found();
    if (found.size() < topics::kServices.size()) return false;
    auto message = runtime::to_idl(found);
    sources_.write(message);
    return true;
  }

  // One tick: the sample, and every 100 the life signs.
  void step() {
    ++tick_;
    stillhand_msgs::Sensed message;
    message.tick(tick_);
    const double t = 1e-3 * static_cast<double>(tick_);
    message.accel_y_m_s2(2.0 * std::sin(2.0 * std::numbers::pi * 1.3 * t));
    message.accel_z_m_s2(9.81);
    message.theta_rad(0.05 * std::sin(2.0 * std::numbers::pi * 0.4 * t));
    sensed_.write(message);
    samples_[tick_] = message;
    if (tick_ % 50 == 0) {
      for (auto& [name, stand] : stands_) stand->life.write(stand->status);
    }
    runtime::sleep_until_ns(due_ns_ += 1'000'000);
  }
  bool step_until(const std::function<bool()>& condition, int limit) {
    for (int n = 0; n < limit; ++n) {
      if (condition()) return true;
      step();
    }
    return false;
  }

  stillhand_msgs::FeedthroughModel model_of(bool to_position, double gain, double pole) {
    stillhand_msgs::FeedthroughModel model;
    model.to_position(to_position);
    model.model(kModel);
    model.usable(true);
    model.control_rate_hz(1000.0);
    model.control_numerator({gain * (1.0 - pole), 0.0});
    model.control_denominator({1.0, -pole});
    return model;
  }
  /// @param pole  of a lag in front of it; 0: none
  void publish_position_model(double gain_s2, double pole = 0.0) {
    auto model = model_of(true, gain_s2, pole);
    model_.write(model);
  }
  /// And waits until f^ is of this model: an assignment, of another writer, may overtake it.
  void publish_force_model(double gain_n_s2_m) {
    auto model = model_of(false, gain_n_s2_m, 0.0);
    model_.write(model);
    ASSERT_TRUE(step_until([this] { return newest_command().model() == kModel; }, 10'000));
    for (Tick n = 0; n < cancellation::Config{}.fade_ticks; ++n) step();
  }
  void add_part(stillhand_msgs::MitigationPartKind kind, const std::vector<double>& values = {}) {
    parts_.emplace_back().kind(kind);
    parts_.back().values(values);
  }
  void begin_trial(std::int32_t trial = kTrial, Tick duration_ticks = 10'000,
                   bool cancellation = false) {
    stillhand_msgs::TrialAssignment assignment;
    assignment.trial(trial);
    assignment.cancellation(cancellation);
    if (!parts_.empty()) assignment.mitigation("test");
    assignment.parts(parts_);
    assignment_.write(assignment);
    stillhand_msgs::TrialControl control;
    control.session(stillhand_msgs::SESSION_RUNNING);
    control.trial(trial);
    control.phase(stillhand_msgs::PHASE_TRACKING);
    control.start_tick(tick_ + 1000);
    control.duration_ticks(duration_ticks);
    control.ramp_ticks(500);
    control_.write(control);
  }

  /// Begins a trial until `condition` holds.  Where a loaded machine holds up a process's life sign
  /// the interlock opens, and stays open for that trial: then the next number begins.
  /// @return the trial in which it held; -1: in none
  std::int32_t begin_until(const std::function<bool()>& condition, std::int32_t trial,
                           Tick duration_ticks = 10'000, bool cancellation = false) {
    for (const std::int32_t last = trial + 4; trial <= last; ++trial) {
      begin_trial(trial, duration_ticks, cancellation);
      const Tick end = tick_ + 1000 + duration_ticks;
      const auto opened = [this] {
        return newest_command().enabled() && !newest_command().permitted();
      };
      // The answers to the samples of before are of the trial of before.
      const Tick from = tick_ + 500;
      step_until([&] { return condition() || (tick_ > from && opened()) || tick_ > end; }, 40'000);
      if (condition()) return trial;
    }
    return -1;
  }

  /// Both processes run, and the session's clock.
  void begin_session() {
    ASSERT_TRUE(support::eventually([this] { return name_sources(); }));
    stillhand_msgs::TrialControl running;
    running.session(stillhand_msgs::SESSION_RUNNING);
    running.trial(-1);
    control_.write(running);
    ASSERT_TRUE(step_until([this] { return newest_tracking().tick() > 0; }, 10'000));
    EXPECT_EQ(newest_command().mitigated_trial(), 0);
  }

  /// The same core, of the messages alone, bit for bit.  A command that the recorder lost on a
  /// loaded machine is passed over; up to the sample that cancellation lost, too.
  /// @returns how many commands it answered the same; -1: it answered one otherwise
  int same_in_one_process(std::int32_t trial,
                          const std::optional<cancellation::ControlModel>& force,
                          const std::optional<signal::DifferenceModel>& position) {
    stillhand_msgs::TrialAssignment assignment;
    assignment.parts(parts_);
    auto recipe = recipe_of(cancellation::parts_of(assignment), position, {});
    recipe.model = force;
    cancellation::Countermeasure sut({}, recipe);
    int compared = 0;
    bool lost = false;
    Tick next = -1;
    const std::lock_guard lock(mutex_);
    for (const auto& command : commands_) {
      if (command.mitigated_trial() != trial) continue;
      const auto answer = [&](Tick tick) {
        return sut.step(
            cancellation::from_idl(samples_.at(tick), command.enabled(), command.permitted()));
      };
      for (; compared > 0 && next < command.tick(); ++next) {
        answer(next);
        lost = true;
      }
      next = command.tick() + 1;
      const auto again = answer(command.tick());
      if (again.taken_off_rad != command.taken_off_rad() || again.force_n != command.force_n() ||
          again.weights[0] != command.gain_weight() || again.weights[1] != command.phase_weight()) {
        return lost ? compared : -1;
      }
      ++compared;
    }
    return compared;
  }

  /// Newest trial for which cancellation says that it is prepared.
  std::int64_t armed() {
    const std::lock_guard lock(mutex_);
    return armed_;
  }
  /// What cancellation noted.
  std::set<std::string> notes() {
    const std::lock_guard lock(mutex_);
    return notes_;
  }
  /// Commands of the ticks from `from` on.
  std::vector<stillhand_msgs::MotorCommand> commands_from(Tick from) {
    const std::lock_guard lock(mutex_);
    std::vector<stillhand_msgs::MotorCommand> out;
    std::ranges::copy_if(commands_, std::back_inserter(out),
                         [from](const auto& command) { return command.tick() >= from; });
    return out;
  }
  /// Cursors that followed a mitigated command which is recorded, too.
  int recorded_pairs() {
    const std::lock_guard lock(mutex_);
    std::set<Tick> taken_off;
    for (const auto& command : commands_) {
      if (command.taken_off_rad() != 0.0) taken_off.insert(command.tick());
    }
    return static_cast<int>(std::ranges::count_if(
        tracking_, [&](const auto& sample) { return taken_off.contains(sample.command_tick()); }));
  }

  stillhand_msgs::MotorCommand newest_command() {
    const std::lock_guard lock(mutex_);
    return commands_.empty() ? stillhand_msgs::MotorCommand{} : commands_.back();
  }
  stillhand_msgs::TrackingSample newest_tracking() {
    const std::lock_guard lock(mutex_);
    return tracking_.empty() ? stillhand_msgs::TrackingSample{} : tracking_.back();
  }

  std::map<std::string, std::unique_ptr<Stand>> stands_;
  runtime::Publisher<stillhand_msgs::TrialControl> control_;
  runtime::Publisher<stillhand_msgs::SessionSources> sources_;
  runtime::Publisher<stillhand_msgs::TrialAssignment> assignment_;
  runtime::Publisher<stillhand_msgs::FeedthroughModel> model_;
  runtime::Publisher<stillhand_msgs::Sensed> sensed_;
  std::vector<stillhand_msgs::MitigationPart> parts_;
  std::mutex mutex_;
  std::vector<stillhand_msgs::MotorCommand> commands_;
  std::vector<stillhand_msgs::TrackingSample> tracking_;
  std::map<Tick, stillhand_msgs::Sensed> samples_;
  std::int64_t armed_ = -1;
  std::set<std::string> notes_;
  Tick tick_ = 0;
  std::int64_t due_ns_ = runtime::monotonic_ns();  // of the next sample
  support::Child cancellation_{words_of("cancellation"), output_of("cancellation")};
  support::Child display_{words_of("display"), output_of("display")};
};

}  // namespace stillhand
