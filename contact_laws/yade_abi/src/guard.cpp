#include "statejump/yade_abi/guard.hpp"

#include <dlfcn.h>
#include <elf.h>
#include <link.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <sstream>
#include <utility>

#ifndef STATEJUMP_NO_LAYOUT_CHECKS  // only the test that sees this guard refuse defines it
#include "statejump/yade_abi/layout_checks.hpp"
#endif
#include "statejump/yade_abi/dispatch.hpp"

namespace statejump::yade_abi {

// Outside of the unnamed namespace, so that its vtable has a dynamic symbol with a size.
template <class Base>
struct DoNothing : Base {};

namespace {

namespace py = boost::python;

// ---- 1. build identifiers ----------------------------------------------------------------------

struct KnownLibrary {
  const char* file_name;
  const char* build_id;
};
// Debian 12, yade 2023.02a-1, amd64, double.
constexpr std::array<KnownLibrary, 3> known_libraries = {
    {{"libyade.so", "ab5587ac78af12fe3854492b492477acfe3232cf"},
     {"libpkg_common.so", "19a40f7f0ca11dea152744a6c7e37f281b0ae033"},
     {"libpkg_dem.so", "7762461858975c1ded391bce08efb28114fa3f2d"}}};

struct Search {
  const char* file_name;
  std::string build_id;
};

std::string note_text(const dl_phdr_info& info) {
  for (int i = 0; i < info.dlpi_phnum; ++i) {
    const auto& header = info.dlpi_phdr[i];
    if (header.p_type != PT_NOTE) continue;
    const char* position = reinterpret_cast<const char*>(info.dlpi_addr + header.p_vaddr);
    const char* end = position + header.p_memsz;
    while (position + sizeof(ElfW(Nhdr)) <= end) {
      ElfW(Nhdr) note;
      std::memcpy(&note, position, sizeof note);
      const char* name = position + sizeof note;
      const char* bytes = name + ((note.n_namesz + 3U) & ~3U);
      if (note.n_type == NT_GNU_BUILD_ID && std::string(name) == "GNU") {
        std::string text;
        for (unsigned k = 0; k < note.n_descsz; ++k) {
          char digits[3];
          std::snprintf(digits, sizeof digits, "%02x", static_cast<unsigned char>(bytes[k]));
          text += digits;
        }
        return text;
      }
      position = bytes + ((note.n_descsz + 3U) & ~3U);
    }
  }
  return "none";
}

int find_library(dl_phdr_info* info, std::size_t, void* data) {
  auto& search = *static_cast<Search*>(data);
  const std::string path = info->dlpi_name ? info->dlpi_name : "";
  if (path.substr(path.rfind('/') + 1) != search.file_name) return 0;
  search.build_id = note_text(*info);
  return 1;
}

std::string build_id_difference() {
  for (const auto& library : known_libraries) {
    Search search{library.file_name, ""};
    dl_iterate_phdr(find_library, &search);
    if (search.build_id.empty()) {
      return std::string(library.file_name) + " is not loaded: this is not a running YADE";
    }
    if (search.build_id != library.build_id) {
      return std::string(library.file_name) + " has build identifier " + search.build_id +
             ", known is " + library.build_id;
    }
  }
  return "";
}

// ---- 2. sizes ----------------------------------------------------------------------------------

// yade::Create<Class>() starts with operator new(sizeof(Class)); its argument is an immediate
// operand: mov edi, imm32 (opcode bf), then call (e8).
std::size_t allocated_size(const char* create_symbol) {
  const auto* code = static_cast<const unsigned char*>(dlsym(RTLD_DEFAULT, create_symbol));
  if (!code) return 0;
  for (int i = 0; i < 64; ++i) {
    if (code[i] != 0xbf) continue;
    std::uint32_t size;
    std::memcpy(&size, code + i + 1, sizeof size);
    for (int j = i + 5; j < i + 32; ++j) {
      if (code[j] == 0xe8) return size;
    }
  }
  return 0;
}

template <class Class>
std::string size_difference(const char* name) {
  const std::string length = std::to_string(std::strlen(name) + 6);
  const std::size_t found = allocated_size(("_ZN4yade" + length + "Create" + name + "Ev").c_str());
  if (found == sizeof(Class)) return "";
  std::ostringstream text;
  text << "size of " << name << " is " << found << " bytes, declared " << sizeof(Class);
  return text.str();
}

std::string size_differences() {
  using namespace yade;
  for (const std::string& difference :
       {size_difference<Shape>("Shape"), size_difference<Bound>("Bound"),
        size_difference<Aabb>("Aabb"), size_difference<State>("State"),
        size_difference<Material>("Material"), size_difference<ElastMat>("ElastMat"),
        size_difference<FrictMat>("FrictMat"), size_difference<Body>("Body"),
        size_difference<IGeom>("IGeom"), size_difference<IPhys>("IPhys"),
        size_difference<GenericSpheresContact>("GenericSpheresContact"),
        size_difference<NormPhys>("NormPhys"), size_difference<NormShearPhys>("NormShearPhys"),
        size_difference<FrictPhys>("FrictPhys"), size_difference<Interaction>("Interaction"),
        size_difference<Functor>("Functor"), size_difference<Engine>("Engine"),
        size_difference<GlobalEngine>("GlobalEngine")}) {
    if (!difference.empty()) return difference;
  }
  return "";
}

// ---- 3. vtables --------------------------------------------------------------------------------

using Slots = std::pair<void* const*, std::size_t>;  // start of the table and number of entries

// The table of a type, found by its mangled symbol, with the size from the symbol table.
Slots table_of(const void* address) {
  Dl_info info;
  ElfW(Sym)* symbol = nullptr;
  if (!address || !dladdr1(address, &info, reinterpret_cast<void**>(&symbol), RTLD_DL_SYMENT) ||
      !symbol) {
    return {nullptr, 0};
  }
  return {static_cast<void* const*>(info.dli_saddr), symbol->st_size / sizeof(void*)};
}

bool is_destructor(const void* function) {
  Dl_info info;
  if (!dladdr(function, &info) || !info.dli_sname) return true;  // local: ours
  const std::string name = info.dli_sname;
  return name.find("D0Ev") != std::string::npos || name.find("D1Ev") != std::string::npos ||
         name.find("D2Ev") != std::string::npos;
}

template <class Base>
std::string vtable_difference(const char* name) {
  const std::string base_symbol = "_ZTVN4yade" + std::to_string(std::strlen(name)) + name + "E";
  const Slots library = table_of(dlsym(RTLD_DEFAULT, base_symbol.c_str()));
  if (!library.first) return std::string("the vtable of ") + name + " is not in YADE's libraries";
  // Built and destroyed without ever being called.
  const DoNothing<Base> child;
  const void* pointer;
  std::memcpy(&pointer, static_cast<const void*>(&child), sizeof pointer);
  const Slots ours = table_of(pointer);
  if (ours.second != library.second) {
    std::ostringstream text;
    text << "the vtable of " << name << " has " << library.second << " entries, declared "
         << ours.second;
    return text.str();
  }
  for (std::size_t i = 0; i < library.second; ++i) {
    const void* expected = library.first[i];
    const void* found = ours.first[i];
    if (expected == found) continue;
    Dl_info info;
    const bool typeinfo =
        dladdr(expected, &info) && info.dli_sname && std::strncmp(info.dli_sname, "_ZTI", 4) == 0;
    if (typeinfo || is_destructor(expected)) continue;
    std::ostringstream text;
    text << "entry " << i << " of the vtable of " << name << " differs from the declared one";
    return text.str();
  }
  return "";
}

std::string vtable_differences() {
  using namespace yade;
  for (const std::string& difference :
       {vtable_difference<Shape>("Shape"), vtable_difference<IGeom>("IGeom"),
        vtable_difference<GenericSpheresContact>("GenericSpheresContact"),
        vtable_difference<FrictMat>("FrictMat"), vtable_difference<FrictPhys>("FrictPhys"),
        vtable_difference<Aabb>("Aabb"), vtable_difference<State>("State"),
        vtable_difference<BoundFunctor>("BoundFunctor"),
        vtable_difference<IGeomFunctor>("IGeomFunctor"),
        vtable_difference<IPhysFunctor>("IPhysFunctor"),
        vtable_difference<LawFunctor>("LawFunctor"),
        vtable_difference<GlobalEngine>("GlobalEngine")}) {
    if (!difference.empty()) return difference;
  }
  return "";
}

// ---- 4. sentinels ------------------------------------------------------------------------------

// Sets attributes of a fresh Python object to values that occur nowhere else and reads the declared
// members of the same object.
class Probe {
 public:
  explicit Probe(const py::object& wrapper) : wrapper_(wrapper) {}

