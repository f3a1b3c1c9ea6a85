// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/read_options.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>

#include "apps/libraries/measurement/tables/ask.hpp"
#include "apps/libraries/measurement/tables/bag_table.hpp"
#include "apps/libraries/measurement/tables/suggestion.hpp"
#include "apps/libraries/report/command_line.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/settings/check_name.hpp"
#include "services/files/settings/check_number.hpp"

namespace stillhand::measurement {
namespace {

constexpr const char* kGroup = "Recordings of other programs";

}  // namespace

std::vector<command_line::Option> add_read_options(command_line::Command& verb,
                                                   ReadOptions& options) {
  if (isatty(STDIN_FILENO) != 0 && isatty(STDERR_FILENO) != 0) {
    options.ask = [](TableFile& file) { return ask_mapping(file, std::cin, std::cerr); };
  }
  const auto map =
      verb.add_option_function<std::vector<std::string>>(
              "--map",
              [&options](const std::vector<std::string>& words) {
                for (const std::string& word : words) {
                  options.mapping.columns.push_back(parse_wish(word));
                }
              },
              "the channel of each column, as 'TITLE=NAME [UNIT]': 'time=t [ms]' 'acc=a_y [g]' "
              "'force=f [N]'. The time is t. A gain may follow: 'ai0=f [V] * 22.5 [N/V]'. A column "
              "without a title is '#2'. Units become SI units. Without --map, each title is 'name "
              "[unit]', and the time is 't [s]'")
          .type_name("'TITLE=NAME [UNIT]'")
          .takes_all()
          .group(kGroup);
  const auto file =
      verb.add_option(
              "--map-file", options.map_file,
              "YAML file with the mapping (map, rate_hz, separator, decimal). If it does not "
              "exist, the verb asks for the mapping on the terminal and writes the file")
          .check(settings::check_name)
          .excludes(map)
          .group(kGroup);
  const auto rate = verb.add_option_function<double>(
                            "--sample-rate",
                            [&options](double rate_hz) {
                              options.mapping.rate_hz = check_rate_hz(rate_hz, "--sample-rate");
                            },
                            "sample rate [Hz] of a file without times")
                        .group(kGroup);
  const auto separator = verb.add_option_function<std::string>(
                                 "--separator",
                                 [&options](const std::string& word) {
                                   options.mapping.form.separator =
                                       parse_separator(word, "--separator");
                                 },
                                 "column separator of a text file [found from the content]")
                             .type_name("{comma,semicolon,tab,blank}")
                             .group(kGroup);
  const auto decimal = verb.add_option_function<std::string>(
                               "--decimal",
                               [&options](const std::string& word) {
                                 options.mapping.form.decimal = parse_decimal(word, "--decimal");
                               },
                               "decimal sign of a text file [found from the content]")
                           .type_name("{point,comma}")
                           .group(kGroup);
  return {map, file, rate, separator, decimal};
}

void add_recording_options(command_line::Command& verb, std::string& recording,
                           ReadOptions& options) {
  verb.add_option("REC", recording, "recording: MCAP, CSV, MATLAB, HDF5 or sound").required();
  verb.add_option("--trial", options.trial,
                  "trial of a session's recording: its number, or the letter of its condition");
  add_read_options(verb, options);
}

void add_heaviest_option(command_line::Command& verb, double& heaviest_kg) {
  verb.add_option("--heaviest", heaviest_kg,
                  "mass [kg] that a force in N may show over an acceleration in m/s^2: more is "
                  "taken for a wrong unit. State it for a machine, such as a shaking table")
      .check(settings::number_between(0.01, 1e7))
      .group(kGroup);
}

std::string words_of(const ReadOptions& options) {
  if (!options.map_file.empty()) {
    return " --map-file " + report::quoted_for_shell(options.map_file);
  }
  const Mapping& mapping = options.mapping;
  std::string words = mapping.columns.empty() ? "" : " --map";
  for (const ColumnWish& wish : mapping.columns) {
    words += " " + report::quoted_for_shell(wish_text(wish));
  }
  if (mapping.rate_hz) words += fmt::format(" --sample-rate {}", *mapping.rate_hz);
  return words;
}

void require_channels(const diagnosis::Measurement& measurement,
                      const std::vector<std::string>& names, const ReadOptions& options,
                      const std::string& where) {
  const auto missing = std::ranges::find_if(
      names, [&](const std::string& name) { return measurement.find(name) == nullptr; });
  if (missing == names.end()) return;
  std::string want;
  for (const diagnosis::Channel& each : measurement.channels) {
    want += (want.empty() ? "one of " : ", ") + each.name;
  }
  const std::string& path = measurement.source;
  const bool is_table = kind_of(path) != FileKind::kMcap || !is_session(path);
  // A mapping gives a column the name of one of Stillhand's channels, and no other.
  const bool mends = *missing != "t" && !si_unit(*missing).empty();
  if (!mends) {
    throw ConfigError(where.empty() ? path : where, "'" + *missing + "', no channel of " + path,
                      want);
  }
  if (is_table && options.mapping.columns.empty() && options.map_file.empty()) {
    want += "; " + words_to_add(*open_table(path, options.mapping.form, options.most_values));
  }
  throw ConfigError(path, "no channel '" + *missing + "'", want);
}

std::string step_for(const std::string& reason) {
  if (reason == "unit") {
    return "correct the unit: --map 'TITLE=NAME [UNIT]' for every column, with the unit that the "
           "values have; of a machine that is so heavy, --heaviest KG";
  }
  if (reason == "sign") return "correct the sign of one recording: --map 'TITLE=NAME [UNIT] * -1'";
  if (reason == "swapped") return "check which column is which: --input, --output or --map";
  if (reason == "clocks") return "shift one column by that time, or record both by one clock";
  if (reason == "samples") return "record again, or name another column: --input, --output";
  if (reason == "copy") return "name another column: --input, --output";
  if (reason == "filter") return "the same command with a lower --order";
  return "check that the columns are of one rig and one ride, and their names: --input, --output "
         "or "
         "--map";
}

}  // namespace stillhand::measurement
