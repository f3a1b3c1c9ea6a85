// SPDX-License-Identifier: Apache-2.0
#include "apps/experiment/experiment_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <random>
#include <sstream>

#include "apps/experiment/conduct.hpp"
#include "apps/experiment/export/export_command.hpp"
#include "apps/experiment/report_command.hpp"
#include "apps/experiment/status.hpp"
#include "apps/experiment/unblind.hpp"
#include "apps/libraries/experiment/core/counterbalance.hpp"
#include "apps/libraries/experiment/file/experiment_file.hpp"
#include "apps/libraries/report/command_line.hpp"
#include "apps/libraries/session/instructions.hpp"
#include "apps/libraries/session/protocol.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/cancellation/control_model_file.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/files/settings/check_name.hpp"
#include "services/system/command_line/command_line.hpp"
#include "services/system/process/remark.hpp"

namespace stillhand::experiment {
namespace {

struct Typed {
  std::filesystem::path folder;
  std::string participant;
  std::string reason;
  std::string conditions = "A,B,C";
  std::string order = "williams";
  std::filesystem::path control_model;  // of condition C+, copied into the folder
  std::filesystem::path plan;           // of plan-run
  std::optional<std::uint64_t> seed;
  Design design;
  lab::LabOptions lab;
  bool ordinary = false;
  bool incomplete = false;
};

command_line::Command subcommand(command_line::Command& verb, const char* name, const char* help,
                                 Typed& typed) {
  command_line::Command sub = verb.add_subcommand(name, help);
  sub.add_option("DIR", typed.folder, "folder of the experiment")
      .required()
      .check(settings::check_name);
  return sub;
}

std::uint64_t random_seed() {
  std::random_device source;
  return source();
}

// A session checks it against its own settings, too.
void require_control_model(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) {
    throw ConfigError("--control-model", file.string(), "a file, or diagnosed");
  }
  static_cast<void>(
      cancellation::parse_control_model(recording::read_file(file.string()), file.string(), kRig));
}

void make(Typed typed) {
  std::istringstream list(typed.conditions);
  typed.design.conditions.clear();
  for (std::string word; std::getline(list, word, ',');) typed.design.conditions.push_back(word);
  typed.design.order = order_named(typed.order);
  if (typed.conditions != "A,B,C") typed.design.comparisons.clear();
  typed.design.instructions = session::instructions(typed.design.who);
  const bool has_model = !typed.control_model.empty();
  const bool diagnosed = typed.control_model == kDiagnosed;
  if (has_model && !diagnosed) require_control_model(typed.control_model);
  const bool wants_model = std::ranges::count(typed.design.conditions, "C+") > 0;
  if (wants_model != has_model) {
    throw ConfigError("--control-model", has_model ? typed.control_model.string() : "nothing",
                      "a file or diagnosed with condition C+, and none without it");
  }
  if (has_model) typed.design.control_model = diagnosed ? kDiagnosed : "control_model.json";
  // As the file would be read: `run` refuses no folder that was made here.
  design_of(yaml_of(typed.design), "the experiment.yaml that these options give");
  make_folder(typed.folder, typed.design, typed.seed ? *typed.seed : random_seed());
  if (const std::string file = typed.design.model_file(); !file.empty()) {
    std::filesystem::copy_file(typed.control_model, typed.folder / file);
  }
  const auto round =
      static_cast<std::int64_t>(round_of(typed.design.order, typed.design.conditions.size()));
  // Person and pass choose the row together, Eq. EX-3: all rows of one or of the other balance it.
  const std::int64_t passes = typed.design.blocks * typed.design.trials;
  if (typed.design.participants % round != 0 && passes % round != 0) {
    runtime::remark(fmt::format("orders of {} participants are not balanced: those of {} are",
                                typed.design.participants,
                                (typed.design.participants / round + 1) * round));
  }
  std::printf("%s: read it, change it, then `%s`\n", (typed.folder / kDesignFile).c_str(),
              command_for("run", typed.folder).c_str());
}

// Of an experiment with everybody complete or excluded.
void say_after(const Folder& folder) {
  report::say_next(command_for(folder.unblinded() ? "report" : "unblind", folder.path()));
}

int run(Typed typed) {
  typed.lab.real_time = !typed.ordinary;
  const Folder folder(typed.folder);
  const std::optional<std::size_t> index =
      typed.participant.empty()
          ? next_participant(folder)
          : participant_index(typed.participant, folder.design().participants);
  if (!index) {
    std::puts("every planned participant is complete or excluded");
    say_after(folder);
    return 0;
  }
  runtime::Stop stop;
  if (!typed.plan.empty()) return conduct_planned(folder, *index, typed.plan, typed.lab, stop);
  const int status = conduct(folder, *index, typed.lab, stop);
  report::say_next(command_for("status", typed.folder));
  return status;
}

int show_status(const Typed& typed) {
  const Folder folder(typed.folder);
  const Overview overview = overview_of(folder);
  std::fputs(overview.table.c_str(), stdout);
  for (const std::string& finding : overview.findings) runtime::remark(finding);
  if (overview.findings.empty() && next_participant(folder)) {
    report::say_next(command_for("run", typed.folder));
  } else if (overview.findings.empty()) {
    say_after(folder);
  }
  return overview.findings.empty() ? 0 : 2;
}

void exclude(const Typed& typed) {
  const Folder folder(typed.folder);
  const std::size_t index = participant_index(typed.participant, folder.design().participants);
  folder.open_participant(index);  // of a person who never came
  Journal journal(folder.journal(index));
  journal.append({.kind = EntryKind::kExcluded, .text = typed.reason});
}

void add_new(command_line::Command& verb, const std::shared_ptr<Typed>& typed) {
  command_line::Command sub =
      subcommand(verb, "new", "Makes the folder and its experiment.yaml.", *typed);
  Design& design = typed->design;
  sub.add_option("--title", design.title, "title").check([](const std::string& word) {
    return in_one_line(word) == word ? "" : "want a title of one line, of at most 1000 bytes";
  });
  sub.add_option("--conditions", typed->conditions,
                 "comma-separated: " + session::known_conditions(session::kExperimentConditions));
  sub.add_option("--participants", design.participants, "planned number");
  sub.add_option("--order", typed->order, "orders of the trials")
      .type_name("{random,latin,williams}");
  sub.add_option("--blocks", design.blocks, "blocks");
  sub.add_option("--trials", design.trials, "trials of each condition in a block");
  sub.add_option("--trial-seconds", design.trial_s, "length of a trial [s]");
  sub.add_option("--identify-seconds", design.identify_s, "length of the pegged trial [s]");
  sub.add_option("--operator", design.who, "who tracks").type_name("{simulated,mouse,gamepad}");
  sub.add_option("--control-model", typed->control_model,
                 "model of condition C+, copied into the folder; `stillhand close-the-loop` and "
                 "`stillhand control-model` write such a file. diagnosed: each session's own, in "
                 "the pause behind its identification")
      .check(settings::check_name);
  sub.add_option("--seed", typed->seed,
                 "seed of the orders: the same seed gives the same orders [random]")
      .check(session::check_seed);
  sub.callback([typed] { make(*typed); });
}

void add_run(command_line::Command& verb, const std::shared_ptr<Typed>& typed, int& status) {
  command_line::Command sub = subcommand(
      verb, "run", "Conducts a participant's next session; continues where the last one ended.",
      *typed);
  lab::LabOptions& lab = typed->lab;
  lab::set_places(lab);
  sub.add_option("--participant", typed->participant,
                 "code such as P07 [the first participant who is not complete]");
  sub.add_option("--plan", typed->plan,
                 "conduct the run of this plan.json of `stillhand plan-run` with --participant, in "
                 "place of the protocol: it is no step of it")
      .needs("--participant")
      .existing_file();
  sub.add_option("--domain", lab.domain, "DDS domain, 0 to 232");
  sub.add_option("--config", lab.config, "folder with the settings of each service");
  sub.add_option("--match-seconds", lab.match_s,
                 "longest wait until all processes have found each other [s]");
  sub.add_option("--gamepad", lab.gamepad,
                 "input device, for example /dev/input/event5, if the operator is gamepad")
      .check(settings::check_name);
  sub.add_option("--stop-key", lab.stop_key,
                 "input device, for example /dev/input/event3: each of its keys is an emergency "
                 "stop")
      .check(settings::check_name);
  sub.add_flag("--headless", lab.headless, "open no window");
  sub.add_flag("--wait-for-start", lab.wait_for_start,
               "each trial waits until a person presses Start on the dashboard");
  sub.add_flag("--no-real-time", typed->ordinary, "do not ask for real-time scheduling");
  recording::add_keep_options(sub, lab.keep);
  sub.callback([typed, &status] { status = run(*typed); });
}

void add_rest(command_line::Command& verb, const std::shared_ptr<Typed>& typed, int& status) {
  command_line::Command shown =
      subcommand(verb, "status", "Shows how far each participant is.", *typed);
  shown.callback([typed, &status] { status = show_status(*typed); });
  command_line::Command excluded =
      subcommand(verb, "exclude",
                 "Marks a participant as excluded, with the reason. Deletes nothing.", *typed);
  excluded.add_option("--participant", typed->participant, "code such as P07").required();
  excluded.add_option("--reason", typed->reason, "why").required().check(settings::check_name);
  excluded.callback([typed] { exclude(*typed); });
  command_line::Command opened =
      subcommand(verb, "unblind",
                 "Writes assignment.json: the condition of each label and trial. "
                 "Refuses while a participant is not complete.",
                 *typed);
  opened.add_option("--reason", typed->reason, "why now").required().check(settings::check_name);
  opened.add_option("--participant", typed->participant,
                    "open this participant alone, for their safety; the others stay blinded");
  opened.add_flag(
      "--incomplete", typed->incomplete,
      "open all although a participant is not complete; you confirm with the folder's name");
  opened.callback([typed] {
    const std::string text = unblind(
        Folder(typed->folder), {typed->reason, typed->participant, typed->incomplete}, std::cin);
    std::fputs(text.c_str(), stdout);
    if (typed->participant.empty()) {
      report::say_next(command_for("report", typed->folder));
    }
  });
}

}  // namespace

void add_experiment_command(command_line::Command& cli, int& status) {
  const auto typed = std::make_shared<Typed>();
  command_line::Command verb = cli.add_subcommand(
      "experiment",
      "Conducts an experiment with participants: a folder with a pre-registration, a journal and\n"
      "recordings for each participant.\n"
      "Example: stillhand experiment new study1, then stillhand experiment run study1");
  verb.require_subcommand();
  add_new(verb, typed);
  add_run(verb, typed, status);
  add_rest(verb, typed, status);
  add_report_command(verb, status);
  add_export_command(verb);
}

}  // namespace stillhand::experiment
