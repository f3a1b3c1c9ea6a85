// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace stillhand::record {

/// Adds the verb `record`; `status` is its exit status after parsing.
void add_record_command(CLI::App& cli, int& status);

}  // namespace stillhand::record
