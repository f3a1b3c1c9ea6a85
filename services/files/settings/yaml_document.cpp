// SPDX-License-Identifier: Apache-2.0
#include "services/files/settings/yaml_document.hpp"

#include <yaml-cpp/eventhandler.h>

#include <sstream>

#include "services/core/contract/config_error.hpp"

namespace stillhand::settings {
namespace {

// Where the newest document begins; everything else is left to YAML::Load().
class Beginning : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& mark) override { mark_ = mark; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t,
                const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}

  [[nodiscard]] const YAML::Mark& mark() const noexcept { return mark_; }

 private:
  YAML::Mark mark_;
};

void refuse_a_second(const std::string& yaml, const std::string& source_name) {
  std::istringstream text(yaml);
  YAML::Parser parser(text);
  Beginning document;
  if (!parser.HandleNextDocument(document)) return;
  const YAML::Mark first = document.mark();
  if (!parser.HandleNextDocument(document)) return;
  if (document.mark().pos == first.pos) {
    throw ConfigError(place_of(first, source_name), "a sign that begins no value",
                      "well-formed YAML");
  }
  throw ConfigError(place_of(document.mark(), source_name), "a second document", "one");
}

}  // namespace

std::string place_of(const YAML::Mark& mark, const std::string& source_name) {
  if (mark.is_null()) return source_name;
  return source_name + ":" + std::to_string(mark.line + 1) + ":" + std::to_string(mark.column + 1);
}

YAML::Node one_document(const std::string& yaml, const std::string& source_name) {
  try {
    refuse_a_second(yaml, source_name);
    return YAML::Load(yaml);
  } catch (const YAML::Exception& error) {
    throw ConfigError(place_of(error.mark, source_name), error.msg, "well-formed YAML");
  }
}

}  // namespace stillhand::settings
