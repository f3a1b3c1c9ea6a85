// SPDX-License-Identifier: Apache-2.0
// The codecs of models; see codec_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>
#include <vector>

#include "services/files/cancellation/control_model_file.hpp"
#include "services/messages/cancellation/codec.hpp"
#include "services/messages/identification/codec.hpp"
#include "tests/support/idl_fields.hpp"

namespace stillhand {
namespace {

using tests::Fields;
using tests::fields_of;

// A path that the model does not have, or no path at all: check_model() refuses it.
TEST(CancellationCodecTest, AnElementWithMemoryWithoutAPlaceIsRefused) {
  using namespace cancellation;
  ControlModel model;
  model.rate_hz = 1000.0;
  model.denominator = {1.0, 0.0};
  model.inputs = {{Channel::kAccelY, {}, {1.0, 0.0}}};
  model.paths = {{Channel::kRoll, 0.0, {}, 1.0}};
  model.hysteresis = {{0, signal::HysteresisOperator::kStop, 1.0, -1.0, 1.0}};
  const auto refusal = [&](std::int32_t path) {
    auto message = to_idl(model, 1003);
    message.hysteresis()[0].path(path);
    return check_model(from_idl(message), {60.0, 25.0}).refusal;
  };
  EXPECT_EQ(refusal(0), Refusal::kNone);
  for (const std::int32_t path : {-1, -2, 1, 7}) EXPECT_EQ(refusal(path), Refusal::kMalformed);
}

TEST(CancellationCodecTest, AControlModelComesBackAsItWasSent) {
  using namespace cancellation;
  ControlModel model;
  model.rate_hz = 1000.0;
  model.denominator = {1.0, 0.5};
  model.inputs = {{Channel::kAccelY, {-1.0, 2.0, {3.0, 4.0}}, {5.0, 6.0}},
                  {Channel::kAccelX, {}, {7.0, 8.0}}};
  model.loop = LoopPath{{1.0, 2.0}, {3.0, 4.0}, {0.0, 5.0}, {-6.0, 7.0, {8.0, 9.0}}, 33};
  model.output = {-10.0, 11.0, {12.0, 13.0, 14.0}};
  model.paths = {{Channel::kOmega, 0.15, {-1.0, 1.0, {-2.0, 2.0}}, 0.16}};
  model.waves = {{std::nullopt, 17.0, 18.0, 19.0}, {Channel::kTheta, 20.0, 21.0, 22.0}};
  model.adapts = HandCompliance{23.0, 24.0, 25.0, 26.0};
  model.hysteresis = {{0, signal::HysteresisOperator::kDahl, 27.0, -28.0, 29.0},
                      {std::nullopt, signal::HysteresisOperator::kStop, 30.0, -31.0, 32.0}};
  const auto message = to_idl(model, 1003);
  EXPECT_EQ(message.model(), 1003);
  EXPECT_EQ(control_model_json(from_idl(message), 1), control_model_json(model, 1));
  model.adapts.reset();
  EXPECT_FALSE(from_idl(to_idl(model, 1)).adapts);
}

identification::FeedthroughModel identified() {
  identification::FeedthroughModel model;
  model.fit = {50.0, {0.5, 1.5}, {1.0, 2.5}};
  model.control = {1000.0, {3.5, 4.5, 5.5}, {1.0, 6.5, 7.5}};
  model.heldout.free_run_vaf_percent = 8.5;
  model.heldout.free_run_rms_n = 9.5;
  model.conversion_error = 10.5;
  return model;
}

TEST(IdentificationCodecTest, EveryFieldOfAModelIsSet) {
  EXPECT_EQ(fields_of(identification::to_idl(identified(), 11, 12)),
            (Fields{{"rig", "0"},
                    {"stamp_ns", "0"},
                    {"model", "11"},
                    {"from_tick", "0"},
                    {"trial", "12"},
                    {"fit_rate_hz", "50"},
                    {"fit_numerator", "[0.5, 1.5]"},
                    {"fit_denominator", "[1, 2.5]"},
                    {"control_rate_hz", "1000"},
                    {"control_numerator", "[3.5, 4.5, 5.5]"},
                    {"control_denominator", "[1, 6.5, 7.5]"},
                    {"heldout_vaf_percent", "8.5"},
                    {"heldout_rmse_n", "9.5"},
                    {"conversion_error", "10.5"},
                    {"usable", "true"},
                    {"text", ""},
                    {"to_position", "false"}}));
}

TEST(IdentificationCodecTest, AModelComesBackFromTheBusAsItWent) {
  const auto message = identification::to_idl(identified(), 11, 12);
  EXPECT_EQ(fields_of(identification::to_idl(identification::from_idl(message), 11, 12)),
            fields_of(message));
}

TEST(IdentificationCodecTest, TheCancellerGetsTheControlRateFilter) {
  const auto [rate_hz, numerator, denominator] =
      cancellation::from_idl(identification::to_idl(identified(), 11, 12));
  EXPECT_EQ(std::tuple(rate_hz, numerator, denominator),
            std::tuple(1000.0, identified().control.numerator, identified().control.denominator));
}

TEST(IdentificationCodecTest, AFailureSaysWhyWithinTheRoomOfTheIdl) {
  const identification::Identification failed{std::nullopt, std::string(500, 'x')};
  const auto fields = fields_of(identification::to_idl(failed, 11, 12));
  const auto has = [&fields](const char* name, const std::string& value) {
    return std::find(fields.begin(), fields.end(), Fields::value_type{name, value}) != fields.end();
  };
  EXPECT_TRUE(has("model", "11") && has("trial", "12") && has("usable", "false"));
  EXPECT_TRUE(has("text", std::string(199, 'x'))) << "string<200> with its end";
}

}  // namespace
}  // namespace stillhand
