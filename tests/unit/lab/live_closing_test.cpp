// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/live_closing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <thread>

#include "idl/session.h"
#include "services/files/cancellation/control_model_file.hpp"
#include "tests/support/folder.hpp"
#include "tests/unit/lab/pause_summary.hpp"

namespace stillhand::lab::live_closing_test {
namespace {

using session::Condition;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

cancellation::ControlModel gain(double n_s2_m) {
  cancellation::ControlModel model;
  model.rate_hz = 1000.0;
  model.denominator = {1.0};
  model.inputs = {{cancellation::Channel::kAccelY, {}, {n_s2_m}}};
  model.adapts = cancellation::kAverageHand;
  return model;
}

/// A session in which every trial is completed at once.
class Trials final : public LiveTrials {
 public:
  Trials() { model_.control = {1000.0, {-2.0}, {1.0}}; }

  const session::TrialOutcome& run(const session::PlannedTrial& planned) override {
    return run_once(planned);
  }
  const session::TrialOutcome& run_once(const session::PlannedTrial& planned) override {
    return run_between(planned);
  }
  const session::TrialOutcome& run_between(const session::PlannedTrial& planned) override {
    ran.push_back(planned.label);
    outcome_.planned = planned;
    outcome_.completed = true;
    outcome_.no_model = planned.label == Condition::kIdentification ? no_model : std::string();
    return outcome_;
  }
  void show(const Prompt& /*prompt*/) override {}
  std::optional<std::int64_t> ask(const Prompt& /*prompt*/, const std::string& /*what*/) override {
    return std::nullopt;
  }
  void rest(const std::string& what, double seconds, const std::function<bool()>& over) override {
    rested[what] += seconds;
    while (patient && what.starts_with("diagnosis") && !over()) std::this_thread::yield();
  }
  void say(const std::string& line) override { said += line + "\n"; }
  void note(const std::string& /*text*/) override {}
  Asked asked() override { return {}; }
  [[nodiscard]] const identification::FeedthroughModel& model() const override { return model_; }
  std::string use(const cancellation::ControlModel& model) override {
    gains.push_back(model.inputs.at(0).numerator.at(0));
    EXPECT_FALSE(model.adapts);  // as C, and as it was judged
    if (!answers) throw std::runtime_error("the canceller did not answer within 5 s");
    return refuses;
  }
  [[nodiscard]] bool interrupted() const override { return false; }

  std::string no_model, refuses;
  bool answers = true;  ///< the canceller does
  bool patient = true;  ///< waits for the diagnosis
  std::vector<Condition> ran;
  std::map<std::string, double> rested;  ///< [s]
  std::vector<double> gains;             ///< of the models that the canceller got
  std::string said;

