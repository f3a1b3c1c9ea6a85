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

/// What `lab` and `diagnose` need of a plan's file.
struct PlanFile {
  double seconds = 0.0;
  std::filesystem::path ride;
  std::vector<Candidate> candidates;
};

/// One of the file's `candidates`: what it is, and its whole model.
nlohmann::ordered_json json_of(const Candidate& candidate);

/// @throws stillhand::ConfigError naming the entry that is missing or wrong
PlanFile read_plan(const std::filesystem::path& path);

}  // namespace stillhand::next_run
