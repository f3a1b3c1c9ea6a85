// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <cstdlib>

/// A broken precondition is a bug of the caller: prints its place and aborts.  For a mistake that
/// the operator can correct, throw ConfigError; for bad input during a run, set a Flag.
#define STILLHAND_EXPECTS(condition)                                                            \
  do {                                                                                          \
    if (!(condition)) {                                                                         \
      std::fprintf(stderr, "%s:%d: broken precondition: %s\n", __FILE__, __LINE__, #condition); \
      std::abort();                                                                             \
    }                                                                                           \
  } while (false)
