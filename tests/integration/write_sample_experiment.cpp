// SPDX-License-Identifier: Apache-2.0
// write_sample_experiment DIR: conducts every participant of an experiment of conditions A, B, C
// that `stillhand experiment new` made, with simulated subjects and without a bus: the cores in one
// process, then journals and recordings as a session over the bus leaves them.  Four participants
// are special, where there are so many:
//
//   P02  the first trial is ended after half its length and runs again
//   P03  the session is killed after the first trial; a second session goes on
//   P04  every fiftieth sample of the first trial is lost, and one more
//   P05  is excluded by the experimenter
#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "apps/experiment/folder.hpp"
#include "apps/session/in_process.hpp"
#include "apps/study/trial_analysis.hpp"
#include "idl/idl_text.hpp"
#include "services/population/population.hpp"
#include "services/recording/file_io.hpp"
#include "services/recording/of_experiment.hpp"
#include "tests/support/session_file.hpp"

namespace stillhand::tests {
namespace {

using experiment::Entry;
using experiment::EntryKind;
using session::PlannedTrial;
using session::TrialSignals;

constexpr std::size_t kBrokenOff = 1, kKilled = 2, kLossy = 3, kExcluded = 4;

session::CoreConfigs configs_of(const experiment::Design& design, std::size_t index) {
  session::CoreConfigs configs;
  const auto subject = population::draw_subject({}, static_cast<std::uint64_t>(design.subject_seed),
                                                static_cast<std::int64_t>(index));
  configs.rig.body = subject.body;
  configs.human_operator = subject.who;
  configs.human_operator.arm = population::learnt_feel(configs.rig.body, configs.rig.stick);
  return configs;
}

// One session of one participant.
class SampleSession {
 public:
  SampleSession(const experiment::Folder& folder, std::size_t index, std::int64_t number,
                experiment::Journal& journal)
      : folder_(folder),
        index_(index),
        number_(number),
        journal_(journal),
        loop_(configs_of(folder.design(), index),
              experiment::session_seed(folder.design(), index, number)) {
    loop_.keep_measured();
    protocol_.trial_s = folder.design().trial_s;
    protocol_.identify_s = folder.design().identify_s;
    const std::string name = number < 10 ? "0" + std::to_string(number) : std::to_string(number);
    file_.metadata(
        recording::kExperimentRecord,
        recording::experiment_texts({experiment::participant_code(index), folder.digest(), name}));
    add({.kind = EntryKind::kSessionBegan, .digest = folder.digest()});
  }

  void identify() {
    PlannedTrial planned = session::identification_trial(protocol_);
    planned.motion_seed = experiment::identification_seed(folder_.design(), index_, number_);
    add({.kind = EntryKind::kTrialBegan, .trial = 0});
    const TrialSignals signals = run(planned, 1.0, 0);
    const study::Identification found = study::identified(signals.pegged);
    identification::FeedthroughModel model;
    model.fit = found.fit;
    model.control = found.control.model;
    if (loop_.use_model(model) != cancellation::Refusal::kNone) {
      throw std::runtime_error("the canceller refused the model of " +
                               experiment::participant_code(index_));
    }
    add({.kind = EntryKind::kTrialEnded, .trial = 0, .completed = true});
  }

  // @param share  of the trial that runs  @param lose_every  a lost sample every so many; 0: none
  void track(const experiment::Plan& plan, std::size_t step, double share = 1.0,
             Tick lose_every = 0) {
    const experiment::Step& at = plan[step];
    const std::string& condition = folder_.design().conditions[at.condition];
    PlannedTrial planned = session::tracking_trial(
        protocol_, static_cast<session::Condition>(condition.front()), at.place);
    planned.motion_seed = at.motion_seed;
    planned.reference_seed = at.target_seed;
    planned.trial.number = ++trials_;
    Entry entry{.kind = EntryKind::kTrialBegan,
                .step = static_cast<std::int64_t>(step),
                .trial = trials_,
                .label = folder_.assignment().labels[at.condition]};
    add(entry);
    run(planned, share, lose_every);
    entry.kind = EntryKind::kTrialEnded;
    entry.completed = share == 1.0;
    if (!entry.completed) entry.text = "stopped, asked by dashboard on anna-laptop: Anna sneezed";
    add(entry);
  }

  void close(bool completed) {
    const std::filesystem::path place = folder_.session(index_, number_);
    std::filesystem::create_directories(place);
    const auto bytes = file_.close();
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const auto written = recording::write_file_atomically((place / "session.mcap").string(), text);
    if (!written.ok()) throw std::runtime_error(written.text);
    add({.kind = EntryKind::kSessionEnded, .completed = completed});
  }

