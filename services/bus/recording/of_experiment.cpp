// SPDX-License-Identifier: Apache-2.0
#include "services/bus/recording/of_experiment.hpp"

#include "services/system/command_line/command_line.hpp"

namespace stillhand::recording {

void add_experiment_options(command_line::Command& cli, OfExperiment& place) {
  const std::string group = "Experiment";
  command_line::Option participant =
      cli.add_option("--participant", place.participant, "code of the participant, for the record");
  command_line::Option digest = cli.add_option("--experiment-digest", place.digest,
                                               "SHA-256 of the experiment's file, for the record");
  command_line::Option session = cli.add_option(
      "--experiment-session", place.session, "number of the participant's session, for the record");
  for (command_line::Option option : {participant, digest, session}) option.group(group);
  participant.needs(digest).needs(session);
  digest.needs(participant);
  session.needs(participant);
}

std::vector<std::string> experiment_words(const OfExperiment& place) {
  if (place.participant.empty()) return {};
  return {"--participant", place.participant,      "--experiment-digest",
          place.digest,    "--experiment-session", place.session};
}

TextMap experiment_texts(const OfExperiment& place) {
  return {{"participant", place.participant}, {"digest", place.digest}, {"session", place.session}};
}

}  // namespace stillhand::recording
