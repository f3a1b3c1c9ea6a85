# SPDX-License-Identifier: Apache-2.0
# How the project's libraries and programs are declared.

# stillhand_library(<target> <folder> [FILES <file>...] [EXCEPT <folder>] [LINK ...] [PRIVATE ...]):
# the .cpp files of a folder and of the folders in it, but not those in <folder>/EXCEPT nor
# <folder>/EXCEPT.cpp, a regular expression; or the files named.  Paths are relative to the caller.  A new file needs no edit.
function(stillhand_library target folder)
  cmake_parse_arguments(arg "" "EXCEPT" "FILES;LINK;PRIVATE" ${ARGN})
  set(here ${CMAKE_CURRENT_SOURCE_DIR}/${folder})
  if(arg_FILES)
    list(TRANSFORM arg_FILES PREPEND ${here}/ OUTPUT_VARIABLE sources)
  else()
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${here}/*.cpp)
    if(arg_EXCEPT)
      list(FILTER sources EXCLUDE REGEX "^${here}/${arg_EXCEPT}(/|[.]cpp$)")
    endif()
  endif()
  add_library(${target} STATIC ${sources})
  target_link_libraries(${target} PUBLIC stillhand_contract ${arg_LINK} PRIVATE ${arg_PRIVATE})
endfunction()