  py::object make(const char* class_name) {
    class_name_ = class_name;
    object_ = wrapper_.attr(class_name)();
    if (py::len(object_.attr("dict")()) == 0) report("dict()", "empty");
    return object_;
  }
  template <class Class>
  Class& as() {
    return py::extract<Class&>(object_);
  }
  yade::Real number() { return next_ += 1.0078125; }
  yade::Vector3r vector() { return {number(), number(), number()}; }

  void number_at(const char* attribute, const yade::Real& member) {
    const yade::Real value = number();
    object_.attr(attribute) = value;
    if (!(member == value)) report(attribute, "not at the declared place");
  }
  void vector_at(const char* attribute, const yade::Vector3r& member) {
    const yade::Vector3r value = vector();
    object_.attr(attribute) = value;
    if (!(member == value)) report(attribute, "not at the declared place");
  }
  void flag_at(const char* attribute, const bool& member) {
    for (const bool value : {true, false, true}) {
      object_.attr(attribute) = value;
      if (member != value) report(attribute, "not at the declared place");
    }
  }
  void integer_at(const char* attribute, const int& member) {
    const int value = static_cast<int>(1000 * number());
    object_.attr(attribute) = value;
    if (member != value) report(attribute, "not at the declared place");
  }
  void text_at(const char* attribute, const std::string& member) {
    const std::string value = "sentinel" + std::to_string(static_cast<int>(number()));
    object_.attr(attribute) = value;
    // A wrong place need not hold a string: compare sizes and bytes without trusting it.
    if (member.size() != value.size() || member != value) {
      report(attribute, "not at the declared place");
    }
  }
  void report(const std::string& attribute, const char* what) {
    if (difference_.empty()) difference_ = class_name_ + "." + attribute + " is " + what;
  }
  const std::string& difference() const { return difference_; }

