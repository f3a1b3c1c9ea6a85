// SPDX-License-Identifier: Apache-2.0
// Same core, two modes: what a live session's cores answered, their replay in one process answers
// bit for bit, gaps included.  STILLHAND_RECORDING names the session.mcap.
#include <gtest/gtest.h>

#include <bit>
#include <cstdlib>
#include <functional>
#include <iostream>

#include "contract/config_error.hpp"
#include "equivalence/core_replays.hpp"
#include "recording/core/mcap_reader.hpp"
#include "recording/file_io.hpp"

namespace stillhand::equivalence {
namespace {

// A core that answered for less than a second proves nothing.
constexpr std::int64_t kFewest = 1000;

std::uint64_t seed_of(const std::string& path) {
  recording::FileSource file(path);
  const recording::McapReader reader(file);
  const recording::Metadata* session = reader.find_metadata("stillhand.session");
  if (session == nullptr || session->texts.count("seed") == 0) {
    throw ConfigError(path, "no seed", "a recording of a session");
  }
  return std::stoull(session->texts.at("seed"));
}

class LiveRecordingTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const char* path = std::getenv("STILLHAND_RECORDING");
    if (path == nullptr) return;
    settings_ = {STILLHAND_SOURCE "/deploy/config", seed_of(path)};
    session_ = std::make_unique<SessionRecording>(experiment::read_session(path));
  }
  static void TearDownTestSuite() { session_.reset(); }
  void SetUp() override {
    if (std::getenv("STILLHAND_RECORDING") == nullptr) {
      GTEST_SKIP() << "STILLHAND_RECORDING names no recording of a live session";
    }
    ASSERT_NE(session_, nullptr);
  }

  static void expect_same(const Replay& replay, std::int64_t fewest = kFewest) {
    std::cout << replay.core << ": from tick " << replay.first_tick << ", " << replay.compared
              << " compared, " << replay.different << " different, " << replay.unseen
              << " ticks unseen by the core, " << replay.unrecorded << " unseen by the recorder";
    if (!replay.ended.empty()) std::cout << "; ENDED EARLY: " << replay.ended;
    std::cout << '\n';
    EXPECT_EQ(replay.different, 0) << replay.first_difference;
    EXPECT_GE(replay.compared, fewest) << replay.ended;
  }

  static std::unique_ptr<SessionRecording> session_;
  static SessionSettings settings_;
};

std::unique_ptr<SessionRecording> LiveRecordingTest::session_;
SessionSettings LiveRecordingTest::settings_;

TEST_F(LiveRecordingTest, TheRecordingIsWhole) {
  EXPECT_TRUE(session_->damage.empty()) << session_->damage.front();
  for (const auto& [topic, lost] : session_->lost_ticks) {
    std::cout << topic << ": " << session_->messages[topic] << " messages, " << lost
              << " ticks missing\n";
  }
}

TEST_F(LiveRecordingTest, SensingAnswersTheSame) {
  expect_same(replay_sensing(*session_, settings_));
}

TEST_F(LiveRecordingTest, MotionAnswersTheSame) {
  expect_same(replay_motion(*session_, settings_));
}

TEST_F(LiveRecordingTest, CancellationAnswersTheSame) {
  expect_same(replay_cancellation(*session_, settings_));
}

TEST_F(LiveRecordingTest, DisplayAnswersTheSame) {
  expect_same(replay_display(*session_, settings_));
}

TEST_F(LiveRecordingTest, TheSimulatedSubjectAnswersTheSame) {
  if (!session_->pointers.empty()) GTEST_SKIP() << "a person's mouse took the subject's place";
  expect_same(replay_human_operator(*session_, settings_));
}

TEST_F(LiveRecordingTest, TheRigAnswersTheSame) { expect_same(replay_rig(*session_, settings_)); }

TEST_F(LiveRecordingTest, IdentificationFindsTheSameModel) {
  // Its outputs are models, each from the many samples of a pegged trial.
  expect_same(replay_identification(*session_, settings_), 1);
}

// ---- The comparison can fail: one bit of one input, and the answers part from there.

