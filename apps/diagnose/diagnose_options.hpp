// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/diagnosis/diagnose.hpp"

namespace CLI {
class App;
}

namespace stillhand::diagnose {

/// Adds the options that decide a verdict (--model, --order, --most-effects, --least-force) to a
/// verb.  Every verb that diagnoses takes them from here, so that one file has one verdict.
/// @param options  keeps what the user gives; as it comes it holds the defaults
void add_diagnose_options(CLI::App& verb, diagnosis::DiagnoseOptions& options);

}  // namespace stillhand::diagnose
