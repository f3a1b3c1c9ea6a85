// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/diagnose_options.hpp"

#include <CLI/CLI.hpp>
#include <string>

#include "services/files/settings/check_number.hpp"

namespace stillhand::diagnose {

void add_diagnose_options(CLI::App& verb, diagnosis::DiagnoseOptions& options) {
  constexpr double kMostForce_n = 100.0;  // larger than any force of a stick
  verb.add_option_function<std::string>(
          "--model",
          [&options](const std::string& word) {
            options.model = word == "arx"      ? diagnosis::ModelClass::kArx
                            : word == "linear" ? diagnosis::ModelClass::kLinear
                                               : diagnosis::ModelClass::kAuto;
          },
          "baseline: arx (the paper's difference model, refined on its free-run error), linear "
          "(static in the inputs: inverse dynamics), or auto (the better one)")
      ->check(CLI::IsMember({"auto", "arx", "linear"}))
      ->default_str("auto");
  verb.add_option("--order", options.order, "order of the difference model")
      ->check(CLI::Range(1, 12))
      ->capture_default_str();
  verb.add_option("--most-effects", options.search.most_effects,
                  "stop after this many effects; 0: the baseline alone")
      ->check(CLI::Range(0, 8))
      ->capture_default_str();
  verb.add_option("--least-force", options.least_force_n,
                  "smallest RMS force of an effect that counts [N]; the default moves the cursor "
                  "by 0.8 mm. If the output has another unit, every effect counts")
      ->check(settings::number_between(0.0, kMostForce_n))
      ->capture_default_str();
}

}  // namespace stillhand::diagnose
