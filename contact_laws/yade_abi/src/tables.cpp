// SPDX-License-Identifier: GPL-3.0-or-later
// Reads object sizes and vtables from the code and data of YADE's libraries.
#include <dlfcn.h>
#include <elf.h>
#include <link.h>

#include <array>
#include <sstream>
#include <utility>

#include "checks.hpp"
#include "memory.hpp"

namespace statejump::yade_abi {
namespace {

// Size that YADE allocates. yade::Create<Class>() starts with operator new(sizeof(Class)), whose
// argument is an immediate operand: mov edi, imm32 (opcode bf), then call (e8).
std::size_t allocated_size(const std::string& class_name) {
  const auto* code = static_cast<const unsigned char*>(
      symbol("_ZN4yade" + mangled_name("Create" + class_name) + "Ev"));
  if (!code) return 0;
  for (int i = 0; i < 64; ++i) {
    if (code[i] != 0xbf) continue;
    std::uint32_t size;
    std::memcpy(&size, code + i + 1, sizeof size);
    for (int j = i + 5; j < i + 32; ++j) {
      if (code[j] == 0xe8) return size;
    }
  }
  return 0;
}

// Size [byte] of the symbol that starts at an address; 0 if there is no such symbol.
std::size_t symbol_size(const void* address) {
  Dl_info info;
  ElfW(Sym)* found = nullptr;
  if (!address || !dladdr1(address, &info, reinterpret_cast<void**>(&found), RTLD_DL_SYMENT) ||
      !found || info.dli_saddr != address) {
    return 0;
  }
  return found->st_size;
}

// Vtable entries that every class defines itself: type information, destructors, and thunks of
// destructors for second bases. They are looked up by name, because finding the name of an address
// is slow.
// @param name mangled name without enclosing N and E
struct OwnEntries {
  OwnEntries(const void* (*find)(const std::string&), const std::string& name) {
    std::size_t i = 0;
    for (const char* prefix : {"_ZN", "_ZThn24_N", "_ZThn80_N"}) {
      for (const char* suffix : {"D0Ev", "D1Ev", "D2Ev"}) {
        entries[i++] = find(prefix + name + suffix);
      }
    }
    entries[i] = find("_ZTIN" + name + "E");
  }
  // Returns whether two entries have the same role in their classes. The complete destructor (D1)
  // and the base destructor (D2) of a class may be the same function.
  bool same_role(const void* entry, const OwnEntries& other, const void* other_entry) const {
    for (std::size_t i = 0; i < entries.size(); ++i) {
      if (entry && entry == entries[i] && other_entry && other_entry == other.entries[i]) {
        return true;
      }
    }
    return false;
  }
  std::array<const void*, 10> entries{};
};

std::string table_difference(const DeclaredInterface::Table& declared) {
  const std::string name = "4yade" + mangled_name(declared.class_name);
  // The mangled name without the enclosing N and E.
  const std::string child = declared.mangled_child.substr(1, declared.mangled_child.size() - 2);
  const auto* library = static_cast<const void* const*>(symbol("_ZTVN" + name + "E"));
  const std::size_t length = symbol_size(library) / sizeof(void*);
  if (length == 0)
    return "the table of virtual functions of " + declared.class_name +
           " is not in YADE's libraries";
  const auto* ours = static_cast<const void* const*>(own_symbol("_ZTVN" + child + "E"));
  const std::size_t our_length = symbol_size(ours) / sizeof(void*);
  if (our_length != length) {
    std::ostringstream text;
    text << "the table of virtual functions of " << declared.class_name << " has " << length
         << " entries, declared " << our_length;
    return text.str();
  }
  const OwnEntries of_library(symbol, name), of_child(own_symbol, child);
  for (std::size_t i = 0; i < length; ++i) {
    if (library[i] == ours[i] || of_library.same_role(library[i], of_child, ours[i])) continue;
    std::ostringstream text;
    text << "entry " << i << " of the table of virtual functions of " << declared.class_name
         << " differs from the declared one";
    return text.str();
  }
  return "";
}

}  // namespace

std::string size_difference(const DeclaredInterface& declared) {
  for (const auto& one : declared.classes) {
    const std::size_t found = one.allocated ? allocated_size(one.name) : one.size;
    if (found == one.size) continue;
    std::ostringstream text;
    text << "size of " << one.name << " is " << found << " bytes, declared " << one.size;
    return text.str();
  }
  return "";
}

std::string table_difference(const DeclaredInterface& declared) {
  for (const auto& one : declared.tables) {
    if (std::string difference = table_difference(one); !difference.empty()) return difference;
  }
  // A static member has no offset, so its size in the symbol table is checked.
  if (declared.view_flag_size != 0 &&
      symbol_size(symbol("_ZN4yade14OpenGLRenderer8initDoneE")) != declared.view_flag_size) {
    return "OpenGLRenderer.initDone is not the flag that is declared";
  }
  return "";
}

}  // namespace statejump::yade_abi
