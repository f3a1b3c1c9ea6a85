// SPDX-License-Identifier: Apache-2.0
// write_sample_experiment DIR [REMNANT [GAIN [EFFECT [REFUSED [FRICTION [HOLDERS]]]]]]: conducts
// every participant of an experiment that `stillhand experiment new` made, with simulated subjects
// and without a bus: the cores in one process, then journals and recordings as a session over the
// bus leaves them.  Five participants are special, where there are so many:
//
//   P02  the first trial is ended after half its length and runs again
//   P03  the session is killed after the first trial; a second session goes on
//   P04  every fiftieth sample of the first trial is lost, and one more
//   P05  is excluded by the experimenter
//   P06  repeats the first trial on request, although it was complete
//
// REMNANT is added to the seeds of remnant and sensor noise, so that a simulation of the same
// people meets other noise; GAIN is that of the motor, so that it meets another rig; EFFECT is the
// seed of an undeclared effect that every rig holds; REFUSED is the number of a participant whose
// canceller refuses the model of C+ and goes on with the one before.  FRICTION [N] is that of every
// stick; HOLDERS are the digits of the participants who alone hold EFFECT, as 26 for P02 and P06.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "apps/close_the_loop/verdict/control_model.hpp"
#include "apps/experiment/folder/folder.hpp"
#include "apps/libraries/session/in_process.hpp"
#include "apps/study/subjects/trial_analysis.hpp"
#include "idl/idl_text.hpp"
#include "services/bus/recording/of_experiment.hpp"
#include "services/core/population/population.hpp"
#include "services/files/cancellation/control_model_file.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/messages/cancellation/codec.hpp"
#include "services/messages/identification/codec.hpp"
#include "tests/support/session_file.hpp"

namespace stillhand::tests {
namespace {

using experiment::Entry;
using experiment::EntryKind;
using session::PlannedTrial;
using session::TrialSignals;

constexpr std::size_t kBrokenOff = 1, kKilled = 2, kLossy = 3, kExcluded = 4, kRepeated = 5;

struct Otherwise {
  std::uint64_t remnant = 0;
  double motor_gain = 1.0;
  std::uint64_t effect = 0;
  std::size_t refused = 0;
  double friction_n = rig::StickConfig{}.coulomb_friction_n;
  std::string holders;  ///< empty: all

  [[nodiscard]] std::uint64_t effect_of(std::size_t index) const {
    const bool holds =
        holders.empty() || holders.find(std::to_string(index + 1)) != std::string::npos;
    return holds ? effect : 0;
  }
};

session::CoreConfigs configs_of(const experiment::Design& design, std::size_t index,
                                const Otherwise& otherwise) {
  session::CoreConfigs configs;
  configs.rig.motor.gain = otherwise.motor_gain;
  configs.rig.stick.coulomb_friction_n = otherwise.friction_n;
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
                experiment::Journal& journal, const Otherwise& otherwise)
      : folder_(folder),
        index_(index),
        number_(number),
        journal_(journal),
        refused_(otherwise.refused),
        loop_(configs_of(folder.design(), index, otherwise),
              experiment::session_seed(folder.design(), index, number) + otherwise.remnant, 1,
              rig::SealedEffect(otherwise.effect_of(index), rig::RigConfig{})) {
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
    auto message = identification::to_idl(model, 0, 0);
    message.from_tick(last_tick_ + 1);
    message.usable(true);
    file_.add(topics::kFeedthroughModel, message);
    identified_ = model.control;
    in_use_ = 0;
    add({.kind = EntryKind::kTrialEnded, .trial = 0, .completed = true});
  }

