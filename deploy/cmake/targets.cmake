# SPDX-License-Identifier: Apache-2.0
# How the project's libraries and programs are declared.

# Headers that many files read, compiled once; a target names one with PCH.  Each kind is compiled
# once, by an empty library, and shared by every target that names it.
function(stillhand_precompiled kind)
  cmake_parse_arguments(arg "" "" "HEADERS;LINK" ${ARGN})
  set(empty ${PROJECT_BINARY_DIR}/generated/precompiled_${kind}.cpp)
  if(NOT EXISTS ${empty})
    file(WRITE ${empty} "")
  endif()
  add_library(stillhand_precompiled_${kind} OBJECT ${empty})
  target_link_libraries(stillhand_precompiled_${kind} PRIVATE stillhand_options ${arg_LINK})
  target_precompile_headers(stillhand_precompiled_${kind} PRIVATE ${arg_HEADERS})
  # Their definitions are part of the compiled header: each target that uses it needs them.
  set_property(GLOBAL PROPERTY stillhand_precompiled_${kind}_link ${arg_LINK})
endfunction()
function(stillhand_use_precompiled target kind)
  target_precompile_headers(${target} REUSE_FROM stillhand_precompiled_${kind})
  get_property(link GLOBAL PROPERTY stillhand_precompiled_${kind}_link)
  target_link_libraries(${target} PRIVATE ${link})
endfunction()

# stillhand_library(<target> <folder> [FILES <file>...] [EXCEPT <folder>] [PCH <kind>] [LINK ...] [PRIVATE ...]):
# the .cpp files of a folder and of the folders in it, but not those in <folder>/EXCEPT nor
# <folder>/EXCEPT.cpp, a regular expression; or the files named.  Paths are relative to the caller.  A new file needs no edit.
function(stillhand_library target folder)
  cmake_parse_arguments(arg "" "PCH;EXCEPT" "FILES;LINK;PRIVATE" ${ARGN})
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
  if(arg_PCH)
    stillhand_use_precompiled(${target} ${arg_PCH})
  endif()
endfunction()
