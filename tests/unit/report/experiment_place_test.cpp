// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/experiment_place.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "apps/libraries/report/result_files.hpp"
#include "apps/libraries/report/staged_folder.hpp"
#include "services/core/contract/config_error.hpp"
#include "tests/support/refusal.hpp"
#include "tests/unit/report/sample_figures.hpp"

namespace stillhand::report::experiment_place_test {
namespace {

using testing::HasSubstr;

TEST(ExperimentPlaceTest, NoResultTakesAPlaceThatAnExperimentKeeps) {
  const test::TemporaryFolder folder;
  const std::filesystem::path study = std::filesystem::canonical(folder.path());
  std::ofstream(study / "experiment.yaml") << "title: one\n";
  const auto refusal = [&](const char* below) {
    return support::refusal([&] { refuse_place_of_experiment(study / below, "--out"); });
  };
  for (const char* kept : {"experiment.yaml", "experiment.sha256", "assignment.sealed",
                           "journal.jsonl", "participants", "participants/set",
                           "participants/P01/journal.jsonl", "participants/P01/sessions/01"}) {
    EXPECT_THAT(refusal(kept), HasSubstr("a place of the experiment in " + study.string())) << kept;
  }
  for (const char* free : {"report", "report/figures", "set1", "participants/P01/sessions/01/found",
                           "../experiment.yaml"}) {
    EXPECT_EQ(refusal(free), "accepted") << free;
  }
  EXPECT_THROW(StagedFolder(study / "participants" / "set"), ConfigError);
  EXPECT_FALSE(std::filesystem::exists(study / "participants"));
  EXPECT_THROW(ResultFiles({{"--json", study / "experiment.yaml"}}, {}), ConfigError);
}

}  // namespace
}  // namespace stillhand::report::experiment_place_test
