// SPDX-License-Identifier: GPL-3.0-or-later
// The interface that the plugin was compiled with, as data: what the guard compares with the
// running libraries. It knows nothing of how the classes are declared, so the checks do not depend
// on the declarations that they check.
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
  // Classes whose table of virtual functions is compared, each with the mangled name of a child
  // that does nothing.
  struct Table {
    std::string class_name, mangled_child;
  };
  std::vector<Table> tables;
  std::size_t view_flag_size;  // of OpenGLRenderer::initDone [byte]; 0: not used

  // Null when there is none.
  const DeclaredClass* find_class(const std::string& name) const;
  const DeclaredMember* find_member(const std::string& class_name, const std::string& name) const;
};

// From the declarations, or from YADE's own headers where the plugin is built against those.
DeclaredInterface declared_interface();

// A mangled name of a type as the C++ runtime spells it; the name itself where it is none.
std::string demangled(const char* mangled);

}  // namespace statejump::yade_abi
