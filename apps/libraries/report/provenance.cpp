// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/provenance.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <nlohmann/json.hpp>

#include "apps/libraries/report/command_line.hpp"
#include "apps/libraries/report/or_null.hpp"
#include "services/files/digest/content_digest.hpp"
#include "services/files/digest/digest.hpp"
#include "version.hpp"

namespace stillhand::report {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kShownDigits = 12;  // of 64: enough to distinguish files

std::int64_t seconds_now() {
  if (const char* given = std::getenv("SOURCE_DATE_EPOCH")) {
    char* end = nullptr;
    const long long seconds = std::strtoll(given, &end, 10);
    if (end != given && *end == '\0') return seconds;
  }
  return std::chrono::duration_cast<std::chrono::seconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace

ordered_json json_of(const Provenance& provenance) {
  ordered_json sources = ordered_json::array();
  for (const SourceFile& source : provenance.sources) {
    sources.push_back({{"name", source.name}, {"sha256", or_null(source.sha256)}});
  }
  return {{"version", provenance.version},
          {"date", provenance.date},
          {"command", provenance.command},
          {"sources", sources}};
}

std::string utc(std::int64_t seconds_since_1970) {
  const auto seconds = static_cast<std::time_t>(seconds_since_1970);
  std::tm parts{};
  if (::gmtime_r(&seconds, &parts) == nullptr) return {};
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text.data();
}

Provenance provenance_of_this_call(const std::vector<std::filesystem::path>& sources) {
  Provenance provenance{kVersion, utc(seconds_now()), command_line(), {}};
  for (const std::filesystem::path& path : sources) {
    const bool plain = std::filesystem::is_regular_file(path);
    provenance.sources.push_back({path.string(), plain ? digest::sha256_of_file(path) : ""});
  }
  return provenance;
}

std::string with_provenance(std::string_view json, const Provenance& provenance) {
  ordered_json whole = ordered_json::parse(json);
  whole.erase(digest::kProvenance);
  ordered_json entry = json_of(provenance);
  entry[digest::kContentDigest] = digest::content_digest(whole);
  whole[digest::kProvenance] = std::move(entry);
  return whole.dump(2) + "\n";
}

std::optional<Provenance> provenance_in(std::string_view json) {
  try {
    const ordered_json whole = ordered_json::parse(json);
    const ordered_json& entry = whole.at("provenance");
    Provenance provenance{entry.at("version"), entry.at("date"), entry.at("command"), {}};
    for (const ordered_json& source : entry.at("sources")) {
      const ordered_json& digest = source.at("sha256");
      provenance.sources.push_back(
          {source.at("name"), digest.is_null() ? std::string() : digest.get<std::string>()});
    }
    return provenance;
  } catch (const nlohmann::json::exception&) {
    return {};
  }
}

std::string made_by() { return fmt::format("stillhand {}, {}", kVersion, utc(seconds_now())); }

std::string in_words(const Provenance& provenance) {
  std::vector<std::string> sources;
  for (const SourceFile& source : provenance.sources) {
    sources.push_back(source.sha256.empty() ? source.name
                                            : source.name + " (SHA-256 " +
                                                  source.sha256.substr(0, kShownDigits) + ")");
  }
  return fmt::format("stillhand {}, {}, from {}: {}", provenance.version, provenance.date,
                     fmt::join(sources, ", "), provenance.command);
}

}  // namespace stillhand::report
