// SPDX-License-Identifier: Apache-2.0
// plant_writer DOMAIN: a program of another project with Fast DDS.  Its types are those of
// plant.idl, which it describes in discovery; one topic is as ROS 2 writes it, with a hash of its
// type and no description.  Waits for a reader of each topic, writes, prints "written 60" once they
// have everything, and stays until SIGTERM.  Used by foreign_bus_test.py.
// plant_writer DOMAIN crowd READ: writers of 5 topics more than READ, plant/0 and so on.  Once READ
// of them have a reader, each writes a sample; "written READ" follows.
#include <algorithm>
#include <cstdio>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <string>
#include <vector>

#include "places.hpp"
#include "services/bus/participant.hpp"
#include "services/bus/serialized_sample.hpp"
#include "services/system/process/stop.hpp"
#include "tests/plant_described.hpp"
#include "tests/support/wait.hpp"

namespace {

using namespace stillhand;  // NOLINT(google-build-using-namespace): a program of one file
namespace edds = runtime::edds;

constexpr int kCount = 60;

edds::DataWriterQos qos_of(bool latched, const std::string& user_data) {
  edds::DataWriterQos qos;
  qos.reliability().kind = edds::RELIABLE_RELIABILITY_QOS;
  qos.durability().kind =
      latched ? edds::TRANSIENT_LOCAL_DURABILITY_QOS : edds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = edds::KEEP_ALL_HISTORY_QOS;
  qos.deadline().period = {100, 0};
  qos.data_sharing().off();
  qos.user_data().data_vec({user_data.begin(), user_data.end()});
  return qos;
}

struct Program {
  explicit Program(std::uint32_t domain)
      : participant(runtime::create_participant(STILLHAND_SOURCE "/qos/profiles.xml", domain,
                                                "a plant", false, {}, nullptr)),
        publisher(participant->create_publisher(edds::PUBLISHER_QOS_DEFAULT)) {}
  ~Program() {
    participant->delete_contained_entities();
    edds::DomainParticipantFactory::get_instance()->delete_participant(participant);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  edds::DataWriter* writer(const std::string& name, const edds::TypeSupport& type, bool latched,
                           const std::string& user_data = "") {
    type.register_type(participant);
    edds::Topic* topic =
        participant->create_topic(name, type.get_type_name(), edds::TOPIC_QOS_DEFAULT);
    return publisher->create_datawriter(topic, qos_of(latched, user_data), &listener);
  }

  edds::DataWriterListener listener;  // 2.9.1 ends with a fault where a deadline meets none
  edds::DomainParticipant* participant;
  edds::Publisher* publisher;
};

bool has_reader(edds::DataWriter* writer) {
  edds::PublicationMatchedStatus status;
  return runtime::ok(writer->get_publication_matched_status(status)) && status.current_count > 0;
}

plant::State state_at(int i) {
  plant::State state;
  state.arm(static_cast<std::uint32_t>(i % 3));
  state.tick(i);
  state.mode(plant::Mode::MOVING);
  state.joint().angle_rad(0.5 * i);
  state.joint().torque_n_m({1.0F, 2.0F, 3.0F});
  state.others().resize(static_cast<std::size_t>(i % 4));
  state.gains({0.25, -i * 1.0});
  state.name("arm");
  state.ready(true);
  return state;
}

int write_in_a_crowd(Program& program, std::size_t read, runtime::Stop& stop) {
  std::vector<edds::DataWriter*> writers;
  for (std::size_t i = 0; i < read + 5; ++i) {
    writers.push_back(program.writer("plant/" + std::to_string(i),
                                     runtime::carrier_of("plant::Unknown", false), false));
    if (writers.back() == nullptr) return 1;
  }
  while (!stop.requested() &&
         static_cast<std::size_t>(std::ranges::count_if(writers, has_reader)) < read) {
    support::eventually([&] { return stop.requested(); }, std::chrono::milliseconds(100));
  }
  runtime::SerializedSample sample{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
  sample.resize(12);
  for (edds::DataWriter* each : writers) {
    if (!runtime::ok(each->write(&sample))) return 1;
  }
  for (edds::DataWriter* each : writers) {
    if (!runtime::ok(each->wait_for_acknowledgments({10, 0}))) return 1;
  }
  std::printf("written %zu\n", read);
  std::fflush(stdout);
  stop.wait();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 && argc != 4) return 2;
  runtime::Stop stop;
  describe();
  Program program(static_cast<std::uint32_t>(std::stoul(argv[1])));
  if (argc == 4) return write_in_a_crowd(program, std::stoul(argv[3]), stop);
  edds::DataWriter* states =
      program.writer("plant/state", edds::TypeSupport(new plant::StatePubSubType()), false);
  edds::DataWriter* flats =
      program.writer("plant/flat", edds::TypeSupport(new plant::FlatPubSubType()), true);
  edds::DataWriter* imus =
      program.writer("rt/imu", runtime::carrier_of("sensor_msgs::msg::dds_::Imu_", false), false,
                     "typehash=RIHS01_0123456789abcdef;");
  if (states == nullptr || flats == nullptr || imus == nullptr) return 1;
  while (!stop.requested() && !(has_reader(states) && has_reader(flats) && has_reader(imus))) {
    support::eventually([&] { return stop.requested(); }, std::chrono::milliseconds(10));
  }
  for (int i = 0; i < kCount; ++i) {
    plant::State state = state_at(i);
    plant::Flat flat;
    flat.tick(i);
    flat.pressure_pa(1e5 - i);
    flat.note(std::string(static_cast<std::size_t>(i), 'x'));
    flat.level({0.0F, 1.0F, 2.0F, static_cast<float>(i)});
    runtime::SerializedSample imu(64 + static_cast<std::size_t>(i) * 4, std::byte(i));
    imu[0] = imu[2] = imu[3] = std::byte{0};
    imu[1] = std::byte{1};
    if (!runtime::ok(states->write(&state)) || !runtime::ok(flats->write(&flat)) ||
        !runtime::ok(imus->write(&imu))) {
      return 1;
    }
    // Ends of instances take numbers of the sequence, and are no samples.
    if (i % 20 == 10 && !runtime::ok(states->dispose(&state, edds::HANDLE_NIL))) return 1;
    if (i % 20 == 15 && !runtime::ok(states->unregister_instance(&state, edds::HANDLE_NIL))) {
      return 1;
    }
  }
  for (edds::DataWriter* each : {states, flats, imus}) {
    if (!runtime::ok(each->wait_for_acknowledgments({10, 0}))) return 1;
  }
  std::printf("written %d\n", kCount);
  std::fflush(stdout);
  stop.wait();
  return 0;
}
