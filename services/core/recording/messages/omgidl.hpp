// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stillhand::recording {

/// Encoding of a value of an IDL type.
enum class IdlKind : std::uint8_t {
  kBoolean,
  kOctet,
  kChar,
  kInt8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat32,
  kFloat64,
  kString,
  kEnum,
  kStruct,
  kSequence,
  kArray,
  kUnsupported  ///< union, map, wide text, ...: only the name is known; not decoded
};

struct IdlType {
  IdlKind kind = IdlKind::kUnsupported;
  std::uint32_t of = 0;      ///< number of the struct or enum, or of the element's type
  std::uint32_t length = 0;  ///< [-] elements of an array
  std::string name = {};     ///< name of an unsupported type
};

struct IdlMember {
  std::string name;
  std::uint32_t type = 0;  ///< number in IdlSchema::types
  std::string unit;        ///< from "// [unit] ..." after the member, or annotated; empty: none
  bool key = false;
  bool optional = false;  ///< not decoded
};

struct IdlStruct {
  std::string name;  ///< scoped: "module::Name"
  std::vector<IdlMember> members;
  bool is_mutable = false;  ///< not decoded
};

struct IdlEnum {
  std::string name;
  std::vector<std::pair<std::int64_t, std::string>> values;
};

/// The types of an IDL text (OMG IDL 4.2, the part that DDS topics use): modules, structs with
/// inheritance, enums, typedefs, arrays, sequences, strings, integer constants, annotations.  The
/// parser skips everything else (unions, maps, bit sets, wide characters); an error occurs only if
/// a message needs it.
struct IdlSchema {
  std::vector<IdlType> types;
  std::vector<IdlStruct> structs;
  std::vector<IdlEnum> enums;

  /// Struct of that scoped name ("a::B", or "a/B" as in some files), or nullptr.
  [[nodiscard]] const IdlStruct* find(std::string_view name) const;
};

/// @param source  name for messages, for example "F.mcap, schema 3"
/// @throws stillhand::ConfigError with line and column.  Pure.
IdlSchema parse_idl(std::string_view text, const std::string& source);

}  // namespace stillhand::recording
