// SPDX-License-Identifier: Apache-2.0
#include "services/system/command_line/command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <sstream>
#include <utility>

namespace stillhand::command_line {
namespace {

using Text = const std::string&;
template <typename T>
using Take = std::function<void(const T&)>;

UsageError usage_error_of(const CLI::App& app, const CLI::ParseError& error) {
  std::ostringstream answer;
  std::ostringstream complaint;
  const bool asked = app.exit(error, answer, complaint) == 0;
  return {error.what(), asked ? 0 : 2, asked ? answer.str() : complaint.str()};
}

}  // namespace

UsageError::UsageError(const std::string& what, int status, std::string text)
    : std::runtime_error(what), status_(status), text_(std::move(text)) {}

int UsageError::print() const {
  (status_ == 0 ? std::cout : std::cerr) << text_ << std::flush;
  return status_;
}

Option Option::required() { return Option(option_->required()); }

Option Option::excludes(const Option& other) { return Option(option_->excludes(other.option_)); }

Option Option::excludes(const std::string& name) { return Option(option_->excludes(name)); }

Option Option::needs(const Option& other) { return Option(option_->needs(other.option_)); }

Option Option::needs(const std::string& name) { return Option(option_->needs(name)); }

Option Option::check(const std::function<std::string(const std::string&)>& check) {
  return Option(option_->check(check));
}

Option Option::between(int least, int most) {
  return Option(option_->check(CLI::Range(least, most)));
}

Option Option::one_of(const std::vector<std::string>& words) {
  return Option(option_->check(CLI::IsMember(words)));
}

Option Option::existing_file() { return Option(option_->check(CLI::ExistingFile)); }

Option Option::repeatable() {
  option_->allow_extra_args(false);
  return takes_all();
}

Option Option::takes_all() {
  return Option(option_->multi_option_policy(CLI::MultiOptionPolicy::TakeAll));
}

Option Option::expected(int least_values, int most_values) {
  return Option(option_->expected(least_values, most_values));
}

Option Option::delimiter(char between_values) { return Option(option_->delimiter(between_values)); }

Option Option::envname(const std::string& name) { return Option(option_->envname(name)); }

Option Option::default_str(const std::string& text) { return Option(option_->default_str(text)); }

Option Option::capture_default_str() { return Option(option_->capture_default_str()); }

Option Option::type_name(const std::string& text) { return Option(option_->type_name(text)); }

Option Option::group(const std::string& title) { return Option(option_->group(title)); }

template <typename T>
Option Command::add_option(const std::string& name, T& value, const std::string& help) {
  return Option(app_->add_option(name, value, help));
}

template <typename T>
Option Command::add_option_function(const std::string& name,
                                    const std::function<void(const T&)>& take,
                                    const std::string& help) {
  return Option(app_->add_option_function<T>(name, take, help));
}

Option Command::add_flag(const std::string& name, bool& value, const std::string& help) {
  return Option(app_->add_flag(name, value, help));
}

Option Command::add_flag_callback(const std::string& name, const std::function<void()>& call,
                                  const std::string& help) {
  return Option(app_->add_flag_callback(name, call, help));
}

Command Command::add_subcommand(const std::string& name, const std::string& help) {
  return Command(app_->add_subcommand(name, help));
}

void Command::require_subcommand() { app_->require_subcommand(1); }

void Command::callback(const std::function<void()>& call) { app_->callback(call); }

void Command::description(const std::string& text) { app_->description(text); }

void Command::group(const char* title, std::initializer_list<const char*> names) {
  for (const char* name : names) app_->get_option(name)->group(title);
}

Option Command::get_option(const std::string& name) const { return Option(app_->get_option(name)); }

std::vector<std::string> Command::option_names() const {
  std::vector<std::string> names;
  for (const CLI::Option* option : app_->get_options()) names.push_back(option->get_name());
  return names;
}

std::size_t Command::count(const std::string& name) const { return app_->count(name); }

std::string Command::help() const { return app_->help(); }

Program::Program(const std::string& description)
    : Program(std::make_unique<CLI::App>(description)) {}

Program::Program(std::unique_ptr<CLI::App> owned)
    : Command(owned.get()), owned_(std::move(owned)) {}

Program::~Program() = default;

void Program::name(const std::string& name) { owned_->name(name); }

void Program::version(const std::string& text) { owned_->set_version_flag("--version", text); }

void Program::last_word_counts() {
  owned_->option_defaults()->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
  owned_->option_defaults()->always_capture_default();
}

std::optional<int> Program::parse(int argc, char** argv) {
  try {
    owned_->parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return usage_error_of(*owned_, error).print();
  }
  return std::nullopt;
}

void Program::parse(std::vector<std::string> words) {
  std::ranges::reverse(words);  // as CLI11 takes them
  try {
    owned_->parse(std::move(words));
  } catch (const CLI::ParseError& error) {
    throw usage_error_of(*owned_, error);
  }
}

// The types of all options.
template Option Command::add_option(Text, std::string&, Text);
template Option Command::add_option(Text, std::filesystem::path&, Text);
template Option Command::add_option(Text, int&, Text);
template Option Command::add_option(Text, std::int64_t&, Text);
template Option Command::add_option(Text, std::uint16_t&, Text);
template Option Command::add_option(Text, std::uint32_t&, Text);
template Option Command::add_option(Text, std::uint64_t&, Text);
template Option Command::add_option(Text, double&, Text);
template Option Command::add_option(Text, std::optional<int>&, Text);
template Option Command::add_option(Text, std::optional<std::uint32_t>&, Text);
template Option Command::add_option(Text, std::optional<std::uint64_t>&, Text);
template Option Command::add_option(Text, std::optional<double>&, Text);
template Option Command::add_option(Text, std::optional<std::string>&, Text);
template Option Command::add_option(Text, std::vector<std::string>&, Text);
template Option Command::add_option(Text, std::vector<std::filesystem::path>&, Text);
template Option Command::add_option(Text, std::vector<std::uint64_t>&, Text);
template Option Command::add_option(Text, std::vector<double>&, Text);

template Option Command::add_option_function(Text, const Take<std::string>&, Text);
template Option Command::add_option_function(Text, const Take<int>&, Text);
template Option Command::add_option_function(Text, const Take<double>&, Text);
template Option Command::add_option_function(Text, const Take<std::vector<std::string>>&, Text);
template Option Command::add_option_function(Text, const Take<std::vector<double>>&, Text);

}  // namespace stillhand::command_line
