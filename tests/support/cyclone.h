// SPDX-License-Identifier: Apache-2.0
// What every program of Cyclone DDS here needs: to end at a signal, and at an entity that is
// refused.
#pragma once

#include <dds/dds.h>
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>

extern char* program_invocation_short_name;  // of glibc

static volatile sig_atomic_t stop = 0;
static void on_signal(int number) {
  (void)number;
  stop = 1;
}

static dds_entity_t good(dds_entity_t result, const char* what) {
  if (result < 0) {
    fprintf(stderr, "%s: %s: %s\n", program_invocation_short_name, what, dds_strretcode(-result));
    exit(1);
  }
  return result;
}