 private:
  py::object wrapper_;
  py::object object_;
  std::string class_name_;
  std::string difference_;
  yade::Real next_ = 100;
};

std::string sentinel_differences(const py::object& wrapper) {
  Probe probe(wrapper);

  probe.make("Sphere");
  auto& shape = probe.as<yade::Shape>();
  probe.vector_at("color", shape.color);
  probe.flag_at("wire", shape.wire);
  probe.flag_at("highlight", shape.highlight);

  probe.make("FrictMat");
  auto& material = probe.as<yade::FrictMat>();
  probe.number_at("density", material.density);
  probe.number_at("young", material.young);
  probe.number_at("poisson", material.poisson);
  probe.number_at("frictionAngle", material.frictionAngle);
  probe.text_at("label", material.label);

  probe.make("FrictPhys");
  auto& physics = probe.as<yade::FrictPhys>();
  probe.number_at("kn", physics.kn);
  probe.number_at("ks", physics.ks);
  probe.vector_at("normalForce", physics.normalForce);
  probe.vector_at("shearForce", physics.shearForce);
  probe.number_at("tangensOfFrictionAngle", physics.tangensOfFrictionAngle);

  probe.make("ScGeom");
  auto& geometry = probe.as<yade::GenericSpheresContact>();
  probe.vector_at("normal", geometry.normal);
  probe.vector_at("contactPoint", geometry.contactPoint);
  probe.number_at("refR1", geometry.refR1);
  probe.number_at("refR2", geometry.refR2);

  py::object state_object = probe.make("State");
  auto& state = probe.as<yade::State>();
  probe.vector_at("vel", state.vel);
  probe.vector_at("angVel", state.angVel);
  probe.vector_at("inertia", state.inertia);
  probe.number_at("mass", state.mass);
  probe.number_at("densityScaling", state.densityScaling);
  probe.flag_at("isDamped", state.isDamped);
  probe.vector_at("pos", state.se3.position);
  state_object.attr("blockedDOFs") = "xZ";
  if (state.blockedDOFs != 33) probe.report("blockedDOFs", "not at the declared place");

  probe.make("NewtonIntegrator");
  auto& engine = probe.as<yade::Engine>();
  probe.flag_at("dead", engine.dead);
  probe.integer_at("ompThreads", engine.ompThreads);
  probe.text_at("label", engine.label);

  probe.make("Bo1_Sphere_Aabb");
  probe.text_at("label", probe.as<yade::Functor>().label);

  probe.make("Aabb");
  probe.vector_at("color", probe.as<yade::Bound>().color);

  py::object body_object = probe.make("Body");
  auto& body = probe.as<yade::Body>();
  body_object.attr("material") = wrapper.attr("FrictMat")();
  body_object.attr("shape") = wrapper.attr("Sphere")();
  if (body.material.get() != py::extract<yade::Material*>(body_object.attr("material"))()) {
    probe.report("material", "not at the declared place");
  }
  if (body.shape.get() != py::extract<yade::Shape*>(body_object.attr("shape"))()) {
    probe.report("shape", "not at the declared place");
  }
  if (body.state.get() != py::extract<yade::State*>(body_object.attr("state"))()) {
    probe.report("state", "not at the declared place");
  }
  if (!probe.difference().empty()) return probe.difference();

  // The scene: written at the declared place, read through Python, restored.
  const py::object omega = wrapper.attr("Omega")();
  yade::Scene& scene = *yade::Omega::instance().getScene();
  const auto kept_dt = scene.dt;
  const auto kept_iter = scene.iter;
  const auto kept_time = scene.time;
  const auto kept_flag = scene.trackEnergy;
  scene.dt = probe.number();
  scene.iter = 123457;
  scene.time = probe.number();
  scene.trackEnergy = !kept_flag;
  std::string difference;
  if (py::extract<double>(omega.attr("dt"))() != scene.dt) difference = "O.dt";
  if (py::extract<long>(omega.attr("iter"))() != scene.iter) difference = "O.iter";
  if (py::extract<double>(omega.attr("time"))() != scene.time) difference = "O.time";
  if (py::extract<bool>(omega.attr("trackEnergy"))() != scene.trackEnergy) {
    difference = "O.trackEnergy";
  }
  scene.dt = kept_dt;
  scene.iter = kept_iter;
  scene.time = kept_time;
  scene.trackEnergy = kept_flag;
  if (!difference.empty()) return difference + " is not at the declared place";
  const auto bodies = static_cast<std::size_t>(py::len(omega.attr("bodies")));
  std::size_t counted = 0;
  for (const auto& entry : scene.bodies->body) counted += entry ? 1 : 0;
  if (counted != bodies) return "O.bodies is not at the declared place";
  return "";
}

}  // namespace

std::string difference_from_running_yade(const py::object& wrapper, const GuardOptions& options) {
  if (options.check_build_ids) {
    if (std::string difference = build_id_difference(); !difference.empty()) return difference;
  }
  if (std::string difference = size_differences(); !difference.empty()) return difference;
  if (std::string difference = vtable_differences(); !difference.empty()) return difference;
  return sentinel_differences(wrapper);
}

}  // namespace statejump::yade_abi
