// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "services/files/settings/section.hpp"

namespace stillhand::deploy {

/// Single values of the inventory's file.  `path` names the entry in messages, "hosts[1].address";
/// every refusal is a ConfigError that begins with the entry's file, line and column.

[[noreturn]] void refuse(const settings::Entry& entry, const std::string& path,
                         const std::string& want);
[[noreturn]] void refuse_second(const settings::Entry& entry, const std::string& path,
                                const settings::Entry& first, const std::string& want);

std::string item_path(const std::string& list, std::size_t index);

/// Refuses every other key.  Call it before required(): an unknown key may be a missing one,
/// misspelt.
void allow_only(settings::SectionReader& reader, std::initializer_list<std::string_view> keys);

/// The entry of that key.  @param section  the entry that `reader` reads
const settings::Entry& required(settings::SectionReader& reader, const settings::Entry& section,
                                const std::string& path, std::string_view key,
                                const std::string& want);
std::string text_of(const settings::Entry& entry, const std::string& path, const std::string& want);
const std::vector<settings::Entry>& items_of(const settings::Entry& entry, const std::string& path,
                                             const std::string& want);
/// A name that becomes part of file names, units and other programs' arguments.
std::string name_in(const settings::Entry& entry, const std::string& path);
/// A host's IPv4 address.
std::string address_in(const settings::Entry& entry, const std::string& path);

}  // namespace stillhand::deploy
