// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/experiment_place.hpp"

#include <iterator>
#include <system_error>

#include "services/core/contract/config_error.hpp"

namespace stillhand::report {
namespace {

namespace fs = std::filesystem;

// The folder's own names, apps/experiment/README.md, "The folder".
bool is_kept(const fs::path& below) {
  const std::string first = below.begin()->string();
  const auto depth = std::distance(below.begin(), below.end());
  // participants/P01/sessions/01 is a session; results of it may lie in there.
  if (first == "participants") return depth <= 4;
  return first.starts_with("assignment.") || first.starts_with("experiment.") ||
         first == "journal.jsonl";
}

}  // namespace

void refuse_place_of_experiment(const fs::path& place, const std::string& option) {
  std::error_code error;
  for (fs::path at = place; at.has_relative_path(); at = at.parent_path()) {
    const fs::path folder = at.parent_path();
    if (!fs::exists(folder / "experiment.yaml", error)) continue;
    if (!is_kept(place.lexically_relative(folder))) continue;
    throw ConfigError(option, place.string() + ", a place of the experiment in " + folder.string(),
                      "a place outside of it");
  }
}

}  // namespace stillhand::report
