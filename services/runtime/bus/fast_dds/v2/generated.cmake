# SPDX-License-Identifier: Apache-2.0
# What fastddsgen 2 makes of an IDL file: `outputs`, the messages, and `bus_outputs`.
set(fast_dds_words)
set(fast_dds_bus_definitions)
macro(fast_dds_outputs subject)
  set(outputs ${generated}/${subject}.h ${generated}/${subject}.cxx)
  set(bus_outputs ${generated}/${subject}PubSubTypes.h ${generated}/${subject}PubSubTypes.cxx)
endmacro()
