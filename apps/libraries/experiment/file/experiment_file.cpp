// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/experiment/file/experiment_file.hpp"

#include <fmt/format.h>

#include "apps/libraries/report/command_line.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/files/settings/load.hpp"
#include "services/files/settings/placed_error.hpp"
#include "services/files/settings/yaml_text.hpp"

namespace stillhand::experiment {
namespace {

using Section = settings::Entry;

// Each field with its meaning above it.
class CommentedYaml {
 public:
  explicit CommentedYaml(std::string indent = {}) : indent_(std::move(indent)) {}

  template <typename Value>
  void operator()(std::string_view name, const Value& value, Range range, std::string_view doc) {
    settings::YamlWriter line(indent_);
    line(name, value, range, doc);
    text_ += fmt::format("{}# {}\n{}", indent_, doc, line.text());
  }
  template <typename Group>
  void group(std::string_view name, const Group& fields) {
    CommentedYaml inner(indent_ + "  ");
    Group::fields(inner, fields);
    text_ += fmt::format("{}{}:\n{}", indent_, name, inner.text_);
  }
  [[nodiscard]] const std::string& text() const noexcept { return text_; }

 private:
  std::string indent_;
  std::string text_;
};

// One word of a list, in quotes.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

std::string list_of(const std::vector<std::string>& words) {
  std::vector<std::string> all;
  all.reserve(words.size());
  for (const std::string& word : words) all.push_back(quoted(word));
  return fmt::format("[{}]", fmt::join(all, ", "));
}

std::vector<std::string> words_of(const Section& entry) {
  if (entry.kind != Section::Kind::kSequence) {
    throw ConfigError(entry.place + ": " + entry.key, settings::got_of(entry), "a list [...]");
  }
  std::vector<std::string> words;
  for (const Section& child : entry.children) {
    if (child.kind != Section::Kind::kScalar) {
      throw ConfigError(child.place + ": " + entry.key, settings::got_of(child), "a word");
    }
    words.push_back(child.text);
  }
  return words;
}

// The fields of a question as a section of settings.
struct QuestionFields {
  Question question;
  std::string after = "block";

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("name", self.question.name, Range{1.0, 40.0}, "in the journal");
    visit("after", self.after, Range{1.0, 10.0}, "practice, trial, block or end");
    visit("text", self.question.text, Range{1.0, 100.0}, "as the screen shows it");
    visit("lowest", self.question.lowest, Range{0.0, 40.0}, "words for 1");
    visit("highest", self.question.highest, Range{0.0, 40.0}, "words for the largest answer");
    visit("steps", self.question.steps, Range{2.0, 9.0}, "[-] answers are 1 to this number");
  }
};

std::vector<Question> questions_of(const Section& entry) {
  if (entry.kind != Section::Kind::kSequence) {
    throw ConfigError(entry.place + ": questions", settings::got_of(entry), "a list");
  }
  std::vector<Question> questions;
  for (const Section& child : entry.children) {
    auto fields = settings::load_section<QuestionFields>(child, "questions");
    fields.question.after = after_named(fields.after);
    questions.push_back(fields.question);
  }
  return questions;
}

std::string yaml_of(const std::vector<Question>& questions) {
  if (questions.empty()) return " []\n";
  std::string text = "\n";
  for (const Question& question : questions) {
    std::string lines = settings::yaml_text(QuestionFields{question, name_of(question.after)});
    lines.pop_back();
    for (std::size_t at = lines.find('\n'); at != std::string::npos;
         at = lines.find('\n', at + 1)) {
      lines.replace(at, 1, "\n    ");
    }
    text += "  - " + lines + "\n";
  }
  return text;
}

}  // namespace

std::string command_for(std::string_view verb, const std::filesystem::path& folder) {
  return fmt::format("stillhand experiment {} {}{}", verb, report::quoted_for_shell(folder),
                     verb == "unblind" ? " --reason TEXT" : "");
}

std::string registered_text(const std::filesystem::path& folder) {
  std::string text = recording::read_file((folder / kDesignFile).string());
  std::erase(text, '\r');
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  return text;
}

std::string yaml_of(const Design& design) {
  CommentedYaml plain;
  Design::fields(plain, design);
  std::string text =
      "# An experiment of Stillhand. This file is the pre-registration: change it before the "
      "first\n"
      "# participant, and not after. `stillhand experiment` notices a change by its SHA-256.\n";
  text += plain.text();
  text += fmt::format("# {}\nconditions: {}\n", live_conditions(), list_of(design.conditions));
  text += fmt::format("# order of the conditions: random, latin or williams\norder: {}\n",
                      name_of(design.order));
  text += fmt::format("# lines on the tracking screen before the first trial\ninstructions: {}\n",
                      list_of(design.instructions));
  text += "# name, after (practice, trial, block, end), text, lowest, highest, steps of each\n";
  text += "questions:" + yaml_of(design.questions);
  text += fmt::format("# planned comparisons, at level alpha\ncomparisons: {}\n",
                      list_of(design.comparisons));
  return text;
}

Design design_of(const std::string& yaml, const std::string& origin) {
  const Section root = settings::parse_text(yaml, origin);
  Design design;
  settings::SectionReader reader(root, "experiment");
  Design::fields(reader, design);
  if (const Section* entry = reader.find("conditions")) design.conditions = words_of(*entry);
  if (const Section* entry = reader.find("order")) {
    design.order = settings::placed(entry->place, [entry] { return order_named(entry->text); });
  }
  if (const Section* entry = reader.find("instructions")) design.instructions = words_of(*entry);
  if (const Section* entry = reader.find("questions")) design.questions = questions_of(*entry);
  if (const Section* entry = reader.find("comparisons")) design.comparisons = words_of(*entry);
  reader.refuse_unknown();
  settings::placed(origin, [&design] { check(design); });
  return design;
}

}  // namespace stillhand::experiment
