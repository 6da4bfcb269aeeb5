# Which YADE is installed, and which variant of the declared interface it has.
#
# contact_laws/yade_abi/known_binaries.csv has one row for each known binary: the build identifiers of
# its libraries decide. Sets YADE_LIBRARY_DIR, STATEJUMP_YADE_VARIANT and STATEJUMP_YADE_NAME, and
# writes below STATEJUMP_YADE_GENERATED what the guard reads: the table of binaries with the place of
# the row, and the measured layout of the variant.
option(STATEJUMP_MEASURE_YADE
       "Accept a YADE with unknown build identifiers if scripts/measure_yade finds a known interface in it" OFF)
set(YADE_LIBRARY_DIR "/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/yade-double" CACHE PATH
    "Folder of libyade.so, libpkg_common.so and libpkg_dem.so")
set(YADE_COMMAND "" CACHE STRING "Command that starts this YADE, for STATEJUMP_MEASURE_YADE; by default bin/yade of its prefix")
set(STATEJUMP_YADE_ABI "${PROJECT_SOURCE_DIR}/contact_laws/yade_abi")
set(STATEJUMP_YADE_GENERATED "${PROJECT_BINARY_DIR}/yade_abi")

# The measured layout of a variant as calls of macros, for layout_checks.hpp and declared.cpp.
function(statejump_write_layout variant folder)
  set(_text "")
  set(_table "${STATEJUMP_YADE_ABI}/variants/${variant}_members.csv")
  set_property(DIRECTORY "${PROJECT_SOURCE_DIR}" APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${_table}")
  file(STRINGS "${_table}" _rows)
  list(REMOVE_AT _rows 0)
  foreach(_row IN LISTS _rows)
    if(_row MATCHES "^([^,]+),,,([0-9]+),(allocation|place),")
      if(CMAKE_MATCH_3 STREQUAL "allocation")
        set(_allocated true)
      else()
        set(_allocated false)
      endif()
      string(APPEND _text "STATEJUMP_CLASS(${CMAKE_MATCH_1}, ${CMAKE_MATCH_2}, ${_allocated})\n")
    elseif(_row MATCHES "^([^,]+),([^,]+),([0-9]+),([0-9]+),(getter|value),(public|private),")
      if(CMAKE_MATCH_5 STREQUAL "getter")
        set(_getter true)
      else()
        set(_getter false)
      endif()
      if(CMAKE_MATCH_6 STREQUAL "private")
        set(_macro STATEJUMP_PRIVATE_MEMBER)
      else()
        set(_macro STATEJUMP_MEMBER)
      endif()
      string(APPEND _text
        "${_macro}(${CMAKE_MATCH_1}, ${CMAKE_MATCH_2}, ${CMAKE_MATCH_3}, ${CMAKE_MATCH_4}, ${_getter})\n")
    else()
      message(FATAL_ERROR "${variant}_members.csv: this is no row of the table: ${_row}")
    endif()
  endforeach()
  file(CONFIGURE OUTPUT "${folder}/statejump/yade_abi/measured_layout.inc" CONTENT "${_text}" @ONLY)
endfunction()

# The build identifier of a library, empty when it has none.
function(statejump_build_id library result)
  execute_process(COMMAND readelf -n "${library}" OUTPUT_VARIABLE _notes COMMAND_ERROR_IS_FATAL ANY)
  if(_notes MATCHES "Build ID: ([0-9a-f]+)")
    set(${result} "${CMAKE_MATCH_1}" PARENT_SCOPE)
  else()
    set(${result} "" PARENT_SCOPE)
  endif()
endfunction()

file(STRINGS "${STATEJUMP_YADE_ABI}/known_binaries.csv" _rows)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${STATEJUMP_YADE_ABI}/known_binaries.csv")
list(POP_FRONT _rows _header)
if(NOT _header STREQUAL "release,version,variant,run,libyade,libpkg_common,libpkg_dem")
  message(FATAL_ERROR "known_binaries.csv has other columns than this build reads: ${_header}")
endif()

if(YADE_SOURCE_DIR)
  # YADE's own headers: nothing has to be known beforehand.
  set(_place -1)
  set(STATEJUMP_YADE_NAME "the YADE of ${YADE_SOURCE_DIR}")
  set(STATEJUMP_YADE_VARIANT 202302)  # whose classes and members the guard looks at, by name
else()
  set(_ids "")
  foreach(_library libyade libpkg_common libpkg_dem)
    if(NOT EXISTS "${YADE_LIBRARY_DIR}/${_library}.so")
      message(FATAL_ERROR "YADE is missing: no ${_library}.so in ${YADE_LIBRARY_DIR}; "
                          "install Debian's package 'yade' or set YADE_LIBRARY_DIR")
    endif()
    statejump_build_id("${YADE_LIBRARY_DIR}/${_library}.so" _id)
    list(APPEND _ids "${_id}")
  endforeach()
  list(JOIN _ids "," _ids)
  set(_place -1)
  set(_index 0)
  foreach(_row IN LISTS _rows)
    if(_row MATCHES "^([^,]+),([^,]+),([0-9]+),[a-z]+,${_ids}$")
      set(_place ${_index})
      set(STATEJUMP_YADE_NAME "YADE ${CMAKE_MATCH_2} of ${CMAKE_MATCH_1}")
      set(STATEJUMP_YADE_VARIANT "${CMAKE_MATCH_3}")
    endif()
    math(EXPR _index "${_index} + 1")
  endforeach()
  set(_measure "${PROJECT_SOURCE_DIR}/scripts/measure_yade")
  if(_place EQUAL -1 AND STATEJUMP_MEASURE_YADE)
    set(_command "")
    if(YADE_COMMAND)
      set(_command --yade "${YADE_COMMAND}")
    endif()
    execute_process(COMMAND "${_measure}" "${YADE_LIBRARY_DIR}" --variant-only ${_command}
      OUTPUT_VARIABLE STATEJUMP_YADE_VARIANT OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE _status)
    if(NOT _status EQUAL 0)
      message(FATAL_ERROR "the interface of YADE in ${YADE_LIBRARY_DIR} is none of the known ones; "
                          "${_measure} ${YADE_LIBRARY_DIR} lists the differences")
    endif()
    set(_place ${_index})
    set(STATEJUMP_YADE_NAME "YADE in ${YADE_LIBRARY_DIR}, measured on this machine")
    list(APPEND _rows "this machine,(measured),${STATEJUMP_YADE_VARIANT},tested,${_ids}")
  elseif(_place EQUAL -1)
    message(FATAL_ERROR "YADE in ${YADE_LIBRARY_DIR} is none of the known binaries (build identifiers "
      "${_ids}); run ${_measure} ${YADE_LIBRARY_DIR}, and if it finds a known interface, configure with "
      "-DSTATEJUMP_MEASURE_YADE=ON, else with -DYADE_SOURCE_DIR=<YADE sources>")
  endif()
endif()
message(STATUS "Plugin for ${STATEJUMP_YADE_NAME}, interface variant ${STATEJUMP_YADE_VARIANT}")

list(LENGTH _rows _count)
set(_text "constexpr std::array<KnownBinary, ${_count}> known_binaries = {{\n")
foreach(_row IN LISTS _rows)
  string(REGEX REPLACE "^([^,]+),([^,]+),[^,]+,[^,]+,([^,]+),([^,]+),([^,]+)$"
    "    {\"\\1\", \"\\2\", {\"\\3\", \"\\4\", \"\\5\"}},\n" _line "${_row}")
  string(APPEND _text "${_line}")
endforeach()
string(APPEND _text "}};\nconstexpr int built_for_row = ${_place};\n")
file(CONFIGURE OUTPUT "${STATEJUMP_YADE_GENERATED}/statejump/yade_abi/known_binaries.inc"
     CONTENT "${_text}" @ONLY)
statejump_write_layout("${STATEJUMP_YADE_VARIANT}" "${STATEJUMP_YADE_GENERATED}")
