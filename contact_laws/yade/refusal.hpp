// SPDX-License-Identifier: GPL-3.0-or-later
// An argument of a class, or a scene, that the plugin rejects, as code and fields.
#pragma once

#include <string>

#include "yade_api.hpp"

namespace statejump::dem {

struct Refusal {
  const char* code;
  std::string key = {};  // class and attribute, an engine or a body
  std::string value = {};
  std::string allowed = {};
  std::string said = {};  // the sentence, if another library gave it
};

// The only place with the wording of refusals.
std::string sentence(const Refusal& refusal);

// Keeps a refusal for take_refusal(). Engines raise errors in a thread of YADE, where a Python
// exception would lose its attributes.
void keep(const Refusal& refusal);

// Keeps it, then throws std::invalid_argument with the sentence.
[[noreturn, gnu::cold]] void refuse(const Refusal& refusal);

// Returns the last refusal once, as a dict: code, key, value, allowed, sentence. Returns None if
// there is no new refusal.
boost::python::object take_refusal();

}  // namespace statejump::dem
