# `make package`: a Debian package for the Debian and the YADE that it was built on.
#
# Python packages and yade are the group run of scripts/setup.sh, libraries are found by
# dpkg-shlibdeps. The plugin is built for one binary of YADE, so its version is required exactly.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME statejump)
set(CPACK_PACKAGE_VERSION "${PROJECT_VERSION}")
set(CPACK_PACKAGE_CONTACT "statejump maintainers <statejump@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGE_DIRECTORY "${CMAKE_BINARY_DIR}/package")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_STRIP_FILES ON)
# Paths are written into the launcher at installation, so they must be those of the package: staged
# by DESTDIR, not by another prefix.
set(CPACK_SET_DESTDIR ON)
set(CPACK_INSTALL_PREFIX /usr)

file(STRINGS "${PROJECT_SOURCE_DIR}/scripts/packages/run.txt" _depends)
if(STATEJUMP_BUILD_YADE)
  execute_process(COMMAND dpkg-query --show "--showformat=\${Version}" yade
    OUTPUT_VARIABLE _yade_version RESULT_VARIABLE _status ERROR_QUIET)
  if(_status EQUAL 0)
    list(TRANSFORM _depends REPLACE "^yade$" "yade (= ${_yade_version})")
  endif()
endif()
math(EXPR _next_minor "${Python3_VERSION_MINOR} + 1")
list(APPEND _depends "python3 (>= ${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}~)"
                     "python3 (<< ${Python3_VERSION_MAJOR}.${_next_minor})")
list(JOIN _depends ", " CPACK_DEBIAN_PACKAGE_DEPENDS)
# For statejump laws build; OpenTURNS for statejump rare.
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "g++, libeigen3-dev, libboost-dev, python3-openturns")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# libyade.so has no version in its name; that dependency is the one on yade.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${YADE_LIBRARY_DIR}")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA
  "${PROJECT_SOURCE_DIR}/cmake/debian/postinst" "${PROJECT_SOURCE_DIR}/cmake/debian/prerm")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
include(CPack)