 private:
  identification::FeedthroughModel model_;
  session::TrialOutcome outcome_;
};

/// In place of the diagnosis, a program that copies its results from the folder `answer`.
class LiveClosingTest : public testing::Test {
 protected:
  LiveClosingTest() {
    for (const char* each : {"logs", "bin", "config", "answer"}) {
      std::filesystem::create_directory(folder_ / each);
    }
    write("config/cancellation.yaml", "");
    write("bin/stillhand", "#!/bin/sh\nfor out; do :; done\nmkdir -p \"$out\"\ncp " +
                               (folder_ / "answer").string() + "/* \"$out\"\n");
    std::filesystem::permissions(folder_ / "bin/stillhand", std::filesystem::perms::owner_all);
    write("answer/summary.json", pause_summary().dump());
    write("answer/control_model.json", cancellation::control_model_json(gain(3.2), 1));
    options_.protocol.conditions = {Condition::kC};
    options_.headless = true;
    options_.out = folder_.path();
    options_.programs = folder_ / "bin";
    options_.config = folder_ / "config";
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  /// A trial of C whose model did not hold.
  static session::TrialOutcome changed() {
    stillhand_msgs::Event event;
    event.kind(stillhand_msgs::EVENT_NOTE);
    event.code(stillhand_msgs::CODE_MODEL_CHANGED);
    session::TrialOutcome outcome{};
    outcome.planned.label = Condition::kC;
    outcome.completed = true;
    outcome.marks = {session::mark_of(event)};
    return outcome;
  }
  bool after(const session::TrialOutcome& outcome) {
    return LiveClosing(options_, trials_).after(outcome);
  }

  support::Folder folder_;
  LabOptions options_;
  Trials trials_;
};

TEST_F(LiveClosingTest, AModelThatHoldsIsLeftAlone) {
  session::TrialOutcome outcome = changed();
  outcome.marks.clear();
  EXPECT_TRUE(after(outcome));
  EXPECT_THAT(trials_.ran, IsEmpty());
  EXPECT_EQ(trials_.said, "");
}

TEST_F(LiveClosingTest, CPlusThatLeavesLessRunsAndTheSessionsModelComesBack) {
  EXPECT_TRUE(after(changed()));
  EXPECT_THAT(trials_.ran, ElementsAre(Condition::kIdentification, Condition::kCPlus));
  EXPECT_THAT(trials_.gains, ElementsAre(3.2, -2.0));
  EXPECT_THAT(trials_.said, HasSubstr("C+ taken for trial 3, dead_zone: leaves 0.81 N"));
  EXPECT_EQ(trials_.rested.at("before the identification"), 10.0);
}

TEST_F(LiveClosingTest, WhatIsNotCertainIsNotTakenWithoutAPerson) {
  auto summary = pause_summary();
  summary["decision"]["less_interval95"] = nullptr;
  write("answer/summary.json", summary.dump());
  EXPECT_TRUE(after(changed()));
  EXPECT_THAT(trials_.ran, ElementsAre(Condition::kIdentification, Condition::kC));
  EXPECT_THAT(trials_.gains, IsEmpty());
  EXPECT_THAT(trials_.said, HasSubstr("C+ not taken for trial 3"));
}

TEST_F(LiveClosingTest, AModelThatTheCancellerRefusesDoesNotRun) {
  trials_.refuses = "unstable";
  EXPECT_TRUE(after(changed()));
  EXPECT_THAT(trials_.ran, ElementsAre(Condition::kIdentification, Condition::kC));
  EXPECT_THAT(trials_.said, HasSubstr("C+ does not run in trial 3: unstable"));
}

// Which model the canceller has is not known then: no trial may be named after either.
TEST_F(LiveClosingTest, WithoutAnAnswerOfTheCancellerTheSessionEnds) {
  trials_.answers = false;
  EXPECT_THROW(after(changed()), std::runtime_error);
  EXPECT_THAT(trials_.ran, ElementsAre(Condition::kIdentification));
}

TEST_F(LiveClosingTest, AModelOfAnotherRigDoesNotRun) {
  write("answer/control_model.json", cancellation::control_model_json(gain(3.2), 2));
  EXPECT_TRUE(after(changed()));
  EXPECT_THAT(trials_.ran, ElementsAre(Condition::kIdentification, Condition::kC));
  EXPECT_THAT(trials_.gains, IsEmpty());
}

TEST_F(LiveClosingTest, ADiagnosisThatFailsLeavesTheModelThatWasIdentifiedAgain) {
  write("bin/stillhand", "#!/bin/sh\necho no gnuplot >&2\nexit 2\n");
  EXPECT_TRUE(after(changed()));
  EXPECT_THAT(trials_.ran, ElementsAre(Condition::kIdentification, Condition::kC));
  EXPECT_THAT(trials_.said, HasSubstr("exit status 2; it said: no gnuplot"));
  trials_.said.clear();
  write("bin/stillhand", "#!/bin/sh\nexec sleep 100\n");
  trials_.patient = false;
  EXPECT_TRUE(after(changed()));
  EXPECT_THAT(trials_.said, HasSubstr("its diagnosis was not ready"));
}

TEST_F(LiveClosingTest, WithoutAModelTheSessionGoesOnWithTheOneItHas) {
  trials_.no_model = "too little motion";
  EXPECT_TRUE(after(changed()));
  EXPECT_THAT(trials_.ran, ElementsAre(Condition::kIdentification));
  EXPECT_THAT(trials_.said,
              testing::EndsWith("the session goes on with its model: too little motion\n"));
}

}  // namespace
}  // namespace stillhand::lab::live_closing_test
