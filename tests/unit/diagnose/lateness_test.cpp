// SPDX-License-Identifier: Apache-2.0
// The split ahead of the verdict, of a recording whose stalls are known.
#include "apps/diagnose/page/lateness.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "places.hpp"
#include "services/core/recording/experiment_record.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/session_file.hpp"
#include "tests/support/stalled_session.hpp"

namespace stillhand::diagnose::lateness_test {

using testing::HasSubstr;

class LatenessTest : public testing::Test {
 protected:
  void write(const tests::StalledSession& made, bool cancels, bool blinded = false) {
    tests::SessionFile file;
    const Trial& trial = made.trial;
    file.assignment(1, stillhand_msgs::MOTION_BAND_NOISE, cancels);
    stillhand_msgs::TrialControl control;
    control.session(stillhand_msgs::SESSION_RUNNING);
    control.trial(1);
    control.phase(stillhand_msgs::PHASE_TRACKING);
    control.start_tick(trial.start_tick);
    control.duration_ticks(trial.duration_ticks);
    control.ramp_ticks(trial.ramp_ticks);
    file.add(topics::kTrialControl, control);
    const session::SessionRecording& session = made.recording;
    for (const auto& model : session.control_models) file.add(topics::kAugmentedModel, model);
    for (const auto& raw : session.raw_samples) file.add(topics::kRawSample, raw);
    for (const auto& sensed : session.sensed) file.add(topics::kSensed, sensed);
    for (const auto& command : session.motor_commands) file.add(topics::kMotorCommand, command);
    for (const auto& truth : session.rig_truths) file.add(topics::kRigTruth, truth);
    if (blinded) file.metadata(recording::kExperimentRecord, {{"participant", "P01"}});
    const auto bytes = file.close();
    std::ofstream(path_, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }
  std::vector<RecordedSplit> splits(const std::string& trial = "") const {
    return recorded_splits({path_}, trial, STILLHAND_SOURCE "/deploy/config");
  }
  void TearDown() override { std::filesystem::remove(path_); }

  std::string path_ = testing::TempDir() + "lateness_" +
                      testing::UnitTest::GetInstance()->current_test_info()->name() + ".mcap";
};

TEST_F(LatenessTest, SplitsWhatKnownStallsDidAheadOfTheVerdict) {
  // --gtest_random_seed=N: other noise, another motion, stalls at other moments.
  tests::Faults faults{.seed = 1 + static_cast<std::uint64_t>(GTEST_FLAG_GET(random_seed))};
  const tests::StalledSession whole = stalled_session(faults);
  faults.stall_ticks = 73;
  const tests::StalledSession stalled = stalled_session(faults);
  write(stalled, true);
  const double known_n = tests::share_n(stalled, tests::difference(stalled.motor_n, whole.motor_n));
  const auto sut = splits();
  ASSERT_EQ(sut.size(), 1u);
  ASSERT_TRUE(sut.front().split.budget) << sut.front().split.why;
  const session::ForceBudget& budget = *sut.front().split.budget;
  std::printf("stalls of 73 ms a second: %.4f N known, %.4f N (%.4f to %.4f) found\n", known_n,
              budget.lateness.force_n, budget.lateness.low_n, budget.lateness.high_n);
  EXPECT_NEAR(budget.lateness.force_n, known_n, 0.05 * known_n);
  EXPECT_THAT(splits_table(sut), HasSubstr("trial 1 (C, 30 s) leaves"));
  const auto json = nlohmann::json::parse(with_splits("{}", sut)).at("lateness").at(0);
  EXPECT_EQ(json.at("lateness").at("force_n"), budget.lateness.force_n);
  double sum_n = 0.0;
  for (const session::ForceCause& cause : session::kForceCauses) {
    sum_n += json.at(cause.key).at("force_n").get<double>();
  }
  EXPECT_NEAR(sum_n, json.at("left").at("force_n").get<double>(), 1e-9);
  report::Page page("title", "verdict");
  add_splits(sut, page);
  EXPECT_THAT(page.html(), HasSubstr("samples and answers were late"));
  EXPECT_EQ(splits("1").size(), 1u);
  EXPECT_EQ(splits("C").size(), 1u);
}

TEST_F(LatenessTest, ATrialWithoutCancellationOrBlindedHasNone) {
  const tests::StalledSession made = tests::stalled_session({});
  write(made, false);
  EXPECT_EQ(splits_table(splits()), "");
  write(made, true, true);
  EXPECT_TRUE(splits().empty());
  EXPECT_TRUE(splits("1").empty());
  EXPECT_THAT(support::refusal([&] { (void)splits("C"); }),
              HasSubstr("--trial: got C, want one of 1 (30 s) in "))
      << "its condition would find it";
}

}  // namespace stillhand::diagnose::lateness_test
