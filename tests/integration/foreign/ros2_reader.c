// SPDX-License-Identifier: Apache-2.0
// ros2_reader DOMAIN reliable|best-effort: reads the topics of the bridge with Cyclone DDS, as a
// node of ROS 2 does, and prints a line of JSON for each message: topic, frame, numbers, texts.
#include <string.h>

#include "ros2.h"
#include "tests/support/cyclone.h"

enum { kTopics = 8, kAtOnce = 64 };

static const char* text(const char* of) { return of == NULL ? "" : of; }
static void print_three(const double* xyz) {
  printf("%.17g, %.17g, %.17g", xyz[0], xyz[1], xyz[2]);
}

static void print_imu(const void* of) {
  const sensor_msgs_msg_dds__Imu_* m = of;
  printf("\"%s\", [%.17g, %.17g, %.17g, %.17g, %.17g, ", text(m->header.frame_id), m->orientation.x,
         m->orientation.y, m->orientation.z, m->orientation.w, m->angular_velocity_covariance[0]);
  print_three(&m->linear_acceleration.x);
  printf("], []");
}
static void print_wrench(const void* of) {
  const geometry_msgs_msg_dds__WrenchStamped_* m = of;
  printf("\"%s\", [", text(m->header.frame_id));
  print_three(&m->wrench.force.x);
  printf(", ");
  print_three(&m->wrench.torque.x);
  printf("], []");
}
static void print_joint(const void* of) {
  const sensor_msgs_msg_dds__JointState_* m = of;
  if (m->name._length != 1 || m->position._length != 1 || m->velocity._length != 1) exit(1);
  printf("\"%s\", [%.17g, %.17g], [\"%s\"]", text(m->header.frame_id), m->position._buffer[0],
         m->velocity._buffer[0], text(m->name._buffer[0]));
}
static void print_point(const void* of) {
  const geometry_msgs_msg_dds__PointStamped_* m = of;
  printf("\"%s\", [", text(m->header.frame_id));
  print_three(&m->point.x);
  printf("], []");
}
static void print_diagnostics(const void* of) {
  const diagnostic_msgs_msg_dds__DiagnosticArray_* m = of;
  if (m->status._length != 1) exit(1);
  const diagnostic_msgs_msg_dds__DiagnosticStatus_* status = &m->status._buffer[0];
  printf("\"%s\", [%d], [\"%s\"", text(m->header.frame_id), status->level, text(status->name));
  for (uint32_t i = 0; i < status->values._length; ++i) {
    printf(", \"%s\", \"%s\"", text(status->values._buffer[i].key),
           text(status->values._buffer[i].value));
  }
  printf("]");
}

static const struct {
  const char* name;
  const dds_topic_descriptor_t* type;
  void (*print)(const void*);
} kRead[kTopics] = {
    {"rt/rig_1/imu", &sensor_msgs_msg_dds__Imu__desc, print_imu},
    {"rt/rig_1/hand/wrench", &geometry_msgs_msg_dds__WrenchStamped__desc, print_wrench},
    {"rt/rig_1/motor/wrench", &geometry_msgs_msg_dds__WrenchStamped__desc, print_wrench},
    {"rt/rig_1/stick/joint_states", &sensor_msgs_msg_dds__JointState__desc, print_joint},
    {"rt/rig_1/platform/joint_states", &sensor_msgs_msg_dds__JointState__desc, print_joint},
    {"rt/rig_1/target", &geometry_msgs_msg_dds__PointStamped__desc, print_point},
    {"rt/rig_1/cursor", &geometry_msgs_msg_dds__PointStamped__desc, print_point},
    {"rt/diagnostics", &diagnostic_msgs_msg_dds__DiagnosticArray__desc, print_diagnostics}};

static void print_new(dds_entity_t reader, int topic) {
  void* samples[kAtOnce] = {NULL};
  dds_sample_info_t info[kAtOnce];
  const int taken = good(dds_take(reader, samples, info, kAtOnce, kAtOnce), "take");
  for (int i = 0; i < taken; ++i) {
    if (!info[i].valid_data) continue;
    printf("[\"%s\", ", kRead[topic].name + 2);
    kRead[topic].print(samples[i]);
    printf("]\n");
  }
  if (taken > 0) good(dds_return_loan(reader, samples, taken), "loan");
}

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  signal(SIGTERM, on_signal);
  const dds_entity_t participant =
      good(dds_create_participant((dds_domainid_t)atoi(argv[1]), NULL, NULL), "participant");
  dds_qos_t* qos = dds_create_qos();
  const int reliable = strcmp(argv[2], "reliable") == 0;
  dds_qset_reliability(qos, reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       DDS_SECS(1));
  dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
  dds_entity_t readers[kTopics];
  for (int i = 0; i < kTopics; ++i) {
    const dds_entity_t topic =
        good(dds_create_topic(participant, kRead[i].type, kRead[i].name, NULL, NULL), "topic");
    readers[i] = good(dds_create_reader(participant, topic, qos, NULL), "reader");
  }
  dds_delete_qos(qos);
  int printed = 0;
  while (!stop) {
    int matched = 0;
    for (int i = 0; i < kTopics; ++i) {
      print_new(readers[i], i);
      dds_subscription_matched_status_t status;
      good(dds_get_subscription_matched_status(readers[i], &status), "status");
      matched += status.current_count > 0;
    }
    if (matched != printed) printf("matched %d\n", matched);
    printed = matched;
    fflush(stdout);
    dds_sleepfor(DDS_MSECS(10));
  }
  dds_delete(participant);
  return 0;
}
