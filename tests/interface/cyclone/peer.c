// SPDX-License-Identifier: Apache-2.0
// cyclone_peer DOMAIN: a program of another DDS (Cyclone), with types that idlc made from
// idl/control_loop.idl. Until SIGTERM it writes stillhand/motor_command at 1 kHz and reads
// stillhand/platform_command; tells on stdout when it runs, what came first, and how much came in
// all.
#include <inttypes.h>

#include "control_loop.h"
#include "tests/support/cyclone.h"

// What a reader with the profile control_loop asks of a writer: qos/README.md, "From another DDS".
static dds_qos_t* control_loop(void) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
  dds_qset_durability(qos, DDS_DURABILITY_VOLATILE);
  dds_qset_deadline(qos, DDS_USECS(5500));
  dds_qset_liveliness(qos, DDS_LIVELINESS_AUTOMATIC, DDS_MSECS(100));
  return qos;
}

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  signal(SIGTERM, on_signal);
  const dds_entity_t participant =
      good(dds_create_participant((dds_domainid_t)atoi(argv[1]), NULL, NULL), "participant");
  dds_qos_t* qos = control_loop();
  const dds_entity_t command_topic =
      good(dds_create_topic(participant, &stillhand_msgs_MotorCommand_desc,
                            "stillhand/motor_command", NULL, NULL),
           "motor_command");
  const dds_entity_t platform_topic =
      good(dds_create_topic(participant, &stillhand_msgs_PlatformCommand_desc,
                            "stillhand/platform_command", NULL, NULL),
           "platform_command");
  const dds_entity_t writer =
      good(dds_create_writer(participant, command_topic, qos, NULL), "writer");
  const dds_entity_t reader =
      good(dds_create_reader(participant, platform_topic, qos, NULL), "reader");
  dds_delete_qos(qos);

  stillhand_msgs_MotorCommand command = {.rig = 1,
                                         .tick = 7,
                                         .stamp_ns = 8,
                                         .acquired_ns = 9,
                                         .force_n = -1.5,
                                         .predicted_force_n = 2.25,
                                         .gain_weight = 0.5,
                                         .phase_weight = 0.125,
                                         .model = 4,
                                         .enabled = true,
                                         .permitted = false,
                                         .flags = 6};
  int64_t written = 0;
  int64_t received = 0;
  while (!stop) {
    if (dds_write(writer, &command) == DDS_RETCODE_OK && ++written == 1) {
      printf("running\n");
      fflush(stdout);
    }
    void* samples[16] = {NULL};
    dds_sample_info_t infos[16];
    const int32_t count = dds_take(reader, samples, infos, 16, 16);
    for (int32_t i = 0; i < count; ++i) {
      if (!infos[i].valid_data || ++received > 1) continue;
      const stillhand_msgs_PlatformCommand* first = samples[i];
      printf("first %" PRIu32 " %" PRId64 " %" PRId64 " %g %g %g %" PRId32 " %" PRIu32 "\n",
             first->rig, first->tick, first->stamp_ns, first->position_m, first->velocity_m_s,
             first->acceleration_m_s2, first->trial, first->flags);
      fflush(stdout);
    }
    if (count > 0) dds_return_loan(reader, samples, count);
    dds_sleepfor(DDS_MSECS(1));
  }
  printf("received %" PRId64 " written %" PRId64 "\n", received, written);
  dds_delete(participant);
  return 0;
}
