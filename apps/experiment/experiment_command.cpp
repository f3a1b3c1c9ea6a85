// SPDX-License-Identifier: Apache-2.0
#include "apps/experiment/experiment_command.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <random>
#include <sstream>

#include "apps/experiment/conduct.hpp"
#include "apps/experiment/export/export_command.hpp"
#include "apps/experiment/file/experiment_file.hpp"
#include "apps/experiment/report_command.hpp"
#include "apps/experiment/sealed_assignment.hpp"
#include "apps/experiment/status.hpp"
#include "apps/session/instructions.hpp"
#include "apps/session/protocol.hpp"
#include "services/contract/config_error.hpp"
#include "services/recording/file_io.hpp"
#include "services/settings/check_name.hpp"

namespace stillhand::experiment {
namespace {

struct Words {
  std::filesystem::path folder;
  std::string participant;
  std::string reason;
  std::string conditions = "A,B,C";
  std::string order = "williams";
  std::filesystem::path control_model;  // of condition C+, copied into the folder
  std::optional<std::uint64_t> seed;
  Design design;
  lab::LabOptions lab;
  bool ordinary = false;
};

CLI::App* subcommand(CLI::App& verb, const char* name, const char* help, Words& words) {
  CLI::App* sub = verb.add_subcommand(name, help);
  sub->add_option("DIR", words.folder, "folder of the experiment")
      ->required()
      ->check(settings::check_name);
  return sub;
}

std::uint64_t random_seed() {
  std::random_device source;
  return source();
}

void make(Words words) {
  std::istringstream list(words.conditions);
  words.design.conditions.clear();
  for (std::string word; std::getline(list, word, ',');) words.design.conditions.push_back(word);
  words.design.order = order_named(words.order);
  if (words.conditions != "A,B,C") words.design.comparisons.clear();
  words.design.instructions = session::instructions(words.design.who);
  const bool has_model = !words.control_model.empty();
  if (has_model && !std::filesystem::is_regular_file(words.control_model)) {
    throw ConfigError("--control-model", words.control_model.string(), "a file");
  }
  if (has_model) words.design.control_model = "control_model.json";
  // As the file would be read: `run` refuses no folder that was made here.
  design_of(yaml_of(words.design), "experiment.yaml of these options");
  make_folder(words.folder, words.design, words.seed ? *words.seed : random_seed());
  if (has_model) {
    std::filesystem::copy_file(words.control_model, words.folder / words.design.control_model);
  }
  std::printf("%s: read it, change it, then `stillhand experiment run %s`\n",
              (words.folder / kDesignFile).c_str(), words.folder.c_str());
}

int run(Words words) {
  words.lab.real_time = !words.ordinary;
  const Folder folder(words.folder);
  const std::size_t index =
      words.participant.empty()
          ? next_participant(folder)
          : participant_index(words.participant, folder.design().participants);
  runtime::Stop stop;
  return conduct(folder, index, words.lab, stop);
}

int show_status(const Words& words) {
  const Overview overview = overview_of(Folder(words.folder));
  std::fputs(overview.table.c_str(), stdout);
  for (const std::string& finding : overview.findings)
    std::cerr << "stillhand: " << finding << '\n';
  return overview.findings.empty() ? 0 : 2;
}

void exclude(const Words& words) {
  const Folder folder(words.folder);
  const std::size_t index = participant_index(words.participant, folder.design().participants);
  if (!std::filesystem::exists(folder.journal(index))) {
    throw ConfigError("--participant", words.participant + ", who has no session",
                      "a participant with a journal");
  }
  Journal journal(folder.journal(index));
  journal.append({.kind = EntryKind::kExcluded, .text = words.reason});
}

void unblind(const Words& words) {
  const Folder folder(words.folder);
  Journal journal(folder.path() / "journal.jsonl");
  journal.append({.kind = EntryKind::kNote, .text = "unblinded: " + words.reason});
  const std::string text = opened_text(folder.design(), folder.assignment());
  const auto written =
      recording::write_file_atomically((folder.path() / kOpenedFile).string(), text);
  if (!written.ok()) throw std::runtime_error(written.text);
  std::fputs(text.c_str(), stdout);
}

void add_new(CLI::App& verb, const std::shared_ptr<Words>& words) {
  CLI::App* sub = subcommand(verb, "new", "Makes the folder and its experiment.yaml.", *words);
  Design& design = words->design;
  sub->add_option("--title", design.title, "title")->capture_default_str();
  sub->add_option("--conditions", words->conditions, live_conditions())->capture_default_str();
  sub->add_option("--participants", design.participants, "planned number")->capture_default_str();
  sub->add_option("--order", words->order, "random, latin or williams")->capture_default_str();
  sub->add_option("--blocks", design.blocks, "blocks")->capture_default_str();
  sub->add_option("--trials", design.trials, "trials of each condition in a block")
      ->capture_default_str();
  sub->add_option("--trial-seconds", design.trial_s, "length of a trial [s]")
      ->capture_default_str();
  sub->add_option("--identify-seconds", design.identify_s, "length of the pegged trial [s]")
      ->capture_default_str();
  sub->add_option("--operator", design.who, "simulated, mouse or gamepad")->capture_default_str();
  sub->add_option("--control-model", words->control_model,
                  "model of condition C+, copied into the folder; `stillhand close-the-loop` and "
                  "`stillhand control-model` write such a file")
      ->check(settings::check_name);
  sub->add_option(
         "--seed", words->seed,
         "seed of the orders, which can be drawn again with it; without: from the system's "
         "random source")
      ->check(session::check_seed);
  sub->callback([words] { make(*words); });
}

void add_run(CLI::App& verb, const std::shared_ptr<Words>& words, int& status) {
  CLI::App* sub = subcommand(
      verb, "run", "Conducts the next session of a participant, from where the last one ended.",
      *words);
  lab::LabOptions& lab = words->lab;
  lab::set_places(lab);
  sub->add_option("--participant", words->participant,
                  "code such as P07; without: the first who is not complete");
  sub->add_option("--domain", lab.domain, "DDS domain, 0 to 232")->capture_default_str();
  sub->add_option("--config", lab.config, "folder with the settings of each service")
      ->capture_default_str();
  sub->add_option("--match-seconds", lab.match_s,
                  "longest wait until every endpoint has matched [s]")
      ->capture_default_str();
  sub->add_option("--gamepad", lab.gamepad,
                  "of operator: gamepad: input device, for example /dev/input/event5")
      ->check(settings::check_name);
  sub->add_option("--stop-key", lab.stop_key,
                  "input device, for example /dev/input/event3: each of its keys is an emergency "
                  "stop")
      ->check(settings::check_name);
  sub->add_flag("--headless", lab.headless, "open no window");
  sub->add_flag("--wait-for-start", lab.wait_for_start,
                "each trial waits until a person presses Start on the dashboard");
  sub->add_flag("--no-real-time", words->ordinary, "do not ask for real-time scheduling");
  recording::add_keep_options(*sub, lab.keep);
  sub->callback([words, &status] { status = run(*words); });
}

void add_rest(CLI::App& verb, const std::shared_ptr<Words>& words, int& status) {
  CLI::App* shown = subcommand(verb, "status", "Shows what there is of each participant.", *words);
  shown->callback([words, &status] { status = show_status(*words); });
  CLI::App* excluded = subcommand(
      verb, "exclude", "Notes that a participant's data do not count; deletes nothing.", *words);
  excluded->add_option("--participant", words->participant, "code such as P07")->required();
  excluded->add_option("--reason", words->reason, "why")->required()->check(settings::check_name);
  excluded->callback([words] { exclude(*words); });
  CLI::App* opened = subcommand(
      verb, "unblind", "Writes assignment.json: the condition of each label and trial.", *words);
  opened->add_option("--reason", words->reason, "why now")->required()->check(settings::check_name);
  opened->callback([words] { unblind(*words); });
}

}  // namespace

void add_experiment_command(CLI::App& cli, int& status) {
  const auto words = std::make_shared<Words>();
  CLI::App* verb = cli.add_subcommand(
      "experiment",
      "Conducts an experiment with participants: a folder with a pre-registration, a journal and\n"
      "recordings for each participant.\n"
      "Example: stillhand experiment new study1, then stillhand experiment run study1");
  verb->require_subcommand(1);
  add_new(*verb, words);
  add_run(*verb, words, status);
  add_rest(*verb, words, status);
  add_report_command(*verb, status);
  add_export_command(*verb);
}

}  // namespace stillhand::experiment
