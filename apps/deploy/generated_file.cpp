// SPDX-License-Identifier: Apache-2.0
#include "apps/deploy/generated_file.hpp"

namespace stillhand::deploy {

std::string generated_note(const Inventory& inventory, const Host& host) {
  std::string source = inventory.file.filename().string();
  for (char& c : source) {
    // The name must not end a line or an XML comment.
    if (static_cast<unsigned char>(c) < ' ' || c == '>') c = '_';
  }
  return std::string(kGeneratedMark) + " from " + source + " for host " + host.name + " of lab " +
         inventory.lab + ". Change that file and generate again.";
}

std::string installed_folder(const Inventory& inventory) {
  return "/etc/stillhand/" + inventory.lab;
}

}  // namespace stillhand::deploy
