// SPDX-License-Identifier: Apache-2.0
#include "apps/stillhand/help.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "services/files/settings/nearest.hpp"

namespace stillhand {
namespace {

constexpr std::size_t kColumns = 100;
constexpr std::size_t kIndent = 28;
constexpr std::size_t kOnOnePage = 20;  // options
constexpr const char* kFirstGroup = "Options";

struct Line {
  std::string_view verb, does;
};
struct Door {
  std::string_view title;
  std::vector<Line> lines;
};

const std::vector<Door>& overview() {
  static const std::vector<Door> doors{
      {"A recording of yours: CSV, MATLAB, HDF5, ROS 2, sound",
       {{"identify", "fit the paper's model, and see how well it predicts"},
        {"diagnose", "find what the model lacks, with the error before and after"},
        {"plan-run", "plan the run that settles a tie of causes"},
        {"predict", "put that model to the test on another recording"}}},
      {"A laboratory: stick, motor, platform, or their simulation",
       {{"lab", "run a whole session: identify, run the conditions, compute the results"},
        {"calibrate", "find the scales and signs of real devices"},
        {"dashboard", "watch a session or a recording in a browser"},
        {"ros2-bridge", "publish a running session for ROS 2"},
        {"stop", "stop every session of this machine at once"},
        {"deploy", "write and check the files of a lab of several machines"}}},
      {"An experiment with people",
       {{"experiment", "conduct one: pre-registration, journal, participants"},
        {"study", "run the paper's experiment with simulated subjects, or evaluate people"},
        {"compare", "say which condition is best, and how sure that is"},
        {"vehicle", "map where hand and vehicle are stable together"}}},
      {"A better model in the canceller",
       {{"close-the-loop", "diagnose, add what the model lacks, run again"},
        {"control-model", "convert a diagnosed model for the motor"}}},
      {"Recordings of sessions",
       {{"info", "say what is in a recording"},
        {"misses", "say who was late, and what the motor force did"},
        {"verify", "look for damage and gaps"},
        {"recover", "copy what a damaged recording still holds"},
        {"export", "write its topics as CSV, MATLAB, HDF5 or ROS 2"},
        {"record", "record a running bus"},
        {"replay", "play it on the bus, with its own timing"}}}};
  return doors;
}

// One paragraph, with lines of at most `room` columns.
std::string wrapped(const std::string& text, std::size_t room) {
  std::istringstream words(text);
  std::ostringstream out;
  std::size_t column = 0;
  for (std::string word; words >> word; column += word.size()) {
    const bool fits = column + 1 + word.size() <= room;
    if (column > 0) out << (fits ? ' ' : '\n');
    column = column > 0 && fits ? column + 1 : 0;
    out << word;
  }
  return out.str();
}

std::size_t count_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return !option->get_group().empty(); })
      .size();
}

