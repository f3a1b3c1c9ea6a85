// SPDX-License-Identifier: Apache-2.0
#include "apps/experiment/session_script.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apps/close_the_loop/verdict/control_model.hpp"
#include "apps/lab/control_model.hpp"
#include "apps/lab/pause_diagnosis.hpp"
#include "apps/libraries/measurement/written_trial.hpp"
#include "apps/libraries/session/instructions.hpp"

namespace stillhand::experiment {
namespace {

static_assert(kMostInstructions * (kMostLine + 1) <= lab::kMostPromptText);
static_assert(kMostWord == lab::kMostPromptWord);

constexpr double kEndShown_s = 20.0;
constexpr double kBoxHalfWidth_m = 0.015;  // paper III-C; Eq. ID-13

// Share of a trial's recorded ticks with the cursor in the box.
double dwell_ratio(const std::filesystem::path& recording, const Trial& trial) {
  const auto session = measurement::written_trial(recording, trial, true);
  const auto& target_m = session.rows.find("x_r")->values;
  const auto& cursor_m = session.rows.find("x_p")->values;
  std::size_t inside = 0;
  for (std::size_t i = 0; i < target_m.size(); ++i) {
    inside += std::abs(cursor_m[i] - target_m[i]) < kBoxHalfWidth_m ? 1 : 0;
  }
  return static_cast<double>(inside) / static_cast<double>(target_m.size());
}

bool chooses_models(const Design& design) {
  return std::ranges::any_of(design.conditions, [](const std::string& each) {
    return each.size() > 1 && !is_mitigation(each);
  });
}

// `signal` takes off by a model of the feedthrough to position.
bool needs_position(const Design& design) {
  return std::ranges::any_of(design.conditions, [](const std::string& each) {
    return needs_position(condition_of(each));
  });
}

// C+ where nothing is known to be missing: the identified model, with a straight line as its curve,
// which keeps its trials apart from those of C in a recording.
cancellation::ControlModel without_effect(const identification::FeedthroughModel& identified) {
  cancellation::ControlModel model = cancellation::control_model(identified.control);
  model.inputs.at(0).map = {-1.0, 1.0, {-1.0, 1.0}};
  return model;
}

}  // namespace

SessionScript::SessionScript(const Folder& folder, std::size_t index, Journal& journal,
                             Progress& progress, const lab::LabOptions& lab)
    : folder_(folder),
      index_(index),
      journal_(journal),
      progress_(progress),
      lab_(lab),
      plan_(folder.plan(index)),
      session_(progress.sessions()) {
  const std::string file = folder.design().model_file();
  if (!file.empty()) augmented_ = lab::control_model(folder.path() / file, lab.rig, lab.config);
}

void SessionScript::add(Entry entry) {
  entry.session = session_;
  progress_.take(journal_.append(std::move(entry)));
}

session::PlannedTrial SessionScript::planned_of(const Step& step) const {
  const session::Condition condition = experiment::condition_of(condition_of(step));
  session::PlannedTrial planned =
      session::tracking_trial(lab_.protocol, planned_as(condition), step.place);
  planned.motion_seed = step.motion_seed;
  planned.reference_seed = step.target_seed;
  return planned;
}

session::PlannedTrial SessionScript::free_identification() const {
  // A number that the pegged trial was stopped with is added where it runs.
  session::PlannedTrial planned = session::free_identification_trial(lab_.protocol, 1);
  planned.motion_seed =
      session::repeat_seed(identification_seed(folder_.design(), index_, session_), 1);
  return planned;
}

session::PlannedTrial SessionScript::practice_of(std::int64_t number) const {
  session::ProtocolOptions protocol = lab_.protocol;
  protocol.trial_s = folder_.design().practice.trial_s;
  session::PlannedTrial planned =
      session::tracking_trial(protocol, session::Condition::kA, number + 1);
  planned.reference_seed = practice_trial(folder_.design(), index_, number).target_seed;
  return planned;
}

session::PlannedTrial SessionScript::identification() const {
  session::PlannedTrial planned = session::identification_trial(lab_.protocol);
  planned.motion_seed = identification_seed(folder_.design(), index_, session_);
  return planned;
}

std::vector<session::PlannedTrial> SessionScript::possible_trials() const {
  std::vector<session::PlannedTrial> trials{identification()};
  if (needs_position(folder_.design())) trials.push_back(free_identification());
  for (const Step& step : plan_) {
    if (step.kind == StepKind::kTrial) trials.push_back(planned_of(step));
  }
  for (std::int64_t n = 0; n < folder_.design().practice.most_trials; ++n) {
    trials.push_back(practice_of(n));
  }
  return trials;
}

void SessionScript::run(lab::LiveTrials& trials) {
  if (!instruct(trials) || !identify(trials) || !diagnose(trials)) return;
  do {
    while (const auto next = progress_.next()) {
      if (!do_step(trials, *next) || !look(trials)) return;
    }
    show_end(trials);
    if (!look(trials)) return;
  } while (progress_.next());  // the last trial was asked again while the end was shown
}

lab::Prompt SessionScript::prompt_of(lab::PromptKind kind, const Step& step) const {
  lab::Prompt prompt{.kind = kind,
                     .participant = participant_code(index_),
                     .block = step.block,
                     .blocks = folder_.design().blocks,
                     .trial = step.place,
                     .trials = trials_of(plan_)};
  if (kind == lab::PromptKind::kPractice) {
    prompt.trial = progress_.practice_trials() + 1;
    prompt.trials = folder_.design().practice.most_trials;
  }
  return prompt;
}

bool SessionScript::instruct(lab::LiveTrials& trials) {
  const std::vector<std::string>& lines = folder_.design().instructions;
  if (!with_person() || lines.empty()) return look(trials);
  lab::Prompt prompt = prompt_of(lab::PromptKind::kInstructions, {});
  prompt.text = session::text_of(lines);
  prompt.steps = 1;
  trials.ask(prompt, "instructions");
  return look(trials);
}

// The processes end when the script does, and with them the screen: a person reads it first.
void SessionScript::show_end(lab::LiveTrials& trials) {
  lab::Prompt prompt = prompt_of(lab::PromptKind::kEnd, {});
  if (!with_person()) return trials.show(prompt);
  prompt.steps = 1;
  prompt.wait_s = kEndShown_s;
  trials.ask(prompt, "the end");
}

bool SessionScript::look(lab::LiveTrials& trials) {
  const lab::Asked asked = trials.asked();
  for (const std::string& note : asked.notes) {
    add({.kind = EntryKind::kNote, .text = note});
  }
  if (asked.repeat && progress_.last_trial()) {
    const auto step = static_cast<std::int64_t>(*progress_.last_trial());
    add({.kind = EntryKind::kRepeatAsked, .step = step, .text = *asked.repeat});
  }
  if (!trials.interrupted()) return true;
  ended_ = asked.aborted.empty() ? "interrupted" : asked.aborted;
  return false;
}

bool SessionScript::identify(lab::LiveTrials& trials) {
  lab::Prompt prompt = prompt_of(lab::PromptKind::kIdentification, {});
  if (with_person()) prompt.text = "The simulated arm is measured.\nThere is nothing to do.\n";
  trials.show(prompt);
  if (!identify(trials, identification(), "identification")) return false;
  if (!needs_position(folder_.design())) return true;
  prompt = prompt_of(lab::PromptKind::kInstructions, {});
  prompt.text = session::kHoldStill;
  trials.show(prompt);
  return identify(trials, free_identification(), "identification, stick free");
}

bool SessionScript::identify(lab::LiveTrials& trials, const session::PlannedTrial& planned,
                             const std::string& what) {
  add({.kind = EntryKind::kTrialBegan, .trial = planned.trial.number, .text = what});
  const session::TrialOutcome& outcome = trials.run(planned);
  numbers_ = outcome.planned.trial.number;
  add({.kind = EntryKind::kTrialEnded,
       .trial = numbers_,
       .completed = outcome.completed,
       .text = outcome.aborted});
  ended_ = outcome.aborted;
  return look(trials) && outcome.completed;
}

bool SessionScript::do_step(lab::LiveTrials& trials, std::size_t number) {
  switch (plan_[number].kind) {
    case StepKind::kPractice:
      return practise(trials, number);
    case StepKind::kTrial:
      return track(trials, number);
    case StepKind::kBreak:
      return take_break(trials, number);
    case StepKind::kQuestion:
      return ask(trials, number);
  }
  return false;
}

bool SessionScript::practise(lab::LiveTrials& trials, std::size_t number) {
  return run_trial(trials, number, practice_of(progress_.practice_trials()));
}

bool SessionScript::track(lab::LiveTrials& trials, std::size_t number) {
  if (chooses_models(folder_.design())) give_model(trials, condition_of(plan_[number]));
  return run_trial(trials, number, planned_of(plan_[number]));
}

bool SessionScript::diagnose(lab::LiveTrials& trials) {
  if (folder_.design().control_model != kDiagnosed) return true;
  if (with_person()) {
    lab::Prompt prompt = prompt_of(lab::PromptKind::kIdentification, {});
    prompt.text = "Please wait.\n";
    trials.show(prompt);
  }
  lab::PauseVerdict verdict = lab::diagnose_in_pause(lab_, trials);
  if (!look(trials)) return false;
  try {
    if (verdict.certain) augmented_ = lab::diagnosed_model(lab_);
  } catch (const std::exception& error) {
    verdict = {.why_not = error.what()};
  }
  if (!augmented_) augmented_ = without_effect(trials.model());
  add({.kind = EntryKind::kNote,
       .text = verdict.certain ? "diagnosis: " + verdict.found
                               : "diagnosis: the identified model runs in its place: " +
                                     (verdict.why_not.empty() ? verdict.found : verdict.why_not)});
  return true;
}

// C runs the session's own model, C' the same while it follows the hand, C+ that of the file or of
// the diagnosis.  A and B get the session's own, which they do not use: who sees the event of a
// loaded model, or waits for it, learns nothing.
void SessionScript::give_model(lab::LiveTrials& trials, const std::string& condition) {
  cancellation::ControlModel model =
      condition == "C+" ? *augmented_ : cancellation::control_model(trials.model().control);
  if (condition == "C'") model.adapts = close_the_loop::average_hand();
  const double own_s = lab::settled_after_s(model, lab_.config);
  settled_s_ = std::max(
      {settled_s_, own_s, augmented_ ? lab::settled_after_s(*augmented_, lab_.config) : 0.0});
  if (const std::string refused = trials.use(model); !refused.empty()) {
    throw std::runtime_error("the canceller refused a model: " + refused);
  }
  // As long before every condition.
  trials.rest("rest", settled_s_ - own_s, [] { return false; });
}

bool SessionScript::run_trial(lab::LiveTrials& trials, std::size_t step,
                              session::PlannedTrial planned) {
  const Step& planned_step = plan_[step];
  const bool practice = planned_step.kind == StepKind::kPractice;
  const auto labels = labels_of(folder_.design().conditions.size(), folder_.assignment(), index_);
  const std::string label = practice ? "" : labels[planned_step.condition];
  for (;;) {
    const double rest_s = first_ ? 0.0 : folder_.design().rest_s;
    lab::Prompt prompt =
        prompt_of(practice ? lab::PromptKind::kPractice : lab::PromptKind::kTrial, planned_step);
    prompt.wait_s = rest_s + lab::kTrialLead_s +
                    static_cast<double>(planned.trial.ramp_ticks) * kControlPeriod_s;
    trials.show(prompt);
    if (rest_s > 0.0) trials.rest("rest", rest_s, {});
    first_ = false;
    if (!look(trials)) return false;
    if (progress_.next() != step) return true;  // during the rest, the last trial was asked again
    planned.trial.number = ++numbers_;
    trials.note(practice ? fmt::format("experiment: trial {}, practice", numbers_)
                         : fmt::format("experiment: trial {}, block {}, place {}, label {}",
                                       numbers_, planned_step.block, planned_step.place, label));
    Entry entry{.kind = EntryKind::kTrialBegan,
                .step = static_cast<std::int64_t>(step),
                .trial = numbers_,
                .label = label};
    add(entry);
    const session::TrialOutcome& outcome = trials.run_once(planned);
    entry.kind = EntryKind::kTrialEnded;
    entry.completed = outcome.completed;
    entry.text = outcome.aborted;
    if (practice && outcome.completed) {
      entry.dwell_ratio = dwell_ratio(lab_.out / "session.mcap", outcome.planned.trial);
    }
    add(entry);
    if (outcome.completed) return true;
    ended_ = outcome.aborted;
    if (!look(trials) || !outcome.stopped) return false;
    ended_.clear();
  }
}

bool SessionScript::take_break(lab::LiveTrials& trials, std::size_t number) {
  lab::Prompt prompt = prompt_of(lab::PromptKind::kBreak, plan_[number]);
  for (std::size_t step = number; step < plan_.size() && prompt.trial == 0; ++step) {
    prompt.trial = plan_[step].place;  // what comes after it
  }
  prompt.wait_s = folder_.design().break_s;
  trials.show(prompt);
  trials.rest(fmt::format("break after block {}", plan_[number].block), folder_.design().break_s,
              {});
  if (!look(trials)) return false;
  add({.kind = EntryKind::kBreakOver, .step = static_cast<std::int64_t>(number)});
  first_ = true;  // the break was the rest
  return true;
}

bool SessionScript::ask(lab::LiveTrials& trials, std::size_t number) {
  const Question& question = folder_.design().questions[plan_[number].question];
  Entry entry{.kind = EntryKind::kQuestionAnswered, .step = static_cast<std::int64_t>(number)};
  if (with_person()) {
    lab::Prompt prompt = prompt_of(lab::PromptKind::kQuestion, plan_[number]);
    for (std::size_t step = number; step > 0 && prompt.trial == 0; --step) {
      prompt.trial = plan_[step - 1].place;  // the trial that it follows
    }
    prompt.text = question.text + "\n";
    prompt.lowest = question.lowest;
    prompt.highest = question.highest;
    prompt.steps = question.steps;
    const auto answer = trials.ask(prompt, "question " + question.name);
    // One that was not answered when the session ended is asked again.
    if (!answer && !look(trials)) return false;
    entry.answer = answer.value_or(0);
    entry.text = question.name + (answer ? "" : ": passed over by the experimenter");
  } else {
    entry.text = question.name + ": not asked of a simulated subject";
  }
  add(entry);
  return true;
}

}  // namespace stillhand::experiment
