// SPDX-License-Identifier: Apache-2.0
#include "services/files/digest/content_digest.hpp"

#include <nlohmann/json.hpp>

#include "services/core/contract/config_error.hpp"
#include "services/files/digest/digest.hpp"

namespace stillhand::digest {

std::string content_digest(nlohmann::ordered_json whole) {
  whole.erase(kProvenance);
  return sha256(whole.dump());
}

void require_as_written(std::string_view json, const std::string& origin) {
  const auto whole = nlohmann::ordered_json::parse(json);
  if (!whole.contains(kProvenance)) return;
  const auto& provenance = whole.at(kProvenance);
  if (!provenance.contains(kContentDigest)) return;
  if (provenance.at(kContentDigest) == content_digest(whole)) return;
  throw ConfigError(origin, "a file that was changed after it was written",
                    "it as it was written (provenance.content_sha256), or made again");
}

}  // namespace stillhand::digest