class Help final : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    if (app->get_parent() != nullptr) return help_of_verb(app, std::move(name), mode);
    std::ostringstream out;
    out << app->get_description() << "\nUsage: stillhand VERB [OPTIONS]\n\nSubcommands:\n";
    for (const Door& door : overview()) {
      out << door.title << '\n';
      for (const Line& line : door.lines) {
        CLI::detail::format_help(out, std::string(line.verb), std::string(line.does), 18);
      }
    }
    out << "\n`stillhand help VERB` explains a verb; `stillhand --version` prints the version.\n";
    return out.str();
  }

  std::string make_option(const CLI::Option* option, bool positional) const override {
    std::ostringstream out;
    CLI::detail::format_help(out, make_option_name(option, positional) + make_option_opts(option),
                             wrapped(make_option_desc(option), kColumns - kIndent), kIndent);
    return out.str();
  }

  // "--unblinded{false}" is a flag that may be taken back, which needs no word.
  std::string make_option_name(const CLI::Option* option, bool positional) const override {
    std::string name = Formatter::make_option_name(option, positional);
    for (auto brace = name.find('{'); brace != std::string::npos; brace = name.find('{')) {
      name.erase(brace, name.find('}', brace) + 1 - brace);
    }
    return name;
  }

  // The words of a choice, or the type; then "=4", "(1 to 12)", "(required)", "(with --live)".
  // What options exclude each other is said when somebody tries.
  std::string make_option_opts(const CLI::Option* option) const override {
    if (!option->get_option_text().empty()) return " " + option->get_option_text();
    const std::string type = option->get_type_name();  // "INT:INT in [1 - 12]", "TEXT:{auto,arx}"
    if (type.empty()) return behind(*option);
    const auto colon = std::min(type.find(':'), type.size());
    const std::string check = type.substr(std::min(colon + 1, type.size()));
    std::string text = " " + (check.starts_with("{") ? check : type.substr(0, colon));
    if (option->get_expected_max() > 1) text += " ...";
    const std::string& usual = option->get_default_str();
    if (!usual.empty() && usual != "[]") text += "=" + usual;  // []: a list, empty
    if (const auto in = check.find(" in ["); in != std::string::npos) {
      std::string bounds = check.substr(in + 5, check.find(']', in) - in - 5);
      if (const auto dash = bounds.find(" - "); dash != std::string::npos) {
        bounds.replace(dash, 3, " to ");
      }
      text += " (" + bounds + ")";
    }
    return text + behind(*option);
  }

 private:
  static std::string behind(const CLI::Option& option) {
    std::string with;
    for (const CLI::Option* each : option.get_needs()) with += " " + each->get_name();
    return (option.get_required() ? " (required)" : "") +
           (with.empty() ? "" : " (with" + with + ")");
  }

  [[nodiscard]] std::string help_of_verb(const CLI::App* app, std::string name,
                                         CLI::AppFormatMode mode) const {
    if (mode != CLI::AppFormatMode::Normal || count_of(*app) <= kOnOnePage) {
      return Formatter::make_help(app, std::move(name), mode);
    }
    std::string more;
    for (const std::string& group : app->get_groups()) {
      if (group.empty() || group == kFirstGroup) continue;
      more += (more.empty() ? "" : ", ") + group;
    }
    const auto first = app->get_options([](const CLI::Option* option) {
      return option->get_group() == kFirstGroup && option->nonpositional();
    });
    std::ostringstream out;
    out << make_description(app) << make_usage(app, std::move(name)) << make_positionals(app)
        << make_group(kFirstGroup, false, first) << '\n';
    if (!more.empty()) {
      out << wrapped("More with `stillhand " + app->get_name() + " --help-all`: " + more + ".",
                     kColumns)
          << '\n';
    }
    return out.str();
  }
};

bool is_known(std::string_view verb) {
  return std::ranges::any_of(overview(), [&](const Door& door) {
    return std::ranges::any_of(door.lines, [&](const Line& line) { return line.verb == verb; });
  });
}

void set(CLI::App& app, const std::shared_ptr<Help>& help) {
  app.formatter(help);
  app.set_help_all_flag("--help-all", "every option")->group("");
  for (CLI::App* verb : app.get_subcommands({})) set(*verb, help);
}

}  // namespace

void add_help(command_line::Program& cli) {
  const auto help = std::make_shared<Help>();
  help->column_width(kIndent);
  set(cli.app(), help);
  for (const CLI::App* verb : cli.app().get_subcommands({})) {
    if (!is_known(verb->get_name())) throw std::logic_error("no overview of " + verb->get_name());
  }
}

std::vector<std::string> without_help_verb(std::vector<std::string> words) {
  if (words.empty() || words.front() != "help") return words;
  words.erase(words.begin());
  words.emplace_back("--help");
  return words;
}

std::string misspelt_verb(const std::vector<std::string>& words) {
  if (words.empty() || words.front().starts_with("-")) return "";
  std::vector<std::string_view> verbs;
  for (const Door& door : overview()) {
    for (const Line& line : door.lines) verbs.push_back(line.verb);
  }
  if (std::ranges::find(verbs, words.front()) != verbs.end()) return "";
  return "got " + words.front() + ", want a verb: " + settings::suggestion(words.front(), verbs) +
         "; `stillhand help` explains each";
}

std::string usage_error(const command_line::Program& cli, const std::string& what) {
  const CLI::App* verb = &cli.app();
  std::string name = "stillhand";
  while (!verb->get_subcommands().empty()) {
    verb = verb->get_subcommands().front();
    name += " " + verb->get_name();
  }
  const std::vector<std::string> words = cli.app().remaining(true);
  const auto own = verb->get_subcommands({});
  const auto word = std::ranges::find_if(
      words, [&](const std::string& each) { return !own.empty() || each.starts_with("--"); });
  if (word == words.end()) {
    return name + ": " + what + "; see `stillhand help" + name.substr(name.find(' ')) + "`";
  }
  std::vector<std::string> names;
  for (const CLI::App* each : own) names.push_back(each->get_name());
  for (const CLI::Option* option : verb->get_options()) {
    for (const std::string& each : option->get_lnames()) names.push_back("--" + each);
  }
  const std::vector<std::string_view> candidates(names.begin(), names.end());
  return name + ": got " + *word + ", want \"" + settings::nearest(*word, candidates) +
         "\" perhaps; `" + name + " --help-all` lists what there is";
}

}  // namespace stillhand
