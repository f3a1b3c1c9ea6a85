// SPDX-License-Identifier: Apache-2.0
// What this version of Fast DDS does where qos/RESULTS.md ("Facts of Fast DDS 2.9.1 and 3.1.2") has
// a row: plain Fast DDS on loopback, a row of the table on standard output for each fact.
// build/tests/fast_dds_facts [DOMAIN]; a minute.  A fact has a process of its own: one may crash.
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "fast_dds/types.hpp"
#include "idl/control_loop.h"
#include "idl/control_loopPubSubTypes.h"
#include "tests/support/wait.hpp"

namespace stillhand::runtime {
namespace {

using std::chrono::seconds;
using stillhand_msgs::Sensed;
using support::eventually;
using Clock = std::chrono::steady_clock;

constexpr double kLease_s = 0.1;
unsigned domain = 77;

edds::Duration_t duration(double time_s) {
  const auto whole = static_cast<std::int32_t>(time_s);
  return {whole, static_cast<std::uint32_t>((time_s - whole) * 1e9 + 0.5)};
}

double since_s(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

edds::DomainParticipant* participant(const char* interface = "127.0.0.1") {
  edds::DomainParticipantQos qos;
  qos.transport().use_builtin_transports = false;
  auto udp = std::make_shared<ertps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList = {interface};
  qos.transport().user_transports.push_back(udp);
  return edds::DomainParticipantFactory::get_instance()->create_participant(domain, qos);
}

edds::Topic* topic(edds::DomainParticipant* of, const char* name = "facts") {
  static edds::TypeSupport type(new SharedType<stillhand_msgs::SensedPubSubType>());
  type.register_type(of);
  return of->create_topic(name, name_of(*type.get()), edds::TOPIC_QOS_DEFAULT);
}

struct Heard : edds::DataReaderListener {
  std::atomic<int> missed{0}, alive{0}, samples{0}, matched{0};
  void on_requested_deadline_missed(edds::DataReader*,
                                    const edds::RequestedDeadlineMissedStatus&) override {
    ++missed;
  }
  void on_liveliness_changed(edds::DataReader*,
                             const edds::LivelinessChangedStatus& status) override {
    alive = status.alive_count;
  }
  void on_subscription_matched(edds::DataReader*,
                               const edds::SubscriptionMatchedStatus& status) override {
    matched = status.current_count;
  }
  void on_data_available(edds::DataReader* reader) override {
    Sensed sample;
    edds::SampleInfo info;
    while (ok(reader->take_next_sample(&sample, &info))) samples += info.valid_data ? 1 : 0;
  }
};

edds::DataReader* reader(edds::DomainParticipant* of, edds::Topic* topic, Heard* heard,
                         double deadline_s = 0.0, double lease_s = 0.0) {
  edds::DataReaderQos qos = edds::DATAREADER_QOS_DEFAULT;
  qos.data_sharing().off();
  if (deadline_s > 0.0) qos.deadline().period = duration(deadline_s);
  if (lease_s > 0.0) qos.liveliness().lease_duration = duration(lease_s);
  return of->create_subscriber(edds::SUBSCRIBER_QOS_DEFAULT)->create_datareader(topic, qos, heard);
}

edds::DataWriter* writer(edds::DomainParticipant* of, edds::Topic* topic,
                         const edds::DataWriterQos& qos) {
  return of->create_publisher(edds::PUBLISHER_QOS_DEFAULT)->create_datawriter(topic, qos);
}

edds::DataWriterQos offered(double deadline_s = 0.0, double lease_s = 0.0) {
  edds::DataWriterQos qos = edds::DATAWRITER_QOS_DEFAULT;
  qos.reliability().kind = edds::BEST_EFFORT_RELIABILITY_QOS;
  qos.data_sharing().off();
  if (deadline_s > 0.0) qos.deadline().period = duration(deadline_s);
  if (lease_s > 0.0) {
    qos.liveliness().kind = edds::AUTOMATIC_LIVELINESS_QOS;
    qos.liveliness().lease_duration = duration(lease_s);
    qos.liveliness().announcement_period = duration(0.3 * lease_s);
  }
  return qos;
}

// A process with a writer of that topic, whose liveliness Fast DDS announces, until it is killed.
pid_t living(const char* name) {
  const pid_t child = fork();
  if (child != 0) return child;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  auto* self = participant();
  writer(self, topic(self, name), offered(0.0, kLease_s));
  while (true) pause();
}

void death_noticed(int others) {
  std::vector<pid_t> alive{living("facts")};
  for (int i = 0; i < others; ++i) alive.push_back(living("others"));
  auto* self = participant();
  static Heard heard, of_others;  // their participant outlives this function
  reader(self, topic(self), &heard, 0.0, kLease_s);
  reader(self, topic(self, "others"), &of_others, 0.0, kLease_s);
  const bool all = eventually([&] { return heard.alive == 1 && of_others.matched == others; });
  std::this_thread::sleep_for(seconds(1));  // every announcement has come once
  kill(alive.front(), SIGKILL);
  const auto begin = Clock::now();
  const bool gone = eventually([&] { return heard.alive == 0; }, seconds(8));
  std::printf("| AUTOMATIC liveliness, lease 100 ms, killed next to %d others | %s %.2f s%s |\n",
              others, gone ? "noticed after" : "not noticed within", since_s(begin),
              all ? "" : " (not all were matched)");
  for (const pid_t each : alive) kill(each, SIGKILL);
}

void missed_deadlines(double period_s) {
  auto* reading = participant();
  auto* writing = participant();
  static Heard heard;
  reader(reading, topic(reading), &heard, period_s);
  auto* out = writer(writing, topic(writing), offered(period_s));
  Sensed sample;
  eventually([&] {
    out->write(&sample);
    return heard.samples > 0;
  });
  const int before = heard.missed;
  const auto begin = Clock::now();
  std::this_thread::sleep_for(seconds(2));
  std::printf("| calls of a missed deadline of %.1f ms a second | %.0f |\n", 1e3 * period_s,
              (heard.missed - before) / since_s(begin));
}

// The writer has no listener, the participant has one.
void offered_deadline_missed() {
  edds::DomainParticipantListener listener;
  auto* self = participant();
  self->set_listener(&listener);
  Sensed sample;
  writer(self, topic(self), offered(0.01))->write(&sample);
  std::this_thread::sleep_for(seconds(1));
  std::puts("| a missed offered deadline, only the participant has a listener | goes on |");
}

void data_sharing_of_a_keyed_type() {
  auto qos = offered();
  qos.data_sharing().on("/dev/shm");
  qos.endpoint().history_memory_policy = ertps::PREALLOCATED_MEMORY_MODE;
  auto* self = participant();
  std::printf("| data sharing for a keyed type | %s |\n",
              writer(self, topic(self), qos) ? "a writer" : "no writer");
}

void misspelt_security() {
  edds::DomainParticipantQos qos;
  ertps::Property property;
  property.name("dds.sec.auth.plugn");
  property.value("builtin.PKI-DH");
  qos.properties().properties().push_back(property);
  auto* made = edds::DomainParticipantFactory::get_instance()->create_participant(domain, qos);
  std::printf("| a misspelt security property | %s |\n",
              made ? "no security, no error" : "no participant");
}

void white_list_by_name() {
  auto* reading = participant("lo");
  auto* writing = participant("lo");
  static Heard heard;
  reader(reading, topic(reading), &heard);
  writer(writing, topic(writing), offered());
  std::printf("| a white list with the name of an interface | %s |\n",
              eventually([&] { return heard.matched > 0; }, seconds(5)) ? "matches" : "no match");
}

// UDP ports of this domain that this machine has open.
std::set<unsigned> ports() {
  std::set<unsigned> found;
  std::ifstream table("/proc/self/net/udp");
  for (std::string line; std::getline(table, line);) {
    const std::size_t at = line.find(':', line.find(':') + 1);
    if (at == std::string::npos || line.find(':') > 8) continue;
    const auto port = static_cast<unsigned>(std::strtoul(line.c_str() + at + 1, nullptr, 16));
    if (port / 250 == (7400 + 250 * domain) / 250) found.insert(port);
  }
  return found;
}

void participant_numbers() {
  auto* factory = edds::DomainParticipantFactory::get_instance();
  const auto before = ports();
  factory->delete_participant(participant());
  auto* second = participant();
  std::set<unsigned> mine;
  for (const unsigned port : ports())
    if (!before.contains(port)) mine.insert(port);
  // Ports of participant 0: 10 and 11 above the domain's first one; of participant 1: 12 and 13.
  const bool again = mine.contains(7400 + 250 * domain + 10);
  std::printf("| the number of a participant that ended | %s |\n",
              again ? "used again" : "not used again");
  factory->delete_participant(second);
}

void sizes() {
  const auto threads = [] {
    return std::distance(std::filesystem::directory_iterator("/proc/self/task"), {});
  };
  const auto resident_MB = [] {
    std::ifstream in("/proc/self/statm");
    long all = 0, resident = 0;
    in >> all >> resident;
    return static_cast<double>(resident * sysconf(_SC_PAGESIZE)) / 1e6;
  };
  const auto threads_before = threads();
  const double before_MB = resident_MB();
  participant();
  std::printf("| threads, memory that the first participant adds | %td, %.1f MB |\n",
              threads() - threads_before, resident_MB() - before_MB);
  std::printf("| default of maxInitialPeersRange | %u |\n",
              ertps::UDPv4TransportDescriptor().maxInitialPeersRange);
}

void in_a_process(const char* fact, const std::function<void()>& show) {
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    show();
    std::fflush(stdout);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFSIGNALED(status)) std::printf("| %s | %s |\n", fact, strsignal(WTERMSIG(status)));
}

}  // namespace
}  // namespace stillhand::runtime

int main(int argc, char** argv) {
  using namespace stillhand::runtime;
  if (argc > 1) domain = static_cast<unsigned>(std::atoi(argv[1]));
  std::puts("| fact | this version |\n| --- | --- |");
  for (const int others : {0, 1, 2, 3, 5}) {
    in_a_process("AUTOMATIC liveliness", [others] { death_noticed(others); });
  }
  for (const double period_s : {0.001, 0.002, 0.0055, 0.010}) {
    in_a_process("missed deadline", [period_s] { missed_deadlines(period_s); });
  }
  in_a_process("a missed offered deadline, only the participant has a listener",
               offered_deadline_missed);
  in_a_process("data sharing for a keyed type", data_sharing_of_a_keyed_type);
  in_a_process("a misspelt security property", misspelt_security);
  in_a_process("a white list with the name of an interface", white_list_by_name);
  in_a_process("the number of a participant that ended", participant_numbers);
  in_a_process("threads and memory", sizes);
  return 0;
}
