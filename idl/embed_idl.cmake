# SPDX-License-Identifier: Apache-2.0
# Writes ${OUT}: the text of each IDL file of ${FOLDER} as a raw string literal.
set(text "#include \"idl/idl_text.hpp\"\n\nnamespace stillhand::topics {\n")
string(APPEND text "static constexpr std::string_view kTexts[]{\n")
file(GLOB files ${FOLDER}/*.idl)
foreach(idl_file ${files})
  file(READ ${idl_file} body)
  string(APPEND text "R\"IDL(${body})IDL\",\n")
endforeach()
string(APPEND text "};\nconst std::span<const std::string_view> kIdlTexts = kTexts;\n}  // namespace stillhand::topics\n")
file(WRITE ${OUT} "${text}")
