// SPDX-License-Identifier: Apache-2.0
// A session's script without a bus: what the participant is shown, and what is left after a kill at
// every point of it.
#include "apps/experiment/session_script.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "services/core/cancellation/model_check.hpp"
#include "services/files/cancellation/control_model_file.hpp"
#include "tests/support/folder.hpp"
#include "tests/unit/lab/pause_summary.hpp"

namespace stillhand::experiment::session_script_test {
namespace {

using lab::PromptKind;
using testing::ElementsAre;
using testing::HasSubstr;

struct Killed {};

/// Processes that complete every trial, and a participant who always gives the largest answer.
class FakeTrials final : public lab::LiveTrials {
 public:
  /// @param kill_at  number of the call, from 1, in which the program is killed; 0: in none
  explicit FakeTrials(int kill_at = 0) : kill_at_(kill_at) {
    model_.control = {1000.0, {-2.0}, {1.0}};
  }

  const session::TrialOutcome& run(const session::PlannedTrial& planned) override {
    return run_once(planned);
  }
  const session::TrialOutcome& run_once(const session::PlannedTrial& planned) override {
    count();
    ran.push_back(planned);
    outcome_.planned = planned;
    outcome_.completed = true;
    return outcome_;
  }
  void show(const lab::Prompt& prompt) override {
    count();
    shown.push_back(prompt);
  }
  std::optional<std::int64_t> ask(const lab::Prompt& prompt, const std::string& /*what*/) override {
    show(prompt);
    ++asked_prompts;
    count();
    if (prompt.kind == PromptKind::kQuestion && passes_over) return std::nullopt;
    return prompt.steps;
  }
  const session::TrialOutcome& run_between(const session::PlannedTrial& planned) override {
    return run_once(planned);
  }
  void rest(const std::string& what, double seconds, const std::function<bool()>& over) override {
    count();
    if (what == "rest") rested.push_back(seconds);
    while (what.starts_with("diagnosis") && !over()) std::this_thread::yield();
  }
  void say(const std::string& /*line*/) override {}
  void note(const std::string& /*text*/) override {}
  lab::Asked asked() override { return {}; }
  [[nodiscard]] const identification::FeedthroughModel& model() const override { return model_; }
  std::string use(const cancellation::ControlModel& model) override {
    ++models;
    used.push_back(model);
    return "";
  }
  [[nodiscard]] bool interrupted() const override { return false; }

  std::vector<lab::Prompt> shown;
  std::vector<session::PlannedTrial> ran;
  int asked_prompts = 0;
  int models = 0;
  std::vector<cancellation::ControlModel> used;
  std::vector<double> rested;  ///< [s]
  bool passes_over = false;

 private:
  void count() {
    if (++calls_ == kill_at_) throw Killed{};
  }
  int kill_at_;
  int calls_ = 0;
  session::TrialOutcome outcome_;
  identification::FeedthroughModel model_;
};

class SessionScriptTest : public testing::Test {
 protected:
  SessionScriptTest() {
    std::filesystem::create_directory(root_ / "config");
    write("config/cancellation.yaml", "");
    lab_.config = root_ / "config";
    design_.participants = 6;
    design_.blocks = 2;
    design_.rest_s = 10.0;
    design_.break_s = 60.0;
    design_.who = "mouse";
    design_.instructions = {"Keep the cross in the box.", "Any time."};
    design_.questions = {
        {"effort", Question::After::kTrial, "How hard was it?", "not at all", "very", 7},
        {"sick", Question::After::kEnd, "How do you feel?", "well", "sick", 9}};
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(root_ / name) << text;
  }
  /// A new folder with the orders of a seed.
  void make(std::uint64_t order_seed) {
    const std::filesystem::path path = root_ / std::to_string(++folders_);
    make_folder(path, design_, order_seed);
    folder_ = std::make_unique<Folder>(path);
    std::filesystem::create_directories(folder_->participant(0));
  }
  /// One session of the first participant.  @return false: it was killed
  bool run(FakeTrials& trials) {
    Journal journal(folder_->journal(0));
    const Plan plan = folder_->plan(0);
    Progress progress(folder_->design(), plan);
    for (const Entry& entry : journal.entries()) progress.take(entry);
    const std::int64_t session = progress.sessions() + 1;
    progress.take(journal.append({.kind = EntryKind::kSessionBegan, .session = session}));
    SessionScript script(*folder_, 0, journal, progress, lab_);
    try {
      script.run(trials);
    } catch (const Killed&) {
      return false;
    }
    EXPECT_TRUE(progress.complete());
    return true;
  }
  /// How often each step of the plan was completed, by the journal.
  std::map<std::int64_t, int> completed() {
    std::map<std::int64_t, int> counts;
    for (const Entry& entry : read_journal(folder_->journal(0))) {
      const bool done = (entry.kind == EntryKind::kTrialEnded && entry.completed) ||
                        entry.kind == EntryKind::kQuestionAnswered ||
                        entry.kind == EntryKind::kBreakOver;
      if (done && entry.step >= 0) ++counts[entry.step];
    }
    return counts;
  }

