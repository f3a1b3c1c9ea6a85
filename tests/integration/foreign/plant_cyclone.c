// SPDX-License-Identifier: Apache-2.0
// plant_cyclone DOMAIN [plain]: the same with Cyclone DDS: one type with a key in plain CDR, one
// that may grow, in XCDR 2, for which "plain" waits for no reader.
#include <stdbool.h>

#include "plant.h"
#include "tests/support/cyclone.h"

enum { kCount = 60 };

static bool has_reader(dds_entity_t writer) {
  dds_publication_matched_status_t status;
  return dds_get_publication_matched_status(writer, &status) == DDS_RETCODE_OK &&
         status.current_count > 0;
}

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  signal(SIGTERM, on_signal);
  const dds_entity_t participant =
      good(dds_create_participant((dds_domainid_t)atoi(argv[1]), NULL, NULL), "participant");
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(10));
  dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
  dds_qset_deadline(qos, DDS_SECS(100));
  const dds_entity_t states =
      good(dds_create_writer(
               participant,
               good(dds_create_topic(participant, &plant_State_desc, "plant/state", NULL, NULL),
                    "state"),
               qos, NULL),
           "writer");
  const dds_entity_t growing =
      good(dds_create_writer(
               participant,
               good(dds_create_topic(participant, &plant_Growing_desc, "plant/growing", NULL, NULL),
                    "growing"),
               qos, NULL),
           "writer");
  dds_delete_qos(qos);
  const dds_time_t limit = dds_time() + DDS_SECS(60);
  while (!stop && !(has_reader(states) && (argc > 2 || has_reader(growing)))) {
    if (dds_time() > limit) return 1;
    dds_sleepfor(DDS_MSECS(10));
  }
  plant_Joint joints[3] = {{1.0, {1, 2, 3}}, {2.0, {4, 5, 6}}, {3.0, {7, 8, 9}}};
  double gains[2] = {0.25, 0.0};
  for (int i = 0; i < kCount && !stop; ++i) {
    gains[1] = -i;
    plant_State state = {.arm = (uint32_t)i % 3,
                         .tick = i,
                         .mode = plant_MOVING,
                         .joint = {0.5 * i, {1, 2, 3}},
                         .name = "arm",
                         .ready = true};
    state.others._length = (uint32_t)i % 4;
    state.others._buffer = joints;
    state.gains._length = 2;
    state.gains._buffer = gains;
    char note[kCount + 1] = "";
    for (int j = 0; j < i; ++j) note[j] = 'x';
    const plant_Growing grown = {.count = (uint32_t)i, .note = note};
    good(dds_write(states, &state), "write");
    good(dds_write(growing, &grown), "write");
    // Ends of instances take numbers of the sequence, and are no samples.
    if (i % 20 == 10) good(dds_dispose(states, &state), "dispose");
    if (i % 20 == 15) good(dds_unregister_instance(states, &state), "unregister");
  }
  good(dds_wait_for_acks(states, DDS_SECS(10)), "acknowledgements");
  good(dds_wait_for_acks(growing, DDS_SECS(10)), "acknowledgements");
  printf("written %d\n", kCount);
  fflush(stdout);
  while (!stop) dds_sleepfor(DDS_MSECS(10));
  dds_delete(participant);
  return 0;
}
