// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>

#include "apps/experiment/folder/folder.hpp"

namespace stillhand::experiment {

struct Unblinding {
  std::string reason = {};
  std::string participant =
      {};                   ///< code of the only one to open, for that person's safety; empty: all
  bool incomplete = false;  ///< although somebody is neither complete nor excluded
};

/// Opens the conditions: writes why, when and how far the experiment was into journal.jsonl of the
/// folder, then assignment.json there, or of one participant in that participant's folder.
/// @param typed  if somebody is not complete, its next line has to be the name of the folder or the
///               title of the experiment
/// @return the text of assignment.json
/// @throws ConfigError before anything is written: somebody is not complete and `incomplete` was
/// not
///         given, the line is another one, or the one participant has no session
std::string unblind(const Folder& folder, const Unblinding& asked, std::istream& typed);

}  // namespace stillhand::experiment
