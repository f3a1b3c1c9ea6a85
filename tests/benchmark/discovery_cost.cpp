// SPDX-License-Identifier: Apache-2.0
// What it costs the processes of a lab to find each other, by each discovery that an inventory may
// name (deploy/README.md).
// As root: build/tests/discovery_cost [ROUNDS [PARTICIPANTS...]]
// 5 rounds of 2, 8, 32 and 64 participants by default, on one host in a network
// namespace of its own.  Each participant is a process with the profiles that `stillhand deploy
// generate` makes for a lab of as many services; it writes and reads the 10 Hz status that every
// service has, and nothing else.  All start at once.  Then 2 s with the status and 2 s without.
// Packets are those that lo and the host's interface sent; a refused one counts twice, since the
// refusal is a packet too.
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <limits>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "apps/deploy/checks.hpp"
#include "apps/deploy/generate.hpp"
#include "apps/deploy/ports.hpp"
#include "idl/session.h"
#include "places.hpp"
#include "services/bus/bus.hpp"
#include "services/system/process/real_time.hpp"
#include "services/system/process/stop.hpp"
#include "tests/support/child.hpp"
#include "tests/support/wait.hpp"
#include "tests/unit/deploy/sample_inventory.hpp"

namespace {

using namespace stillhand;  // NOLINT(google-build-using-namespace): a program of one file
namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr int kSkipped = 77;
constexpr const char* kAddress = "10.213.7.1";
constexpr const char* kInterface = "lan";
constexpr const char* kServerProgram = "/usr/bin/fast-discovery-server";
constexpr std::chrono::seconds kLimit{120};
constexpr milliseconds kSettle{1500};  // the first announcements take 1 s
constexpr milliseconds kWindow{2000};  // four announcements of each
constexpr std::int64_t kStatusPeriod_ns = 100'000'000;
constexpr std::int64_t kPoll_ns = 10'000'000;

std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void say(const char* what, std::int64_t figure) {
  std::printf("%s %lld\n", what, static_cast<long long>(figure));
  std::fflush(stdout);
}

/// One process of the lab.  Says "started NS" when it is on the bus, "matched NS" when it has found
/// `count` writers and readers, its own among them, and "kept N" how many it had when it fell
/// quiet.
int member(const std::string& service, std::uint32_t rig, std::uint32_t count,
           const fs::path& profiles, const fs::path& quiet) {
  runtime::end_with_parent(getppid());
  runtime::Stop stop;
  runtime::Bus::Options options;
  options.service = service;
  options.rig = rig;
  options.profiles = profiles;
  runtime::Bus bus(options);
  auto statuses = bus.publisher<stillhand_msgs::ServiceStatus>(topics::kServiceStatus);
  bus.subscribe<stillhand_msgs::ServiceStatus>(topics::kServiceStatus,
                                               [](const auto&, const auto&) {});
  bus.start();
  say("started", runtime::monotonic_ns());
  const auto found = [&bus] {
    std::uint32_t fewest = std::numeric_limits<std::uint32_t>::max();
    for (const auto& endpoint : bus.report()) fewest = std::min(fewest, endpoint.matched);
    return fewest;
  };
  stillhand_msgs::ServiceStatus status;
  status.service(service);
  bool matched = false;
  bool silent = false;
  std::int64_t due_ns = runtime::monotonic_ns();
  while (!stop.requested()) {
    const std::int64_t now_ns = runtime::monotonic_ns();
    if (!matched && found() >= count) {
      matched = true;
      say("matched", now_ns);
    }
    if (now_ns >= due_ns) {
      if (!silent && fs::exists(quiet)) {
        silent = true;
        say("kept", found());
      }
      if (!silent) statuses.write(status);
      due_ns = now_ns + kStatusPeriod_ns;
    }
    runtime::sleep_until_ns(matched ? due_ns : std::min(due_ns, now_ns + kPoll_ns));
  }
  return 0;
}

/// What the namespace has sent.
struct Traffic {
  double packets = 0.0, bytes = 0.0;
};

Traffic sent() {
  std::ifstream stream("/proc/net/dev");
  Traffic sum;
  for (std::string line; std::getline(stream, line);) {
    std::istringstream words(line);
    std::string name;
    words >> name;
    if (name != "lo:" && name != std::string(kInterface) + ":") continue;
    double word = 0.0;
    for (int column = 0; column < 8; ++column) words >> word;  // what it received
    Traffic interface;
    words >> interface.bytes >> interface.packets;
    sum.packets += interface.packets;
    sum.bytes += interface.bytes;
  }
  return sum;
}

Traffic since(const Traffic& before) {
  const Traffic now = sent();
  return {now.packets - before.packets, now.bytes - before.bytes};
}

Traffic per_second() {
  const std::int64_t began_ns = runtime::monotonic_ns();
  const Traffic before = sent();
  std::this_thread::sleep_for(kWindow);
  const Traffic sum = since(before);
  const double took_s = static_cast<double>(runtime::monotonic_ns() - began_ns) * 1e-9;
  return {sum.packets / took_s, sum.bytes / took_s};
}

/// A lab of one host with so many services at least, whole rigs, and its generated files.
struct Lab {
  Lab(const std::string& discovery, std::size_t participants) {
    std::string rigs;
    std::string services;
    const std::size_t each = topics::kServices.size();
    for (std::size_t rig = 1; rig <= (participants + each - 1) / each; ++rig) {
      const std::string name = "r" + std::to_string(rig);
      const char* comma = rig == 1 ? "" : ", ";
      rigs += comma + ("{name: " + name) + ", number: " + std::to_string(rig) + "}";
      for (const auto service : topics::kServices) {
        services += (services.empty() ? "" : ", ") + ("{service: " + std::string(service)) +
                    ", rig: " + name + "}";
      }
    }
    inventory = deploy::read_inventory(folder.file(
        "lab: bench\ndiscovery: " + discovery + "\nrigs: [" + rigs +
        "]\nhosts: [{name: pc, address: " + kAddress + ", services: [" + services + "]}]"));
    deploy::generate(inventory, deploy::LabProfiles(STILLHAND_SOURCE "/qos/profiles.xml"),
                     folder.path());
  }
  [[nodiscard]] fs::path generated(const std::string& name) const {
    return folder.path() / "pc" / name;
  }

