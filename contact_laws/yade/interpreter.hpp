// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Python.h>

namespace statejump::dem {

// Holds Python's global interpreter lock (GIL). A running simulation does not hold it.
class Interpreter {
 public:
  Interpreter() : state_(PyGILState_Ensure()) {}
  ~Interpreter() { PyGILState_Release(state_); }
  Interpreter(const Interpreter&) = delete;
  Interpreter& operator=(const Interpreter&) = delete;

 private:
  PyGILState_STATE state_;
};

}  // namespace statejump::dem
