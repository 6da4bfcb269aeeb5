// Conversion between a Python list of ThermalLink objects and the C++ vector of pointers.
#pragma once

#include <boost/python.hpp>
#include <new>
#include <vector>

#include "thermal.hpp"

namespace statejump::dem {

struct LinkListConverter {
  using List = std::vector<yade::shared_ptr<ThermalLink>>;

  static PyObject* convert(const List& list) {
    boost::python::list result;
    for (const auto& link : list) result.append(link);
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
      list.push_back(py::extract<yade::shared_ptr<ThermalLink>>(sequence[i]));
    }
    data->convertible = new (storage) List(std::move(list));
  }
};

inline void register_link_list_converter() {
  namespace py = boost::python;
  py::to_python_converter<LinkListConverter::List, LinkListConverter>();
  py::converter::registry::push_back(&LinkListConverter::accepts, &LinkListConverter::construct,
                                     py::type_id<LinkListConverter::List>());
}

}  // namespace statejump::dem
