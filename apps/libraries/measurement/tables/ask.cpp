// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/ask.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <istream>
#include <ostream>
#include <string_view>

#include "apps/libraries/measurement/tables/guess.hpp"
#include "apps/libraries/measurement/tables/suggestion.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::measurement {
namespace {

constexpr std::size_t kShownColumns = 200;

struct Question {
  const char* name;
  const char* text;
};
constexpr std::array<Question, 3> kQuestions{
    {{"t", "time"}, {"a_y", "acceleration that shakes the hand"}, {"f", "force at the hand"}}};

// One dialogue.
class Dialogue {
 public:
  Dialogue(TableFile& file, std::istream& in, std::ostream& out)
      : head_(file.head()), in_(in), out_(out), proposal_(suggestion(file)) {}

  Mapping run() {
    show_columns();
    for (const Question& question : kQuestions) {
      if (std::string_view(question.name) == "t" && (head_.has_times || head_.rate_hz > 0.0))
        continue;
      ask_channel(question);
    }
    while (ask_further()) {
    }
    const bool timed =
        std::ranges::find(mapping_.columns, "t", &ColumnWish::name) != mapping_.columns.end();
    if (!timed && !head_.has_times && head_.rate_hz <= 0.0) ask_rate();
    return std::move(mapping_);
  }

 private:
  void show_columns() {
    out_ << "Columns of " << head_.path << " (" << head_.form << "):\n";
    for (std::size_t i = 0; i < std::min(head_.columns.size(), kShownColumns); ++i) {
      out_ << fmt::format("  #{:<3} {}\n", i + 1, in_one_line(head_.columns[i].title));
    }
    out_ << "Answer with a title or a #number, and with the unit where the title has none: "
            "acc [m/s^2].\nEnter takes the answer in parentheses, - leaves the channel out.\n";
  }

  std::string answer(const std::string& question) {
    out_ << question << ": " << std::flush;
    std::string line;
    if (!std::getline(in_, line)) {
      throw ConfigError("--map-file", "no answer to '" + question + "'", "an answer, or --map");
    }
    while (!line.empty() && (line.back() == ' ' || line.back() == '\r')) line.pop_back();
    while (!line.empty() && line.front() == ' ') line.erase(0, 1);
    return line;
  }

  // A column "a" is not the one that "acc" asks for.
  static bool ends_at(const std::string& text, std::size_t place) {
    return place == text.size() || std::string_view(" [*/").find(text[place]) != std::string::npos;
  }

  // "acc [g] * 2": the longest title or #number in front, then what belongs to the channel.
  std::optional<ColumnWish> wish_of(const std::string& text, const std::string& name) {
    std::size_t longest = 0;
    std::string reference;
    for (std::size_t i = 0; i < head_.columns.size(); ++i) {
      const ColumnHead& column = head_.columns[i];
      for (const std::string& word : {column.title, column.name, "#" + std::to_string(i + 1)}) {
        if (word.size() > longest && text.starts_with(word) && ends_at(text, word.size())) {
          longest = word.size();
          reference = reference_to(head_, i);
        }
      }
    }
    if (longest == 0) {
      out_ << "  there is no column '" << in_one_line(text) << "'\n";
      return std::nullopt;
    }
    try {
      return parse_wish(reference + "=" + name + text.substr(longest));
    } catch (const ConfigError& error) {
      out_ << "  " << error.what() << "\n";
      return std::nullopt;
    }
  }

  void ask_channel(const Question& question) {
    const auto proposed = std::ranges::find(proposal_.columns, question.name, &ColumnWish::name);
    std::string proposal = "-";
    if (proposed != proposal_.columns.end()) {
      proposal = proposed->from + (proposed->unit.empty() ? "" : " [" + proposed->unit + "]");
    }
    for (;;) {
      std::string text =
          answer(fmt::format("{}, {} ({})", question.name, question.text, in_one_line(proposal)));
      if (text == "-" || (text.empty() && proposal == "-")) return;
      if (text.empty()) {
        mapping_.columns.push_back(*proposed);
        return;
      }
      if (auto wish = wish_of(text, question.name)) {
        mapping_.columns.push_back(std::move(*wish));
        return;
      }
    }
  }

  // @returns false when there is no further channel
  bool ask_further() {
    const std::string text = answer("another channel, as NAME=COLUMN [UNIT] (none)");
    if (text.empty() || text == "-") return false;
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) {
      out_ << "  NAME=COLUMN [UNIT], for example theta=angle [rad]\n";
      return true;
    }
    const std::size_t first = text.find_first_not_of(' ', equals + 1);
    if (first == std::string::npos) return true;
    if (auto wish = wish_of(text.substr(first), text.substr(0, equals))) {
      mapping_.columns.push_back(std::move(*wish));
    }
    return true;
  }

  void ask_rate() {
    for (;;) {
      const std::string text = answer("sample rate [Hz]");
      double rate_hz = 0.0;
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), rate_hz);
      if (error != std::errc() || end != text.data() + text.size()) rate_hz = 0.0;
      try {
        mapping_.rate_hz = check_rate_hz(rate_hz, "rate");
        return;
      } catch (const ConfigError&) {
        out_ << "  a number, for example 1000\n";
      }
    }
  }

  const TableHead& head_;
  std::istream& in_;
  std::ostream& out_;
  Mapping proposal_;
  Mapping mapping_;
};

}  // namespace

Mapping ask_mapping(TableFile& file, std::istream& in, std::ostream& out) {
  return Dialogue(file, in, out).run();
}

}  // namespace stillhand::measurement
