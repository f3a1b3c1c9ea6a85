// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/messages/omgidl_names.hpp"

#include <cstddef>

namespace stillhand::recording {
namespace {

std::string inside(const std::string& scope, const std::string& name) {
  return scope.empty() ? name : scope + "::" + name;
}

template <typename Value>
const Value* look_up(const std::map<std::string, Value>& values, std::string name,
                     const std::string& open) {
  const bool global = name.starts_with("::");
  if (global) name.erase(0, 2);
  for (std::string scope = global ? "" : open;;) {
    const auto found = values.find(inside(scope, name));
    if (found != values.end()) return &found->second;
    if (scope.empty()) return nullptr;
    const std::size_t cut = scope.rfind("::");
    scope = cut == std::string::npos ? "" : scope.substr(0, cut);
  }
}

}  // namespace

std::string IdlNames::scoped(const std::string& name) const { return inside(scope_, name); }

std::string IdlNames::enter(const std::string& module) {
  std::string outside = scope_;
  scope_ = scoped(module);
  return outside;
}

const std::uint32_t* IdlNames::type(const std::string& name) const {
  return look_up(types_, name, scope_);
}

const std::int64_t* IdlNames::constant(const std::string& name) const {
  return look_up(constants_, name, scope_);
}

}  // namespace stillhand::recording
