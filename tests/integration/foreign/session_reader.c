// SPDX-License-Identifier: Apache-2.0
// session_reader DOMAIN: reads stillhand/event with Cyclone DDS as a late joiner does, and prints
// which processes' status it hears. Its reader of the status comes second, so a process that writes
// to it knows its reader of events.
#include "session.h"
#include "tests/support/cyclone.h"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  signal(SIGTERM, on_signal);
  const dds_entity_t participant =
      good(dds_create_participant((dds_domainid_t)atoi(argv[1]), NULL, NULL), "participant");
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
  good(dds_create_reader(participant,
                         good(dds_create_topic(participant, &stillhand_msgs_Event_desc,
                                               "stillhand/event", NULL, NULL),
                              "event"),
                         qos, NULL),
       "reader");
  dds_delete_qos(qos);
  const dds_entity_t reader =
      good(dds_create_reader(participant,
                             good(dds_create_topic(participant, &stillhand_msgs_ServiceStatus_desc,
                                                   "stillhand/service_status", NULL, NULL),
                                  "service_status"),
                             NULL, NULL),
           "reader");
  while (!stop) {
    void* sample[1] = {NULL};
    dds_sample_info_t info;
    if (good(dds_take(reader, sample, &info, 1, 1), "take") > 0) {
      const stillhand_msgs_ServiceStatus* status = sample[0];
      if (info.valid_data) printf("heard %s\n", status->service);
      fflush(stdout);
      good(dds_return_loan(reader, sample, 1), "loan");
    } else {
      dds_sleepfor(DDS_MSECS(10));
    }
  }
  dds_delete(participant);
  return 0;
}
