# Fetches the packages that package-lock.json names, once, and bundles the page. Without the registry
# the build goes on: only 'statejump report' is missing then, and says so itself.
foreach(_part package.json package-lock.json build.mjs tsconfig.json NOTICES.txt)
  configure_file("${SOURCE}/${_part}" "${BUILD}/${_part}" COPYONLY)
endforeach()
file(REMOVE_RECURSE "${BUILD}/src")
file(COPY "${SOURCE}/src" DESTINATION "${BUILD}")

file(SHA256 "${SOURCE}/package-lock.json" _wanted)
if(TESTS)
  string(APPEND _wanted " with tests")
endif()
set(_stamp "${BUILD}/node_modules/.statejump-stamp")
set(_present "")
if(EXISTS "${_stamp}")
  file(READ "${_stamp}" _present)
endif()
if(NOT _present STREQUAL _wanted)
  set(_omit --omit=dev)  # playwright and the type checker are for tests
  if(TESTS)
    set(_omit "")
  endif()
  execute_process(
    COMMAND "${NPM}" ci ${_omit} --ignore-scripts --no-audit --no-fund --prefer-offline --loglevel=error
    WORKING_DIRECTORY "${BUILD}" RESULT_VARIABLE _status OUTPUT_VARIABLE _said ERROR_VARIABLE _said)
  if(NOT _status EQUAL 0)
    file(REMOVE "${OUTPUT}/page.js" "${OUTPUT}/page.css" "${OUTPUT}/notices.txt")
    message(WARNING "npm could not fetch the packages of the report page (status ${_status}):\n${_said}\n"
      "'statejump report' does not work in this build; everything else does. Build again when the npm "
      "registry can be reached, or set STATEJUMP_BUILD_REPORT=OFF.")
    return()
  endif()
  file(WRITE "${_stamp}" "${_wanted}")
endif()
execute_process(COMMAND "${NODE}" build.mjs "${OUTPUT}" WORKING_DIRECTORY "${BUILD}" RESULT_VARIABLE _status)
if(NOT _status EQUAL 0)
  message(FATAL_ERROR "the report page could not be bundled")
endif()
