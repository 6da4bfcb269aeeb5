#include "statejump/yade_abi/guard.hpp"

#include <dlfcn.h>
#include <elf.h>
#include <link.h>
#include <omp.h>

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
       {size_difference<Shape>("Shape"),
        size_difference<Bound>("Bound"),
        size_difference<Aabb>("Aabb"),
        size_difference<State>("State"),
        size_difference<Material>("Material"),
        size_difference<ElastMat>("ElastMat"),
        size_difference<FrictMat>("FrictMat"),
        size_difference<Body>("Body"),
        size_difference<IGeom>("IGeom"),
        size_difference<IPhys>("IPhys"),
        size_difference<GenericSpheresContact>("GenericSpheresContact"),
        size_difference<NormPhys>("NormPhys"),
        size_difference<NormShearPhys>("NormShearPhys"),
        size_difference<FrictPhys>("FrictPhys"),
        size_difference<Interaction>("Interaction"),
        size_difference<Functor>("Functor"),
        size_difference<BoundFunctor>("BoundFunctor"),
        size_difference<IGeomFunctor>("IGeomFunctor"),
        size_difference<IPhysFunctor>("IPhysFunctor"),
        size_difference<LawFunctor>("LawFunctor"),
        size_difference<GlShapeFunctor>("GlShapeFunctor"),
        size_difference<Engine>("Engine"),
        size_difference<GlobalEngine>("GlobalEngine"),
        size_difference<Scene>("Scene"),
        size_difference<BodyContainer>("BodyContainer"),
        size_difference<InteractionContainer>("InteractionContainer"),
        size_difference<EnergyTracker>("EnergyTracker")}) {
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

// Entries that a child has of its own: type information, destructors and their thunks for second
// bases. Asked by name, because the way from an address to its name is slow.
bool belongs_to_each_class(const void* entry, const std::string& mangled_class) {
  for (const char* prefix : {"_ZN", "_ZThn24_N", "_ZThn80_N"}) {
    for (const char* suffix : {"D0Ev", "D1Ev", "D2Ev"}) {
      if (entry == dlsym(RTLD_DEFAULT, (prefix + mangled_class + suffix).c_str())) return true;
    }
  }
  return entry == dlsym(RTLD_DEFAULT, ("_ZTIN" + mangled_class + "E").c_str());
}

// A static member has a size of its own in the symbol table.
std::string flag_difference() {
  const auto* flag = &yade::OpenGLRenderer::initDone;
  Dl_info info;
  ElfW(Sym)* symbol = nullptr;
  if (dladdr1(flag, &info, reinterpret_cast<void**>(&symbol), RTLD_DL_SYMENT) && symbol &&
      info.dli_saddr == flag && symbol->st_size == sizeof *flag) {
    return "";
  }
  return "OpenGLRenderer.initDone is not the flag that is declared";
}

template <class Base>
std::string vtable_difference(const char* name) {
  const std::string mangled = "4yade" + std::to_string(std::strlen(name)) + name;
  const Slots library = table_of(dlsym(RTLD_DEFAULT, ("_ZTVN" + mangled + "E").c_str()));
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
    if (expected == found || (expected && belongs_to_each_class(expected, mangled))) continue;
    std::ostringstream text;
    text << "entry " << i << " of the vtable of " << name << " differs from the declared one";
    return text.str();
  }
  return "";
}

std::string vtable_differences() {
  using namespace yade;
  for (const std::string& difference :
       {vtable_difference<Serializable>("Serializable"), vtable_difference<Shape>("Shape"),
        vtable_difference<IGeom>("IGeom"), vtable_difference<IPhys>("IPhys"),
        vtable_difference<Material>("Material"), vtable_difference<Functor>("Functor"),
        vtable_difference<Engine>("Engine"),
        vtable_difference<GenericSpheresContact>("GenericSpheresContact"),
        vtable_difference<FrictMat>("FrictMat"), vtable_difference<FrictPhys>("FrictPhys"),
        vtable_difference<Aabb>("Aabb"), vtable_difference<State>("State"),
        vtable_difference<BoundFunctor>("BoundFunctor"),
        vtable_difference<IGeomFunctor>("IGeomFunctor"),
        vtable_difference<IPhysFunctor>("IPhysFunctor"),
        vtable_difference<LawFunctor>("LawFunctor"),
        vtable_difference<GlShapeFunctor>("GlShapeFunctor"),
        vtable_difference<GlobalEngine>("GlobalEngine")}) {
    if (!difference.empty()) return difference;
  }
  return "";
}

