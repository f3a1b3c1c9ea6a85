// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/messages/same_definition.hpp"

#include <algorithm>

namespace stillhand::recording {
namespace {

constexpr int kMostLevels = 32;

// Values that were added at the end since leave the others as they were.
template <typename Values>
bool begins(const Values& all, const Values& first) {
  return first.size() <= all.size() && std::equal(first.begin(), first.end(), all.begin());
}

struct Comparison {
  const IdlSchema& recorded;
  const IdlSchema& known;
  bool may_lack_last;

  std::string types(const IdlType& a, const IdlType& b, const std::string& path, int level) const {
    if (a.kind != b.kind || a.length != b.length) return path + " is of another type";
    if (a.kind == IdlKind::kUnsupported && a.name != b.name) return path + " is of another type";
    if (level > kMostLevels) return path + " is nested too deeply";
    if (a.kind == IdlKind::kStruct) {
      return structs(recorded.structs[a.of], known.structs[b.of], path + ".", level + 1);
    }
    if (a.kind == IdlKind::kEnum &&
        !begins(known.enums[b.of].values, recorded.enums[a.of].values)) {
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
      if (i >= a.members.size()) {
        if (may_lack_last && level == 0) return {};
        return path + b.members[i].name + " is missing";
      }
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
                                  std::string_view type, bool may_lack_last) {
  const IdlStruct* a = recorded.find(type);
  const IdlStruct* b = known.find(type);
  if (a == nullptr) return "its schema does not define the type";
  if (b == nullptr) return "the type is unknown";
  return Comparison{recorded, known, may_lack_last}.structs(*a, *b, "", 0);
}

}  // namespace stillhand::recording
