// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/diagnose_options.hpp"

#include <string>

#include "apps/diagnose/enough.hpp"
#include "services/files/settings/check_number.hpp"
#include "services/system/command_line/command_line.hpp"

namespace stillhand::diagnose {

void add_recordings(command_line::Command& verb, std::vector<std::string>& recordings,
                    measurement::ReadOptions& read, diagnosis::DiagnoseOptions& options) {
  verb.add_option("REC", recordings, "recording(s): MCAP, CSV, MATLAB, HDF5 or sound").required();
  verb.add_option("--input", options.inputs, "inputs of the model: channel(s), comma-separated")
      .delimiter(',')
      .takes_all()
      .expected(1, 1);
  verb.add_option("--output", options.output, "channel that the model predicts");
  add_diagnose_options(verb, options);
  verb.add_option("--trial", read.trial,
                  "trial of a session's recording: its number, or the letter of its condition");
  measurement::add_read_options(verb, read);
}

std::vector<diagnosis::Measurement> read_recordings(const std::vector<std::string>& recordings,
                                                    measurement::ReadOptions read,
                                                    const diagnosis::DiagnoseOptions& options) {
  read.channels = {options.inputs, options.output};
  std::vector<std::string> names = options.inputs;
  names.push_back(options.output);
  std::vector<diagnosis::Measurement> parts;
  for (const std::string& path : recordings) {
    parts.push_back(measurement::read_measurement(path, read));
    measurement::require_channels(parts.back(), names, read, "--input, --output");
  }
  check_enough(parts, options);
  return parts;
}

void add_diagnose_options(command_line::Command& verb, diagnosis::DiagnoseOptions& options) {
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
      .one_of({"auto", "arx", "linear"})
      .default_str("auto");
  verb.add_option("--order", options.order, "order of the difference model").between(1, 12);
  verb.add_option("--most-effects", options.search.most_effects,
                  "stop after this many effects; 0: the baseline alone")
      .between(0, 8);
  verb.add_option("--least-force", options.least_force_n,
                  "smallest RMS force of an effect that counts [N]; the default moves the cursor "
                  "by 0.8 mm. If the output has another unit, every effect counts")
      .check(settings::number_between(0.0, kMostForce_n));
  measurement::add_heaviest_option(verb, options.heaviest_kg);
}

}  // namespace stillhand::diagnose
