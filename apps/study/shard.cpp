// SPDX-License-Identifier: Apache-2.0
#include "apps/study/shard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "apps/study/stored_result.hpp"
#include "apps/study/study.hpp"
#include "services/contract/config_error.hpp"
#include "services/population/population.hpp"
#include "services/recording/file_io.hpp"
#include "services/rig/sealed_file.hpp"
#include "version.hpp"

namespace stillhand::study {
namespace {

using nlohmann::json;

constexpr const char* kFormat = "stillhand study shard 1";

std::string cbor(const json& value) {
  std::string bytes;
  json::to_cbor(value, bytes);
  return bytes;
}

// Visitors of Population::fields().
json population_json(const population::Population& population) {
  json out = json::object();
  population::Population::fields(
      [&](const char* name, double value, Range, const char*) { out[name] = value; }, population);
  return out;
}

population::Population population_of(const json& from) {
  population::Population population;
  population::Population::fields([&](const char* name, double& value, Range,
                                     const char*) { value = from.at(name).get<double>(); },
                                 population);
  return population;
}

// All that the options of the verb can change and that changes a result; see options_of().
json settings_json(const StudyOptions& options) {
  return {{"subjects", options.subjects},
          {"seed", options.seed},
          {"conditions", stored::to_json(options.protocol.conditions)},
          {"trial_seconds", options.protocol.trial_s},
          {"identify_seconds", options.protocol.identify_s},
          {"canceller", options.canceller},
          {"stick_damping_n_s_m", options.damped_stick_n_s_m},
          {"wrong_models", options.wrong_models},
          {"undeclared_effect", options.undeclared_effect},
          {"population", population_json(options.population)}};
}

StudyOptions options_of(const json& settings) {
  StudyOptions options;
  settings.at("subjects").get_to(options.subjects);
  settings.at("seed").get_to(options.seed);
  stored::from_json(settings.at("conditions"), options.protocol.conditions);
  settings.at("trial_seconds").get_to(options.protocol.trial_s);
  settings.at("identify_seconds").get_to(options.protocol.identify_s);
  settings.at("canceller").get_to(options.canceller);
  settings.at("stick_damping_n_s_m").get_to(options.damped_stick_n_s_m);
  settings.at("wrong_models").get_to(options.wrong_models);
  settings.at("undeclared_effect").get_to(options.undeclared_effect);
  options.population = population_of(settings.at("population"));
  return options;
}

// A shard as it was read.
struct Part {
  std::filesystem::path folder;
  Shard shard;
  json settings;
  std::string sealed;
  double wall_s = 0.0;
  std::vector<SubjectResult> results;
};

[[noreturn]] void damaged(const std::filesystem::path& file, const std::string& got) {
  throw ConfigError(file.string(), got,
                    "the whole file that `stillhand study --shard` wrote; run this shard again");
}

// The items before the digest.
std::string checked_bytes(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) {
    throw ConfigError(file.parent_path().string(), fmt::format("no file {}", kShardFile),
                      "a folder that `stillhand study --shard K/N --out DIR` has finished");
  }
  std::string bytes = recording::read_file(file.string());
  if (bytes.size() < kShardDigestBytes) damaged(file, fmt::format("{} bytes", bytes.size()));
  const std::string digest = bytes.substr(bytes.size() - kShardDigestBytes);
  bytes.resize(bytes.size() - kShardDigestBytes);
  if (digest != cbor(rig::sha256(bytes))) damaged(file, "bytes that do not fit the digest");
  return bytes;
}

// Reads the items; from_cbor() takes one from the stream at each call.
Part read_items(const std::filesystem::path& file, std::istream& items) {
  const json header = json::from_cbor(items, false);
  if (header.at("format") != kFormat) damaged(file, header.at("format").get<std::string>());
  if (header.at("version") != kVersion) {
    throw ConfigError(file.string(),
                      "a shard of version " + header.at("version").get<std::string>(),
                      fmt::format("version {}, this program's, in every shard", kVersion));
  }
  Part part{file.parent_path(),
            {header.at("shard").get<std::int64_t>(), header.at("of").get<std::int64_t>()},
            header.at("settings"),
            header.at("sealed").get<std::string>(),
            header.at("wall_s").get<double>(),
            {}};
  const StudyOptions options = options_of(part.settings);
  if (options.subjects > kMaxSubjects || part.shard.of > options.subjects ||
      part.shard.number < 1 || part.shard.number > part.shard.of) {
    damaged(file, fmt::format("shard {}/{} of {} subjects", part.shard.number, part.shard.of,
                              options.subjects));
  }
  const std::int64_t end = part.shard.end(options.subjects);
  for (std::int64_t index = part.shard.first(options.subjects); index < end; ++index) {
    SubjectResult& result = part.results.emplace_back();
    stored::from_json(json::from_cbor(items, false), result);
    result.subject = population::draw_subject(options.population, options.seed, index);
  }
  return part;
}

Part read_shard(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / kShardFile;
  std::istringstream items(checked_bytes(file));
  try {
    return read_items(file, items);
  } catch (const json::exception& error) {
    damaged(file, error.what());
  }
}

// Names the first setting that differs.
void check_same_study(const Part& part, const Part& first) {
  if (part.shard.of != first.shard.of) {
    throw ConfigError(
        part.folder.string(), fmt::format("shard {}/{}", part.shard.number, part.shard.of),
        fmt::format("one of {} shards, as {}", first.shard.of, first.folder.string()));
  }
  if (part.settings == first.settings) return;
  const json patch = json::diff(first.settings, part.settings);
  const json::json_pointer where(patch.at(0).at("path").get<std::string>());
  throw ConfigError(part.folder.string(),
                    fmt::format("{} {}", where.back(), part.settings.value(where, json()).dump()),
                    fmt::format("{}, as in {}", first.settings.value(where, json()).dump(),
                                first.folder.string()));
}

void check_all_there(const std::vector<Part*>& by_number) {
  std::string missing;
  for (std::size_t i = 0; i < by_number.size(); ++i) {
    if (by_number[i] == nullptr) missing += fmt::format("{}{}", missing.empty() ? "" : ", ", i + 1);
  }
  if (missing.empty()) return;
  throw ConfigError("--merge", fmt::format("no shard {} of {}", missing, by_number.size()),
                    "the folders of all shards");
}

}  // namespace

