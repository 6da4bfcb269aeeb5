// SPDX-License-Identifier: GPL-3.0-or-later
// The interface for which the plugin was compiled, as data. The guard compares it with the running
// libraries. This header and the checks do not depend on the class declarations.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace statejump::yade_abi {

struct DeclaredClass {
  std::string name;  // without the namespace yade
  std::size_t size;  // [byte]
  bool allocated;    // YADE has a function Create<Class>; false: the class occurs only as a base of
                     // others
};

struct DeclaredMember {
  std::string class_name, name;
  std::size_t offset, size;  // [byte]
  std::string type;          // as demangled by the C++ runtime
  bool has_getter;           // plain data member in Boost.Python; false: it is found by its value
};

struct DeclaredInterface {
  std::vector<DeclaredClass> classes;
  std::vector<DeclaredMember> members;
  // Classes whose vtable is compared. Each has an empty derived class, given by its mangled name.
  struct Table {
    std::string class_name, mangled_child;
  };
  std::vector<Table> tables;
  std::size_t view_flag_size;  // size of OpenGLRenderer::initDone [byte]; 0: not used

  // Null if there is none.
  const DeclaredClass* find_class(const std::string& name) const;
  const DeclaredMember* find_member(const std::string& class_name, const std::string& name) const;
};

// Built from the plugin's declarations, or from YADE's own headers if the plugin is compiled with
// them.
DeclaredInterface declared_interface();

// Demangled type name; the name itself if it is not mangled.
std::string demangled(const char* mangled);

}  // namespace statejump::yade_abi
