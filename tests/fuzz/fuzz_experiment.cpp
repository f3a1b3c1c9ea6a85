// SPDX-License-Identifier: Apache-2.0
// Files of an experiment's folder: experiment.yaml, a participant's journal, the sealed assignment.
// A design that is read is written and read again, and so is each entry of a journal.
#include <cstdlib>
#include <string>

#include "apps/experiment/folder/sealed_assignment.hpp"
#include "apps/libraries/experiment/file/experiment_file.hpp"
#include "apps/libraries/experiment/file/journal.hpp"
#include "services/core/contract/config_error.hpp"

namespace {

using namespace stillhand;

void check_design(const std::string& yaml) {
  const std::string once = experiment::yaml_of(experiment::design_of(yaml, "experiment.yaml"));
  try {
    if (experiment::yaml_of(experiment::design_of(once, "copy")) != once) std::abort();
  } catch (const ConfigError&) {
    std::abort();
  }
}

void check_journal(const std::string& lines) {
  for (const auto& entry : experiment::entries_of(lines, "journal.jsonl")) {
    const std::string once = experiment::line_of(entry);
    const auto again = experiment::entries_of(once + "\n", "copy");
    if (again.size() != 1 || experiment::line_of(again.front()) != once) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(bytes), size);
  try {
    check_design(text);
  } catch (const ConfigError&) {
  }
  try {
    check_journal(text);
  } catch (const ConfigError&) {
  }
  try {
    experiment::order_seed_of(text, "assignment.sealed");
  } catch (const ConfigError&) {
    return 0;
  }
  return 0;
}
