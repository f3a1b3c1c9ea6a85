// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

/// Command lines, by CLI11.  Its headers cost 4.8 s of a processor in each file that includes them;
/// command_line.cpp and the help of `stillhand` alone do.
///
/// A method does what CLI11's of the same name does.  Command and Option are handles: copies mean
/// the same option, and live no longer than the Program.
namespace stillhand::command_line {

/// A command line that is wrong (status 2), or that asks for --help or --version (status 0).
class UsageError : public std::runtime_error {
 public:
  UsageError(const std::string& what, int status, std::string text);

  [[nodiscard]] int status() const noexcept { return status_; }
  /// Prints the answer on standard output, or what is wrong on standard error.  @return status()
  int print() const;

 private:
  int status_;
  std::string text_;
};

class Option {
 public:
  explicit Option(CLI::Option* option) noexcept : option_(option) {}

  Option required();
  Option excludes(const Option& other);
  Option excludes(const std::string& name);
  Option needs(const Option& other);
  Option needs(const std::string& name);

  /// What a word must be.  A check returns an error text, or an empty text for a good word.
  Option check(const std::function<std::string(const std::string&)>& check);
  Option between(int least, int most);
  Option one_of(const std::vector<std::string>& words);
  Option existing_file();

  /// May be given several times, with one value each.
  Option repeatable();
  /// May be given several times, with several values each.
  Option takes_all();
  Option expected(int least_values, int most_values);
  Option delimiter(char between_values);
  Option envname(const std::string& name);

  /// What --help shows: the default, the kind of value, the title of the list that it is in.
  Option default_str(const std::string& text);
  Option capture_default_str();
  Option type_name(const std::string& text);
  Option group(const std::string& title);

 private:
  CLI::Option* option_;
};

/// A program or a verb of it.
class Command {
 public:
  explicit Command(CLI::App* app) noexcept : app_(app) {}

  /// Parsing sets `value`.  A type that no option has yet needs a line at the end of the .cpp.
  template <typename T>
  Option add_option(const std::string& name, T& value, const std::string& help);
  /// Parsing calls `take`.
  template <typename T>
  Option add_option_function(const std::string& name, const std::function<void(const T&)>& take,
                             const std::string& help);
  Option add_flag(const std::string& name, bool& value, const std::string& help);
  Option add_flag_callback(const std::string& name, const std::function<void()>& call,
                           const std::string& help);

  Command add_subcommand(const std::string& name, const std::string& help);
  /// Exactly one.
  void require_subcommand();
  /// Parsing calls it at the end, if this command was given.
  void callback(const std::function<void()>& call);
  void description(const std::string& text);
  /// Lists options under a title of their own in --help.
  void group(const char* title, std::initializer_list<const char*> names);

  [[nodiscard]] Option get_option(const std::string& name) const;
  [[nodiscard]] std::vector<std::string> option_names() const;
  /// How often the option was given.
  [[nodiscard]] std::size_t count(const std::string& name) const;
  [[nodiscard]] std::string help() const;
  [[nodiscard]] CLI::App& app() const noexcept { return *app_; }

 private:
  CLI::App* app_;
};

class Program : public Command {
 public:
  explicit Program(const std::string& description = "");
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void name(const std::string& name);
  void version(const std::string& text);
  /// Of the options added from here on the last word counts, and --help shows the default.
  void last_word_counts();

  /// Of main().  @return the exit status, if the program ends here: its help is printed, or what is
  /// wrong
  [[nodiscard]] std::optional<int> parse(int argc, char** argv);
  /// @param words  without the program.  @throws UsageError
  void parse(std::vector<std::string> words);

 private:
  explicit Program(std::unique_ptr<CLI::App> owned);
  std::unique_ptr<CLI::App> owned_;
};

}  // namespace stillhand::command_line
