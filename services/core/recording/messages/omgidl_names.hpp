// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace stillhand::recording {

/// The names that an IDL text has defined so far, and the module whose definitions are being read.
/// A name is looked up in the open module, then in each module around it.
class IdlNames {
 public:
  /// The full name, "a::b", of a name defined here.
  [[nodiscard]] std::string scoped(const std::string& name) const;
  /// Opens a module.  @returns the one around it, for leave_to()
  std::string enter(const std::string& module);
  void leave_to(const std::string& outside) { scope_ = outside; }

  /// A later definition of the same name replaces the earlier one.  @param name  full
  void set_type(const std::string& name, std::uint32_t type) { types_[name] = type; }
  void set_constant(const std::string& name, std::int64_t value) { constants_[name] = value; }

  /// @param name  as in the text; "::a" from the outermost scope  @returns nullptr if unknown
  [[nodiscard]] const std::uint32_t* type(const std::string& name) const;
  [[nodiscard]] const std::int64_t* constant(const std::string& name) const;

 private:
  std::string scope_;
  std::map<std::string, std::uint32_t> types_;  // places in IdlSchema::types
  std::map<std::string, std::int64_t> constants_;
};

}  // namespace stillhand::recording
