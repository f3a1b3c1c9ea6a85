// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <initializer_list>

namespace stillhand::settings {

/// Lets an option be given several times, with one value each.
inline CLI::Option* repeatable(CLI::Option* option) {
  return option->allow_extra_args(false)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

/// Lists options under a title of their own in --help.
inline void in_group(CLI::App& verb, const char* title, std::initializer_list<const char*> names) {
  for (const char* name : names) verb.get_option(name)->group(title);
}

}  // namespace stillhand::settings
