// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "services/core/next_run/contest.hpp"

namespace stillhand::next_run {

/// The ride of a plan, in the folder of its file.
inline constexpr const char* kRideName = "ride.csv";

/// [s] Length of a run.
inline constexpr double kShortest_s = 5.0;
inline constexpr double kLongest_s = 600.0;

/// What `lab` and `diagnose` need of a plan's file.
struct PlanFile {
  double seconds = 0.0;
  std::filesystem::path ride;
  std::vector<Candidate> candidates;
};

/// One of the file's `candidates`: what it is, and its whole model.
nlohmann::ordered_json json_of(const Candidate& candidate);

/// @param version  of this program: another one may mean other causes by the same numbers
/// @throws stillhand::ConfigError naming the entry that is missing or wrong, a ride that is not the
/// plan's, and a file that was changed after it was written
PlanFile read_plan(const std::filesystem::path& path, const std::string& version);

}  // namespace stillhand::next_run
