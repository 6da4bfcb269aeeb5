// SPDX-License-Identifier: GPL-3.0-or-later
// Conversion between a Python list of objects and the C++ vector of pointers to them.
#pragma once

#include <boost/python.hpp>
#include <new>
#include <utility>
#include <vector>

#include "yade_api.hpp"

namespace statejump::dem {

template <class Class>
struct ListConverter {
  using List = std::vector<yade::shared_ptr<Class>>;

  static PyObject* convert(const List& list) {
    boost::python::list result;
    for (const auto& entry : list) result.append(entry);
    return boost::python::incref(result.ptr());
  }
  static void* accepts(PyObject* object) {
    return PyList_Check(object) || PyTuple_Check(object) ? object : nullptr;
  }
  static void construct(PyObject* object,
                        boost::python::converter::rvalue_from_python_stage1_data* data) {
    namespace py = boost::python;
    void* storage =
        reinterpret_cast<py::converter::rvalue_from_python_storage<List>*>(data)->storage.bytes;
    const py::object sequence{py::handle<>(py::borrowed(object))};
    List list;
    for (py::ssize_t i = 0; i < py::len(sequence); ++i) {
      list.push_back(py::extract<yade::shared_ptr<Class>>(sequence[i]));
    }
    data->convertible = new (storage) List(std::move(list));
  }
};

template <class Class>
void register_list_converter() {
  namespace py = boost::python;
  using Converter = ListConverter<Class>;
  py::to_python_converter<typename Converter::List, Converter>();
  py::converter::registry::push_back(&Converter::accepts, &Converter::construct,
                                     py::type_id<typename Converter::List>());
}

}  // namespace statejump::dem
