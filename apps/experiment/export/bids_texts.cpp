// SPDX-License-Identifier: Apache-2.0
#include "apps/experiment/export/bids_texts.hpp"

#include <fmt/format.h>

#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "apps/libraries/session/core/trial_numbers.hpp"
#include "services/core/contract/config_error.hpp"
#include "version.hpp"

namespace stillhand::experiment {
namespace {

using nlohmann::ordered_json;

// idl/control_loop.idl; axes x forward, y right, z up.
constexpr std::array<MotionChannel, 10> kChannels{
    {{"a_x", "x", "ACCEL", "Platform", "acceleration of the platform, forward"},
     {"a_y", "y", "ACCEL", "Platform", "acceleration of the platform, right (lateral)"},
     {"a_z", "z", "ACCEL", "Platform", "specific force, up; +9.81 at rest"},
     {"roll", "x", "ORNT", "Platform", "roll of the platform, positive right side down"},
     {"theta", "x", "ORNT", "Stick", "angle of the stick, positive to the right"},
     {"omega", "x", "GYRO", "Stick", "rate of the stick's angle"},
     {"f", "n/a", "MISC", "Hand", "force of the hand on the stick, positive to the right"},
     {"f_motor", "n/a", "MISC", "Stick", "force asked of the motor at the hand"},
     {"x_r", "y", "POS", "ScreenTarget", "target on the screen, right of its centre"},
     {"x_p", "y", "POS", "ScreenCursor", "cursor on the screen, right of its centre"}}};

std::string text_of(const ordered_json& json) {
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

ordered_json column(const char* description, std::string_view unit = "") {
  ordered_json out{{"Description", description}};
  if (!unit.empty()) out["Units"] = unit;
  return out;
}

ordered_json levels(const char* description,
                    const std::vector<std::pair<std::string_view, std::string_view>>& all) {
  ordered_json out{{"Description", description}, {"Levels", ordered_json::object()}};
  for (const auto& [level, meaning] : all) out["Levels"][std::string(level)] = meaning;
  return out;
}

ordered_json condition_levels() {
  std::vector<std::pair<std::string_view, std::string_view>> all;
  for (const session::Condition each : session::conditions_of(session::kExperimentConditions)) {
    all.emplace_back(name_of(each), session::row_of(each).meaning);
  }
  return levels("Condition of the trial; n/a: the motor ran another model than the condition's",
                all);
}

// Of every table with a row a trial.
void add_trial_columns(ordered_json& json) {
  json["block"] = column("Block of the protocol, from 1");
  json["place"] = column("Place in the protocol over all blocks, from 1");
  json["condition"] = condition_levels();
  json["completed"] = levels("The trial ran to its end", {{"yes", "it did"},
                                                          {"no",
                                                           "it was ended "
                                                           "early; it runs again as another run"}});
  json["lost_share"] = column("Lost share of the planned samples", "1");
  for (const session::Number& each : session::numbers(session::kExport)) {
    json[each.name] = column(each.meaning, each.unit() == "-" ? "1" : each.unit());
  }
}

const char* task_description(TrialKind kind) {
  constexpr std::array kTasks{
      "The stick is held by a peg, the hand rests on it, and the platform moves: identification of "
      "the biodynamic feedthrough",
      "The hand holds the free stick still, and the platform moves: identification of the "
      "biodynamic feedthrough to position",
      "Pursuit tracking on a standing platform, before the measured trials",
      "Pursuit tracking of a target on a screen with a stick, on a platform that stands or moves "
      "laterally"};
  return kTasks.at(static_cast<std::size_t>(kind));
}

// Title, task and conditions.
std::string readme_head(const Design& design, const DataSet& set) {
  std::string text = fmt::format(
      "{}\n\n"
      "Pursuit tracking with a force-reflecting stick on a platform that shakes the hand\n"
      "(biodynamic feedthrough), after R. B. Gillespie and S. Sovenyi, Model-Based Cancellation\n"
      "of Biodynamic Feedthrough Using a Force-Reflecting Joystick. {} participants; operator: "
      "{}.\n\n",
      design.title, set.participants.size(), design.who);
  text += "Conditions\n";
  for (const std::string& condition : design.conditions) {
    text += fmt::format("- {}: {}\n", condition, session::row_of(condition_of(condition)).meaning);
  }
  return text;
}

}  // namespace

const MotionChannel& channel_of(const std::string& column) {
  for (const MotionChannel& channel : kChannels) {
    if (column == channel.name) return channel;
  }
  throw ConfigError(column, "a column without a place in BIDS", "a column of the CSV format");
}

std::string dataset_description(const Design& design, const Release& release) {
  ordered_json json{{"Name", design.title},
                    {"BIDSVersion", kBidsVersion},
                    {"DatasetType", "raw"},
                    {"License", release.licence}};
  if (!release.authors.empty()) json["Authors"] = release.authors;
  json["GeneratedBy"] = {{{"Name", "stillhand experiment export"}, {"Version", kVersion}}};
  return text_of(json);
}

std::string readme(const Folder& folder, const DataSet& set, const Release& release) {
  const Design& design = folder.design();
  std::string text = readme_head(design, set);
  text += fmt::format(
      "\nTasks\n"
      "- identification: pegged stick, {} s, at the begin of each session\n"
      "- freestick: the same with the stick free, where a condition needs it\n"
      "- practice: tracking on a standing platform, where the experiment has it\n"
      "- tracking: the measured trials, {} s each\n\n"
      "Files\n"
      "- *_motion.tsv: 1 kHz, one row a tick of the sample clock, no header. *_channels.tsv names\n"
      "  the columns and their units. A lost sample is n/a. The run index is the number of the\n"
      "  trial in its session.\n"
      "- *_events.tsv: the condition of the run.\n"
      "- *_beh.tsv: one row a trial with its results; the JSON file of the same task at the top\n"
      "  has meaning and unit of each column.\n"
      "- participants.tsv: codes. Names, ages, times of day, notes and reasons are not in here.\n"
      "- sourcedata/experiment.yaml: the pre-registration, SHA-256 {}.\n"
      "- SHA256SUMS: checksums of all other files; `sha256sum --check SHA256SUMS`.\n\n"
      "Licence: {}\n\n"
      "Format: Brain Imaging Data Structure {}; motion data as in Jeung et al., Motion-BIDS,\n"
      "Scientific Data 11, 716 (2024). Made by stillhand {}.\n",
      design.identify_s, design.trial_s, folder.digest(), release.licence, kBidsVersion, kVersion);
  return text;
}

std::string changes(const DataSet& set) {
  return fmt::format("1.0.0 {}\n  - First version, after unblinding.\n", set.released);
}

std::string participants_json() {
  ordered_json json;
  json["participant_id"] = column("Code of the participant");
  json["excluded"] = levels("The experimenter excluded the participant",
                            {{"yes", "the data do not count"}, {"no", "the data count"}});
  json["sessions"] = column("Number of recorded sessions");
  json["trials"] = column("Number of completed tracking trials, without practice");
  json["order"] = column("Conditions of the completed tracking trials in their order");
  json["simulated"] = levels("Whether a person took part",
                             {{"yes", "a simulated subject, no person"}, {"no", "a person"}});
  return text_of(json);
}

std::string trials_json(TrialKind kind) {
  ordered_json json{{"TaskName", name_of(kind)}, {"TaskDescription", task_description(kind)}};
  json["run"] = column("Number of the trial in its session, the run index of its motion file");
  add_trial_columns(json);
  return text_of(json);
}

std::string answers_json(const Design& design) {
  ordered_json json{{"TaskName", "questions"}};
  json["block"] = column("Block after which the question was asked; 0: before the first");
  ordered_json question{{"Description", "Name of the question"}, {"Levels", {}}};
  for (const Question& each : design.questions) {
    question["Levels"][each.name] =
        fmt::format("{} (1: {}, {}: {})", each.text, each.lowest, each.steps, each.highest);
  }
  json["question"] = question;
  json["answer"] = column("Answer on the scale of the question, a whole number from 1");
  return text_of(json);
}

std::string events_json() {
  ordered_json json;
  json["onset"] = column("Begin, from the first sample of the motion file", "s");
  json["duration"] = column("Length until the end of the trial", "s");
  json["trial_type"] = condition_levels();
  return text_of(json);
}

std::string columns_json(const Design& design) {
  ordered_json json;
  json["participants"]["participant"] = column("Code of the participant");
  json["participants"]["excluded"] = column("1: the experimenter excluded the participant");
  json["participants"]["sessions"] = column("Number of recorded sessions");
  json["participants"]["simulated"] = column("1: a simulated subject, no person");
  ordered_json& trials = json["trials"];
  trials["participant"] = column("Code of the participant");
  trials["session"] = column("Number of the session of the participant");
  trials["trial"] = column("Number of the trial in its session");
  trials["task"] =
      levels("Task of the trial", {{"identification", task_description(TrialKind::kIdentification)},
                                   {"freestick", task_description(TrialKind::kFreeIdentification)},
                                   {"practice", task_description(TrialKind::kPractice)},
                                   {"tracking", task_description(TrialKind::kTracking)}});
  add_trial_columns(trials);
  trials["completed"] = column("1: the trial ran to its end; 0: it was ended early");
  if (!design.questions.empty()) {
    json["answers"] = ordered_json::parse(answers_json(design));
    json["answers"].erase("TaskName");
  }
  ordered_json& samples = json["samples"];
  samples["t"] =
      column("Time from the first sample of the trial; a lost sample is a missing row", "s");
  for (const MotionChannel& channel : kChannels) {
    samples[channel.name] = column(channel.description);
  }
  return text_of(json);
}

std::string tables_readme(const Folder& folder, const DataSet& set, const Release& release) {
  std::string text = readme_head(folder.design(), set);
  text += fmt::format(
      "\nTables\n"
      "- participants: codes. Names, ages, times of day, notes and reasons are not in here.\n"
      "- trials: one row a trial with its results. answers: where questions were answered.\n"
      "- P07_session_01_trial_02: the samples of one trial, 1 kHz.\n"
      "columns.json has the meaning of each column; units are in the tables. experiment.yaml is\n"
      "the pre-registration, SHA-256 {}. SHA256SUMS has the checksums of all other files.\n\n"
      "Licence: {}\n",
      folder.digest(), release.licence);
  if (!release.authors.empty()) {
    text += fmt::format("Authors: {}\n", fmt::join(release.authors, ", "));
  }
  return text + fmt::format("Made by stillhand {}.\n", kVersion);
}

std::string motion_json(const Design& design, const ExportedTrial& trial,
                        const recording::Recording& rows) {
  ordered_json json{{"TaskName", name_of(trial.kind)},
                    {"TaskDescription", task_description(trial.kind)}};
  std::string instructions;
  for (const std::string& line : design.instructions) {
    instructions += (instructions.empty() ? "" : " ") + line;
  }
  if (!instructions.empty()) json["Instructions"] = instructions;
  json["TrackingSystemName"] = "rig";
  json["SamplingFrequency"] = rows.rate_hz;
  json["RecordingDuration"] = static_cast<double>(rows.row_count()) / rows.rate_hz;
  json["MissingValues"] = "n/a";
  json["SoftwareVersions"] = std::string("stillhand ") + kVersion;
  json["MotionChannelCount"] = rows.columns.size();
  std::map<std::string, int> counts;
  std::set<std::string> points;
  for (const recording::Column& each : rows.columns) {
    ++counts[channel_of(each.name).type];
    points.insert(channel_of(each.name).tracked_point);
  }
  for (const auto& [type, count] : counts) json[type + "ChannelCount"] = count;
  json["TrackedPointsCount"] = points.size();
  return text_of(json);
}

std::string channels_tsv(const recording::Recording& rows) {
  std::string text =
      "name\tcomponent\ttype\ttracked_point\tunits\tsampling_frequency\tdescription\n";
  for (const recording::Column& each : rows.columns) {
    const MotionChannel& channel = channel_of(each.name);
    text +=
        fmt::format("{}\t{}\t{}\t{}\t{}\t{}\t{}\n", channel.name, channel.component, channel.type,
                    channel.tracked_point, each.unit, rows.rate_hz, channel.description);
  }
  return text;
}

}  // namespace stillhand::experiment
