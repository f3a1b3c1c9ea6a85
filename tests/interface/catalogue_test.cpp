// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "idl/idl_text.hpp"
#include "idl/topics.hpp"
#include "places.hpp"

namespace stillhand::topics {
namespace {

std::vector<std::string> cells(const std::string& row) {
  std::vector<std::string> list;
  std::istringstream stream(row);
  for (std::string cell; std::getline(stream, cell, '|');) {
    const auto begin = cell.find_first_not_of(" `");
    const auto end = cell.find_last_not_of(" `");
    list.push_back(begin == std::string::npos ? "" : cell.substr(begin, end - begin + 1));
  }
  return list;
}

std::set<std::string> names(const std::string& text) {
  // Remote control: no process of a session.
  if (text == "any client" || text.starts_with("stillhand re")) return {};
  if (text == "every process") return {kServices.begin(), kServices.end()};
  if (text == "every launched process") return {kLaunched.begin(), kLaunched.end()};
  std::set<std::string> list;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, ',');) {
    list.insert(word.substr(word.find_first_not_of(' ')));
  }
  return list;
}

// Rows of the table in idl/README.md by topic name.
std::map<std::string, std::vector<std::string>> readme_rows() {
  std::map<std::string, std::vector<std::string>> rows;
  std::ifstream readme(STILLHAND_SOURCE "/idl/README.md");
  for (std::string line; std::getline(readme, line);) {
    if (line.starts_with("| `stillhand/")) {
      const auto row = cells(line);
      rows[row.at(1)] = row;
    }
  }
  return rows;
}

TEST(ProcessesTest, TheRecorderStartsFirstAndEndsLast) {
  EXPECT_EQ(kLaunchOrder.front(), "recorder");
  EXPECT_EQ(kEndsLast, "recorder");
}

TEST(ProcessesTest, EveryProcessButTheConductorIsLaunchedOnce) {
  const std::set<std::string_view> launched(kLaunchOrder.begin(), kLaunchOrder.end());
  std::set<std::string_view> others(kServices.begin(), kServices.end());
  others.erase("experiment");
  EXPECT_EQ(launched, others);
  EXPECT_EQ(launched, (std::set<std::string_view>{kLaunched.begin(), kLaunched.end()}));
}

TEST(CatalogueTest, TheReadmeHasTheSameTopics) {
  const auto rows = readme_rows();
  std::set<std::string> in_readme;
  for (const auto& [name, row] : rows) in_readme.insert(name);
  std::set<std::string> in_code;
  for (const Topic* topic : kCatalogue) in_code.insert(std::string(topic->name));
  for (const Topic* topic : kRemoteControl) in_code.insert(std::string(topic->name));
  EXPECT_EQ(in_readme, in_code);
}

TEST(CatalogueTest, TheReadmeSaysTheSameOfEachTopic) {
  const auto rows = readme_rows();
  std::vector<const Topic*> all(kCatalogue.begin(), kCatalogue.end());
  all.insert(all.end(), kRemoteControl.begin(), kRemoteControl.end());
  for (const Topic* topic : all) {
    const auto found = rows.find(std::string(topic->name));
    ASSERT_NE(found, rows.end()) << topic->name;
    const auto& row = found->second;
    EXPECT_EQ(row.at(2), topic->type);
    if (topic->rate_hz > 0.0) {
      EXPECT_EQ(std::stod(row.at(3)), topic->rate_hz) << topic->name;
    } else {
      EXPECT_TRUE(row.at(3).starts_with("when")) << topic->name;
    }
    EXPECT_EQ(names(row.at(5)),
              (std::set<std::string>{topic->writers.begin(), topic->writers.end()}))
        << topic->name;
    EXPECT_EQ(names(row.at(6)),
              (std::set<std::string>{topic->readers.begin(), topic->readers.end()}))
        << topic->name;
    EXPECT_EQ(row.at(7), profile_of(*topic)) << topic->name;
  }
}

TEST(CatalogueTest, DdsSupervisesWhatMovesTheMotorAndThePlatform) {
  std::map<std::string_view, std::string_view> supervised;
  for (const Topic* topic : kCatalogue) {
    if (!topic->supervisor.empty()) supervised[topic->type] = topic->supervisor;
    for (const std::string_view reader : topic->readers) {
      const bool loop = reader == topic->supervisor;
      EXPECT_EQ(profile_of(*topic, reader), loop ? "control_loop" : profile_of(topic->pattern));
    }
  }
  EXPECT_THAT(supervised, testing::UnorderedElementsAre(
                              testing::Pair("stillhand_msgs::MotorCommand", "rig"),
                              testing::Pair("stillhand_msgs::PlatformCommand", "rig")));
}

TEST(CatalogueTest, EveryTopicIsRecorded) {
  for (const Topic* topic : kCatalogue) {
    EXPECT_THAT(topic->readers, testing::Contains("recorder")) << topic->name;
  }
}

TEST(CatalogueTest, EveryTypeIsDefinedInTheIdlThatTravelsWithRecordings) {
  std::vector<const Topic*> all(kCatalogue.begin(), kCatalogue.end());
  all.insert(all.end(), kRemoteControl.begin(), kRemoteControl.end());
  for (const Topic* topic : all) {
    const std::string name(topic->type.substr(topic->type.rfind(':') + 1));
    const std::string wanted = "struct " + name + " {";
    int found = 0;
    for (const auto text : kIdlTexts) {
      if (text.find(wanted) != std::string_view::npos) ++found;
    }
    EXPECT_EQ(found, 1) << topic->type;
  }
}

TEST(CatalogueTest, EveryFieldOfEveryStructHasItsUnitInAComment) {
  for (const auto text : kIdlTexts) {
    std::istringstream lines{std::string(text)};
    bool in_struct = false;
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("struct ")) in_struct = true;
      if (line.starts_with("};")) in_struct = false;
      if (in_struct && line.starts_with("  ") && line.find(';') != std::string::npos) {
        EXPECT_NE(line.find("// ["), std::string::npos) << line;
      }
    }
  }
}

}  // namespace
}  // namespace stillhand::topics
