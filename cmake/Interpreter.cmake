# Finds the Python that the engine's module is built for (Python3_*) and refuses any other.
#
# YADE's Python modules are linked against one Boost.Python, and so against one Python minor version. Debian's YADE uses
# Debian's /usr/bin/python3, whatever python3 comes first on PATH. Without YADE the first python3 on PATH is used.
set(STATEJUMP_OLDEST_PYTHON 3.11)
if(STATEJUMP_BUILD_YADE)
  set(_python /usr/bin/python3)
else()
  # The interpreter reports its own path: the python3 of pyenv is a script that chooses one.
  execute_process(COMMAND python3 -c "import sys; print(sys.executable)"
    OUTPUT_VARIABLE _python OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
set(STATEJUMP_PYTHON "${_python}" CACHE FILEPATH "The interpreter to build for; with YADE the one that YADE was built for")
if(NOT EXISTS "${STATEJUMP_PYTHON}")
  message(FATAL_ERROR "STATEJUMP_PYTHON=${STATEJUMP_PYTHON} does not exist; "
                      "set it to the Python that YADE was built for, on Debian /usr/bin/python3, "
                      "or without YADE to any CPython from ${STATEJUMP_OLDEST_PYTHON} on")
endif()
set(Python3_EXECUTABLE "${STATEJUMP_PYTHON}")
find_package(Python3 REQUIRED COMPONENTS Interpreter Development.Module)
set(Python_EXECUTABLE "${STATEJUMP_PYTHON}")
if(Python3_VERSION VERSION_LESS STATEJUMP_OLDEST_PYTHON)
  message(FATAL_ERROR "${STATEJUMP_PYTHON} is Python ${Python3_VERSION}, needed is ${STATEJUMP_OLDEST_PYTHON} or later; "
                      "set -DSTATEJUMP_PYTHON=<path of another interpreter>")
endif()

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

# Debian's Python imports from lib/pythonX/dist-packages below /usr and from lib/pythonX.Y/dist-packages below another
# prefix, other Pythons from site-packages. The prefix may be chosen at installation time, so the folder is set then.
execute_process(COMMAND "${STATEJUMP_PYTHON}" -c "import sysconfig; print(sysconfig.get_path('purelib'))"
  OUTPUT_VARIABLE _packages COMMAND_ERROR_IS_FATAL ANY)
set(_site "lib/python${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}")
if(STATEJUMP_WHEEL)
  set(_code "set(STATEJUMP_SITE .)")
elseif(_packages MATCHES "dist-packages")
  set(_code "
    if(CMAKE_INSTALL_PREFIX STREQUAL \"/usr\")
      set(STATEJUMP_SITE \"lib/python${Python3_VERSION_MAJOR}/dist-packages\")
    else()
      set(STATEJUMP_SITE \"${_site}/dist-packages\")
    endif()")
else()
  set(_code "set(STATEJUMP_SITE \"${_site}/site-packages\")")
endif()
install(CODE "${_code}")
set(STATEJUMP_INSTALL_PYTHON_DIR "\${STATEJUMP_SITE}")
