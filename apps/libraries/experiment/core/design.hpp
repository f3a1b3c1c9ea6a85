// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/libraries/experiment/core/counterbalance.hpp"
#include "apps/libraries/session/core/conditions.hpp"
#include "services/core/contract/config_field.hpp"

namespace stillhand::experiment {

/// Number of the rig of every session: that of `stillhand lab` without --rig, for which
/// `stillhand close-the-loop` writes a model.
inline constexpr std::uint32_t kRig = 1;

/// Conditions that a session over the bus can run.  D to F need the command filter, another stick
/// or another rest of the arm, which run in one process alone (`stillhand study`).
std::string live_conditions();

/// `control_model` of an experiment whose C+ is diagnosed in each session, from its identification.
inline constexpr const char* kDiagnosed = "diagnosed";

/// Trials before the measured ones, in a condition that the participant may know.
struct Practice {
  double trial_s = 60.0;
  std::int64_t most_trials = 0;
  double dwell_ratio = 0.35;
  std::int64_t in_a_row = 1;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("trial_s", self.trial_s, Range{5.0, 3600.0}, "[s] measured length of a practice trial");
    visit("most_trials", self.most_trials, Range{0.0, 50.0},
          "[-] most practice trials, if the criterion is not met; the platform stands; 0: none");
    visit("dwell_ratio", self.dwell_ratio, Range{0.0, 1.0},
          "[-] criterion: a practice trial with this dwell ratio or more");
    visit("in_a_row", self.in_a_row, Range{1.0, 10.0}, "[-] such trials in a row");
  }
};

/// When a participant's data do not count; the analysis applies these rules and reports the results
/// with and without them.
struct Exclusion {
  double least_completed_share = 1.0;
  double most_lost_tick_share = 0.02;
  double least_dwell_ratio_a = 0.0;
  double most_rms_deviations = 0.0;
  std::int64_t most_broken_trials = 100;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("least_completed_share", self.least_completed_share, Range{0.0, 1.0},
          "[-] share of the planned trials; who completed less is excluded");
    visit("most_lost_tick_share", self.most_lost_tick_share, Range{0.0, 1.0},
          "[-] lost share of a trial's ticks; more exclude the trial");
    visit("least_dwell_ratio_a", self.least_dwell_ratio_a, Range{0.0, 1.0},
          "[-] mean dwell ratio in condition A; less excludes the participant");
    visit("most_rms_deviations", self.most_rms_deviations, Range{0.0, 10.0},
          "[-] standard deviations of the RMS error of a condition from its mean over the "
          "participants; more exclude the participant; 0: no such rule");
    visit("most_broken_trials", self.most_broken_trials, Range{0.0, 100.0},
          "[-] tracking trials that were ended early; more exclude the participant");
  }
};

/// Bounds of what the tracking screen shows, which its topic keeps too.
inline constexpr std::size_t kMostInstructions = 8;  ///< [-] lines
inline constexpr std::size_t kMostLine = 100;        ///< [bytes] a line or a question
inline constexpr std::size_t kMostWord = 40;         ///< [bytes] a word at the end of a scale

/// A question that the tracking screen asks; the answer is a whole number.
struct Question {
  enum class After : std::uint8_t { kPractice, kTrial, kBlock, kEnd };

  std::string name;  ///< in the journal: letters, digits, _
  After after = After::kBlock;
  std::string text;             ///< at most 100 bytes of UTF-8
  std::string lowest, highest;  ///< words at the ends of the scale
  std::int64_t steps = 7;       ///< answers are 1 to this number, 2 to 9
};

/// One experiment: the content of experiment.yaml.
struct Design {
  std::string title = "Cancelling biodynamic feedthrough";
  std::int64_t participants = 12;
  std::vector<std::string> conditions{"A", "B", "C"};
  Order order = Order::kWilliams;
  std::int64_t blocks = 1;
  std::int64_t trials = 1;
  double trial_s = 180.0;
  double identify_s = 120.0;
  double rest_s = 20.0;
  double break_s = 120.0;
  std::int64_t motion_seed = 1;
  std::int64_t target_seed = 1;
  bool same_motion_for_all = false;
  bool same_target_for_all = false;
  std::string who = "simulated";
  std::int64_t subject_seed = 1;
  std::string control_model;
  std::vector<std::string> instructions;
  Practice practice;
  std::vector<Question> questions;
  Exclusion exclusion;
  std::vector<std::string> comparisons{"A-B", "B-C"};
  double alpha = 0.05;
  std::string assignment;  ///< SHA-256 of the sealed assignment of labels and orders