 private:
  void add(Entry entry) {
    entry.session = number_;
    journal_.append(std::move(entry));
  }

  TrialSignals run(PlannedTrial planned, double share, Tick lose_every) {
    TrialSignals signals = loop_.run(planned);
    const auto first = static_cast<Tick>(signals.measured.time_s.front() * kControlRateHz + 0.5);
    const bool pegged = planned.trial.phase == TrialPhase::kPegged;
    const auto number = static_cast<std::int32_t>(planned.trial.number);
    file_.control(number, pegged ? stillhand_msgs::PHASE_PEGGED : stillhand_msgs::PHASE_TRACKING,
                  first, planned.trial.duration_ticks);
    file_.assignment(
        number, planned.moving ? stillhand_msgs::MOTION_BAND_NOISE : stillhand_msgs::MOTION_STILL,
        planned.cancellation);
    const auto rows =
        static_cast<std::size_t>(share * static_cast<double>(signals.measured.row_count()));
    for (std::size_t row = 0; row < rows; ++row) {
      const Tick tick = first + static_cast<Tick>(row);
      const bool lost =
          lose_every > 0 && (row % static_cast<std::size_t>(lose_every) == 7 || row == rows / 2);
      if (!lost) write(signals, row, tick, pegged);
    }
    file_.control(-1);
    return signals;
  }

  void write(const TrialSignals& signals, std::size_t row, Tick tick, bool pegged) {
    const auto& columns = signals.measured.columns;
    const auto at = [&](std::size_t column) { return columns[column].values[row]; };
    stillhand_msgs::Sensed sensed;
    sensed.tick(tick);
    sensed.accel_x_m_s2(at(0));
    sensed.accel_y_m_s2(at(1));
    sensed.accel_z_m_s2(at(2));
    sensed.roll_rad(at(3));
    sensed.theta_rad(at(4));
    sensed.omega_rad_s(at(5));
    sensed.force_n(at(6));
    file_.add(topics::kSensed, sensed);
    stillhand_msgs::MotorCommand motor;
    motor.tick(tick);
    motor.force_n(at(7));
    file_.add(topics::kMotorCommand, motor);
    stillhand_msgs::RigTruth truth;
    truth.tick(tick);
    truth.feedthrough_force_n(signals.feedthrough_n[row]);
    truth.motor_force_n(signals.motor_n[row]);
    file_.add(topics::kRigTruth, truth);
    if (pegged) return;
    stillhand_msgs::TrackingSample shown;
    shown.tick(tick);
    shown.target_m(at(8));
    shown.cursor_m(at(9));
    file_.add(topics::kTrackingSample, shown);
  }

  const experiment::Folder& folder_;
  std::size_t index_;
  std::int64_t number_;
  experiment::Journal& journal_;
  session::ProtocolOptions protocol_;
  session::InProcessLoop loop_;
  SessionFile file_{std::size_t{1} << 20, recording::Compression::kZstd, topics::idl_of};
  std::int64_t trials_ = 0;
};

void conduct(const experiment::Folder& folder, std::size_t index) {
  std::filesystem::create_directories(folder.participant(index));
  experiment::Journal journal(folder.journal(index));
  const experiment::Plan plan = folder.plan(index);
  auto session = std::make_unique<SampleSession>(folder, index, 1, journal);
  session->identify();
  for (std::size_t step = 0; step < plan.size(); ++step) {
    if (plan[step].kind != experiment::StepKind::kTrial) continue;
    const bool first = plan[step].place == 1;
    if (first && index == kBrokenOff) session->track(plan, step, 0.5);
    session->track(plan, step, 1.0, first && index == kLossy ? 50 : 0);
    if (!first || index != kKilled) continue;
    session->close(false);
    session = std::make_unique<SampleSession>(folder, index, 2, journal);
    session->identify();
  }
  session->close(true);
  if (index == kExcluded) {
    journal.append({.kind = EntryKind::kExcluded, .text = "Anna felt sick"});
  }
}

}  // namespace
}  // namespace stillhand::tests

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: write_sample_experiment DIR\n", stderr);
    return 2;
  }
  try {
    const stillhand::experiment::Folder folder(argv[1]);
    folder.register_design();
    for (std::int64_t n = 0; n < folder.design().participants; ++n) {
      stillhand::tests::conduct(folder, static_cast<std::size_t>(n));
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "write_sample_experiment: %s\n", error.what());
    return 1;
  }
  return 0;
}
