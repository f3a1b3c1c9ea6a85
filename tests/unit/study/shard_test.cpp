// SPDX-License-Identifier: Apache-2.0
// A study in parts: what a shard's file keeps, and which folders are refused.
#include "apps/study/shard.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "apps/study/analysis.hpp"
#include "apps/study/study.hpp"
#include "services/contract/config_error.hpp"
#include "services/recording/file_io.hpp"
#include "services/rig/sealed_file.hpp"
#include "tests/unit/study/made_record.hpp"

namespace stillhand::study {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

constexpr std::int64_t kSubjects = 5;

// Chosen numbers; those that JSON text would lose are among them.
std::vector<SubjectResult> chosen() {
  auto results = made::random_results(kSubjects, "CAB", 7);
  results[0].trials[kB].metrics.crossover_hz = made::kNan;
  results[1].trials[kA].metrics.lines[3].error_snr = std::numeric_limits<double>::infinity();
  results[2].trials[kA].cancelled_share = -0.0;
  results[3].identification.control.peak_gain = std::numeric_limits<double>::denorm_min();
  results[3].identification.paper.heldout.samples = std::numeric_limits<std::size_t>::max();
  results[4].identification.paper_unusable = "unstable: pole 1.02, \"x\"";
  return results;
}

class ShardTest : public testing::Test {
 protected:
  void SetUp() override { fs::remove_all(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  // Writes shard `number` of `of`, as a run with these options would.
  fs::path write(const std::string& name, Shard shard, StudyOptions options = {}) const {
    options.subjects = kSubjects;
    if (options.protocol.conditions.empty()) {
      options.protocol.conditions = session::parse_conditions("A,B,C");
    }
    StudyRecord record;
    record.options = options;
    const auto all = chosen();
    record.results.assign(all.begin() + shard.first(kSubjects), all.begin() + shard.end(kSubjects));
    fs::create_directories(folder_ / name);
    std::ofstream(folder_ / name / kShardFile, std::ios::binary) << shard_file(record, shard);
    return folder_ / name;
  }
  static std::string message_of(const std::vector<fs::path>& folders) {
    try {
      merged(folders);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "accepted";
  }

  fs::path folder_ = fs::temp_directory_path() / "stillhand_shard_test";
};

TEST_F(ShardTest, EverySubjectIsInOneShard) {
  for (const std::int64_t subjects : {1, 5, 12, 10000}) {
    for (std::int64_t of = 1; of <= std::min<std::int64_t>(subjects, 40); ++of) {
      std::int64_t next = 0;
      for (std::int64_t number = 1; number <= of; ++number) {
        const Shard sut{number, of};
        EXPECT_EQ(sut.first(subjects), next);
        EXPECT_GT(sut.end(subjects), next);
        next = sut.end(subjects);
      }
      EXPECT_EQ(next, subjects);
    }
  }
}

TEST_F(ShardTest, AWordThatNamesNoPartIsRefused) {
  EXPECT_EQ(parse_shard("2/3", 5).number, 2);
  EXPECT_EQ(parse_shard("2/3", 5).of, 3);
  for (const char* word : {"", "2", "/3", "0/3", "4/3", "-1/3", "2/3x", "2/", "a/b", "1/0", "2/6",
                           "1/99999999999999999999"}) {
    EXPECT_THROW(parse_shard(word, 5), ConfigError) << word;
  }
}

TEST_F(ShardTest, ShardsInAnyOrderGiveTheResultsOfOneRunBitForBit) {
  const std::vector<fs::path> folders{write("c", {3, 3}), write("a", {1, 3}), write("b", {2, 3})};
  const StudyRecord sut = merged(folders);
  ASSERT_EQ(sut.results.size(), std::size_t{kSubjects});
  StudyRecord one;
  one.options = sut.options;
  one.results = chosen();
  for (std::int64_t i = 0; i < kSubjects; ++i) {
    one.results[static_cast<std::size_t>(i)].subject =
        population::draw_subject(one.options.population, one.options.seed, i);
  }
  // Both as a single shard: the text holds every bit of every number.
  EXPECT_EQ(shard_file(sut, {1, 1}), shard_file(one, {1, 1}));
  EXPECT_TRUE(std::signbit(sut.results[2].trials.at(kA).cancelled_share));
  StudyRecord analysed = sut;
  analysed.analysis = analyse(analysed.results);
  one.analysis = analyse(one.results);
  EXPECT_EQ(summary_json(analysed), summary_json(one));
  const auto files = csv_files(analysed);
  const auto expected = csv_files(one);
  for (std::size_t i = 0; i < files.size(); ++i) EXPECT_EQ(files[i].text, expected[i].text);
}

TEST_F(ShardTest, EverySettingComesBack) {
  StudyOptions options;
  options.seed = std::numeric_limits<std::uint64_t>::max();
  options.protocol.conditions = session::parse_conditions("A,B,C,E", session::kStudyConditions);
  options.protocol.trial_s = 40.1;
  options.protocol.identify_s = 20.3;
  options.canceller = "paper";
  options.damped_stick_n_s_m = 7.7;
  options.wrong_models = true;
  options.undeclared_effect = 9;
  options.population.delay_s = 0.2333333333333333;
  const StudyOptions sut = merged({write("a", {1, 1}, options)}).options;
  EXPECT_EQ(sut.seed, options.seed);
  EXPECT_EQ(sut.protocol.conditions, options.protocol.conditions);
  EXPECT_EQ(sut.protocol.trial_s, options.protocol.trial_s);
  EXPECT_EQ(sut.protocol.identify_s, options.protocol.identify_s);
  EXPECT_EQ(sut.canceller, "paper");
  EXPECT_EQ(sut.damped_stick_n_s_m, options.damped_stick_n_s_m);
  EXPECT_TRUE(sut.wrong_models);
  EXPECT_EQ(sut.undeclared_effect, 9u);
  EXPECT_EQ(sut.population.delay_s, options.population.delay_s);
}

TEST_F(ShardTest, AMissingAndASecondShardAreNamed) {
  const auto first = write("a", {1, 4});
  const auto third = write("b", {3, 4});
  EXPECT_THAT(message_of({first, third}), HasSubstr("no shard 2, 4 of 4"));
  EXPECT_THAT(message_of({first, third, write("again", {1, 4})}),
              AllOf(HasSubstr("again"), HasSubstr("shard 1/4 a second time"), HasSubstr("/a")));
  EXPECT_THAT(message_of({folder_ / "nowhere"}),
              AllOf(HasSubstr("nowhere"), HasSubstr(kShardFile)));
}

TEST_F(ShardTest, AShardOfAnotherStudyIsRefusedWithTheSettingThatDiffers) {
  const auto first = write("a", {1, 2});
  StudyOptions options;
  options.seed = 2;
  EXPECT_THAT(message_of({first, write("seed", {2, 2}, options)}),
              AllOf(HasSubstr("seed: got seed 2, want 1, as in")));
  options = {};
  options.population.wander = 0.2;
  EXPECT_THAT(message_of({first, write("people", {2, 2}, options)}),
              HasSubstr("got wander 0.2, want 0.1"));
  EXPECT_THAT(message_of({first, write("three", {2, 3})}), HasSubstr("got shard 2/3"));
}

TEST_F(ShardTest, AnyChangedByteAndAnyLostEndAreRefused) {
  const fs::path file = write("a", {1, 5}) / kShardFile;
  const std::string whole = recording::read_file(file.string());
  ASSERT_EQ(message_of({file.parent_path()}),
            "--merge: got no shard 2, 3, 4, 5 of 5, want the folders of all shards");
  const auto with = [&](const std::string& bytes) {
    std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
    return message_of({file.parent_path()});
  };
  for (std::size_t at = 0; at < whole.size(); at += 97) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    EXPECT_THAT(with(bytes), HasSubstr("run this shard again")) << at;
    EXPECT_THAT(with(whole.substr(0, at)), HasSubstr("run this shard again")) << at;
  }
}

TEST_F(ShardTest, AShardOfAnotherVersionIsRefused) {
  // The digest is right; only the version in the header differs.
  const fs::path file = write("a", {1, 1}) / kShardFile;
  std::string bytes = recording::read_file(file.string());
  const std::size_t at = bytes.find("version");
  ASSERT_NE(at, std::string::npos);
  bytes[at + 8] = '9';  // behind the name and the byte that says how long the text is
  const std::size_t digest = bytes.size() - 64;
  bytes = bytes.substr(0, digest - 2) + bytes.substr(digest - 2, 2) +
          rig::sha256(bytes.substr(0, digest - 2));
  std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
  EXPECT_THAT(message_of({file.parent_path()}), HasSubstr("a shard of version 9"));
}

}  // namespace
}  // namespace stillhand::study