// ---- 4. sentinels ------------------------------------------------------------------------------

// Whether an object begins with the vtable of the named class. Reads one pointer.
bool is_of_class(const void* object, const char* vtable_symbol) {
  const auto* table = static_cast<const char*>(dlsym(RTLD_DEFAULT, vtable_symbol));
  if (!table || !object || reinterpret_cast<std::uintptr_t>(object) % alignof(void*) != 0) {
    return false;
  }
  const void* first;
  std::memcpy(&first, object, sizeof first);
  return first == table + 2 * sizeof(void*);
}

// Gives a member of an object of ours the bits of a value and takes them away again. The library
// may read the member meanwhile, at the place where it believes it to be.
template <class Type>
class Lent {
 public:
  Lent(Type& member, const Type& value) : place_(&member) {
    std::memcpy(kept_.data(), place_, sizeof(Type));
    std::memcpy(place_, static_cast<const void*>(&value), sizeof(Type));
  }
  ~Lent() { std::memcpy(place_, kept_.data(), sizeof(Type)); }
  Lent(const Lent&) = delete;
  Lent& operator=(const Lent&) = delete;
  // An empty vector or pointer is a row of zeros.
  bool was_empty() const { return kept_ == std::array<char, sizeof(Type)>{}; }

 private:
  void* place_;
  std::array<char, sizeof(Type)> kept_;
};

// Works on a fresh Python object: sets an attribute through Python and reads the declared member,
// or the other way round. Values occur nowhere else. After the first difference nothing is touched
// any more.
class Probe {
 public:
  explicit Probe(const py::object& wrapper) : wrapper_(wrapper) {}

  py::object make(const char* class_name) {
    class_name_ = class_name;
    object_ = wrapper_.attr(class_name)();
    // The abstract bases of interaction physics have no attributes; none of them is probed.
    if (py::len(object_.attr("dict")()) == 0) report("dict()", "empty");
    return object_;
  }
  template <class Class>
  Class& as() {
    return py::extract<Class&>(object_);
  }
  yade::Real number() { return next_ += 1.0078125; }
  int integer() { return static_cast<int>(1024 * number()); }
  yade::Vector3r vector() { return {number(), number(), number()}; }

  // Python writes, the declared member shows it.
  void number_at(const char* attribute, const yade::Real& member) {
    written(attribute, member, number());
  }
  void vector_at(const char* attribute, const yade::Vector3r& member) {
    written(attribute, member, vector());
  }
  void flag_at(const char* attribute, const bool& member) {
    for (const bool value : {true, false, true}) written(attribute, member, value);
  }
  void integer_at(const char* attribute, const int& member) {
    written(attribute, member, integer());
  }
  void text_at(const char* attribute, const std::string& member) {
    // A wrong place need not hold a string; its size is compared before its text is looked at.
    written(attribute, member, "sentinel" + std::to_string(integer()));
  }
  template <class Pointer>
  void pointer_at(const char* attribute, const Pointer& member, const char* class_name) {
    if (differs()) return;
    object_.attr(attribute) = wrapper_.attr(class_name)();
    using Pointee = typename Pointer::element_type;
    expect(member.get() == py::extract<Pointee*>(object_.attr(attribute))(), attribute);
  }
  // The declared member is lent a value, Python shows it: for attributes that Python cannot write.
  template <class Type>
  void shown(const char* attribute, Type& member, const Type& value) {
    if (differs()) return;
    const Lent<Type> lent(member, value);
    const py::object value_seen = object_.attr(attribute);  // extract does not hold it
    const py::extract<Type> seen(value_seen);
    expect(seen.check() && Type(seen()) == value, attribute);
  }
  void number_shown(const char* attribute, yade::Real& member) {
    shown(attribute, member, number());
  }
  void vector_shown(const char* attribute, yade::Vector3r& member) {
    shown(attribute, member, vector());
  }
  void flag_shown(const char* attribute, bool& member) {
    for (const bool value : {true, false, true}) shown(attribute, member, value);
  }
  template <class Integer>
  void integer_shown(const char* attribute, Integer& member) {
    shown(attribute, member, static_cast<Integer>(integer()));
  }

