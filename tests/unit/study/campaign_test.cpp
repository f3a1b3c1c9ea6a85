// SPDX-License-Identifier: Apache-2.0
// The table of mitigations: Eqs. SU-16 to SU-20.  About 12 s of processor time.
#include "apps/study/mitigations/campaign.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "apps/study/mitigations/campaign_output.hpp"
#include "apps/study/mitigations/choices.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::study::campaign_test {
namespace {

signal::DifferenceModel second_order_model() {
  const double r = std::exp(-0.3 * 2.0 * std::numbers::pi * 3.0 * 1e-3);
  const double c = 2.0 * r * std::cos(2.0 * std::numbers::pi * 3.0 * 1e-3);
  const double gain = -3.5 * (1.0 - c + r * r);
  return {1000.0, {gain, 0.0, 0.0}, {1.0, -c, r * r}};
}

// The trial of a mitigation is a session's trial: with the paper's canceller the error is that of
// session::InProcessLoop, bit for bit.
TEST(MitigatedTrialTest, IsTheSessionsTrial) {
  const population::Subject person = population::draw_subject({}, 5, 3);
  session::ProtocolOptions protocol;
  protocol.trial_s = 8.0;
  protocol.seed = 11;
  const session::PlannedTrial planned =
      session::tracking_trial(protocol, session::Condition::kC, 1);
  constexpr std::uint64_t kSeed = 77;

  session::CoreConfigs configs;
  configs.rig.body = person.body;
  configs.human_operator = person.who;
  session::InProcessLoop loop(configs, kSeed);
  ASSERT_EQ(loop.use_model(cancellation::control_model(second_order_model())),
            cancellation::Refusal::kNone);
  const auto signals = loop.run(planned);
  double sum = 0.0;
  for (std::size_t n = 0; n < signals.tracking.target_m.size(); ++n) {
    const double error_m = signals.tracking.cursor_m[n] - signals.tracking.target_m[n];
    sum += error_m * error_m;
  }
  const double expected_mm =
      1000.0 * std::sqrt(sum / static_cast<double>(signals.tracking.target_m.size()));

  TrialScene scene;
  scene.subject = person;
  scene.motion = motion::MotionTrajectory(session::motion_profile(planned), {});
  scene.rig_seed = kSeed;
  scene.reference_seed = planned.reference_seed;
  scene.duration_ticks = planned.trial.duration_ticks;
  scene.ramp_ticks = planned.trial.ramp_ticks;
  scene.settle_ticks = 0;
  cancellation::Recipe recipe;
  recipe.force = true;
  recipe.model = cancellation::control_model(second_order_model());
  const TrialFigures sut = run_mitigated(scene, recipe, false);
  EXPECT_DOUBLE_EQ(sut.error_mm, expected_mm);
  EXPECT_GT(sut.motor_n, 1.0);
}

// A person who relaxes gives no force, and is shaken more than one who holds.
TEST(MitigatedTrialTest, TheTaskChangesThePerson) {
  TrialScene scene;
  scene.subject = population::draw_subject({}, 5, 3);
  scene.duration_ticks = 8000;
  scene.settle_ticks = 2000;
  scene.motion = trial_motion(TrialMotion::kBand, 8000, 2000, 4);
  scene.task = TrialTask::kRelax;
  const TrialFigures relaxed = run_mitigated(scene, {}, false);
  scene.task = TrialTask::kHold;
  const TrialFigures holding = run_mitigated(scene, {}, false);
  EXPECT_EQ(relaxed.effort_n, 0.0);
  EXPECT_GT(relaxed.error_mm, 1.2 * holding.error_mm);
  EXPECT_EQ(relaxed.motor_n, 0.0);
}

// A made ride has the power that SU-17 says: sqrt(1.2^2 + 0.8^2) = 1.44 m/s^2 over many rides; one
// of 60 s spreads by its changing roughness.
TEST(MadeRideTest, HasItsPower) {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    for (const double a : made_ride(60.0, seed)) {
      sum += a * a;
      ++count;
    }
  }
  EXPECT_NEAR(std::sqrt(sum / static_cast<double>(count)), 1.44, 0.15);
  EXPECT_EQ(made_ride(1.0, 3), made_ride(1.0, 3));
}

TrialFigures figures_of(double error_mm) { return {error_mm, 2.0, 3.0, 0.0}; }