/// Bit 20 of the mantissa: a change of 2^-32, small, yet too large to vanish in a rounding.
double flipped(double value) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(value) ^ (std::uint64_t{1} << 20));
}

/// The message in the middle of those that `fits`; nullptr when none does.
template <typename Message, typename Fits>
Message* middle(std::vector<Message>& messages, const Fits& fits) {
  std::vector<Message*> fitting;
  for (Message& message : messages) {
    if (fits(message)) fitting.push_back(&message);
  }
  return fitting.empty() ? nullptr : fitting[fitting.size() / 2];
}

TEST_F(LiveRecordingTest, AFlippedBitOfARawSampleShowsInSensingAtItsTick) {
  SessionRecording session = *session_;
  auto* raw = middle(session.raw_samples, [](const auto&) { return true; });
  ASSERT_NE(raw, nullptr);
  raw->accel_y_v(flipped(raw->accel_y_v()));
  const Replay replay = replay_sensing(session, settings_);
  EXPECT_EQ(replay.first_difference_tick, raw->tick());
  EXPECT_NE(replay.first_difference.find("accel_y_m_s2"), std::string::npos);
}

TEST_F(LiveRecordingTest, AFlippedBitOfAnAccelerationShowsInCancellationAtItsTick) {
  SessionRecording session = *session_;
  // Where a model is at work.
  const auto* command =
      middle(session.motor_commands, [](const auto& each) { return each.force_n() != 0.0; });
  ASSERT_NE(command, nullptr) << "the motor never acted";
  const Tick tick = command->tick();
  auto* sensed = middle(session.sensed, [tick](const auto& each) { return each.tick() == tick; });
  ASSERT_NE(sensed, nullptr);
  sensed->accel_y_m_s2(flipped(sensed->accel_y_m_s2()));
  const Replay replay = replay_cancellation(session, settings_);
  EXPECT_EQ(replay.first_difference_tick, tick);
  EXPECT_NE(replay.first_difference.find("predicted_force_n"), std::string::npos);
}

TEST_F(LiveRecordingTest, AFlippedBitOfAMotorForceShowsInTheRig) {
  SessionRecording session = *session_;
  auto* command =
      middle(session.motor_commands, [](const auto& each) { return each.force_n() != 0.0; });
  ASSERT_NE(command, nullptr) << "the motor never acted";
  command->force_n(flipped(command->force_n()));
  const Replay replay = replay_rig(session, settings_);
  EXPECT_GT(replay.first_difference_tick, command->tick());
  EXPECT_GT(replay.different, 0);
}

TEST_F(LiveRecordingTest, AFlippedBitOfATargetShowsInTheSubject) {
  SessionRecording session = *session_;
  auto* sample =
      middle(session.tracking_samples, [](const auto& e) { return e.target_m() != 0.0; });
  ASSERT_NE(sample, nullptr) << "nothing was tracked";
  sample->target_m(flipped(sample->target_m()));
  const Replay replay = replay_human_operator(session, settings_);
  EXPECT_GE(replay.first_difference_tick, sample->tick());
  EXPECT_GT(replay.different, 0);
}

TEST_F(LiveRecordingTest, AnotherMotionSeedShowsInTheMotion) {
  SessionRecording session = *session_;
  auto* moved = middle(session.trial_assignments, [](const auto& each) {
    return each.motion() != stillhand_msgs::MOTION_STILL;
  });
  ASSERT_NE(moved, nullptr) << "the platform never moved";
  moved->motion_seed(moved->motion_seed() ^ 1u);
  EXPECT_GT(replay_motion(session, settings_).different, 0);
}

TEST_F(LiveRecordingTest, AnotherReferenceSeedShowsInTheDisplay) {
  SessionRecording session = *session_;
  auto* tracked = middle(session.trial_controls, [](const auto& each) {
    return each.phase() == stillhand_msgs::PHASE_TRACKING;
  });
  ASSERT_NE(tracked, nullptr) << "nothing was tracked";
  tracked->reference_seed(tracked->reference_seed() ^ 1u);
  EXPECT_GT(replay_display(session, settings_).different, 0);
}

}  // namespace
}  // namespace stillhand::equivalence
