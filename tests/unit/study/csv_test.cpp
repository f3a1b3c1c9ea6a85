// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "apps/study/report/output.hpp"
#include "tests/unit/study/made_record.hpp"

namespace stillhand::study::csv_test {
namespace {

using made::kNan;
using testing::ElementsAre;

using Rows = std::vector<std::vector<std::string>>;

// Split at every comma, an empty last cell included; no cell of these files has a comma in it.
Rows rows_of(const std::string& text) {
  Rows rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> cells{""};
    for (const char c : line) {
      if (c == ',') {
        cells.emplace_back();
      } else {
        cells.back() += c;
      }
    }
    rows.push_back(cells);
  }
  return rows;
}

std::map<std::string, Rows> tables_of(const StudyRecord& record) {
  std::map<std::string, Rows> tables;
  for (const CsvFile& file : csv_files(record)) tables[file.name] = rows_of(file.text);
  return tables;
}

std::size_t column_of(const Rows& rows, const std::string& name) {
  return static_cast<std::size_t>(std::ranges::find(rows.front(), name) - rows.front().begin());
}

class CsvFilesTest : public testing::Test {
 protected:
  const StudyRecord record_ = made::record_of(made::random_results(3, "CAB", 61));
  std::map<std::string, Rows> sut_ = tables_of(record_);
};

TEST_F(CsvFilesTest, EveryRowHasAsManyCellsAsItsHeader) {
  EXPECT_EQ(sut_.size(), 5u);
  for (const auto& [name, rows] : sut_) {
    ASSERT_GT(rows.size(), 1u) << name;
    for (const auto& row : rows) EXPECT_EQ(row.size(), rows.front().size()) << name;
  }
}

TEST_F(CsvFilesTest, EveryHeaderNamesSubjectFirstAndEveryColumnOnce) {
  for (const auto& [name, rows] : sut_) {
    auto header = rows.front();
    EXPECT_EQ(header.front(), "subject") << name;
    std::ranges::sort(header);
    EXPECT_EQ(std::ranges::adjacent_find(header), header.end()) << name;
  }
}

TEST_F(CsvFilesTest, EverySubjectAndEveryTrialHasItsRows) {
  EXPECT_EQ(sut_.at("subjects.csv").size(), 1u + 3u);
  EXPECT_EQ(sut_.at("metrics.csv").size(), 1u + 3u * 3u);
  EXPECT_EQ(sut_.at("models.csv").size(), 1u + 3u * 3u);
  EXPECT_EQ(sut_.at("moving_averages.csv").size(), 1u + 3u * 3u * 51u);
  EXPECT_EQ(sut_.at("open_loop.csv").size(), 1u + 3u * 3u * signal::kReferenceLines);
}

TEST_F(CsvFilesTest, ANumberIsReadBackBitForBit) {
  const Rows& rows = sut_.at("metrics.csv");
  const std::size_t error = column_of(rows, "rms error [mm]");
  const std::size_t force = column_of(rows, "feedthrough rms [N]");
  for (std::size_t r = 1; r < rows.size(); ++r) {
    const auto& result = record_.results.at(std::stoul(rows[r][0]) - 1);
    const TrackedTrial& trial = result.trials.at(named(rows[r][1]));
    EXPECT_EQ(std::stod(rows[r].at(error)), trial.metrics.rms_error_mm);
    EXPECT_EQ(std::stod(rows[r].at(force)), trial.feedthrough_rms_n);
  }
}

TEST_F(CsvFilesTest, ThePlaceInOrderCountsFromOne) {
  const Rows& rows = sut_.at("metrics.csv");
  const std::size_t place = column_of(rows, "place in order");
  std::map<std::string, std::string> places;
  for (std::size_t r = 1; r < rows.size(); ++r) places[rows[r][1]] = rows[r].at(place);
  EXPECT_EQ(places, (std::map<std::string, std::string>{{"C", "1"}, {"A", "2"}, {"B", "3"}}));
}

TEST_F(CsvFilesTest, TheRowOfAModelHoldsItsRateAndEveryCoefficient) {
  const Rows& rows = sut_.at("models.csv");
  ASSERT_EQ(rows.front().size(), 3u + 5u + 4u);
  const auto check = [&](const std::vector<std::string>& row, const char* which,
                         const signal::DifferenceModel& model) {
    EXPECT_EQ(row[1], which);
    EXPECT_EQ(std::stod(row[2]), model.rate_hz);
    for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(std::stod(row[3 + i]), model.numerator[i]);
    for (std::size_t i = 1; i < 5; ++i) EXPECT_EQ(std::stod(row[7 + i]), model.denominator[i]);
  };
  const Identification& second = record_.results[1].identification;
  check(rows[4], "paper", second.paper.model);
  check(rows[5], "refined", second.refined.model);
  check(rows[6], "1 kHz filter", second.control.model);
}

TEST_F(CsvFilesTest, GainAndPhaseAreThoseOfTheOpenLoop) {
  const Rows& rows = sut_.at("open_loop.csv");
  for (std::size_t r = 1; r < rows.size(); ++r) {
    const auto& trial = record_.results.at(std::stoul(rows[r][0]) - 1).trials.at(named(rows[r][1]));
    const auto& line = trial.metrics.lines.at((r - 1) % signal::kReferenceLines);
    ASSERT_EQ(std::stod(rows[r][2]), line.frequency_hz);
    const auto gain = std::polar(std::stod(rows[r][3]), std::stod(rows[r][4]));
    ASSERT_NEAR(std::abs(gain - line.gain), 0.0, 1e-14 * std::abs(line.gain));
    ASSERT_EQ(std::stod(rows[r][5]), 1.0 / 25.0);
  }
}

TEST_F(CsvFilesTest, AWindowIsNamedByTheSecondItStartsAt) {
  const Rows& rows = sut_.at("moving_averages.csv");
  EXPECT_THAT(std::vector<std::string>(rows[1].begin(), rows[1].begin() + 3),
              ElementsAre("1", "A", "0"));
  EXPECT_EQ(rows[51][2], "50");
  EXPECT_EQ(std::stod(rows[51][3]), record_.results[0].trials.at(kA).metrics.moving_rms_mm[50]);
}

TEST(CsvFileTest, ANumberThatIsNotFiniteIsAnEmptyCell) {
  auto results = made::random_results(1, "B", 62);
  results[0].trials[kB].metrics.crossover_hz = kNan;
  results[0].trials[kB].metrics.dwell_ratio = std::numeric_limits<double>::infinity();
  const auto tables = tables_of(made::record_of(results));
  const Rows& rows = tables.at("metrics.csv");
  EXPECT_EQ(rows[1].at(column_of(rows, "crossover [Hz]")), "");
  EXPECT_EQ(rows[1].at(column_of(rows, "dwell ratio [-]")), "");
  EXPECT_NE(rows[1].at(column_of(rows, "rms error [mm]")), "");
}

TEST(CsvFileTest, ARemnantLargerThanTheErrorIsAllOfIt) {
  auto results = made::random_results(1, "B", 63);
  results[0].trials[kB].metrics.lines[2].error_snr = 0.25;
  const auto tables = tables_of(made::record_of(results));
  EXPECT_EQ(tables.at("open_loop.csv")[3].at(5), "1");
}

TEST(CsvFileTest, TrialsShorterThanTheWindowLeaveTheHeaderOfTheMovingAverages) {
  auto results = made::random_results(2, "AB", 64);
  for (SubjectResult& result : results) {
    for (auto& [condition, trial] : result.trials) {
      trial.metrics.moving_rms_mm.clear();
      trial.metrics.moving_dwell.clear();
    }
  }
  EXPECT_EQ(tables_of(made::record_of(results)).at("moving_averages.csv").size(), 1u);
}

}  // namespace
}  // namespace stillhand::study::csv_test
