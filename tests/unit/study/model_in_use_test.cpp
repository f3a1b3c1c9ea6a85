// SPDX-License-Identifier: Apache-2.0
// The model of a trial, from hand-made messages.
#include "apps/study/recorded/model_in_use.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "services/messages/cancellation/codec.hpp"

namespace stillhand::study::model_in_use_test {
namespace {

using testing::HasSubstr;

class ModelInUseTest : public testing::Test {
 protected:
  ModelInUseTest() {
    trial_.letter = 'C';
    trial_.trial.start_tick = 1000;
    trial_.trial.duration_ticks = 1000;
    trial_.end_tick = 2000;
    stillhand_msgs::FeedthroughModel identified;
    identified.model(0);
    recorded_.models.push_back(identified);
  }

  void give(std::int32_t number, Tick from) {
    stillhand_msgs::AugmentedModel model;
    model.model(number);
    model.from_tick(from);
    recorded_.control_models.push_back(model);
  }
  void run(std::int32_t number, Tick first, Tick last, std::uint32_t rig = 0) {
    for (Tick tick = first; tick < last; ++tick) {
      stillhand_msgs::MotorCommand command;
      command.rig(rig);
      command.tick(tick);
      command.model(number);
      recorded_.motor_commands.push_back(command);
    }
  }
  void answer(stillhand_msgs::EventKind kind, Tick tick, const char* text = "") {
    stillhand_msgs::Event event;
    event.kind(kind);
    event.tick(tick);
    event.text(text);
    recorded_.events.push_back(event);
  }
  [[nodiscard]] std::string other() const { return other_model_in(recorded_, trial_, 0); }

  session::SessionRecording recorded_;
  measurement::SessionTrial trial_;
};

TEST_F(ModelInUseTest, TheModelThatIsInForceIsNoOther) {
  run(0, 900, 2100);
  EXPECT_EQ(other(), "");
  give(1000, 2000);  // for the next trial
  EXPECT_EQ(other(), "");
}

TEST_F(ModelInUseTest, ARefusedModelIsNamedWithTheModelThatRan) {
  give(1000, 500);
  answer(stillhand_msgs::EVENT_MODEL_REFUSED, 400, "too large");
  run(0, 1000, 2000);
  run(1000, 1000, 2000, 1);  // of another rig
  EXPECT_EQ(
      other(),
      "ran model 0 in place of model 1000 in 100 % of it; the canceller refused it: too large");
}

TEST_F(ModelInUseTest, WithoutARefusalTheReasonIsLeftOut) {
  give(1000, 500);
  run(-1, 1000, 1300);
  run(1000, 1300, 2000);
  EXPECT_EQ(other(), "ran no model in place of model 1000 in 30 % of it");
}

TEST_F(ModelInUseTest, OnePercentOfATrialIsNoOtherTrial) {
  give(1000, 500);
  run(0, 1000, 1010);
  run(1000, 1010, 2000);
  EXPECT_EQ(other(), "");
}

TEST_F(ModelInUseTest, ALaterModelThatWasTakenEndsARefusal) {
  answer(stillhand_msgs::EVENT_MODEL_REFUSED, 300, "too large");
  EXPECT_THAT(other(), HasSubstr("had a model that the canceller refused: too large"));
  answer(stillhand_msgs::EVENT_MODEL_LOADED, 400);
  EXPECT_EQ(other(), "");
  answer(stillhand_msgs::EVENT_MODEL_REFUSED, 1000, "for the next trial");
  EXPECT_EQ(other(), "");
}

TEST_F(ModelInUseTest, ATrialWithoutCancellationHasNoModelToLack) {
  give(1000, 500);
  run(0, 1000, 2000);
  trial_.letter = 'B';
  EXPECT_EQ(other(), "");
  EXPECT_EQ(condition_in(recorded_, trial_, 0), kB);
}

TEST_F(ModelInUseTest, CPlusBehindAStraightLineAddsNothing) {
  recorded_.models[0].control_numerator({-2.0});
  recorded_.models[0].control_denominator({1.0});
  cancellation::ControlModel model;
  model.rate_hz = kControlRateHz;
  model.denominator = {1.0};
  model.inputs = {{cancellation::Channel::kAccelY, {-1.0, 1.0, {-1.0, 1.0}}, {-2.0}}};
  const auto judged = [&] {
    recorded_.control_models = {cancellation::to_idl(model, 1000)};
    recorded_.control_models[0].from_tick(500);
    return std::pair(condition_in(recorded_, trial_, 0).value(),
                     adds_nothing(recorded_, trial_, 0));
  };
  EXPECT_EQ(judged(), std::pair(kCPlus, true));
  model.inputs[0].map.values = {-1.0, 0.5};
  EXPECT_EQ(judged(), std::pair(kCPlus, false));
  model.inputs[0].map = {};
  EXPECT_EQ(judged(), std::pair(kC, false));
  model.inputs[0].numerator = {3.0};
  EXPECT_EQ(judged(), std::pair(kCPlus, false));
}

TEST_F(ModelInUseTest, ARecordingWithoutModelsIsJudgedByTheCommands) {
  recorded_.models.clear();
  run(3, 1000, 2000);
  EXPECT_EQ(other(), "");
  run(-1, 1000, 2000);
  EXPECT_EQ(other(), "ran no model");
}

TEST_F(ModelInUseTest, ATrialWithAMitigationIsJudgedByTheTrialThatItsCommandsName) {
  trial_.letter = '?';
  trial_.named = "signal";
  trial_.trial.number = 4;
  EXPECT_EQ(condition_in(recorded_, trial_, 0), kSignal);
  EXPECT_THAT(other(), HasSubstr("has no motor command"));
  run(0, 1000, 2000);
  for (auto& command : recorded_.motor_commands) {
    command.enabled(true);
    command.mitigated_trial(4);
  }
  EXPECT_EQ(other(), "");
  for (std::size_t i = 0; i < 300; ++i) recorded_.motor_commands[i].mitigated_trial(3);
  EXPECT_EQ(other(), "ran without signal in 30 % of it");
  trial_.named = "of another program";
  EXPECT_EQ(condition_in(recorded_, trial_, 0), std::nullopt);
  trial_.named = "C";
  EXPECT_EQ(condition_in(recorded_, trial_, 0), std::nullopt);
}

}  // namespace
}  // namespace stillhand::study::model_in_use_test
