# Writes HEADER with the hash of the kernel headers below FOLDER: cmake -DFOLDER= -DHEADER= -P.
# python/statejump/laws/build.py computes the same.
file(GLOB_RECURSE _headers RELATIVE "${FOLDER}" "${FOLDER}/*.hpp")
list(SORT _headers COMPARE STRING)
set(_lines "")
foreach(_header IN LISTS _headers)
  file(SHA256 "${FOLDER}/${_header}" _hash)
  string(APPEND _lines "${_header} ${_hash}\n")
endforeach()
string(SHA256 _hash "${_lines}")
file(CONFIGURE OUTPUT "${HEADER}" @ONLY CONTENT [[
#pragma once
namespace statejump::law_loader {
inline constexpr const char* hash_of_the_kernel_headers = "@_hash@";
}
]])
