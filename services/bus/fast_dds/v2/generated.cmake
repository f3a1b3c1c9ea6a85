# SPDX-License-Identifier: Apache-2.0
# What fastddsgen 2 makes of an IDL file: `outputs`, the messages, and `bus_outputs`.
set(fast_dds_words)
set(fast_dds_bus_definitions)
macro(fast_dds_outputs subject)
  set(outputs ${generated}/${subject}.h ${generated}/${subject}.cxx)
  set(bus_outputs ${generated}/${subject}PubSubTypes.h ${generated}/${subject}PubSubTypes.cxx)
endmacro()
# The same for a type that discovery describes, and `tests/<subject>_described.hpp`.
macro(fast_dds_described subject)
  set(described ${generated}/${subject}.cxx ${generated}/${subject}PubSubTypes.cxx
                ${generated}/${subject}TypeObject.cxx)
  set(described_words -typeobject)
  file(CONFIGURE OUTPUT ${generated}/tests/${subject}_described.hpp
       CONTENT "#include \"${subject}PubSubTypes.h\"\n#include \"${subject}TypeObject.h\"\ninline void describe() { register${subject}Types(); }\n")
endmacro()
