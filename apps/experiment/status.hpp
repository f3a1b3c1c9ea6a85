// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/experiment/folder/folder.hpp"

namespace stillhand::experiment {

/// What a folder holds of each planned participant, also who has not begun.
struct Overview {
  std::string table;                  ///< for a person
  std::vector<std::string> findings;  ///< what is wrong in the folder, a line each
};

/// Reads every journal and looks at every recording; changes nothing.
/// @throws ConfigError for a journal that cannot be read
Overview overview_of(const Folder& folder);

}  // namespace stillhand::experiment