  void expect(bool holds, const std::string& attribute) {
    if (!holds) report(attribute, "not at the declared place");
  }
  bool differs() const { return !difference_.empty(); }
  const std::string& difference() const { return difference_; }

 private:
  void report(const std::string& attribute, const char* what) {
    if (!differs()) difference_ = class_name_ + "." + attribute + " is " + what;
  }
  template <class Type>
  void written(const char* attribute, const Type& member, const Type& value) {
    if (differs()) return;
    object_.attr(attribute) = value;
    expect(member == value, attribute);
  }

  py::object wrapper_;
  py::object object_;
  std::string class_name_;
  std::string difference_;
  yade::Real next_ = 100;
};

void probe_shape_and_bound(Probe& probe) {
  probe.make("Sphere");
  auto& shape = probe.as<yade::Shape>();
  probe.vector_at("color", shape.color);
  probe.flag_at("wire", shape.wire);
  probe.flag_at("highlight", shape.highlight);

  probe.make("Aabb");
  auto& bound = probe.as<yade::Bound>();
  probe.integer_shown("lastUpdateIter", bound.lastUpdateIter);
  probe.vector_shown("refPos", bound.refPos);
  probe.number_shown("sweepLength", bound.sweepLength);
  probe.vector_at("color", bound.color);
  probe.vector_shown("min", bound.min);
  probe.vector_shown("max", bound.max);
}

void probe_material(Probe& probe) {
  probe.make("FrictMat");
  auto& material = probe.as<yade::FrictMat>();
  probe.integer_shown("id", material.id);
  probe.text_at("label", material.label);
  probe.number_at("density", material.density);
  probe.number_at("young", material.young);
  probe.number_at("poisson", material.poisson);
  probe.number_at("frictionAngle", material.frictionAngle);
}

void probe_state(Probe& probe) {
  py::object object = probe.make("State");
  auto& state = probe.as<yade::State>();
  probe.expect(static_cast<const void*>(&state.pos) == &state.se3.position, "pos");
  probe.expect(static_cast<const void*>(&state.ori) == &state.se3.orientation, "ori");
  probe.vector_at("pos", state.se3.position);
  probe.shown("ori", state.se3.orientation, yade::Quaternionr(0.5, -0.5, 0.5, 0.5));
  probe.vector_at("vel", state.vel);
  probe.number_at("mass", state.mass);
  probe.vector_at("angVel", state.angVel);
  probe.vector_at("angMom", state.angMom);
  probe.vector_at("inertia", state.inertia);
  probe.vector_at("refPos", state.refPos);
  probe.shown("refOri", state.refOri, yade::Quaternionr(0.5, 0.5, -0.5, 0.5));
  probe.flag_at("isDamped", state.isDamped);
  probe.number_at("densityScaling", state.densityScaling);
  if (probe.differs()) return;
  object.attr("blockedDOFs") = "xZ";
  probe.expect(state.blockedDOFs == 33, "blockedDOFs");
}

void probe_body(Probe& probe) {
  probe.make("Body");
  auto& body = probe.as<yade::Body>();
  probe.integer_shown("id", body.id);
  probe.integer_shown("groupMask", body.groupMask);
  probe.integer_shown("flags", body.flags);
  probe.integer_shown("subdomain", body.subdomain);
  probe.pointer_at("material", body.material, "FrictMat");
  probe.pointer_at("state", body.state, "State");
  probe.pointer_at("shape", body.shape, "Sphere");
  probe.pointer_at("bound", body.bound, "Aabb");
  probe.integer_shown("clumpId", body.clumpId);
  probe.integer_shown("iterBorn", body.iterBorn);
  probe.number_shown("timeBorn", body.timeBorn);
}

