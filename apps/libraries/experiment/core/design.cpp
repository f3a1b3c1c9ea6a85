// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/experiment/core/design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <set>
#include <utility>

#include "services/core/contract/config_error.hpp"

namespace stillhand::experiment {
namespace {

constexpr std::array<std::pair<const char*, Order>, 3> kOrders{
    {{"random", Order::kRandom}, {"latin", Order::kLatin}, {"williams", Order::kWilliams}}};
constexpr std::array<std::pair<const char*, Question::After>, 4> kAfters{
    {{"practice", Question::After::kPractice},
     {"trial", Question::After::kTrial},
     {"block", Question::After::kBlock},
     {"end", Question::After::kEnd}}};
bool has(const std::vector<std::string>& words, const std::string& word) {
  return std::ranges::find(words, word) != words.end();
}

void check_conditions(const Design& design) {
  if (design.conditions.empty()) throw ConfigError("conditions", "nothing", "[A, B, C]");
  for (const std::string& word : design.conditions) {
    const auto condition = session::condition_named(word);
    if (!condition || session::row_of(*condition).where == 0 || word != name_of(*condition)) {
      throw ConfigError("conditions", "\"" + word + "\"", live_conditions());
    }
    if ((session::row_of(*condition).where & session::kExperimentConditions) == 0) {
      throw ConfigError("conditions", word,
                        fmt::format("{}: {} {}", live_conditions(), word,
                                    *condition == session::Condition::kScheduled
                                        ? "needs two arms of each participant"
                                        : "runs in one process alone (`stillhand study`)"));
    }
    if (std::ranges::count(design.conditions, word) > 1) {
      throw ConfigError("conditions", word + " twice", "each condition once");
    }
  }
  const auto mitigation = std::ranges::find_if(design.conditions, is_mitigation);
  if (mitigation != design.conditions.end() &&
      (has(design.conditions, "C'") || has(design.conditions, "C+"))) {
    throw ConfigError("conditions", *mitigation + " with C' or C+",
                      "mitigations with A, B and C alone: they use the session's own model");
  }
  if (has(design.conditions, "C+") == design.control_model.empty()) {
    throw ConfigError("control_model",
                      design.control_model.empty() ? "nothing" : design.control_model,
                      "a file or diagnosed with condition C+, and none without it");
  }
}

void check_comparisons(const Design& design) {
  std::set<std::set<std::string>> seen;
  for (const std::string& text : design.comparisons) {
    const auto pair = compared_by(text, design.conditions);
    if (!pair) {
      throw ConfigError("comparisons", "\"" + text + "\"",
                        "two conditions of this experiment, for example A-B");
    }
    if (!seen.insert({pair->first, pair->second}).second) {
      throw ConfigError("comparisons", "\"" + text + "\" twice",
                        "each pair once, in one order: Holm's correction counts them");
    }
  }
}

bool is_name(const std::string& text) {
  return !text.empty() && text.size() <= 40 && std::ranges::all_of(text, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
}

// A line for the tracking screen.
void check_line(const char* key, const std::string& text, std::size_t least, std::size_t most) {
  if (text.size() < least || text.size() > most) {
    throw ConfigError(key, fmt::format("{} bytes", text.size()),
                      fmt::format("{} to {} bytes of UTF-8", least, most));
  }
  if (std::ranges::any_of(text, [](char c) { return static_cast<unsigned char>(c) < ' '; })) {
    throw ConfigError(key, "a control character", "one line of text");
  }
}

void check_questions(const Design& design) {
  for (const Question& question : design.questions) {
    if (!is_name(question.name)) {
      throw ConfigError("questions.name", "\"" + question.name + "\"", "letters, digits and _");
    }
    if (std::ranges::count(design.questions, question.name, &Question::name) > 1) {
      throw ConfigError("questions.name", question.name + " twice", "each name once");
    }
    if (question.steps < 2 || question.steps > 9) {
      throw ConfigError("questions.steps", fmt::to_string(question.steps), "2 to 9");
    }
    check_line("questions.text", question.text, 1, kMostLine);
    check_line("questions.lowest", question.lowest, 0, kMostWord);
    check_line("questions.highest", question.highest, 0, kMostWord);
  }
}

template <typename Value, std::size_t N>
Value named(const std::array<std::pair<const char*, Value>, N>& list, const std::string& word,
            const char* key, const char* want) {
  for (const auto& [name, value] : list) {
    if (word == name) return value;
  }
  throw ConfigError(key, "\"" + word + "\"", want);
}

}  // namespace

std::string live_conditions() {
  std::string plain, mitigations;
  for (const session::Condition each : session::conditions_of(session::kExperimentConditions)) {
    std::string& list = is_mitigation(each) ? mitigations : plain;
    const bool last = each == session::Condition::kCPlus;  // of what is no mitigation
    list += (list.empty() ? "" : last ? " or " : ", ") + std::string(name_of(each));
  }
  return plain + "; or A, B, C and mitigations: " + mitigations;
}

session::Condition condition_of(const std::string& name) {
  return session::condition_named(name).value();
}

bool is_mitigation(const std::string& condition) {
  return session::is_mitigation(condition_of(condition));
}

// A mitigation's name may hold a dash: the one between two conditions counts.
std::optional<std::pair<std::string, std::string>> compared_by(
    const std::string& text, const std::vector<std::string>& conditions) {
  for (std::size_t dash = text.find('-'); dash != std::string::npos;
       dash = text.find('-', dash + 1)) {
    const std::string first = text.substr(0, dash);
    const std::string second = text.substr(dash + 1);
    if (first != second && has(conditions, first) && has(conditions, second)) {
      return std::pair(first, second);
    }
  }
  return std::nullopt;
}

void check(const Design& design) {
  check_conditions(design);
  check_comparisons(design);
  check_questions(design);
  if (design.who != "simulated" && design.who != "mouse" && design.who != "gamepad") {
    throw ConfigError("operator", "\"" + design.who + "\"", "simulated, mouse or gamepad");
  }
  if (design.instructions.size() > kMostInstructions) {
    throw ConfigError("instructions", fmt::format("{} lines", design.instructions.size()),
                      fmt::format("at most {} lines", kMostInstructions));
  }
  for (const std::string& line : design.instructions)
    check_line("instructions", line, 0, kMostLine);
}

Order order_named(const std::string& word) {
  return named(kOrders, word, "order", "random, latin or williams");
}

const char* name_of(Order order) { return kOrders.at(static_cast<std::size_t>(order)).first; }

Question::After after_named(const std::string& word) {
  return named(kAfters, word, "questions.after", "practice, trial, block or end");
}

const char* name_of(Question::After after) {
  return kAfters.at(static_cast<std::size_t>(after)).first;
}

std::string participant_code(std::size_t index) { return fmt::format("P{:02}", index + 1); }

std::size_t participant_index(const std::string& code, std::int64_t participants) {
  std::int64_t number = 0;
  const char* end = code.data() + code.size();
  if (code.size() >= 2 && code[0] == 'P') {
    const auto [rest, error] = std::from_chars(code.data() + 1, end, number);
    const bool whole = error == std::errc() && rest == end && number >= 1;
    const auto index = static_cast<std::size_t>(number - 1);
    if (whole && number <= participants && participant_code(index) == code) return index;
  }
  throw ConfigError("--participant", "\"" + code + "\"",
                    fmt::format("P01 to {}: a code, never a name",
                                participant_code(static_cast<std::size_t>(participants - 1))));
}

}  // namespace stillhand::experiment
