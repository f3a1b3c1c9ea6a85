// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace stillhand::study {

/// Adds the verb "study".  @param status  exit status of the program, set when the verb ran
void add_study_command(CLI::App& cli, int& status);

}  // namespace stillhand::study
