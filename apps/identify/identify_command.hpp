// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace stillhand::identify {

/// Adds `stillhand identify`; @param status  its exit status, once it ran
void add_identify_command(CLI::App& cli, int& status);

}  // namespace stillhand::identify
