// SPDX-License-Identifier: Apache-2.0
#include "apps/compare/summary_file.hpp"

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <set>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "services/files/settings/json_entry.hpp"

namespace stillhand::compare {
namespace {

namespace fs = std::filesystem;
using settings::JsonEntry;

constexpr std::size_t kMostPeople = 100'000;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// Values of each person; null: unknown for that person.
std::vector<double> values_of(const JsonEntry& metric) {
  std::vector<double> out;
  for (const JsonEntry& entry : metric.at("per_subject").entries(0, kMostPeople)) {
    out.push_back(entry.is_null() ? kUnknown : entry.number());
  }
  return out;
}

fs::path without_end(const fs::path& folder) {
  const fs::path whole = fs::absolute(folder).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

}  // namespace

Side read_summary(const fs::path& folder) {
  const fs::path file = folder / "summary.json";
  std::ifstream in(file);
  if (!in) {
    throw ConfigError(folder.string(), "no summary.json",
                      "a folder that study, lab, experiment report or close-the-loop wrote");
  }
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const auto json = settings::parsed_json(text, file.string(), "JSON of a summary");
  const JsonEntry conditions = JsonEntry(json, file.string()).at("conditions");
  Side side;
  side.name = without_end(folder).filename().string();
  if (!json["conditions"].is_object()) conditions.refuse("an object of conditions");
  for (const auto& [label, value] : json["conditions"].items()) {
    if (label.empty()) conditions.refuse("names of conditions");
    const JsonEntry entry = conditions.at(label);
    if (!value.is_object()) entry.refuse("an object of numbers");
    Condition condition{.label = label, .values = {}};
    for (std::size_t m = 0; m < kMetrics.size(); ++m) {
      if (entry.has(kMetrics[m].key)) condition.values[m] = values_of(entry.at(kMetrics[m].key));
    }
    side.conditions.push_back(std::move(condition));
  }
  return side;
}

std::vector<Side> read_summaries(const std::vector<fs::path>& folders) {
  std::set<fs::path> seen;
  std::multiset<std::string> names;
  std::vector<Side> sides;
  for (const fs::path& folder : folders) {
    if (!seen.insert(fs::weakly_canonical(folder)).second) {
      throw ConfigError(folder.string(), "the same folder twice", "each folder once");
    }
    sides.push_back(read_summary(folder));
    names.insert(sides.back().name);
  }
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (names.count(sides[i].name) > 1) sides[i].name = without_end(folders[i]).string();
  }
  return sides;
}

}  // namespace stillhand::compare