  Design design_;
  std::unique_ptr<Folder> folder_;
  lab::LabOptions lab_;
  const support::Folder root_;

 private:
  int folders_ = 0;
};

TEST_F(SessionScriptTest, TheParticipantSeesThePlaceInTheProtocol) {
  make(3);
  FakeTrials trials;
  ASSERT_TRUE(run(trials));
  std::vector<std::string> seen;
  for (const lab::Prompt& prompt : trials.shown) {
    EXPECT_EQ(prompt.participant, "P01");
    EXPECT_EQ(prompt.trials, 6);
    seen.push_back(std::to_string(static_cast<int>(prompt.kind)) + ":" +
                   std::to_string(prompt.trial));
  }
  // 1 instructions, 2 identification, 4 trial, 6 question, 5 break, 7 end; and the trial of each.
  EXPECT_THAT(seen, ElementsAre("1:0", "2:0", "4:1", "6:1", "4:2", "6:2", "4:3", "6:3", "5:4",
                                "4:4", "6:4", "4:5", "6:5", "4:6", "6:6", "6:6", "7:0"));
  EXPECT_EQ(trials.shown[0].text, "Keep the cross in the box.\nAny time.\n");
  EXPECT_EQ(trials.shown[2].wait_s, 3.0);   // of the first trial: lead and ramp
  EXPECT_EQ(trials.shown[4].wait_s, 13.0);  // the rest before them
  EXPECT_EQ(trials.shown[8].wait_s, 60.0);
  EXPECT_EQ(trials.shown[3].steps, 7);
  EXPECT_EQ(trials.shown[3].lowest, "not at all");
}

/// In place of `stillhand close-the-loop`, a program that copies a summary and a model.
class DiagnosedTest : public SessionScriptTest {
 protected:
  /// Settles later than the model without a pole of FakeTrials.
  inline static const signal::DifferenceModel kPlus{1000.0, {3.2, -3.168}, {1.0, -0.99}};
  DiagnosedTest() {
    design_.conditions = {"B", "C", "C+"};
    design_.comparisons = {};
    design_.control_model = kDiagnosed;
    design_.blocks = 1;
    for (const char* each : {"logs", "bin", "answer"}) {
      std::filesystem::create_directory(root_ / each);
    }
    write("bin/stillhand", "#!/bin/sh\nfor out; do :; done\nmkdir -p \"$out\"\ncp " +
                               (root_ / "answer").string() + "/* \"$out\"\n");
    std::filesystem::permissions(root_ / "bin/stillhand", std::filesystem::perms::owner_all);
    write("answer/control_model.json",
          cancellation::control_model_json(cancellation::control_model(kPlus), 1));
    lab_.out = root_.path();
    lab_.programs = root_ / "bin";
  }
  /// First gain of the models that the session's trials got, in order, and whether it has a map.
  std::vector<std::pair<double, bool>> given() {
    make(3);
    FakeTrials trials;
    EXPECT_TRUE(run(trials));
    // Before each trial what its model settles sooner than another, then, but for the first, the
    // rest.
    EXPECT_EQ(std::erase(trials.rested, 10.0), 2u);
    sooner_s_ = trials.rested;
    std::vector<std::pair<double, bool>> out;
    for (const auto& model : trials.used) {
      const cancellation::InputPath& input = model.inputs.at(0);
      out.emplace_back(input.numerator.at(0), !input.map.values.empty());
    }
    return out;
  }
  std::vector<double> sooner_s_;
  std::string note() {
    for (const Entry& entry : read_journal(folder_->journal(0))) {
      if (entry.kind == EntryKind::kNote) return entry.text;
    }
    return "";
  }
};

// B and C run the identified model of FakeTrials, of gain -2.
TEST_F(DiagnosedTest, CPlusIsWhatTheSessionsIdentificationLacks) {
  write("answer/summary.json", lab::pause_summary().dump());
  EXPECT_THAT(given(), testing::UnorderedElementsAre(std::pair(-2.0, false), std::pair(-2.0, false),
                                                     std::pair(3.2, false)));
  EXPECT_THAT(note(), HasSubstr("diagnosis: "));
  EXPECT_THAT(note(), testing::Not(HasSubstr("in its place")));
  // A participant who counts seconds learns nothing.
  const double later_s =
      1e-3 * static_cast<double>(cancellation::settle_ticks(kPlus) -
                                 cancellation::settle_ticks({1000.0, {-2.0}, {1.0}}));
  EXPECT_GT(later_s, 0.1);
  EXPECT_THAT(sooner_s_, testing::UnorderedElementsAre(0.0, testing::DoubleNear(later_s, 1e-9),
                                                       testing::DoubleNear(later_s, 1e-9)));
}

// The intention counts: its trials are C+, and a recording keeps them apart from C.
TEST_F(DiagnosedTest, WithoutACertainGainCPlusIsTheIdentifiedModelBehindAStraightLine) {
  nlohmann::json summary = lab::pause_summary();
  summary["kept"] = false;
  for (const bool ready : {true, false}) {
    write("answer/summary.json", ready ? summary.dump() : "");
    EXPECT_THAT(given(),
                testing::UnorderedElementsAre(std::pair(-2.0, false), std::pair(-2.0, false),
                                              std::pair(-2.0, true)));
    EXPECT_THAT(note(), HasSubstr("the identified model runs in its place"));
  }
}

TEST_F(SessionScriptTest, AMitigationRunsWithItsPartsBehindItsIdentification) {
  design_.conditions = {"B", "signal", "damping+force"};
  design_.comparisons = {"B-signal"};
  design_.blocks = 1;
  make(3);
  FakeTrials trials;
  ASSERT_TRUE(run(trials));
  ASSERT_EQ(trials.ran.size(), 5u);
  EXPECT_EQ(trials.ran[0].label, session::Condition::kIdentification);
  EXPECT_EQ(trials.ran[1].label, session::Condition::kFreeIdentification);
  EXPECT_NE(trials.ran[0].motion_seed, trials.ran[1].motion_seed);
  EXPECT_EQ(trials.models, 0);  // the canceller keeps the session's own
  std::set<std::size_t> parts;
  for (std::size_t i = 0; i < trials.ran.size(); ++i) {
    EXPECT_EQ(trials.ran[i].trial.number, static_cast<std::int64_t>(i));
    EXPECT_FALSE(trials.ran[i].cancellation);
    if (i > 1) parts.insert(trials.ran[i].parts.size());
  }
  EXPECT_THAT(parts, ElementsAre(0, 1, 2));  // B, signal, damping+force
}

TEST_F(SessionScriptTest, WithoutSignalNoFreeStickIsIdentified) {
  design_.conditions = {"B", "damping"};
  design_.comparisons = {};
  make(3);
  FakeTrials trials;
  ASSERT_TRUE(run(trials));
  EXPECT_EQ(trials.ran[1].trial.phase, TrialPhase::kTracking);
}

// Every seed is another order of the conditions and other labels.
TEST_F(SessionScriptTest, NothingThatIsShownDependsOnTheConditions) {
  std::vector<std::vector<std::string>> all;
  std::set<std::vector<std::size_t>> orders;
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u, 6u}) {
    make(seed);
    FakeTrials trials;
    ASSERT_TRUE(run(trials));
    std::vector<std::string> texts;
    for (const lab::Prompt& each : trials.shown) {
      std::string text = each.text + "|" + each.lowest + "|" + each.highest;
      for (const std::int64_t number : {static_cast<std::int64_t>(each.kind), each.block,
                                        each.blocks, each.trial, each.trials, each.steps}) {
        text += "|" + std::to_string(number);
      }
      texts.push_back(text + "|" + std::to_string(each.wait_s.value_or(-1.0)));
    }
    all.push_back(texts);
    std::vector<std::size_t> order;
    for (const Step& step : folder_->plan(0)) {
      if (step.kind == StepKind::kTrial) order.push_back(step.condition);
    }
    orders.insert(order);
    EXPECT_EQ(all.front(), texts) << seed;
  }
  EXPECT_GT(orders.size(), 1u);
}

