// SPDX-License-Identifier: Apache-2.0
#include "services/recording/core/messages/same_definition.hpp"

#include <algorithm>

namespace stillhand::recording {
namespace {

constexpr int kMostLevels = 32;

struct Comparison {
  const IdlSchema& recorded;
  const IdlSchema& known;

  std::string types(const IdlType& a, const IdlType& b, const std::string& path, int level) const {
    if (a.kind != b.kind || a.length != b.length) return path + " is of another type";
    if (a.kind == IdlKind::kUnsupported && a.name != b.name) return path + " is of another type";
    if (level > kMostLevels) return path + " is nested too deeply";
    if (a.kind == IdlKind::kStruct) {
      return structs(recorded.structs[a.of], known.structs[b.of], path + ".", level + 1);
    }
    if (a.kind == IdlKind::kEnum && recorded.enums[a.of].values != known.enums[b.of].values) {
      return path + " has other values";
    }
    if (a.kind == IdlKind::kSequence || a.kind == IdlKind::kArray) {
      return types(recorded.types[a.of], known.types[b.of], path + "[]", level + 1);
    }
    return {};
  }

  std::string structs(const IdlStruct& a, const IdlStruct& b, const std::string& path,
                      int level) const {
    for (std::size_t i = 0; i < std::max(a.members.size(), b.members.size()); ++i) {
      if (i >= a.members.size()) return path + b.members[i].name + " is missing";
      if (i >= b.members.size()) return path + a.members[i].name + " is additional";
      if (a.members[i].name != b.members[i].name) {
        return path + a.members[i].name + " is in the place of " + b.members[i].name;
      }
      std::string difference =
          types(recorded.types[a.members[i].type], known.types[b.members[i].type],
                path + a.members[i].name, level);
      if (!difference.empty()) return difference;
    }
    return {};
  }
};

}  // namespace

std::string definition_difference(const IdlSchema& recorded, const IdlSchema& known,
                                  std::string_view type) {
  const IdlStruct* a = recorded.find(type);
  const IdlStruct* b = known.find(type);
  if (a == nullptr) return "its schema does not define the type";
  if (b == nullptr) return "the type is unknown";
  return Comparison{recorded, known}.structs(*a, *b, "", 0);
}

}  // namespace stillhand::recording
