// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace stillhand::predict {

/// Adds the verb `predict`; `status` is its exit status after parsing.
void add_predict_command(CLI::App& cli, int& status);

}  // namespace stillhand::predict
