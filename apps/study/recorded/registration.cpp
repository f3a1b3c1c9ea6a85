// SPDX-License-Identifier: Apache-2.0
#include "apps/study/recorded/registration.hpp"

#include "apps/libraries/experiment/file/experiment_file.hpp"
#include "apps/study/subjects/conditions.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/digest/digest.hpp"

namespace stillhand::study {

std::optional<Registration> registration_of(const std::vector<std::filesystem::path>& folders,
                                            const std::string& digest) {
  std::optional<Registration> out;
  for (const std::filesystem::path& folder : folders) {
    const std::filesystem::path file = folder / experiment::kDesignFile;
    if (!std::filesystem::is_regular_file(file)) continue;
    const std::string yaml = experiment::registered_text(folder);
    if (digest::sha256(yaml) != digest) {
      throw ConfigError(
          file.string(), "SHA-256 " + digest::sha256(yaml).substr(0, 12) + "...",
          digest.substr(0, 12) + "..., which the recordings state: the pre-registration changed");
    }
    const experiment::Design design = experiment::design_of(yaml, file.string());
    out.emplace();
    out->rules = design.exclusion;
    out->trials_a_condition = design.blocks * design.trials;
    out->alpha = design.alpha;
    out->design = design;
    out->standing = experiment::standing_of(folder, design);
    out->folder = folder;
    for (const std::string& condition : design.conditions) {
      out->conditions.push_back(named(condition));
    }
    for (const std::string& text : design.comparisons) {
      // Design's own check has refused what is no pair.
      const auto pair = experiment::compared_by(text, design.conditions).value();
      out->comparisons.emplace_back(named(pair.first), named(pair.second));
    }
  }
  return out;
}

}  // namespace stillhand::study