Shard parse_shard(const std::string& word, std::int64_t subjects) {
  Shard shard{0, 0};
  const char* end = word.data() + word.size();
  const auto number = std::from_chars(word.data(), end, shard.number);
  const bool slash = number.ec == std::errc() && number.ptr != end && *number.ptr == '/';
  const auto of = slash ? std::from_chars(number.ptr + 1, end, shard.of) : number;
  if (!slash || of.ec != std::errc() || of.ptr != end || shard.number < 1 ||
      shard.number > shard.of) {
    throw ConfigError("--shard", '"' + word + '"', "K/N with K from 1 to N, for example 2/8");
  }
  if (shard.of > subjects) {
    throw ConfigError("--shard", fmt::format("{} shards of {} subjects", shard.of, subjects),
                      "at least one subject in each shard");
  }
  return shard;
}

std::string shard_file(const StudyRecord& record, const Shard& shard) {
  const json settings = settings_json(record.options);
  std::string bytes = cbor({{"format", kFormat},
                            {"version", kVersion},
                            {"shard", shard.number},
                            {"of", shard.of},
                            {"settings", settings},
                            {"settings_sha256", rig::sha256(cbor(settings))},
                            {"sealed", record.sealed},
                            {"wall_s", record.wall_s},
                            {"command_line", record.command_line}});
  for (const SubjectResult& result : record.results) bytes += cbor(stored::to_json(result));
  return bytes + cbor(rig::sha256(bytes));
}

StudyRecord merged(const std::vector<std::filesystem::path>& folders) {
  std::vector<Part> parts;
  parts.reserve(folders.size());
  std::vector<Part*> by_number;
  for (const auto& folder : folders) {
    Part& part = parts.emplace_back(read_shard(folder));
    check_same_study(part, parts.front());
    by_number.resize(static_cast<std::size_t>(part.shard.of));
    Part*& place = by_number.at(static_cast<std::size_t>(part.shard.number - 1));
    if (place != nullptr) {
      throw ConfigError(folder.string(),
                        fmt::format("shard {}/{} a second time", part.shard.number, part.shard.of),
                        "each shard once; the first is in " + place->folder.string());
    }
    place = &part;
  }
  check_all_there(by_number);
  StudyRecord record;
  record.options = options_of(parts.front().settings);
  record.sealed = by_number.front()->sealed;
  for (Part* part : by_number) {
    record.wall_s += part->wall_s;
    std::ranges::move(part->results, std::back_inserter(record.results));
  }
  return record;
}

}  // namespace stillhand::study
