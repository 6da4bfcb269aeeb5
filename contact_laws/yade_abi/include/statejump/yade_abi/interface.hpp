// SPDX-License-Identifier: GPL-3.0-or-later
// The interface for which the plugin was compiled, as data. The guard compares it with the running
// libraries. It does not depend on the declarations of the classes, so neither do the checks.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace statejump::yade_abi {

struct DeclaredClass {
  std::string name;  // without the namespace yade
  std::size_t size;  // [byte]
  bool allocated;    // YADE has a function Create<Class>; else the class is only a part of others
};

struct DeclaredMember {
  std::string class_name, name;
  std::size_t offset, size;  // [byte]
  std::string type;          // as the C++ runtime spells it
  bool has_getter;           // a plain data member for Boost.Python; else it is found by its value
};

struct DeclaredInterface {
  std::vector<DeclaredClass> classes;
  std::vector<DeclaredMember> members;
  // Classes whose table of virtual functions is compared, each with the mangled name of a
  // do-nothing child.
  struct Table {
    std::string class_name, mangled_child;
  };
  std::vector<Table> tables;
  std::size_t view_flag_size;  // of OpenGLRenderer::initDone [byte]; 0: not used

  // Null when there is none.
  const DeclaredClass* find_class(const std::string& name) const;
  const DeclaredMember* find_member(const std::string& class_name, const std::string& name) const;
};

// Made from the declarations, or from YADE's own headers if the plugin is built against those.
DeclaredInterface declared_interface();

// The readable form of a mangled type name; the name itself if it is not mangled.
std::string demangled(const char* mangled);

}  // namespace statejump::yade_abi
