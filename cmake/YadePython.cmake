# Finds the Python that YADE was built for and refuses any other.
#
# YADE's Python modules are linked against one Boost.Python, and so against one Python minor version.
# Debian's YADE uses Debian's /usr/bin/python3, whatever python3 comes first on PATH.
set(STATEJUMP_PYTHON "/usr/bin/python3" CACHE FILEPATH "The interpreter that YADE was built for")
if(NOT EXISTS "${STATEJUMP_PYTHON}")
  message(FATAL_ERROR "STATEJUMP_PYTHON=${STATEJUMP_PYTHON} does not exist; "
                      "needed is the Python that YADE was built for, on Debian /usr/bin/python3")
endif()
set(Python3_EXECUTABLE "${STATEJUMP_PYTHON}")
find_package(Python3 REQUIRED COMPONENTS Interpreter Development.Module)
set(Python_EXECUTABLE "${STATEJUMP_PYTHON}")

if(STATEJUMP_BUILD_YADE AND NOT YADE_SOURCE_DIR)
  execute_process(COMMAND readelf -d "${YADE_LIBRARY_DIR}/libpkg_dem.so"
                  OUTPUT_VARIABLE _needed COMMAND_ERROR_IS_FATAL ANY)
  if(NOT _needed MATCHES "libboost_python([0-9])([0-9]+)\\.so")
    message(FATAL_ERROR "${YADE_LIBRARY_DIR}/libpkg_dem.so is not linked against Boost.Python")
  endif()
  set(_wanted "${CMAKE_MATCH_1}.${CMAKE_MATCH_2}")
  set(_found "${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}")
  if(NOT _wanted STREQUAL _found)
    message(FATAL_ERROR "wrong Python: found ${STATEJUMP_PYTHON} (${Python3_VERSION}), needed is "
                        "Python ${_wanted}, for which YADE in ${YADE_LIBRARY_DIR} was built; "
                        "set -DSTATEJUMP_PYTHON=<path of that interpreter>")
  endif()
endif()
