// SPDX-License-Identifier: Apache-2.0
#include "apps/experiment/folder/sealed_assignment.hpp"

#include <fmt/format.h>

#include <charconv>
#include <nlohmann/json.hpp>

#include "services/core/contract/config_error.hpp"
#include "services/files/digest/digest.hpp"
#include "services/files/settings/json_entry.hpp"

namespace stillhand::experiment {
namespace {

constexpr const char* kWanted = "the file that `stillhand experiment new` wrote";

std::string bytes_of(const std::string& digits, const std::string& origin) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2) {
    unsigned value = 0;
    const char* end = digits.data() + i + 2;
    const auto [rest, error] = std::from_chars(digits.data() + i, end, value, 16);
    if (error != std::errc() || rest != end) {
      throw ConfigError(origin, "a text that is not hexadecimal", kWanted);
    }
    bytes += static_cast<char>(value);
  }
  return bytes;
}

}  // namespace

std::string sealed_text(std::uint64_t order_seed) {
  const nlohmann::ordered_json json{{"order_seed", order_seed}, {"nonce", digest::new_nonce()}};
  std::string digits;
  for (const char c : json.dump()) digits += fmt::format("{:02x}", static_cast<unsigned char>(c));
  return digits + "\n";
}

std::uint64_t order_seed_of(const std::string& sealed, const std::string& origin) {
  std::string digits = sealed;
  while (!digits.empty() && digits.back() == '\n') digits.pop_back();
  const auto json = settings::parsed_json(bytes_of(digits, origin), origin, kWanted);
  const settings::JsonEntry root(json, origin);
  return root.at("order_seed").count();
}

std::string opened_text(const Design& design, const Assignment& assignment,
                        std::optional<std::size_t> only) {
  nlohmann::ordered_json json;
  for (std::int64_t n = 0; n < design.participants; ++n) {
    const auto participant = static_cast<std::size_t>(n);
    if (only && *only != participant) continue;
    const auto labels = labels_of(design.conditions.size(), assignment, participant);
    for (std::size_t i = 0; i < labels.size(); ++i) {
      json["labels"][participant_code(participant)][labels[i]] = design.conditions[i];
    }
    nlohmann::ordered_json order = nlohmann::ordered_json::array();
    for (const Step& step : plan_of(design, assignment, participant)) {
      if (step.kind == StepKind::kTrial) order.push_back(design.conditions[step.condition]);
    }
    json["orders"][participant_code(participant)] = order;
  }
  return json.dump(2) + "\n";
}

}  // namespace stillhand::experiment
