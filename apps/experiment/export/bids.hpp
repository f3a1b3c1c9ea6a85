// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/experiment/export/data_set.hpp"
#include "apps/libraries/report/staged_folder.hpp"

namespace stillhand::experiment {

/// The version of the standard that the data set states.
inline constexpr const char* kBidsVersion = "1.11.1";

/// What only the laboratory knows of a data set.
struct Release {
  std::string licence = "not stated; ask the authors";
  std::vector<std::string> authors;
};

/// Writes a data set of the Brain Imaging Data Structure into a staged folder: README, "The data
/// set". Sources: the BIDS specification 1.11.1, "Motion" and "Behavioral experiments"; Jeung et
/// al., Scientific Data 11, 716 (2024); Gorgolewski et al., Scientific Data 3, 160044 (2016).
/// @returns trials left out, one line each: fewer than two samples
/// @throws std::runtime_error when the disk refuses; study::Interrupted; as rows_of()
std::vector<std::string> write_bids(const DataSet& set, const Folder& folder,
                                    const Release& release, report::StagedFolder& out,
                                    const OnSession& on_participant);

}  // namespace stillhand::experiment