  deploy::SampleFolder folder;
  deploy::Inventory inventory;
};

std::unique_ptr<support::Child> started_server(const Lab& lab) {
  auto server = std::make_unique<support::Child>(
      std::vector<std::string>{kServerProgram, "-i", "0", "-x",
                               lab.generated("discovery_server.xml")},
      lab.folder.path() / "server");
  const std::uint32_t port = deploy::DomainPorts(lab.inventory.domain).server();
  if (!support::eventually(
          [&] { return !deploy::taken_ports(text_of("/proc/net/udp"), port, port).empty(); })) {
    throw std::runtime_error("the discovery server did not open its port within 20 s");
  }
  return server;
}

/// Latest figure that the members said of something.  @return whether all of them have said it
bool heard(const std::vector<std::unique_ptr<support::Child>>& members, const std::string& what,
           std::vector<std::int64_t>& figures) {
  figures.clear();
  for (const auto& each : members) {
    const std::string text = each->output();
    const std::size_t at = text.find(what + " ");
    if (at == std::string::npos || text.find('\n', at) == std::string::npos) continue;
    figures.push_back(std::stoll(text.substr(at + what.size())));
  }
  return figures.size() == members.size();
}

struct Round {
  double started_s, matched_s;  ///< [s] of the last one; infinite: not all within the limit
  std::size_t complete;         ///< how many had found all
  std::int64_t kept;            ///< peers of who had the fewest at the end
  Traffic until, with_status, without_status;  ///< the latter two a second
};

Round measure(const fs::path& self, const std::string& discovery, std::size_t participants) {
  const Lab lab(discovery, participants);
  const fs::path quiet = lab.folder.path() / "quiet";
  const auto server = discovery == "server" ? started_server(lab) : nullptr;
  std::vector<std::unique_ptr<support::Child>> members;
  const Traffic before = sent();
  const std::int64_t began_ns = runtime::monotonic_ns();
  for (std::size_t i = 0; i < participants; ++i) {
    const deploy::Placement& place = lab.inventory.hosts.front().services[i];
    members.push_back(std::make_unique<support::Child>(
        std::vector<std::string>{self, "--member", place.service, std::to_string(place.rig),
                                 std::to_string(participants), lab.generated("profiles.xml"),
                                 quiet},
        lab.folder.path() / std::to_string(i)));
  }
  std::vector<std::int64_t> figures;
  const auto last_s = [&](bool all) {
    if (!all) return std::numeric_limits<double>::infinity();
    return static_cast<double>(*std::max_element(figures.begin(), figures.end()) - began_ns) * 1e-9;
  };
  Round round{};
  // Every 20 ms: reading 64 files takes the members' time.
  support::eventually([&] { return heard(members, "matched", figures); }, kLimit, milliseconds(20));
  round.until = since(before);
  round.complete = figures.size();
  round.matched_s = last_s(figures.size() == participants);
  round.started_s = last_s(heard(members, "started", figures));
  std::this_thread::sleep_for(kSettle);
  round.with_status = per_second();
  std::ofstream(quiet).flush();
  support::eventually([&] { return heard(members, "kept", figures); });
  round.kept =
      figures.size() == participants ? *std::min_element(figures.begin(), figures.end()) : 0;
  round.without_status = per_second();
  for (const auto& each : members) each->ask_to_end();
  return round;
}

template <typename Figure>
double median(const std::vector<Round>& rounds, Figure figure) {
  std::vector<double> values(rounds.size());
  std::transform(rounds.begin(), rounds.end(), values.begin(), figure);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// "1.20 s"; "-": it did not come to that.
std::string seconds(double s) {
  if (!std::isfinite(s)) return "-";
  std::ostringstream text;
  text << std::fixed << std::setprecision(2) << s << " s";
  return text.str();
}

void print_row(std::size_t participants, const std::string& discovery,
               const std::vector<Round>& rounds) {
  const auto all = static_cast<std::size_t>(std::count_if(
      rounds.begin(), rounds.end(), [&](const Round& r) { return r.complete == participants; }));
  double worst_s = 0.0;
  for (const Round& round : rounds) worst_s = std::max(worst_s, round.matched_s);
  std::printf("| %zu | %s | %s | %s | %s | %zu of %zu | %.0f | %.2f | %.0f | %.0f | %.0f |\n",
              participants, discovery.c_str(),
              seconds(median(rounds, [](const Round& r) { return r.started_s; })).c_str(),
              seconds(median(rounds, [](const Round& r) { return r.matched_s; })).c_str(),
              seconds(worst_s).c_str(), all, rounds.size(),
              median(rounds, [](const Round& r) { return r.until.packets; }),
              median(rounds, [](const Round& r) { return r.until.bytes * 1e-6; }),
              median(rounds, [](const Round& r) { return r.without_status.packets; }),
              median(rounds, [](const Round& r) { return r.without_status.bytes * 1e-3; }),
              median(rounds, [](const Round& r) { return r.with_status.packets; }));
  std::fflush(stdout);
}

int measure_all(const fs::path& self, int rounds, const std::vector<std::size_t>& counts) {
  std::vector<std::string> kinds{"peers", "multicast"};
  if (fs::exists(kServerProgram)) {
    kinds.emplace_back("server");
  } else {
    std::fprintf(stderr, "discovery_cost: without the server, since there is no %s\n",
                 kServerProgram);
  }
  std::puts(
      "| participants | discovery | all started, p50 | all matched, p50 | worst | rounds with all "
      "| "
      "packets until then | MB | afterwards, packets/s | kB/s | with the status, packets/s |\n"
      "| ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |");
  for (const std::size_t count : counts) {
    for (const std::string& kind : kinds) {
      std::vector<Round> done;
      for (int i = 0; i < rounds; ++i) {
        const Round& round = done.emplace_back(measure(self, kind, count));
        std::fprintf(stderr, "%zu %s: %zu had all, the last after %.2f s; each kept %lld or more\n",
                     count, kind.c_str(), round.complete, round.matched_s,
                     static_cast<long long>(round.kept));
      }
      print_row(count, kind, done);
    }
  }
  return 0;
}

// The other end of the cable is needed for the link to be up; nobody listens there.
bool enter_own_network() {
  if (unshare(CLONE_NEWNET) != 0) return false;
  const std::string name = kInterface;
  const std::string command = "ip link set lo up && ip link add name " + name +
                              " type veth peer name far && ip address add " + kAddress +
                              "/24 dev " + name + " && ip link set far up && ip link set " + name +
                              " up";
  return std::system(command.c_str()) == 0;  // NOLINT(concurrency-mt-unsafe): no thread yet
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> given(argv + 1, argv + argc);
  const auto number = [&](std::size_t i) {
    return static_cast<std::uint32_t>(std::stoul(given.at(i)));
  };
  try {
    if (given.size() == 6 && given[0] == "--member") {
      return member(given[1], number(2), number(3), given[4], given[5]);
    }
    if (!enter_own_network()) {
      std::cerr << "discovery_cost: skipped, a network namespace needs root\n";
      return kSkipped;
    }
    std::vector<std::size_t> counts;
    for (std::size_t i = 1; i < given.size(); ++i) counts.push_back(number(i));
    if (counts.empty()) counts = {2, 8, 32, 64};
    return measure_all(fs::canonical("/proc/self/exe"),
                       given.empty() ? 5 : static_cast<int>(number(0)), counts);
  } catch (const std::exception& error) {
    std::cerr << "discovery_cost: " << error.what() << '\n';
    return 1;
  }
}
