// SPDX-License-Identifier: Apache-2.0
// Same core, two modes: what a live session's cores answered, their replay in one process answers
// bit for bit, gaps included.  STILLHAND_RECORDING names the session.mcap, STILLHAND_CONFIG its
// settings unless they are deploy/config, STILLHAND_VEHICLE its --vehicle.
#include <gtest/gtest.h>

#include <bit>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <stdexcept>

#include "places.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/recording/mcap/mcap_reader.hpp"
#include "services/files/recording/file_io.hpp"
#include "tests/equivalence/core_replays.hpp"

namespace stillhand::equivalence {
namespace {

// A replay ends where an input is not in the recording.  One that ends early shows little, and
// fails.
constexpr double kLeastShare = 0.95;

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
    const char* config = std::getenv("STILLHAND_CONFIG");
    settings_ = {config != nullptr ? config : STILLHAND_SOURCE "/deploy/config", seed_of(path)};
    session_ = std::make_unique<SessionRecording>(session::read_session(path));
  }
  static void TearDownTestSuite() { session_.reset(); }
  void SetUp() override {
    if (std::getenv("STILLHAND_RECORDING") == nullptr) {
      GTEST_SKIP() << "STILLHAND_RECORDING names no recording of a live session";
    }
    ASSERT_NE(session_, nullptr);
  }

  static void expect_same(const Replay& replay) {
    std::cout << replay.core << ": from tick " << replay.first_tick << ", " << replay.compared
              << " of " << replay.recorded << " compared, " << replay.different << " different, "
              << replay.unseen << " ticks unseen by the core, " << replay.unrecorded
              << " unseen by the recorder";
    if (!replay.ended.empty()) std::cout << "; ENDED EARLY: " << replay.ended;
    std::cout << '\n';
    EXPECT_EQ(replay.different, 0) << replay.first_difference;
    EXPECT_GT(replay.recorded, 0);
    EXPECT_GE(static_cast<double>(replay.compared),
              kLeastShare * static_cast<double>(replay.recorded))
        << replay.ended;
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
  if (std::getenv("STILLHAND_VEHICLE") != nullptr) GTEST_SKIP() << "a vehicle took its place";
  expect_same(replay_motion(*session_, settings_));
}

TEST_F(LiveRecordingTest, TheVehicleAnswersTheSame) {
  const char* vehicle = std::getenv("STILLHAND_VEHICLE");
  if (vehicle == nullptr) GTEST_SKIP() << "STILLHAND_VEHICLE names no vehicle";
  expect_same(replay_vehicle(*session_, settings_, vehicle));
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
  const Replay replay = replay_identification(*session_, settings_);
  // It answers a whole trial at once.  Which ticks reached it, only its events show; without them
  // the recording cannot be replayed.
  if (replay.compared == 0 && !replay.ended.empty()) GTEST_SKIP() << replay.ended;
  expect_same(replay);
}

// ---- The comparison can fail: one bit of one input, and the answers part from there.

/// Bit 20 of the mantissa: a change of 2^-32, small, yet too large to vanish in a rounding.
double flipped(double value) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(value) ^ (std::uint64_t{1} << 20));
}

/// The message in the middle of those that fit.
template <typename Message, typename Fits>
Message& middle(std::vector<Message>& messages, const Fits& fits) {
  std::vector<Message*> fitting;
  for (Message& message : messages) {
    if (fits(message)) fitting.push_back(&message);
  }
  if (fitting.empty()) throw std::runtime_error("the session has nothing that fits");
  return *fitting[fitting.size() / 2];
}

template <typename Message>
Message& at(std::vector<Message>& messages, Tick tick) {
  return middle(messages, [tick](const Message& message) { return message.tick() == tick; });
}

TEST_F(LiveRecordingTest, AFlippedBitOfARawSampleShowsInSensingAtItsTick) {
  SessionRecording session = *session_;
  const Tick tick = middle(session.sensed, [](const auto&) { return true; }).tick();
  auto& raw = at(session.raw_samples, tick);
  raw.accel_y_v(flipped(raw.accel_y_v()));
  const Replay replay = replay_sensing(session, settings_);
  EXPECT_EQ(replay.first_difference_tick, tick);
  EXPECT_NE(replay.first_difference.find("accel_y_m_s2"), std::string::npos);
}