// The dashboard lists that a model was loaded.
TEST_F(SessionScriptTest, EveryTrialOfADesignThatChoosesModelsGetsOne) {
  design_.conditions = {"A", "B", "C", "C'"};
  make(3);
  FakeTrials trials;
  ASSERT_TRUE(run(trials));
  EXPECT_EQ(trials.models, 8);  // two blocks
}

TEST_F(SessionScriptTest, AKillAtAnyPointAsksAgainWhatWasNotAnsweredAndNothingTwice) {
  make(3);
  const std::size_t steps = folder_->plan(0).size();
  int kill_at = 0;
  for (bool whole = false; !whole; ++kill_at) {
    make(3);
    FakeTrials first(kill_at + 1);
    whole = run(first);
    if (!whole) {
      FakeTrials second;
      ASSERT_TRUE(run(second)) << "killed in call " << kill_at + 1;
    }
    const auto counts = completed();
    EXPECT_EQ(counts.size(), steps) << "killed in call " << kill_at + 1;
    for (const auto& [step, count] : counts) EXPECT_EQ(count, 1) << "step " << step;
  }
  EXPECT_GT(kill_at, 30);  // every call of the script
}

TEST_F(SessionScriptTest, AnAnswerIsInTheJournalAndOneThatIsPassedOverHasNone) {
  for (const bool passes_over : {false, true}) {
    make(3);
    FakeTrials trials;
    trials.passes_over = passes_over;
    ASSERT_TRUE(run(trials));
    int questions = 0;
    for (const Entry& entry : read_journal(folder_->journal(0))) {
      if (entry.kind != EntryKind::kQuestionAnswered) continue;
      ++questions;
      const bool effort = entry.text.starts_with("effort");
      EXPECT_EQ(entry.answer, passes_over ? 0 : effort ? 7 : 9);
      if (passes_over) {
        EXPECT_THAT(entry.text, HasSubstr("passed over"));
      }
    }
    EXPECT_EQ(questions, 7);
  }
}

TEST_F(SessionScriptTest, ASimulatedSubjectIsAskedNothing) {
  design_.who = "simulated";
  make(3);
  FakeTrials trials;
  ASSERT_TRUE(run(trials));
  EXPECT_EQ(trials.asked_prompts, 0);
}

}  // namespace
}  // namespace stillhand::experiment::session_script_test
