// SPDX-License-Identifier: Apache-2.0
// The pegged model of one hand on a very different one: what following gain and phase does then,
// Eq. CC-10 to CC-13.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "apps/close_the_loop/session/session.hpp"
#include "apps/close_the_loop/verdict/control_model.hpp"
#include "services/core/contract/tick.hpp"

namespace stillhand::close_the_loop::wrong_task_test {
namespace {

struct Outcome {
  double still = 0.0;     ///< RMS error of A [mm]
  double moving = 0.0;    ///< of B
  double paper = 0.0;     ///< of C, the model as it is
  double followed = 0.0;  ///< of C, its gain and phase followed
};

// @param model_gain  what the identified model is multiplied with before it is used
Outcome run(const rig::BodyConfig& tracking_hand, double model_gain) {
  session::ProtocolOptions protocol;
  protocol.conditions = session::parse_conditions("A,B,C");
  protocol.identify_s = 60.0;
  protocol.trial_s = 120.0;
  session::CoreConfigs configs;
  // Identified on the average hand; another one tracks.
  cancellation::ControlModel model;
  {
    InProcessSession average({configs}, protocol.seed);
    const TrialRun pegged = average.run(session::plan(protocol)[0], "I");
    model = cancellation::control_model(average.identify(pegged).control);
  }
  for (double& c : model.inputs[0].numerator) c *= model_gain;
  configs.rig.body = tracking_hand;
  InProcessSession session({configs}, protocol.seed);
  Outcome out;
  for (const session::PlannedTrial& planned : session::plan(protocol)) {
    if (planned.trial.phase == TrialPhase::kPegged) continue;
    const auto error_mm = [&] { return session.run(planned, "").metrics.rms_error_mm; };
    if (planned.label == session::Condition::kA) out.still = error_mm();
    if (planned.label == session::Condition::kB) out.moving = error_mm();
    if (planned.label != session::Condition::kC) continue;
    EXPECT_EQ(session.use(model), "");
    out.paper = error_mm();
    cancellation::ControlModel followed = model;
    followed.adapts = average_hand();
    EXPECT_EQ(session.use(followed), "");
    out.followed = error_mm();
  }
  std::printf("A %.1f, B %.1f, the model as it is %.1f, followed %.1f mm\n", out.still, out.moving,
              out.paper, out.followed);
  return out;
}

rig::BodyConfig hand(double stiffness_factor, double damping_factor) {
  rig::BodyConfig body;
  body.cocontraction_stiffness_factor = stiffness_factor;
  body.cocontraction_damping_factor = damping_factor;
  return body;
}

TEST(WrongTaskTest, AHandThatClenchesIsFollowed) {
  const Outcome out = run(hand(4.0, 2.0), 1.0);
  EXPECT_LT(out.followed, out.paper);
  // Four times as stiff, it shows an error four times more slowly: two minutes are short.
  EXPECT_LT(out.followed, out.still + 0.3 * (out.moving - out.still));
}

TEST(WrongTaskTest, AModelThatPushesTheWrongWayIsTakenBack) {
  const Outcome out = run(hand(1.3, 1.14), -1.0);
  EXPECT_GT(out.paper, 1.3 * out.moving);     // as it is, it does harm
  EXPECT_LT(out.followed, 1.1 * out.moving);  // the first seconds are in it
}

TEST(WrongTaskTest, AModelThatPushesTooHardIsTakenBack) {
  const Outcome out = run(hand(1.3, 1.14), 2.5);
  EXPECT_GT(out.paper, out.moving);
  EXPECT_LT(out.followed, 0.7 * out.moving);
}

}  // namespace
}  // namespace stillhand::close_the_loop::wrong_task_test
