// SPDX-License-Identifier: GPL-3.0-or-later
// Offsets and types of data members, read from the pointers to member that Boost.Python stores.
//
// A plain attribute of a class is a Python property. Its fget is a function object of Boost.Python:
// the head of every Python object, then a pointer to an object of the class
// caller_py_function_impl<caller<member<Type, Class>, ...>>. The vtable of that class leads to its
// type. Its first member is the pointer to member, which is the offset. This is an internal of
// Boost.Python. So the same code first reads a member of the plugin, and the name of every type
// must be spelt as expected.
#include <boost/python.hpp>
#include <optional>
#include <sstream>

#include "checks.hpp"
#include "memory.hpp"

namespace statejump::yade_abi {

// A getter of a class of the plugin. It is read first, to check that getters can be read.
struct KnownMember {
  long first;
  double second;
};

namespace {

namespace py = boost::python;

const std::string beginning =
    "boost::python::objects::caller_py_function_impl<boost::python::detail::caller<"
    "boost::python::detail::member<";

struct Getter {
  std::string type;    // type of the function object, from the C++ runtime
  std::size_t offset;  // [byte]
};

// Returns nothing if `function` is not a getter of the expected form.
std::optional<Getter> read_getter(const Memory& memory, const py::object& function) {
  PyObject* const object = function.ptr();
  if (std::string(Py_TYPE(object)->tp_name) != "Boost.Python.function") return std::nullopt;
  const auto implementation = memory.word(address_of(object) + sizeof(PyObject));
  const auto table = implementation ? memory.word(*implementation) : std::nullopt;
  const auto type = table ? memory.word(*table - sizeof(Word)) : std::nullopt;
  const auto name = type ? memory.word(*type + sizeof(Word)) : std::nullopt;
  const auto text = name ? memory.text(*name) : std::nullopt;
  const auto offset = text ? memory.word(*implementation + sizeof(Word)) : std::nullopt;
  if (!offset) return std::nullopt;
  return Getter{demangled(text->c_str()), static_cast<std::size_t>(*offset)};
}

bool begins_with(const std::string& text, const std::string& part) {
  return text.compare(0, part.size(), part) == 0;
}

}  // namespace

std::string getter_difference(const DeclaredInterface& declared, const py::object& wrapper) {
  const Memory memory;
  const std::string unreadable = "the getters of this Boost.Python cannot be read";
  const auto known = read_getter(memory, py::make_getter(&KnownMember::second));
  if (!known || known->offset != offsetof(KnownMember, second) ||
      !begins_with(known->type, beginning + "double, statejump::yade_abi::KnownMember>, ")) {
    return unreadable;
  }
  for (const auto& member : declared.members) {
    if (!member.has_getter) continue;
    const std::string name = member.class_name + "." + member.name;
    const py::object attribute =
        py::object(wrapper.attr(member.class_name.c_str()).attr("__dict__"))
            .attr("get")(member.name);
    if (!PyObject_HasAttrString(attribute.ptr(), "fget")) {
      return name + " is not an attribute in Python";
    }
    const auto found = read_getter(memory, attribute.attr("fget"));
    if (!found) return unreadable;
    if (!begins_with(found->type, beginning)) return name + " is not a plain data member";
    const std::string end = ", yade::" + member.class_name + ">, ";
    if (!begins_with(found->type, beginning + member.type + end)) {
      const auto length = found->type.find(end);
      return "type of " + name + " is " +
             (length == std::string::npos
                  ? "another"
                  : found->type.substr(beginning.size(), length - beginning.size())) +
             ", declared " + member.type;
    }
    if (found->offset != member.offset) {
      std::ostringstream text;
      text << "offset of " << name << " is " << found->offset << " bytes, declared "
           << member.offset;
      return text.str();
    }
  }
  return "";
}

}  // namespace statejump::yade_abi
