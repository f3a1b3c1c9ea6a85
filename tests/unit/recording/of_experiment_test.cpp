// SPDX-License-Identifier: Apache-2.0
#include "services/bus/recording/of_experiment.hpp"

#include <gtest/gtest.h>

#include <utility>

#include "services/system/command_line/command_line.hpp"

namespace stillhand::recording::of_experiment_test {
namespace {

OfExperiment parsed(std::vector<std::string> words) {
  command_line::Program cli;
  OfExperiment place;
  add_experiment_options(cli, place);
  cli.parse(std::move(words));
  return place;
}

TEST(OfExperimentTest, AnotherProcessHearsTheSame) {
  const OfExperiment wanted{"P07", std::string(64, 'e'), "03"};
  EXPECT_EQ(parsed(experiment_words(wanted)), wanted);
  EXPECT_TRUE(experiment_words({}).empty());
  EXPECT_EQ(parsed({}), OfExperiment{});
}

TEST(OfExperimentTest, APlaceIsGivenWholeOrNotAtAll) {
  EXPECT_THROW(parsed({"--participant", "P07"}), command_line::UsageError);
  EXPECT_THROW(parsed({"--experiment-session", "01"}), command_line::UsageError);
  EXPECT_THROW(parsed({"--participant", "P07", "--experiment-digest", "a"}),
               command_line::UsageError);
}

TEST(OfExperimentTest, TheRecordHasTheThreeKeysOfTheFormat) {
  EXPECT_EQ(experiment_texts({"P07", "d1", "03"}),
            (TextMap{{"participant", "P07"}, {"digest", "d1"}, {"session", "03"}}));
}

}  // namespace
}  // namespace stillhand::recording::of_experiment_test
