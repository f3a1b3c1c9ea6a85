// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace stillhand::report {

/// Style sheet of a Page, for light and dark schemes, screens and paper.  Figures keep a white
/// ground in the dark scheme, because their colours are chosen for white.
std::string page_style();

}  // namespace stillhand::report
