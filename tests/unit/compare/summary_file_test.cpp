// SPDX-License-Identifier: Apache-2.0
#include "apps/compare/summary_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "tests/support/folder.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::compare::summary_file_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class SummaryFileTest : public testing::Test {
 protected:
  fs::path folder(const std::string& name, const std::string& text) {
    const fs::path out = root_ / name;
    fs::create_directories(out);
    std::ofstream(out / "summary.json") << text;
    return out;
  }
  static std::string refusal(const std::vector<fs::path>& folders) {
    return support::refusal([&] { read_summaries(folders); });
  }

  const support::Folder root_;
};

TEST_F(SummaryFileTest, ReadsConditionsAndUnknownValues) {
  const auto path =
      folder("lab/", R"({"conditions": {"A": {"rms_error_mm": {"per_subject": [1, null]}},
    "C+": {"dwell_ratio": {"per_subject": [0.25]}, "cancelled_share": 0.5}}})");
  const Side side = read_summary(path);
  EXPECT_EQ(side.name, "lab");
  EXPECT_EQ(side.find("A")->values[0].at(0), 1.0);
  EXPECT_TRUE(std::isnan(side.find("A")->values[0].at(1)));
  EXPECT_EQ(side.find("C+")->values[1].at(0), 0.25);
  EXPECT_EQ(side.find("B"), nullptr);
}

TEST_F(SummaryFileTest, FoldersOfOneNameGetTheirPaths) {
  const std::string text = R"({"conditions": {}})";
  const auto first = folder("x/lab", text);
  const auto second = folder("y/lab", text);
  const auto sides = read_summaries({first, second});
  EXPECT_EQ(sides[0].name, first.string());
  EXPECT_EQ(sides[1].name, second.string());
}

TEST_F(SummaryFileTest, WhatIsNoSummaryIsNamed) {
  const auto good = folder("good", R"({"conditions": {}})");
  EXPECT_THAT(refusal({root_ / "nothing"}), HasSubstr("no summary.json"));
  EXPECT_THAT(refusal({good, root_ / "good" / "."}), HasSubstr("the same folder twice"));
  EXPECT_THAT(refusal({folder("cut", R"({"conditions": {)")}), HasSubstr("summary.json"));
  EXPECT_THAT(refusal({folder("none", "{}")}), HasSubstr("conditions"));
  EXPECT_THAT(refusal({folder("list", R"({"conditions": [1]})")}), HasSubstr("conditions"));
  EXPECT_THAT(refusal({folder(
                  "text", R"({"conditions": {"A": {"rms_error_mm": {"per_subject": ["x"]}}}})")}),
              HasSubstr("per_subject"));
}

}  // namespace
}  // namespace stillhand::compare::summary_file_test
