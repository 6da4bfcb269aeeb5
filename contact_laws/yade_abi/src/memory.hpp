// SPDX-License-Identifier: GPL-3.0-or-later
// Reads memory and symbols of the running process without the risk of a crash.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

namespace statejump::yade_abi {

using Word = std::uint64_t;

// Reads memory through a pipe. For an unreadable address the kernel then returns an error. A plain
// read would end the process.
class Memory {
 public:
  Memory();
  ~Memory();
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;

  bool copy(const void* from, void* to, std::size_t bytes) const;
  std::optional<Word> word(Word address) const;
  // Null-terminated text at an address. Returns nothing if it is unreadable or longer than any
  // name.
  std::optional<std::string> text(Word address) const;

 private:
  int ends_[2];
};

inline Word address_of(const void* place) {
  return reinterpret_cast<std::uintptr_t>(place);
}

template <class Type>
Type read_as(const char* place) {
  Type value;
  std::memcpy(&value, place, sizeof value);
  return value;
}

// Class name as it appears in mangled names of the namespace yade, e.g. "5State".
std::string mangled_name(const std::string& class_name);
// Address of a symbol in the libraries that YADE has loaded; null if the symbol does not exist.
const void* symbol(const std::string& name);
// Address of a symbol of this module; null if the symbol does not exist.
const void* own_symbol(const std::string& name);

// A function of YADE, found by its symbol; null if missing. The guard calls YADE only in this way,
// so a wrong declaration cannot change which function is called or how.
template <class Function>
Function* function(const std::string& name) {
  return reinterpret_cast<Function*>(const_cast<void*>(symbol(name)));
}

// Vtable pointer (first word) of objects of a class; 0 if YADE has no such class.
Word table_pointer(const std::string& class_name);

}  // namespace statejump::yade_abi