  // @param share  of the trial that runs  @param lose_every  a lost sample every so many; 0: none
  void track(const experiment::Plan& plan, std::size_t step, double share = 1.0,
             Tick lose_every = 0) {
    const experiment::Step& at = plan[step];
    const std::string& condition = folder_.design().conditions[at.condition];
    PlannedTrial planned = session::tracking_trial(
        protocol_, planned_as(experiment::condition_of(condition)), at.place);
    planned.motion_seed = at.motion_seed;
    planned.reference_seed = at.target_seed;
    planned.trial.number = ++trials_;
    given_ = model_for(condition);
    refuses_ = condition == "C+" && index_ + 1 == refused_;
    if (given_ && !refuses_) use(*given_);
    const std::vector<std::string> labels = experiment::labels_of(
        folder_.design().conditions.size(), folder_.assignment(), static_cast<std::size_t>(index_));
    Entry entry{.kind = EntryKind::kTrialBegan,
                .step = static_cast<std::int64_t>(step),
                .trial = trials_,
                .label = labels[at.condition]};
    add(entry);
    announce("experiment: trial " + std::to_string(trials_) + ", block " +
             std::to_string(at.block) + ", place " + std::to_string(at.place) + ", label " +
             entry.label);
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

  void ask_again(std::size_t step) {
    add({.kind = EntryKind::kRepeatAsked,
         .step = static_cast<std::int64_t>(step),
         .text = "Anna looked away"});
  }

 private:
  void use(const cancellation::ControlModel& model) {
    if (loop_.use_model(model) == cancellation::Refusal::kNone) return;
    throw std::runtime_error("the canceller refused a model of " +
                             experiment::participant_code(index_));
  }

  // As SessionScript::give_model(): none where the identified model is used as it is.
  std::optional<cancellation::ControlModel> model_for(const std::string& condition) const {
    const auto& design = folder_.design();
    const bool chooses = std::ranges::any_of(
        design.conditions, [](const std::string& each) { return each.size() > 1; });
    if (!chooses || condition.front() != 'C') return std::nullopt;
    if (condition == "C+") {
      const std::string file = (folder_.path() / design.control_model).string();
      return cancellation::parse_control_model(recording::read_file(file), file, experiment::kRig);
    }
    cancellation::ControlModel model = cancellation::control_model(identified_);
    if (condition == "C'") model.adapts = close_the_loop::average_hand();
    return model;
  }

  // What the experiment says before a tracking trial.
  void announce(const std::string& text) {
    stillhand_msgs::Event note;
    note.kind(stillhand_msgs::EVENT_NOTE);
    note.source("experiment");
    note.text(text.c_str());
    file_.add(topics::kEvent, note);
  }

  void add(Entry entry) {
    entry.session = number_;
    journal_.append(std::move(entry));
  }

  TrialSignals run(PlannedTrial planned, double share, Tick lose_every) {
    TrialSignals signals = loop_.run(planned);
    const auto first = static_cast<Tick>(signals.measured.time_s.front() * kControlRateHz + 0.5);
    const bool pegged = planned.trial.phase == TrialPhase::kPegged;
    if (given_ && !pegged) {
      auto message = cancellation::to_idl(*given_, cancellation::kFirstControlModel + models_++);
      message.from_tick(first - 1000);
      file_.add(topics::kAugmentedModel, message);
      stillhand_msgs::Event answer;
      answer.kind(refuses_ ? stillhand_msgs::EVENT_MODEL_REFUSED
                           : stillhand_msgs::EVENT_MODEL_LOADED);
      answer.source("cancellation");
      answer.text(refuses_ ? "it is not stable" : "");
      answer.tick(first - 1000);
      file_.add(topics::kEvent, answer);
      if (!refuses_) in_use_ = message.model();
    }
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
    last_tick_ = first + static_cast<Tick>(signals.measured.row_count());
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
    motor.model(in_use_);
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
  std::size_t refused_;
  session::ProtocolOptions protocol_;
  session::InProcessLoop loop_;
  SessionFile file_{std::size_t{1} << 20, recording::Compression::kZstd, topics::idl_of};
  std::int64_t trials_ = 0;
  signal::DifferenceModel identified_;
  std::optional<cancellation::ControlModel> given_;  ///< for the next trial
  bool refuses_ = false;                             ///< the canceller, in this trial
  std::int32_t models_ = 0;
  std::int32_t in_use_ = -1;  ///< number of the model that the canceller has
  Tick last_tick_ = 0;
};

void conduct(const experiment::Folder& folder, std::size_t index, const Otherwise& otherwise) {
  std::filesystem::create_directories(folder.participant(index));
  experiment::Journal journal(folder.journal(index));
  const experiment::Plan plan = folder.plan(index);
  auto session = std::make_unique<SampleSession>(folder, index, 1, journal, otherwise);
  session->identify();
  for (std::size_t step = 0; step < plan.size(); ++step) {
    if (plan[step].kind == experiment::StepKind::kBreak) {
      journal.append({.kind = EntryKind::kBreakOver, .step = static_cast<std::int64_t>(step)});
    }
    if (plan[step].kind != experiment::StepKind::kTrial) continue;
    const bool first = plan[step].place == 1;
    if (first && index == kBrokenOff) session->track(plan, step, 0.5);
    session->track(plan, step, 1.0, first && index == kLossy ? 50 : 0);
    if (first && index == kRepeated) {
      session->ask_again(step);
      session->track(plan, step);
    }
    if (!first || index != kKilled) continue;
    session->close(false);
    session = std::make_unique<SampleSession>(folder, index, 2, journal, otherwise);
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
  if (argc < 2 || argc > 8) {
    std::fputs(
        "usage: write_sample_experiment DIR [REMNANT [GAIN [EFFECT [REFUSED "
        "[FRICTION [HOLDERS]]]]]]\n",
        stderr);
    return 2;
  }
  try {
    stillhand::tests::Otherwise otherwise;
    if (argc > 2) otherwise.remnant = std::stoull(argv[2]);
    if (argc > 3) otherwise.motor_gain = std::stod(argv[3]);
    if (argc > 4) otherwise.effect = std::stoull(argv[4]);
    if (argc > 5) otherwise.refused = std::stoul(argv[5]);
    if (argc > 6) otherwise.friction_n = std::stod(argv[6]);
    if (argc > 7) otherwise.holders = argv[7];
    const stillhand::experiment::Folder folder(argv[1]);
    folder.register_design();
    for (std::int64_t n = 0; n < folder.design().participants; ++n) {
      stillhand::tests::conduct(folder, static_cast<std::size_t>(n), otherwise);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "write_sample_experiment: %s\n", error.what());
    return 1;
  }
  return 0;
}
