// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/record/measurement.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "services/core/contract/config_error.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::diagnosis::measurement_test {

using testing::ElementsAre;
using testing::HasSubstr;

Measurement two_stretches() {
  Measurement sut;
  sut.source = "ride.csv";
  sut.rate_hz = 10.0;
  sut.channels = {{"a_y", "m/s^2", {1.0, 2.0, 3.0, 4.0}}, {"f", "N", {5.0, 6.0, 7.0, 8.0}}};
  sut.weight = {1.0, 0.0, 1.0, 1.0};
  sut.stretches = {{0, 3, 2.0}, {3, 4, 9.0}};
  return sut;
}

std::string error_of(const Measurement& sut) {
  return support::refusal([&] { check(sut); });
}

TEST(MeasurementTest, AChannelIsFoundByItsNameAlone) {
  const Measurement sut = two_stretches();
  ASSERT_NE(sut.find("f"), nullptr);
  EXPECT_EQ(sut.find("f")->unit, "N");
  EXPECT_EQ(sut.find("f [N]"), nullptr);
  EXPECT_EQ(sut.find(""), nullptr);
}

TEST(MeasurementTest, TimeStartsAnewWithEachStretch) {
  EXPECT_THAT(two_stretches().time_s(), ElementsAre(2.0, 2.1, 2.2, 9.0));
}

TEST(MeasurementTest, ARateThatIsNoneIsRefused) {
  for (const double rate_hz : {0.0, -1.0, std::numeric_limits<double>::infinity(),
                               std::numeric_limits<double>::quiet_NaN()}) {
    Measurement sut = two_stretches();
    sut.rate_hz = rate_hz;
    EXPECT_THAT(error_of(sut), HasSubstr("ride.csv, rate"));
  }
}

// Rows 1e-22 s apart: 1 s of them has more samples than an integer counts.
TEST(MeasurementTest, ARateWhoseSamplesNoIntegerCountsIsRefused) {
  Measurement sut = two_stretches();
  sut.rate_hz = 1e12;
  EXPECT_EQ(error_of(sut), "accepted");
  sut.rate_hz = 1e22;
  EXPECT_THAT(error_of(sut), HasSubstr("ride.csv, rate: got 1e+22 Hz, want"));
}

TEST(MeasurementTest, AChannelOfAnotherLengthIsNamed) {
  Measurement sut = two_stretches();
  sut.channels[1].values.pop_back();
  EXPECT_THAT(error_of(sut), HasSubstr("channel f: got 3 samples, want 4 samples"));
}

TEST(MeasurementTest, ASampleThatIsNotFiniteIsNamedWithItsChannel) {
  Measurement sut = two_stretches();
  sut.channels[0].values[2] = std::numeric_limits<double>::infinity();
  EXPECT_THAT(error_of(sut), HasSubstr("channel a_y, sample 2: got inf"));
}

TEST(MeasurementTest, AWeightIsAShare) {
  for (const double weight : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()}) {
    Measurement sut = two_stretches();
    sut.weight[1] = weight;
    EXPECT_THAT(error_of(sut), HasSubstr("weight of sample 1"));
  }
}

TEST(MeasurementTest, StretchesCoverEverySampleOnce) {
  Measurement gap = two_stretches();
  gap.stretches = {{0, 2, 0.0}, {3, 4, 9.0}};
  EXPECT_THAT(error_of(gap), HasSubstr("stretch 1"));
  Measurement overlap = two_stretches();
  overlap.stretches = {{0, 3, 0.0}, {2, 4, 9.0}};
  EXPECT_THAT(error_of(overlap), HasSubstr("stretch 1"));
  Measurement empty = two_stretches();
  empty.stretches = {{0, 0, 0.0}, {0, 4, 9.0}};
  EXPECT_THAT(error_of(empty), HasSubstr("stretch 0"));
  Measurement too_few = two_stretches();
  too_few.stretches.pop_back();
  EXPECT_THAT(error_of(too_few), HasSubstr("stretches of 3 samples, want of all 4 samples"));
  Measurement too_many = two_stretches();
  too_many.stretches[1].end = 5;
  EXPECT_THAT(error_of(too_many), HasSubstr("stretches of 5 samples"));
}

TEST(MeasurementTest, AStretchBeginsAfterTheOneBefore) {
  Measurement sut = two_stretches();
  sut.stretches[1].start_s = 2.1;  // the first ends at 2.3 s
  EXPECT_THAT(error_of(sut), HasSubstr("stretch 1: got a start at 2.1"));
  sut.stretches[1].start_s = 2.24;
  EXPECT_THAT(error_of(sut), HasSubstr("stretch 1")) << "more than half a sample early";
  sut.stretches[1].start_s = 2.26;
  EXPECT_EQ(error_of(sut), "accepted");
  sut.stretches[0].start_s = -7.0;
  EXPECT_EQ(error_of(sut), "accepted") << "a clock may begin anywhere";
}

}  // namespace stillhand::diagnosis::measurement_test
