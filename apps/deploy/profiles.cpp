// SPDX-License-Identifier: Apache-2.0
#include "apps/deploy/profiles.hpp"

#include <tinyxml2.h>

#include "apps/deploy/generated_file.hpp"
#include "apps/deploy/ports.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/recording/file_io.hpp"

namespace stillhand::deploy {
namespace {

using tinyxml2::XMLDocument;
using tinyxml2::XMLElement;
using tinyxml2::XMLNode;

// GUID prefix of a lab's only server; its clients must use the same.
constexpr const char* kServerPrefix = "44.53.00.5f.45.50.52.4f.53.49.4d.41";
constexpr const char* kTransport = "lab_udp";

/// Elements of the document that are replaced.
struct Parts {
  XMLElement* transport;
  XMLElement* used_transport;
  XMLElement* rtps;
  XMLElement* builtin;
  XMLElement* discovery;
};

XMLElement* descend(XMLNode* from, std::initializer_list<const char*> names) {
  XMLNode* at = from;
  for (const char* name : names) {
    if (at != nullptr) at = at->FirstChildElement(name);
  }
  return at == nullptr ? nullptr : at->ToElement();
}

Parts parts_of(XMLDocument& document, const std::filesystem::path& file) {
  XMLElement* profiles = descend(&document, {"dds", "profiles"});
  XMLElement* rtps = descend(profiles, {"participant", "rtps"});
  const Parts parts{descend(profiles, {"transport_descriptors", "transport_descriptor"}),
                    descend(rtps, {"userTransports", "transport_id"}), rtps,
                    descend(rtps, {"builtin"}), descend(rtps, {"builtin", "discovery_config"})};
  if (parts.transport == nullptr || parts.used_transport == nullptr || parts.discovery == nullptr) {
    throw ConfigError(file.string(),
                      "profiles without a transport_descriptor, or a participant without "
                      "userTransports and discovery_config",
                      "those of qos/profiles.xml");
  }
  return parts;
}

// Sets the text of the child of that name; adds the child at the end if there is none.
void set(XMLElement* parent, const char* name, const std::string& text) {
  XMLElement* child = parent->FirstChildElement(name);
  if (child == nullptr) child = parent->InsertNewChildElement(name);
  child->SetText(text.c_str());
}

void add_locator(XMLElement* list, const std::string& address, std::uint32_t port) {
  XMLElement* udp = list->InsertNewChildElement("locator")->InsertNewChildElement("udpv4");
  if (!address.empty()) set(udp, "address", address);
  if (port != 0) set(udp, "port", std::to_string(port));
}

void set_transport(const Parts& parts, const Inventory& inventory, const Host& host) {
  set(parts.transport, "transport_id", kTransport);
  parts.used_transport->SetText(kTransport);
  set(parts.transport, "maxInitialPeersRange", std::to_string(participants_sought(inventory)));
  // The comments around the old list describe a single machine.
  for (XMLNode* child = parts.transport->FirstChild(); child != nullptr;) {
    XMLNode* next = child->NextSibling();
    if (child->ToComment() != nullptr) parts.transport->DeleteChild(child);
    child = next;
  }
  XMLElement* list = parts.transport->FirstChildElement("interfaceWhiteList");
  if (list == nullptr) list = parts.transport->InsertNewChildElement("interfaceWhiteList");
  list->DeleteChildren();
  // Only one address: each has a socket that sends and a thread that receives.  With 127.0.0.1 in
  // addition, local datagrams are sent twice and callbacks of one bus run at the same time.
  list->InsertNewChildElement("address")->SetText(host.address.c_str());
}

// A participant with a unicast locator, even an empty one (the standard port), opens no multicast
// locator.
void add_unicast_only(XMLElement* builtin) {
  add_locator(builtin->InsertNewChildElement("metatrafficUnicastLocatorList"), "", 0);
}

// No ports: Fast DDS fills in the ports of the domain's first maxInitialPeersRange participants, so
// the file serves every domain.
void add_peers(XMLElement* builtin, const Inventory& inventory) {
  XMLElement* list = builtin->InsertNewChildElement("initialPeersList");
  for (const Host& host : inventory.hosts) add_locator(list, host.address, 0);
}

// SUPER_CLIENT: a plain client learns only of endpoints that match its own, and `stillhand record`
// looks for all.
void add_client(XMLElement* discovery, const Inventory& inventory) {
  set(discovery, "discoveryProtocol", "SUPER_CLIENT");
  XMLElement* server = discovery->InsertNewChildElement("discoveryServersList")
                           ->InsertNewChildElement("RemoteServer");
  server->SetAttribute("prefix", kServerPrefix);
  add_locator(server->InsertNewChildElement("metatrafficUnicastLocatorList"),
              inventory.hosts.front().address, DomainPorts(inventory.domain).server());
}

std::string printed(const XMLDocument& document) {
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return printer.CStr();
}

void add_note(XMLDocument& document, const Inventory& inventory, const Host& host) {
  XMLElement* dds = document.RootElement();
  std::string note = " " + generated_note(inventory, host) + " ";
  // "--" would end the XML comment; a name may contain it.
  for (std::size_t at = 0; (at = note.find("--")) != std::string::npos;) note.replace(at, 2, "- -");
  document.InsertAfterChild(dds->PreviousSibling(), document.NewComment(note.c_str()));
}

}  // namespace

LabProfiles::LabProfiles(const std::filesystem::path& base)
    : file_(base), base_(recording::read_file(base.string())) {
  XMLDocument document;
  if (document.Parse(base_.c_str(), base_.size()) != tinyxml2::XML_SUCCESS) {
    throw ConfigError(file_.string(), document.ErrorStr(), "well-formed XML");
  }
  const Parts parts = parts_of(document, file_);
  const auto bytes = [&](const char* name) -> std::uint64_t {
    const XMLElement* child = parts.transport->FirstChildElement(name);
    return child == nullptr ? 0 : child->Unsigned64Text();
  };
  buffers_ = {bytes("sendBufferSize"), bytes("receiveBufferSize")};
}

std::string LabProfiles::of(const Inventory& inventory, const Host& host) const {
  XMLDocument document;
  document.Parse(base_.c_str(), base_.size());
  const Parts parts = parts_of(document, file_);
  add_note(document, inventory, host);
  set_transport(parts, inventory, host);
  switch (inventory.discovery) {
    case Discovery::kPeers:
      add_unicast_only(parts.builtin);
      add_peers(parts.builtin, inventory);
      break;
    case Discovery::kServer:
      add_unicast_only(parts.builtin);
      add_client(parts.discovery, inventory);
      break;
    case Discovery::kMulticast:
      break;
  }
  return printed(document);
}

std::string LabProfiles::of_server(const Inventory& inventory) const {
  XMLDocument document;
  document.Parse(base_.c_str(), base_.size());
  const Parts parts = parts_of(document, file_);
  const Host& host = inventory.hosts.front();
  add_note(document, inventory, host);
  set_transport(parts, inventory, host);
  // Fast DDS's own server reads the file, and a name differs between versions of Fast DDS.
  XMLElement* profiles = document.RootElement()->FirstChildElement("profiles");
  for (const char* kind : {"data_writer", "data_reader"}) {
    while (XMLElement* each = profiles->FirstChildElement(kind)) profiles->DeleteChild(each);
  }
  set(parts.rtps, "prefix", kServerPrefix);
  set(parts.discovery, "discoveryProtocol", "SERVER");
  add_locator(parts.builtin->InsertNewChildElement("metatrafficUnicastLocatorList"), host.address,
              DomainPorts(inventory.domain).server());
  return printed(document);
}

}  // namespace stillhand::deploy
