// SPDX-License-Identifier: Apache-2.0
// Writes a lab's DDS Security documents from the catalogue, unsigned; deploy/security/make.sh
// signs them. stillhand-permissions FOLDER LAB NOT_BEFORE NOT_AFTER DOMAIN_FROM DOMAIN_TO
// writes governance.xml and permissions_<identity>.xml into FOLDER, and prints one identity per
// line.
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iostream>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "idl/topics.hpp"

namespace {

namespace topics = stillhand::topics;

struct Lab {
  std::string folder, name, not_before, not_after, domains;
};

/// The topics that an identity may write and read.
struct Rights {
  std::string identity;
  std::set<std::string> publishes, subscribes;
};

bool is_among(std::span<const std::string_view> names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

Rights rights_of(std::string_view service) {
  Rights rights{std::string(service), {}, {}};
  for (const topics::Topic* topic : topics::kCatalogue) {
    if (is_among(topic->writers, service)) rights.publishes.emplace(topic->name);
    if (is_among(topic->readers, service)) rights.subscribes.emplace(topic->name);
  }
  return rights;
}

/// `stillhand record`, which listens from outside a session: it reads everything, and writes only
/// its own remote control, which no process of a session reads.
Rights rights_of_tap() {
  Rights rights{std::string(topics::kTap), {}, {}};
  for (const topics::Topic* topic : topics::kCatalogue) rights.subscribes.emplace(topic->name);
  for (const topics::Topic* topic : {&topics::kRecorderCommand, &topics::kRecorderStatus}) {
    rights.publishes.emplace(topic->name);
    rights.subscribes.emplace(topic->name);
  }
  return rights;
}

/// Reads like a tap, and writes requests to sessions and recorders.
Rights rights_of_dashboard() {
  Rights rights = rights_of_tap();
  rights.identity = topics::kDashboard;
  rights.publishes = {std::string(topics::kSessionCommand.name),
                      std::string(topics::kRecorderCommand.name)};
  return rights;
}

std::string topic_list(const char* verb, const std::set<std::string>& names) {
  if (names.empty()) return "";
  std::string items;
  for (const std::string& name : names)
    items += fmt::format("            <topic>{}</topic>\n", name);
  return fmt::format(R"(        <{0}>
          <topics>
{1}          </topics>
        </{0}>
)",
                     verb, items);
}

// Elements are in the order of the schema; Fast DDS refuses any other order.
std::string permissions(const Lab& lab, const Rights& rights) {
  return fmt::format(R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
     xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_permissions.xsd">
  <permissions>
    <grant name="{identity}">
      <subject_name>CN={identity},O={lab}</subject_name>
      <validity>
        <not_before>{not_before}</not_before>
        <not_after>{not_after}</not_after>
      </validity>
      <allow_rule>
{domains}{publish}{subscribe}      </allow_rule>
      <default>DENY</default>
    </grant>
  </permissions>
</dds>
)",
                     fmt::arg("identity", rights.identity), fmt::arg("lab", lab.name),
                     fmt::arg("not_before", lab.not_before), fmt::arg("not_after", lab.not_after),
                     fmt::arg("domains", lab.domains),
                     fmt::arg("publish", topic_list("publish", rights.publishes)),
                     fmt::arg("subscribe", topic_list("subscribe", rights.subscribes)));
}

std::string topic_rule(std::string_view name, std::string_view metadata) {
  return fmt::format(R"(        <topic_rule>
          <topic_expression>{}</topic_expression>
          <enable_discovery_protection>true</enable_discovery_protection>
          <enable_liveliness_protection>true</enable_liveliness_protection>
          <enable_read_access_control>true</enable_read_access_control>
          <enable_write_access_control>true</enable_write_access_control>
          <metadata_protection_kind>{}</metadata_protection_kind>
          <data_protection_kind>NONE</data_protection_kind>
        </topic_rule>
)",
                     name, metadata);
}

// README.md, "What is protected, and why", gives the reason for each kind of protection.
std::string governance(const Lab& lab) {
  std::string rules;
  for (const topics::Topic* topic : topics::kCatalogue) {
    const bool in_the_loop = topic->pattern == topics::Pattern::kStream1khz;
    rules += topic_rule(topic->name, in_the_loop ? "SIGN" : "ENCRYPT");
  }
  rules += topic_rule("*", "ENCRYPT");
  return fmt::format(R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
     xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_governance.xsd">
  <domain_access_rules>
    <domain_rule>
{}      <allow_unauthenticated_participants>false</allow_unauthenticated_participants>
      <enable_join_access_control>true</enable_join_access_control>
      <discovery_protection_kind>SIGN</discovery_protection_kind>
      <liveliness_protection_kind>SIGN</liveliness_protection_kind>
      <rtps_protection_kind>NONE</rtps_protection_kind>
      <topic_access_rules>
{}      </topic_access_rules>
    </domain_rule>
  </domain_access_rules>
</dds>
)",
                     lab.domains, rules);
}

void write(const std::string& file, const std::string& text) {
  std::ofstream out(file);
  out << text;
  out.close();
  if (!out) throw std::runtime_error("cannot write " + file);
}

}  // namespace

int main(int argc, char** argv) {
  constexpr const char* kArguments = "FOLDER LAB NOT_BEFORE NOT_AFTER DOMAIN_FROM DOMAIN_TO\n";
  if (argc == 2 && argv[1] == std::string_view("--help")) {
    std::cout
        << "Writes a lab's DDS Security documents. deploy/security/make.sh calls it and signs "
           "them.\n"
        << "Usage: stillhand-permissions " << kArguments;
    return 0;
  }
  if (argc != 7) {
    std::cerr << "stillhand-permissions: got " << argc - 1 << " arguments, want " << kArguments;
    return 2;
  }
  try {
    const Lab lab{argv[1], argv[2], argv[3], argv[4],
                  fmt::format("      <domains><id_range><min>{}</min><max>{}</max></id_range>"
                              "</domains>\n",
                              argv[5], argv[6])};
    std::vector<Rights> all{rights_of_tap(), rights_of_dashboard()};
    for (const std::string_view service : topics::kServices) all.push_back(rights_of(service));
    write(lab.folder + "/governance.xml", governance(lab));
    for (const Rights& rights : all) {
      write(fmt::format("{}/permissions_{}.xml", lab.folder, rights.identity),
            permissions(lab, rights));
      std::cout << rights.identity << '\n';
    }
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "stillhand-permissions: " << error.what() << '\n';
    return 1;
  }
}
