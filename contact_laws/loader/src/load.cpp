// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/law_loader/load.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <set>
#include <string_view>
#include <system_error>

#include "kernel_hash.hpp"
#include "statejump/kernel/laws/registry.hpp"

namespace statejump::law_loader {

namespace fs = std::filesystem;
namespace laws = kernel::laws;

namespace {

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

/// Messages about objects that contain no law.
std::vector<std::string>& no_laws() {
  static std::vector<std::string> sentences;
  return sentences;
}

template <class Law>
bool is_in_the_project(const std::string& name) {
  bool found = false;
  laws::detail::Catalogue<Law>::for_each(
      [&](const auto& law) { found = found || name == law.info.name; });
  return found;
}

bool is_in_the_project(laws::LawKind kind, const std::string& name) {
  switch (kind) {
    case laws::LawKind::normal:
      return is_in_the_project<laws::NormalLaw>(name);
    case laws::LawKind::dissipation:
      return is_in_the_project<laws::DissipationLaw>(name);
    case laws::LawKind::friction:
      return is_in_the_project<laws::FrictionLaw>(name);
    case laws::LawKind::tangential_velocity:
      return is_in_the_project<laws::TangentialVelocityLaw>(name);
  }
  return false;
}

/// Replaces each parameter of a loaded law by the program's own parameter of that name.
/// @return first unknown name
std::string adopt_parameters(laws::LawInfo& info) {
  namespace known = laws::parameter;
  for (const laws::LawParameter*& parameter : info.parameters) {
    if (!parameter) continue;
    const laws::LawParameter* own = nullptr;
    for (const laws::LawParameter* each :
         {&known::friction_coefficient, &known::v0, &known::v1, &known::restitution,
          &known::restitution_from_zero, &known::smallest_impact_speed, &known::contact_length}) {
      const bool same_end = parameter->low_excluded == each->low_excluded || !own;
      if (std::string_view(parameter->name) == each->name && same_end) own = each;
    }
    if (!own) return parameter->name;
    parameter = own;
  }
  return "";
}

void enter(laws::LoadedLaw found) {
  if (found.name.empty()) {
    no_laws().push_back(found.problem);
    return;
  }
  for (laws::LoadedLaw& other : laws::loaded_laws()) {
    if (other.kind != found.kind || other.name != found.name) continue;
    const std::string sentence =
        "two laws have this name, that of " + other.origin + " and that of " + found.origin;
    other.table = nullptr;
    other.problem = sentence;
    return;
  }
  laws::loaded_laws().push_back(std::move(found));
}

}  // namespace

const char* kernel_hash() {
  return hash_of_the_kernel_headers;
}

std::vector<fs::path> folders() {
  std::vector<fs::path> result;
  std::string list = variable("STATEJUMP_LAWS");
  while (!list.empty()) {
    const std::size_t end = std::min(list.find(':'), list.size());
    if (end > 0) result.emplace_back(list.substr(0, end));
    list.erase(0, end + 1);
  }
  if (const std::string data = variable("XDG_DATA_HOME"); !data.empty()) {
    result.push_back(fs::path(data) / "statejump" / "laws");
  } else if (const std::string home = variable("HOME"); !home.empty()) {
    result.push_back(fs::path(home) / ".local" / "share" / "statejump" / "laws");
  }
  return result;
}

laws::LoadedLaw inspect(const fs::path& file) {
  laws::LoadedLaw law;
  law.origin = file.string();
  // Shared objects stay loaded until the program ends, because law tables point into them.
  void* object = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!object) {
    const char* reason = dlerror();
    law.problem = law.origin + " is no law: " + (reason ? reason : "it cannot be loaded");
    return law;
  }
  using Entry = const laws::UserLawTable* (*)();
  const auto entry = reinterpret_cast<Entry>(dlsym(object, "statejump_user_law"));
  const laws::UserLawTable* table = entry ? entry() : nullptr;
  if (!table) {
    law.problem = law.origin + " is no law: 'statejump laws build' did not make it";
    return law;
  }
  law.kind = table->kind;
  law.name = table->name;
  if (table->version != laws::user_law_version ||
      std::string_view(table->kernel) != kernel_hash() || table->sizes != laws::exchanged_sizes()) {
    law.problem = law.origin +
                  " was compiled against another version of the kernel, build it again with "
                  "'statejump laws build'";
    return law;
  }
  if (is_in_the_project(law.kind, law.name)) {
    law.problem = "two laws have this name, that of the project and that of " + law.origin;
    return law;
  }
  law.info = *table->info;
  if (const std::string unknown = adopt_parameters(law.info); !unknown.empty()) {
    law.problem = law.origin + " reads the parameter '" + unknown + "', which no joint has";
    return law;
  }
  law.table = table;
  return law;
}

void load_user_laws() {
  static std::set<fs::path> seen;
  for (const fs::path& folder : folders()) {
    std::error_code error;
    std::set<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      const std::string name = entry.path().filename().string();
      // A file that is still being written has a hidden name.
      if (name.front() == '.' || entry.path().extension() != ".so") continue;
      files.insert(fs::absolute(entry.path(), error));
    }
    for (const fs::path& file : files) {
      if (seen.insert(fs::weakly_canonical(file, error)).second) enter(inspect(file));
    }
  }
}

std::vector<std::string> problems() {
  std::vector<std::string> result = no_laws();
  for (const laws::LoadedLaw& law : laws::loaded_laws()) {
    if (!law.table) result.push_back("law '" + law.name + "': " + law.problem);
  }
  return result;
}

}  // namespace statejump::law_loader