void probe_interaction(Probe& probe) {
  probe.make("FrictPhys");
  auto& physics = probe.as<yade::FrictPhys>();
  probe.number_at("kn", physics.kn);
  probe.vector_at("normalForce", physics.normalForce);
  probe.number_at("ks", physics.ks);
  probe.vector_at("shearForce", physics.shearForce);
  probe.number_at("tangensOfFrictionAngle", physics.tangensOfFrictionAngle);

  probe.make("ScGeom");
  auto& geometry = probe.as<yade::GenericSpheresContact>();
  probe.vector_at("normal", geometry.normal);
  probe.vector_at("contactPoint", geometry.contactPoint);
  probe.number_at("refR1", geometry.refR1);
  probe.number_at("refR2", geometry.refR2);

  probe.make("Interaction");
  auto& contact = probe.as<yade::Interaction>();
  probe.flag_at("isActive", contact.isActive);
  probe.integer_shown("id1", contact.id1);
  probe.integer_shown("id2", contact.id2);
  probe.integer_shown("iterMadeReal", contact.iterMadeReal);
  probe.pointer_at("geom", contact.geom, "ScGeom");
  probe.pointer_at("phys", contact.phys, "FrictPhys");
  probe.shown("cellDist", contact.cellDist,
              yade::Vector3i(probe.integer(), probe.integer(), probe.integer()));
  probe.integer_shown("iterBorn", contact.iterBorn);
}

void probe_engine_and_functor(Probe& probe) {
  probe.make("NewtonIntegrator");
  auto& engine = probe.as<yade::Engine>();
  probe.expect(engine.scene == yade::Omega::instance().getScene().get(), "scene");
  probe.integer_shown("execCount", engine.timingInfo.nExec);
  probe.flag_at("dead", engine.dead);
  probe.integer_at("ompThreads", engine.ompThreads);
  probe.text_at("label", engine.label);

  probe.make("Bo1_Sphere_Aabb");
  probe.text_at("label", probe.as<yade::Functor>().label);
}

// Two bodies and an interaction between them in a scene of our own. The library puts the
// interaction where it believes the containers to be.
void probe_containers(Probe& probe, const py::object& wrapper, yade::Scene& scene) {
  yade::InteractionContainer& interactions = *scene.interactions;
  probe.expect(interactions.bodies == &scene.bodies->body, "interactions (their bodies)");
  if (probe.differs()) return;

  const std::array<py::object, 2> made = {wrapper.attr("Body")(), wrapper.attr("Body")()};
  std::vector<yade::shared_ptr<yade::Body>> bodies;
  for (const auto& body : made) bodies.push_back(py::extract<yade::shared_ptr<yade::Body>>(body));
  bodies[0]->id = 0;
  bodies[1]->id = 1;
  const Lent<std::vector<yade::shared_ptr<yade::Body>>> lent(scene.bodies->body, bodies);
  probe.expect(lent.was_empty(), "bodies (their list)");
  if (probe.differs()) return;
  using Size = std::size_t (*)(const void*);
  const auto size = reinterpret_cast<Size>(dlsym(RTLD_DEFAULT, "_ZNK4yade13BodyContainer4sizeEv"));
  probe.expect(size && size(scene.bodies.get()) == 2, "bodies (their list)");
  if (probe.differs()) return;

  interactions.insert(0, 1);
  probe.expect(interactions.currSize == 1, "interactions (their number)");
  const yade::Interaction* found = nullptr;
  if (!probe.differs()) {
    // An empty list has no first element: one that is not where it was declared, either.
    const auto& list = interactions.linIntrs;
    found = list.empty() || list.size() > 1000000 ? nullptr : list.front().get();
    probe.expect(is_of_class(found, "_ZTVN4yade11InteractionE"), "interactions (their list)");
  }
  if (!probe.differs()) {
    probe.expect(found->id1 == 0 && found->id2 == 1 && found->linIx == 0,
                 "interactions (ids of an interaction)");
    probe.expect(found->functorCache.geomExists && !found->functorCache.geom,
                 "interactions (functorCache)");
    probe.expect(bodies[0]->intrs.size() == 1 && bodies[0]->intrs.begin()->first == 1,
                 "bodies (their intrs)");
  }
  interactions.clear();
}