  /// File of the model of condition C+, inside the folder; empty: there is none.
  [[nodiscard]] std::string model_file() const {
    return control_model == kDiagnosed ? std::string() : control_model;
  }

  /// The plain fields; lists are read and written by experiment_file.
  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("title", self.title, Range{1.0, 200.0}, "title of the experiment");
    visit("participants", self.participants, Range{1.0, 999.0}, "[-] planned participants");
    visit("blocks", self.blocks, Range{1.0, 50.0}, "[-] blocks, with a break between two");
    visit("trials", self.trials, Range{1.0, 20.0}, "[-] trials of each condition in a block");
    visit("trial_s", self.trial_s, Range{5.0, 3600.0},
          "[s] measured length of a trial; paper III-C (180)");
    visit("identify_s", self.identify_s, Range{5.0, 3600.0},
          "[s] pegged trial at the begin of each session; paper III-A (120)");
    visit("rest_s", self.rest_s, Range{0.0, 3600.0}, "[s] shortest rest before a trial");
    visit("break_s", self.break_s, Range{0.0, 36000.0}, "[s] break between two blocks");
    visit("motion_seed", self.motion_seed, Range{0.0, 4294967295.0},
          "[-] seed of the platform motion");
    visit("target_seed", self.target_seed, Range{0.0, 4294967295.0}, "[-] seed of the target");
    visit("same_motion_for_all", self.same_motion_for_all, Range{0.0, 1.0},
          "[-] participants share the motion of each trial; false: each has its own");
    visit("same_target_for_all", self.same_target_for_all, Range{0.0, 1.0},
          "[-] participants share the target of each trial; false: each has its own");
    visit("operator", self.who, Range{1.0, 20.0},
          "who tracks: simulated, mouse or gamepad (`run --gamepad` names its device)");
    visit("subject_seed", self.subject_seed, Range{0.0, 4294967295.0},
          "[-] of the simulated subjects: participant N is subject N of this seed");
    visit("control_model", self.control_model, Range{0.0, 1000.0},
          "model of condition C+: a file inside this folder, or diagnosed: each session's own, in "
          "the pause behind its identification; empty: none");
    visit.group("practice", self.practice);
    visit.group("exclusion", self.exclusion);
    visit("alpha", self.alpha, Range{1e-6, 0.5}, "[-] level of the planned comparisons");
    visit("assignment", self.assignment, Range{0.0, 64.0},
          "SHA-256 of the file with labels and orders; written by `experiment new`");
  }
};

/// Of a checked design's name.
session::Condition condition_of(const std::string& name);
/// Whether a condition is one of `stillhand lab`'s mitigations.
bool is_mitigation(const std::string& condition);

/// The two conditions of a planned comparison, "B-signal".  @return nothing: not two of them
std::optional<std::pair<std::string, std::string>> compared_by(
    const std::string& text, const std::vector<std::string>& conditions);

/// Refuses what no session can run or no analysis can use.
/// @throws ConfigError naming the key
void check(const Design& design);

/// "random", "latin", "williams".  @throws ConfigError for another word
Order order_named(const std::string& word);
const char* name_of(Order order);
/// "practice", "trial", "block", "end".  @throws ConfigError for another word
Question::After after_named(const std::string& word);
const char* name_of(Question::After after);

/// "P07" of 6: the code of a participant, counted from 0.
std::string participant_code(std::size_t index);
/// 6 of "P07".  @throws ConfigError for anything else, and for a number beyond `participants`
std::size_t participant_index(const std::string& code, std::int64_t participants);

}  // namespace stillhand::experiment
