# SPDX-License-Identifier: Apache-2.0
# Writes ${OUT}: the text of each IDL file as a raw string literal.
set(text "#include \"idl/idl_text.hpp\"\n\nnamespace stillhand::topics {\n")
foreach(subject control_loop session model clock recording)
  file(READ ${FOLDER}/${subject}.idl body)
  string(APPEND text "const std::string_view k_${subject}_idl = R\"IDL(${body})IDL\";\n")
endforeach()
string(APPEND text "}  // namespace stillhand::topics\n")
string(REPLACE "k_control_loop_idl" "kControlLoopIdl" text "${text}")
string(REPLACE "k_session_idl" "kSessionIdl" text "${text}")
string(REPLACE "k_model_idl" "kModelIdl" text "${text}")
string(REPLACE "k_clock_idl" "kClockIdl" text "${text}")
string(REPLACE "k_recording_idl" "kRecordingIdl" text "${text}")
file(WRITE ${OUT} "${text}")
