// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/summary_json.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "places.hpp"

namespace stillhand::lab::summary_json_test {
namespace {

using session::Condition;

using nlohmann::ordered_json;
using testing::ElementsAre;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

session::TrialResult trial(Condition label, double rms_error_mm, double dwell,
                           double crossover_hz) {
  session::TrialResult result{};
  result.label = label;
  result.metrics.rms_error_mm = rms_error_mm;
  result.metrics.dwell_ratio = dwell;
  result.metrics.crossover_hz = crossover_hz;
  result.metrics.crossover_reference_hz = crossover_hz + 0.01;
  return result;
}

/// The means of the paper's Table I.
session::SessionResult papers_session() {
  session::SessionResult result;
  for (const Condition label : session::kPaperConditions) {
    const auto of = [label](const session::Number& metric) {
      return label == Condition::kA   ? metric.paper->a
             : label == Condition::kB ? metric.paper->b
                                      : metric.paper->c;
    };
    result.trials.push_back(
        trial(label, of(session::kMetrics[0]), of(session::kMetrics[1]), of(session::kMetrics[2])));
  }
  return result;
}

session::TrialOutcome outcome(std::int64_t number, Condition label) {
  session::TrialOutcome outcome{};
  outcome.planned.trial = {number, TrialPhase::kTracking, 3100, 5000, 2000};
  outcome.planned.label = label;
  outcome.completed = true;
  return outcome;
}

ordered_json json_of(const session::SessionResult& result,
                     const std::vector<session::TrialOutcome>& outcomes = {},
                     const LabOptions& options = {}, bool interrupted = false) {
  return summary_json(options, outcomes, result, interrupted);
}

// The paper prints whole percents of unrounded means; ours come from its rounded means, each off by
// up to 0.005.  The dwell ratio's denominator is 0.25: 0.005 (1/0.25 + 1/0.25) = 4 %, with the
// crossover's 0.15 6.7 %.
TEST(SummaryJsonTest, TheRestorationOfThePapersMeansIsThePapers) {
  const auto json = json_of(papers_session())["restoration"];
  for (const session::Number& metric : session::kMetrics) {
    EXPECT_NEAR(100.0 * json[metric.name].get<double>(), metric.paper->restored_percent, 6.7)
        << metric.key;
  }
  EXPECT_DOUBLE_EQ(json["rms_error"], (9.62 - 7.01) / (9.62 - 4.04));
}

TEST(SummaryJsonTest, AMitigationStandsNextToTheLettersWithTheStudysShare) {
  session::SessionResult result = papers_session();
  result.trials[0].settled_rms_error_mm = 10.0;
  result.trials[1].settled_rms_error_mm = 50.0;
  result.trials[2].settled_rms_error_mm = 20.0;
  session::TrialResult damped = trial(session::Condition::kDampingForce, 6.83, 0.4, 0.2);
  damped.settled_rms_error_mm = 18.0;
  damped.forces.motor_n = 6.5;
  damped.models.force = 1000;
  result.trials.push_back(damped);
  const auto json = json_of(result, {outcome(4, damped.label)});
  EXPECT_EQ(json["conditions"].size(), 4u);
  EXPECT_EQ(json["conditions"]["damping+force"]["rms_error_mm"]["mean"], 6.83);
  const auto& one = json["mitigations"]["damping+force"];
  EXPECT_DOUBLE_EQ(one["restored"], 0.8);
  EXPECT_DOUBLE_EQ(one["motor_n"], 6.5);
  EXPECT_DOUBLE_EQ(one["restoration"]["rms_error"], (9.62 - 6.83) / (9.62 - 4.04));
  EXPECT_EQ(one["models"]["force"], 1000);
  EXPECT_TRUE(one["models"]["position"].is_null());
  EXPECT_DOUBLE_EQ(json["mitigations"]["C"]["restored"], 0.75);
  EXPECT_EQ(json["trials"][0]["condition"], "damping+force");
  // What scripts know stays as it was.
  EXPECT_EQ(json["restoration"], json_of(papers_session())["restoration"]);
  EXPECT_FALSE(json_of(papers_session()).contains("mitigations"));
  result.trials.erase(result.trials.begin());
  EXPECT_TRUE(json_of(result)["mitigations"]["C"]["restored"].is_null());
}

TEST(SummaryJsonTest, CThatRanAgainCountsByItsNewestTrialAndCPlusByItself) {
  session::SessionResult result = papers_session();
  result.trials.push_back(trial(Condition::kC, 5.0, 0.4, 0.2));
  result.trials.back().number = 5;
  result.trials.back().models.force = 1;
  result.trials.push_back(trial(Condition::kCPlus, 4.5, 0.45, 0.22));
  result.trials.back().number = 7;
  result.trials.back().models.force = 1000;
  const auto json = json_of(result, {outcome(5, Condition::kC), outcome(7, Condition::kCPlus)});
  EXPECT_EQ(json["conditions"]["C"]["rms_error_mm"]["mean"], 5.0);
  EXPECT_EQ(json["conditions"]["C+"]["rms_error_mm"]["mean"], 4.5);
  EXPECT_EQ(json["trials"][0]["model"], 1);
  EXPECT_EQ(json["trials"][1]["condition"], "C+");
  EXPECT_EQ(json["trials"][1]["model"], 1000);
}

TEST(SummaryJsonTest, WithoutAllThreeConditionsNothingIsRestored) {
  for (std::size_t missing = 0; missing < 3; ++missing) {
    session::SessionResult result = papers_session();
    result.trials.erase(result.trials.begin() + static_cast<std::ptrdiff_t>(missing));
    const auto json = json_of(result);
    for (const session::Number& metric : session::kMetrics) {
      EXPECT_TRUE(json["restoration"][metric.name].is_null()) << metric.key;
    }
    EXPECT_EQ(json["conditions"].size(), 2u);
  }
}

// B as good as A: there was nothing to restore, and no number says how much of it was.
TEST(SummaryJsonTest, ARestorationThatIsNoNumberIsNull) {
  session::SessionResult result = papers_session();
  result.trials[1].metrics = result.trials[0].metrics;
  result.trials[2].metrics.crossover_hz = kNaN;
  const auto json = json_of(result)["restoration"];
  EXPECT_TRUE(json["rms_error"].is_null());
  EXPECT_TRUE(json["dwell_ratio"].is_null());
  EXPECT_TRUE(json["crossover"].is_null());
}

TEST(SummaryJsonTest, AConditionHasTheStudysShapeForOneSubject) {
  const auto json = json_of(papers_session())["conditions"]["B"];
  EXPECT_DOUBLE_EQ(json["rms_error_mm"]["mean"], 9.62);
  EXPECT_TRUE(json["rms_error_mm"]["std"].is_null());
  EXPECT_EQ(json["rms_error_mm"]["per_subject"], ordered_json::array({9.62}));
  EXPECT_DOUBLE_EQ(json["crossover_reference_hz"], 0.11);
  EXPECT_TRUE(json["cancelled_share"].is_null());
  EXPECT_FALSE(json.contains("counterforce_delay_ms"));
  EXPECT_FALSE(json.contains("sensor_to_command_us"));
}

TEST(SummaryJsonTest, DelaysAreInTheUnitsOfTheirKeys) {
  session::SessionResult result = papers_session();
  result.trials[2].cancelled_share = 0.87;
  result.trials[2].counterforce_delay_s = 0.0065;
  result.trials[2].sensor_to_command = {120.0, 340.0, 900.0, 15.0};
  result.trials[2].sensor_to_force = {170.0, 390.0, 950.0, 0.0};
  result.trials[2].same_tick_share = 0.998;
  const auto json = json_of(result)["conditions"]["C"];
  EXPECT_DOUBLE_EQ(json["cancelled_share"], 0.87);
  EXPECT_DOUBLE_EQ(json["counterforce_delay_ms"], 6.5);
  EXPECT_DOUBLE_EQ(json["sensor_to_command_us"]["p50"], 120.0);
  EXPECT_DOUBLE_EQ(json["sensor_to_command_us"]["p99"], 340.0);
  EXPECT_DOUBLE_EQ(json["sensor_to_command_us"]["max"], 900.0);
  EXPECT_DOUBLE_EQ(json["sensor_to_command_us"]["uncertainty"], 15.0);
  EXPECT_DOUBLE_EQ(json["sensor_to_force_us"]["p99"], 390.0);
  EXPECT_DOUBLE_EQ(json["same_tick_share"], 0.998);
}

TEST(SummaryJsonTest, ANumberThatCouldNotBeComputedIsNull) {
  session::SessionResult result = papers_session();
  result.trials[0].metrics.crossover_hz = kNaN;
  result.trials[0].metrics.crossover_reference_hz = INFINITY;
  const auto json = json_of(result)["conditions"]["A"];
  EXPECT_TRUE(json["crossover_hz"]["mean"].is_null());
  EXPECT_TRUE(json["crossover_hz"]["per_subject"][0].is_null());
  EXPECT_TRUE(json["crossover_reference_hz"].is_null());
}

TEST(SummaryJsonTest, ADisturbanceNamesItsTrialAsAPersonWould) {
  session::SessionResult result;
  session::Miss miss;
  miss.process = "sensing";
  miss.late_s = 0.073;
  miss.trial_s = 11.5;
  result.disturbances = {{Condition::kC, miss}, {Condition::kIdentification, miss}};
  EXPECT_THAT(disturbance_lines(result),
              ElementsAre("C disturbed at 11.5 s: sensing was late by 73 ms",
                          "the identification (I) disturbed at 11.5 s: sensing was late by 73 ms"));
}

TEST(SummaryJsonTest, EveryDisturbedTrialHasALineHoweverShort) {
  session::SessionResult result;
  session::Miss miss;
  miss.process = "sensing";
  for (int i = 0; i < 8; ++i) {
    miss.late_s = 0.020 + 0.001 * i;
    miss.from_ns = i;
    result.disturbances.push_back({Condition::kIdentification, miss});
  }
  miss.late_s = 0.011;
  miss.from_ns = 8;
  result.disturbances.push_back({Condition::kB, miss});
  const std::vector<std::string> sut = disturbance_lines(result);
  ASSERT_EQ(sut.size(), 6u);
  EXPECT_EQ(sut[4].substr(0, 11), "B disturbed");
  EXPECT_EQ(sut[5].substr(0, 15), "4 shorter ones:");
}

TEST(SummaryJsonTest, ATrialHasItsTicksMissesAndMarks) {
  session::TrialOutcome marked = outcome(2, Condition::kC);
  marked.completed = false;
  marked.aborted = "rig: \"peer gone\"\n";
  marked.misses = {1, 2, 3};
  marked.marks = {{"deadline missed", "rig", "stillhand/sensed", "sensing", "late", 4000, 7, 12.5}};
  const auto json = json_of({}, {outcome(1, Condition::kA), marked})["trials"];
  ASSERT_EQ(json.size(), 2u);
  EXPECT_TRUE(json[0]["aborted"].is_null());
  EXPECT_EQ(json[0]["condition"], "A");
  EXPECT_TRUE(json[0]["marks"].empty());
  EXPECT_TRUE(json[0]["motion"].is_null());
  EXPECT_EQ(json[1]["number"], 2);
  EXPECT_EQ(json[1]["start_tick"], 3100);
  EXPECT_EQ(json[1]["duration_ticks"], 5000);
  EXPECT_EQ(json[1]["completed"], false);
  EXPECT_EQ(json[1]["deadline_misses"], 1);
  EXPECT_EQ(json[1]["cycle_misses"], 2);
  EXPECT_EQ(json[1]["lost_ticks"], 3);
  const auto mark = json[1]["marks"][0];
  EXPECT_EQ(mark["what"], "deadline missed");
  EXPECT_EQ(mark["peer"], "sensing");
  EXPECT_EQ(mark["count"], 7);
  EXPECT_EQ(mark["worst_us"], 12.5);
  EXPECT_EQ(ordered_json::parse(json.dump())[1]["aborted"], marked.aborted);
}

TEST(SummaryJsonTest, AMotionSaysWhatItsKindNeeds) {
  LabOptions options;
  options.protocol.road_class = "D";
  options.protocol.road_speed_m_s = 12.5;
  const auto motion_of = [&](motion::MotionKind kind) {
    session::TrialOutcome moving = outcome(1, Condition::kB);
    moving.planned.motion = kind;
    moving.asked = motion::MotionReport{};
    moving.asked->rms_m_s2 = 1.25;
    moving.asked->corner_hz = 0.2;
    return json_of({}, {moving}, options)["trials"][0]["motion"];
  };
  EXPECT_EQ(motion_of(motion::MotionKind::kBandNoise)["kind"], "noise");
  EXPECT_EQ(motion_of(motion::MotionKind::kBandNoise)["rms_m_s2"], 1.25);
  EXPECT_FALSE(motion_of(motion::MotionKind::kBandNoise).contains("corner_hz"));
  EXPECT_EQ(motion_of(motion::MotionKind::kRoad)["kind"], "road");
  EXPECT_EQ(motion_of(motion::MotionKind::kRoad)["road_class"], "D");
  EXPECT_EQ(motion_of(motion::MotionKind::kRoad)["speed_m_s"], 12.5);
  EXPECT_EQ(motion_of(motion::MotionKind::kRide)["kind"], "ride");
  EXPECT_EQ(motion_of(motion::MotionKind::kRide)["corner_hz"], 0.2);
  EXPECT_FALSE(motion_of(motion::MotionKind::kRide).contains("road_class"));
}

TEST(SummaryJsonTest, AnIdentificationThatFailedSaysWhy) {
  session::SessionResult result;
  EXPECT_TRUE(json_of(result)["identification"].is_null());
  result.model.emplace();
  result.model->usable(false);
  result.model->text("VAF 12 %");
  result.model->heldout_vaf_percent(kNaN);
  const auto failed = json_of(result)["identification"];
  EXPECT_EQ(failed["usable"], false);
  EXPECT_EQ(failed["text"], "VAF 12 %");
  EXPECT_TRUE(failed["heldout_vaf_percent"].is_null());
  EXPECT_FALSE(failed.contains("residual_share"));
  result.conversion = {0.02, 0.11};
  EXPECT_EQ(json_of(result)["identification"]["residual_share"]["filter_at_1_khz"], 0.02);
  EXPECT_EQ(json_of(result)["identification"]["residual_share"]["zero_order_hold_of_50_hz"], 0.11);
}

TEST(SummaryJsonTest, AClockIsInSecondsAndMicroseconds) {
  session::SessionResult result;
  stillhand_msgs::ClockOffset offset;
  offset.offset_ns(-2'500'000'000);
  offset.uncertainty_ns(1500.0);
  offset.round_trip_ns(250'000);
  offset.drift_ppm(-3.5);
  offset.drift_sigma_ppm(INFINITY);  // while the window is short
  offset.steps(2);
  result.clocks["rig"] = offset;
  const auto json = json_of(result)["clocks"]["rig"];
  EXPECT_DOUBLE_EQ(json["offset_s"], -2.5);
  EXPECT_DOUBLE_EQ(json["uncertainty_us"], 1.5);
  EXPECT_DOUBLE_EQ(json["round_trip_us"], 250.0);
  EXPECT_DOUBLE_EQ(json["drift_ppm"], -3.5);
  EXPECT_TRUE(json["drift_sigma_ppm"].is_null());
  EXPECT_EQ(json["steps"], 2);
  EXPECT_EQ(json["same_clock"], false);
}

TEST(SummaryJsonTest, TheSessionsOwnNumbersAreThereAlsoWithoutATrial) {
  LabOptions options;
  options.protocol.seed = std::numeric_limits<std::uint64_t>::max();
  options.protocol.trial_s = 20.0;
  options.protocol.identify_s = 30.0;
  options.model = "m/control_model.json";
  session::SessionResult result;
  result.lost_ticks = {{"stillhand/sensed", 4}};
  result.damage = {"a chunk at byte 7"};
  const auto json = json_of(result, {}, options, true);
  std::vector<std::string> keys;
  for (const auto& [key, value] : json.items()) keys.push_back(key);
  EXPECT_THAT(keys,
              ElementsAre("conditions", "t_tests", "manova", "restoration", "identification", "rig",
                          "control_model", "canceller", "trials", "lost_ticks", "clocks",
                          "recording_damage", "interrupted", "seed", "subject", "operator",
                          "trial_seconds", "identify_seconds", "reference_note", "version"));
  EXPECT_EQ(json["conditions"], ordered_json::object());
  EXPECT_EQ(json["clocks"], ordered_json::object());
  EXPECT_EQ(json["trials"], ordered_json::array());
  EXPECT_EQ(json["seed"], options.protocol.seed);
  EXPECT_EQ(json["control_model"], "m/control_model.json");
  EXPECT_EQ(json["canceller"], "now");
  EXPECT_EQ(json["lost_ticks"]["stillhand/sensed"], 4);
  EXPECT_EQ(json["recording_damage"][0], "a chunk at byte 7");
  EXPECT_EQ(json["interrupted"], true);
  EXPECT_TRUE(json_of(result)["control_model"].is_null());
  EXPECT_NE(json_of(result)["reference_note"], json["reference_note"]);  // 180 s and 20 s
}

TEST(SummaryJsonTest, ARigOfDevicesIsNamedWithItsParts) {
  LabOptions options;
  EXPECT_EQ(json_of({}, {}, options, false)["rig"], ordered_json({{"kind", "simulated"}}));
  options.devices = STILLHAND_SOURCE "/deploy/config/devices.yaml";
  const auto rig = json_of({}, {}, options, false)["rig"];
  EXPECT_EQ(rig["kind"], "devices");
  EXPECT_EQ(rig["parts"].size(), 5u);
  EXPECT_EQ(rig["parts"]["platform"], "simulated");
}

}  // namespace
}  // namespace stillhand::lab::summary_json_test
