// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/failure.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <exception>
#include <string>
#include <vector>

#include "bindings.hpp"
#include "statejump/geometry/mesh_failure.hpp"
#include "statejump/kernel/laws/normal.hpp"
#include "statejump/kernel/require.hpp"

namespace py = pybind11;

namespace statejump::bindings {

namespace {

/// Class of EngineFailure. It is a raw pointer, because a static py::object would be released after
/// the interpreter has ended.
PyObject* failure_class = nullptr;

constexpr const char* doc =
    "Why the engine gave no result, as fields; those that do not apply are None or empty.\n\n"
    "kind: 'out_of_range', 'mechanism', 'buckled', 'not_converged', ...: what went wrong\n"
    "message: the sentence, the same as str()\n"
    "item, key, value, allowed: argument out of range, the part it belongs to, its range\n"
    "joint, joints: names of the joints that fail; joint_kind: 'slider' or 'revolute'\n"
    "nodes: names of the nodes that move most, of a mechanism or of buckling\n"
    "time_s, temperature_change_K: when\n"
    "cause, remedy: parts of the sentence\n"
    "file: of a mesh; reason, details: why it is rejected, see mesh_reasons()\n"
    "numbers: further numbers, name with unit to value";

/// Raises EngineFailure with the given attributes. All other attributes keep the defaults of the
/// class: None or empty.
void raise(const char* kind, const std::string& message, const py::dict& attributes) {
  const py::object failure = py::reinterpret_borrow<py::object>(failure_class)(message);
  failure.attr("kind") = kind;
  failure.attr("message") = message;
  for (const auto& [name, value] : attributes) py::setattr(failure, name, value);
  PyErr_SetObject(failure_class, failure.ptr());
}

void raise(const Failure& failure) {
  const FailureFields& fields = failure.fields();
  py::dict attributes;
  std::vector<std::string> joints;
  for (const FailureJoint& joint : fields.joints) joints.push_back(joint.name);
  if (!joints.empty()) {
    attributes["joint"] = joints.front();
    attributes["joint_kind"] = fields.joints.front().kind;
  }
  attributes["joints"] = py::tuple(py::cast(joints));
  std::vector<std::string> nodes;
  for (const FailureMode& mode : fields.modes) {
    for (const ModeNode& moved : mode) {
      if (std::find(nodes.begin(), nodes.end(), moved.node) == nodes.end()) {
        nodes.push_back(moved.node);
      }
    }
  }
  attributes["nodes"] = py::tuple(py::cast(nodes));
  if (fields.time) attributes["time_s"] = *fields.time;
  if (fields.temperature_change) attributes["temperature_change_K"] = *fields.temperature_change;
  if (const std::string why = cause(fields); !why.empty()) attributes["cause"] = why;
  if (const std::string cure = remedy(fields); !cure.empty()) attributes["remedy"] = cure;
  py::dict numbers;
  const auto modes = std::max(static_cast<std::size_t>(fields.mode_count), fields.modes.size());
  if (modes > 0) numbers["modes"] = modes;
  for (const auto& [name, value] : fields.numbers) numbers[py::str(name)] = value;
  attributes["numbers"] = numbers;
  raise(to_string(fields.kind), failure.what(), attributes);
}

void raise(const kernel::OutOfRange& refused) {
  py::dict attributes;
  if (!refused.item().empty()) attributes["item"] = refused.item();
  attributes["key"] = refused.name();
  if (refused.is_number()) {
    attributes["value"] = refused.number();
  } else {
    attributes["value"] = refused.value();
  }
  attributes["allowed"] = refused.range();
  attributes["cause"] = "allowed is " + refused.range();
  const bool is_unloaded = dynamic_cast<const UnloadedJoint*>(&refused) != nullptr;
  raise(is_unloaded ? to_string(FailureKind::unloaded_joint) : "out_of_range", refused.what(),
        attributes);
}

void raise(const kernel::laws::DepthOutOfRange& left) {
  py::dict attributes;
  attributes["item"] = left.law();
  attributes["key"] = "penetration_depth";
  attributes["value"] = left.depth();
  py::dict numbers;
  numbers["limit_m"] = left.limit();
  attributes["numbers"] = numbers;
  raise(to_string(FailureKind::law_left_range), left.what(), attributes);
}

void raise(const geometry::MeshFailure& failure) {
  py::dict attributes;
  attributes["file"] = failure.file();
  attributes["cause"] = failure.cause();
  if (!failure.remedy().empty()) attributes["remedy"] = failure.remedy();
  attributes["reason"] = failure.reason_name();
  py::dict details;
  for (const auto& [name, value] : failure.fields()) details[py::str(name)] = py::cast(value);
  attributes["details"] = details;
  raise(geometry::to_string(failure.fault()), failure.what(), attributes);
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const Failure& failure) {
    raise(failure);
  } catch (const kernel::OutOfRange& refused) {
    raise(refused);
  } catch (const geometry::MeshFailure& failure) {
    raise(failure);
  } catch (const kernel::laws::DepthOutOfRange& left) {
    raise(left);
  }
}

}  // namespace

void bind_failure(py::module_& module) {
  py::dict attributes;
  attributes["__doc__"] = doc;
  attributes["kind"] = "";
  attributes["message"] = "";
  for (const char* name : {"item", "key", "value", "allowed", "joint", "joint_kind", "time_s",
                           "temperature_change_K", "cause", "remedy", "file", "reason"}) {
    attributes[name] = py::none();
  }
  attributes["joints"] = py::tuple();
  attributes["nodes"] = py::tuple();
  attributes["numbers"] = py::dict();
  attributes["details"] = py::dict();
  // Python code can catch EngineFailure as a ValueError (argument out of range) or as a
  // RuntimeError (failed run).
  const py::tuple bases = py::make_tuple(py::reinterpret_borrow<py::object>(PyExc_ValueError),
                                         py::reinterpret_borrow<py::object>(PyExc_RuntimeError));
  failure_class =
      PyErr_NewException("statejump._engine.EngineFailure", bases.ptr(), attributes.ptr());
  if (failure_class == nullptr) throw py::error_already_set();
  module.add_object("EngineFailure", failure_class);
  py::register_exception_translator(&translate);
}

void use_failure(const py::module_& engine) {
  failure_class = engine.attr("EngineFailure").cast<py::object>().release().ptr();
  py::register_exception_translator(&translate);
}

}  // namespace statejump::bindings