// By hand: gains 10, 5 and -2 mm of 20, 20 and 20 mm.
TEST(CellFiguresTest, AreThoseByHand) {
  const CellFigures sut = cell_figures({}, {figures_of(30), figures_of(35), figures_of(42)},
                                       {40, 40, 40}, {20, 20, 20});
  EXPECT_DOUBLE_EQ(sut.restored[0], 0.5);
  EXPECT_DOUBLE_EQ(sut.restored[2], -0.1);
  EXPECT_DOUBLE_EQ(sut.restored_mean->ratio, 13.0 / 60.0);
  EXPECT_DOUBLE_EQ(sut.restored_median.value().median, 0.25);
  EXPECT_EQ(sut.worst_person, 2U);
  EXPECT_EQ(sut.harmed, 1U);
  EXPECT_DOUBLE_EQ(sut.harm.share, 1.0 / 3.0);
  EXPECT_NEAR(sut.error_mm, 107.0 / 3.0, 1e-12);
}

// Whom the motion does not disturb has no share; but can be harmed.
TEST(CellFiguresTest, LeavesOutWhoIsNotDisturbed) {
  const CellFigures sut = cell_figures({}, {figures_of(30), figures_of(50)}, {40, 40}, {20, 39.5});
  EXPECT_TRUE(std::isnan(sut.restored[1]));
  EXPECT_DOUBLE_EQ(sut.restored_median.value().median, 0.5);
  EXPECT_EQ(sut.harmed, 1U);
}

TEST(CellFiguresTest, OfNobodyWhoIsDisturbedHaveNoShareAndNoWorst) {
  const CellFigures sut =
      cell_figures({}, {figures_of(30), figures_of(41)}, {40, 42}, {39.5, 41.8});
  EXPECT_EQ(sut.restored_median, std::nullopt);
  EXPECT_EQ(sut.worst_person, std::nullopt);
}

TEST(MitigationsNamedTest, KeepsTheTablesOrderAndAlwaysNone) {
  const auto sut = mitigations_named("damping,signal");
  EXPECT_EQ(sut, (std::vector<Condition>{kB, kSignal, kDamping}));
  EXPECT_EQ(mitigations_named("arm-rest,none"), (std::vector<Condition>{kB, kF}));
  EXPECT_THROW(mitigations_named("magic"), ConfigError);
  EXPECT_THROW(mitigations_named("signal,signal"), ConfigError);
}

// Two people, every mitigation, tracking in the paper's motion: the same numbers with one thread
// and with three; own models restore.
TEST(CampaignTest, RunsEveryMitigationAndDoesNotDependOnThreads) {
  CampaignOptions options;
  options.subjects = 2;
  options.trial_s = 6.0;
  options.identify_s = 30.0;
  options.mitigations = mitigations_named("all");
  options.tasks = {TrialTask::kTrack};
  options.motions = {TrialMotion::kBand};
  options.threads = 1;
  const auto go_on = [](const std::string&, double) { return true; };
  const Campaign sut = run_campaign(options, go_on);
  // Own, average and another person's model, where a mitigation needs one.
  EXPECT_TRUE(needs_model(kC) && !needs_model(kDamping));
  std::size_t cells = 0;
  for (const Condition each : options.mitigations) cells += needs_model(each) ? 3 : 1;
  EXPECT_EQ(sut.cells.size(), cells);
  options.threads = 3;
  const Campaign again = run_campaign(options, go_on);
  EXPECT_EQ(mitigations_csv(sut), mitigations_csv(again));
  EXPECT_EQ(mitigation_people_csv(sut), mitigation_people_csv(again));
  for (const CellFigures& cell : sut.cells) {
    EXPECT_EQ(cell.people.size(), 2U);
    if (cell.key.mitigation == kB) {
      EXPECT_EQ(cell.harmed, 0U);
    }
    if (cell.key.model == ModelOf::kOwn && cell.key.mitigation == kC) {
      EXPECT_GT(cell.restored_median->median, 0.2);
    }
  }
}

TEST(CampaignTest, StopsWhenAsked) {
  CampaignOptions options;
  options.subjects = 2;
  options.mitigations = mitigations_named("damping");
  EXPECT_THROW(run_campaign(options, [](const std::string&, double) { return false; }),
               std::runtime_error);
  options.subjects = 1;
  EXPECT_THROW(run_campaign(options, [](const std::string&, double) { return true; }), ConfigError);
}

}  // namespace
}  // namespace stillhand::study::campaign_test