void probe_scene(Probe& probe, const py::object& wrapper) {
  probe.make("Scene");
  auto& scene = probe.as<yade::Scene>();
  probe.expect(is_of_class(&scene, "_ZTVN4yade5SceneE"), "its table");
  probe.expect(scene.hostNameMax == 255, "hostNameMax");
  probe.number_at("dt", scene.dt);
  probe.integer_shown("iter", scene.iter);
  probe.flag_shown("subStepping", scene.subStepping);
  probe.integer_shown("subStep", scene.subStep);
  probe.number_shown("time", scene.time);
  probe.number_shown("speed", scene.speed);
  probe.integer_shown("stopAtIter", scene.stopAtIter);
  probe.number_shown("stopAtTime", scene.stopAtTime);
  probe.flag_shown("isPeriodic", scene.isPeriodic);
  probe.flag_shown("trackEnergy", scene.trackEnergy);
  probe.flag_shown("doSort", scene.doSort);
  probe.integer_shown("selectedBody", scene.selectedBody);
  probe.integer_shown("subdomain", scene.subdomain);
  probe.expect(scene.forces.getNumAllocatedThreads() == omp_get_max_threads(), "forces");
  probe.expect(is_of_class(scene.bodies.get(), "_ZTVN4yade13BodyContainerE"), "bodies");
  probe.expect(is_of_class(scene.interactions.get(), "_ZTVN4yade20InteractionContainerE"),
               "interactions");
  probe.expect(is_of_class(scene.energy.get(), "_ZTVN4yade13EnergyTrackerE"), "energy");
  if (probe.differs()) return;

  // engineByName goes through the list of engines and compares class names.
  const py::object made = wrapper.attr("NewtonIntegrator")();
  const std::vector<yade::shared_ptr<yade::Engine>> engines = {
      py::extract<yade::shared_ptr<yade::Engine>>(made)};
  {
    const Lent<std::vector<yade::shared_ptr<yade::Engine>>> lent(scene.engines, engines);
    probe.expect(lent.was_empty() && scene.engineByName("NewtonIntegrator") == engines.front(),
                 "engines");
  }
  if (!probe.differs()) probe_containers(probe, wrapper, scene);
}

std::string sentinel_differences(const py::object& wrapper) {
  Probe probe(wrapper);
  for (const auto part : {probe_shape_and_bound, probe_material, probe_state, probe_body,
                          probe_interaction, probe_engine_and_functor}) {
    part(probe);
    if (probe.differs()) return probe.difference();
  }
  probe_scene(probe, wrapper);
  if (probe.differs()) return probe.difference();
  // The user's scene is only looked at.
  const auto& scene = yade::Omega::instance().getScene();
  const py::object omega = wrapper.attr("Omega")();
  if (!is_of_class(scene.get(), "_ZTVN4yade5SceneE") ||
      scene.get() != py::extract<yade::Scene*>(omega.attr("_sceneObj"))()) {
    return "O._sceneObj is not what Omega::getScene gives";
  }
  return "";
}

}  // namespace

std::string difference_from_running_yade(const py::object& wrapper, const GuardOptions& options) {
  if (options.check_build_ids) {
    if (std::string difference = build_id_difference(); !difference.empty()) return difference;
  }
  if (std::string difference = size_differences(); !difference.empty()) return difference;
  if (std::string difference = vtable_differences(); !difference.empty()) return difference;
  if (std::string difference = flag_difference(); !difference.empty()) return difference;
  return sentinel_differences(wrapper);
}

}  // namespace statejump::yade_abi
