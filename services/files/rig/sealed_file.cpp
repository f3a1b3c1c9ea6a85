// SPDX-License-Identifier: Apache-2.0
#include "services/files/rig/sealed_file.hpp"

#include <nlohmann/json.hpp>

#include "services/core/contract/config_error.hpp"
#include "services/files/recording/file_io.hpp"

namespace stillhand::rig {
SealedSeed read_sealed_seed(std::istream& from) {
  SealedSeed sealed{};
  if (!(from >> sealed.seed >> sealed.nonce) || sealed.nonce.size() != 32) {
    throw ConfigError("--undeclared-effect", "standard input without a seed and its nonce",
                      "the line that `stillhand lab --undeclared-effect SEED` sends");
  }
  return sealed;
}

std::string text_of(const SealedSeed& sealed) {
  return std::to_string(sealed.seed) + " " + sealed.nonce + "\n";
}

std::string sealed_text(const OpenedEffect& effect, const std::string& nonce) {
  nlohmann::ordered_json parameters = nlohmann::ordered_json::object();
  for (const OpenedEffect::Parameter& each : effect.parameters) {
    parameters[each.name] = {{"value", each.value}, {"unit", each.unit}};
  }
  nlohmann::ordered_json json{{"seed", effect.seed},   {"kind", effect.kind},
                              {"channel", nullptr},    {"parameters", parameters},
                              {"place", effect.place}, {"nonce", nonce}};
  if (!effect.channel.empty()) json["channel"] = effect.channel;
  return json.dump(2) + "\n";
}

void commit_effect(const std::filesystem::path& folder, const std::string& text) {
  recording::write_file(folder / kCommitmentFile, digest::digest_line(text, kSealedFile));
}

void open_effect(const std::filesystem::path& folder, const std::string& text,
                 const std::string& verdict_file) {
  const std::string commitment = (folder / kCommitmentFile).string();
  const std::string line = digest::digest_line(text, kSealedFile);
  if (!recording::read_file(commitment).starts_with(line)) {
    throw ConfigError(commitment, "the digest of another effect",
                      "the digest that the rig wrote at the start of the session");
  }
  if (!verdict_file.empty()) {
    const std::string verdict = recording::read_file((folder / verdict_file).string());
    recording::write_file(commitment, line + digest::digest_line(verdict, verdict_file));
  }
  recording::write_file(folder / kSealedFile, text);
}

}  // namespace stillhand::rig
