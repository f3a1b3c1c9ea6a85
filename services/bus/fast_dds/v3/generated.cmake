# SPDX-License-Identifier: Apache-2.0
# What fastddsgen 4 makes of an IDL file: `outputs`, the messages, and `bus_outputs`.
# As fastddsgen 2: types are final, and discovery does not describe them.
set(fast_dds_words -default_extensibility final -no-typeobjectsupport)
set(fast_dds_bus_definitions)
# The tinyxml2 that Fast DDS 3 brings wants this.
target_compile_definitions(stillhand_options INTERFACE _FILE_OFFSET_BITS=64)
macro(fast_dds_outputs subject)
  set(outputs ${generated}/${subject}.hpp ${generated}/${subject}CdrAux.ipp)
  set(bus_outputs ${generated}/${subject}PubSubTypes.hpp ${generated}/${subject}PubSubTypes.cxx)
  # Headers by the names, and enumerators in the scope, that fastddsgen 2 gives them.
  file(READ ${CMAKE_CURRENT_SOURCE_DIR}/${subject}.idl enums)
  string(REGEX MATCHALL "\nenum [A-Za-z]+" enums "${enums}")
  list(TRANSFORM enums REPLACE "\n" "\nusing ")
  string(REPLACE ";" "; " enums "${enums};")
  file(CONFIGURE OUTPUT ${generated}/${subject}.h
       CONTENT "#pragma once\n#include \"${subject}.hpp\"\nnamespace stillhand_msgs { ${enums} }\n")
  file(CONFIGURE OUTPUT ${generated}/${subject}PubSubTypes.h
       CONTENT "#pragma once\n#include \"${subject}.h\"\n#include \"${subject}PubSubTypes.hpp\"\n")
  # The messages' CDR belongs to the messages, which need no Fast DDS; the bus's file holds it, too.
  file(CONFIGURE OUTPUT ${generated}/${subject}Cdr.cpp CONTENT "#include \"${subject}CdrAux.ipp\"\n")
  list(APPEND types ${generated}/${subject}Cdr.cpp)
  string(TOUPPER ${subject} guard)
  list(APPEND fast_dds_bus_definitions FAST_DDS_GENERATED__STILLHAND_MSGS_${guard}CDRAUX_IPP)
endmacro()
# The same for a type that discovery describes, and `tests/<subject>_described.hpp`.
macro(fast_dds_described subject)
  set(described ${generated}/${subject}PubSubTypes.cxx ${generated}/${subject}TypeObjectSupport.cxx)
  set(described_words)
  file(CONFIGURE OUTPUT ${generated}/tests/${subject}_described.hpp
       CONTENT "#include \"${subject}PubSubTypes.hpp\"\ninline void describe() {}\n")
endmacro()
