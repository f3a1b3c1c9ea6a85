// SPDX-License-Identifier: Apache-2.0
#include "services/core/contract/config_field.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "services/core/contract/expects.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::config_field_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct SpringConfig {
  double stiffness_n_m = 5.0;
  bool locked = false;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("stiffness_n_m", self.stiffness_n_m, Range{0.0, 100.0}, "[N/m] spring");
    visit("locked", self.locked, Range{0.0, 0.0}, "always free");
  }
};

struct StickConfig {
  double mass_kg = 1.0;
  std::int64_t delay_ticks = 3;
  std::string name = "left";
  SpringConfig spring;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("mass_kg", self.mass_kg, Range{0.1, 10.0}, "[kg] mass");
    visit.group("spring", self.spring);
    visit("delay_ticks", self.delay_ticks, Range{-2.0, 50.0}, "[ticks] delay");
    visit("name", self.name, Range{1.0, 8.0}, "name");
  }
};

std::string message_of(const StickConfig& config) {
  return support::refusal([&] { validate(config, "rig.stick"); });
}

TEST(ValidateTest, BothEndsOfARangeAreWithinIt) {
  StickConfig config;
  for (const double value : {0.1, 10.0}) {
    config.mass_kg = value;
    EXPECT_EQ(message_of(config), "accepted") << value;
  }
  for (const std::int64_t value : {-2, 50}) {
    config.delay_ticks = value;
    EXPECT_EQ(message_of(config), "accepted") << value;
  }
}

TEST(ValidateTest, TheNextNumberBeyondARangeAndWhatIsNoneIsRefused) {
  StickConfig config;
  for (const double value : {std::nextafter(0.1, 0.0), std::nextafter(10.0, 11.0), std::nan(""),
                             kInfinity, -kInfinity}) {
    config.mass_kg = value;
    EXPECT_THAT(message_of(config), StartsWith("rig.stick.mass_kg: got ")) << value;
  }
  config.mass_kg = 1.0;
  for (const std::int64_t value : {-3, 51}) {
    config.delay_ticks = value;
    EXPECT_THAT(message_of(config),
                StartsWith("rig.stick.delay_ticks: got " + std::to_string(value)));
  }
}

TEST(ValidateTest, ATextIsMeasuredByItsLength) {
  StickConfig config;
  config.name = std::string(8, 'x');
  EXPECT_EQ(message_of(config), "accepted");
  config.name += 'x';
  EXPECT_THAT(message_of(config),
              StartsWith("rig.stick.name: got \"xxxxxxxxx\", want text of 1 to 8"));
  config.name.clear();
  EXPECT_THAT(message_of(config), StartsWith("rig.stick.name: got \"\""));
}

TEST(ValidateTest, AFieldOfAGroupIsNamedWithItsPath) {
  StickConfig config;
  config.spring.stiffness_n_m = -0.5;
  EXPECT_EQ(message_of(config),
            "rig.stick.spring.stiffness_n_m: got -0.5, want a value from 0 to 100");
}

TEST(ValidateTest, ASwitchWithOnePositionRefusesTheOther) {
  StickConfig config;
  config.spring.locked = true;
  EXPECT_THAT(message_of(config), StartsWith("rig.stick.spring.locked: got 1"));
}

TEST(ValidateTest, TheFirstFieldInTheOrderOfTheConfigIsNamed) {
  StickConfig config;
  config.mass_kg = -1.0;
  config.spring.stiffness_n_m = -1.0;
  config.delay_ticks = 1000;
  EXPECT_THAT(message_of(config), HasSubstr("mass_kg"));
  config.mass_kg = 1.0;
  EXPECT_THAT(message_of(config), HasSubstr("stiffness_n_m"));
  config.spring.stiffness_n_m = 1.0;
  EXPECT_THAT(message_of(config), HasSubstr("delay_ticks"));
}

TEST(ExpectsTest, ABrokenPreconditionNamesItsFileAndItsCondition) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  const int lever_ticks = -4;
  EXPECT_DEATH(STILLHAND_EXPECTS(lever_ticks > 0), "config_field_test.*lever_ticks > 0");
  STILLHAND_EXPECTS(lever_ticks < 0);
}

}  // namespace
}  // namespace stillhand::config_field_test