TEST_F(LiveRecordingTest, AFlippedBitOfAnAccelerationShowsInCancellationAtItsTick) {
  SessionRecording session = *session_;
  // Where a model is at work, whether or not its force is asked for.
  const Tick tick = middle(session.motor_commands, [](const auto& each) {
                      return each.predicted_force_n() != 0.0;
                    }).tick();
  auto& sensed = at(session.sensed, tick);
  sensed.accel_y_m_s2(flipped(sensed.accel_y_m_s2()));
  const Replay replay = replay_cancellation(session, settings_);
  EXPECT_EQ(replay.first_difference_tick, tick);
  EXPECT_NE(replay.first_difference.find("predicted_force_n"), std::string::npos);
}

TEST_F(LiveRecordingTest, AFlippedBitOfTheSubjectsForceShowsInTheRig) {
  SessionRecording session = *session_;
  const auto& truth = middle(session.rig_truths, [](const auto& each) {
    return each.operator_tick() >= 0 && each.volitional_force_n() != 0.0;
  });
  auto& force = at(session.operator_forces, truth.operator_tick());
  force.force_n(flipped(force.force_n()));
  const Replay replay = replay_rig(session, settings_);
  EXPECT_GE(replay.first_difference_tick, force.tick());
  EXPECT_LE(replay.first_difference_tick, truth.tick());
  EXPECT_NE(replay.first_difference.find("volitional_force_n"), std::string::npos);
}

TEST_F(LiveRecordingTest, AFlippedBitOfATargetShowsInTheSubject) {
  if (!session_->pointers.empty()) GTEST_SKIP() << "a person's mouse took the subject's place";
  SessionRecording session = *session_;
  const Tick tick =
      middle(session.operator_forces, [](const auto& each) { return each.active(); }).tick();
  auto& sample = at(session.tracking_samples, tick);
  sample.target_m(flipped(sample.target_m()));
  const Replay replay = replay_human_operator(session, settings_);
  EXPECT_GE(replay.first_difference_tick, tick);
  EXPECT_GT(replay.different, 0);
}

TEST_F(LiveRecordingTest, AnotherMotionSeedShowsInTheMotion) {
  SessionRecording session = *session_;
  auto& moved = middle(session.trial_assignments, [](const auto& each) {
    return each.motion() != stillhand_msgs::MOTION_STILL;
  });
  moved.motion_seed(moved.motion_seed() ^ 1u);
  EXPECT_GT(replay_motion(session, settings_).different, 0);
}

TEST_F(LiveRecordingTest, AnotherReferenceSeedShowsInTheDisplay) {
  SessionRecording session = *session_;
  auto& tracked = middle(session.trial_controls, [](const auto& each) {
    return each.phase() == stillhand_msgs::PHASE_TRACKING;
  });
  tracked.reference_seed(tracked.reference_seed() ^ 1u);
  EXPECT_GT(replay_display(session, settings_).different, 0);
}

// ---- Losses of the recorder are distinguished from those of a core.

TEST_F(LiveRecordingTest, OutputsThatOnlyTheRecorderLostAreSteppedThrough) {
  SessionRecording session = *session_;
  const auto whole = [&](std::size_t n) { return (session.sensed[n].flags() & kInputGap) == 0; };
  std::size_t n = session.sensed.size() / 2;
  while (!(whole(n) && whole(n + 1) && whole(n + 2))) ++n;
  const auto first = session.sensed.begin() + static_cast<std::ptrdiff_t>(n);
  session.sensed.erase(first, first + 2);
  const Replay replay = replay_sensing(session, settings_);
  EXPECT_EQ(replay.unrecorded, 2);
  EXPECT_EQ(replay.different, 0) << replay.first_difference;
  EXPECT_EQ(replay.compared, static_cast<std::int64_t>(session.sensed.size()));
}

TEST_F(LiveRecordingTest, AnInputThatTheRecorderLostEndsTheReplayAndIsNamed) {
  SessionRecording session = *session_;
  const Tick tick = middle(session.sensed, [](const auto&) { return true; }).tick();
  std::erase_if(session.raw_samples, [tick](const auto& each) { return each.tick() == tick; });
  const Replay replay = replay_sensing(session, settings_);
  EXPECT_EQ(replay.ended,
            "raw_sample of tick " + std::to_string(tick) + " is not in the recording");
  EXPECT_EQ(replay.different, 0);
}

}  // namespace
}  // namespace stillhand::equivalence
