// SPDX-License-Identifier: GPL-3.0-or-later
// Checks members of fresh objects by their values, both members that Python shows and hidden ones.
#include <omp.h>

#include <algorithm>
#include <array>
#include <boost/python.hpp>
#include <boost/shared_ptr.hpp>
#include <functional>
#include <sstream>
#include <typeinfo>
#include <utility>
#include <vector>

#include "checks.hpp"
#include "memory.hpp"

namespace statejump::yade_abi {
namespace {

namespace py = boost::python;
using Offsets = std::vector<std::size_t>;
using SharedPointer = boost::shared_ptr<void>;  // all boost::shared_ptr have the same layout

// Address of the YADE object behind a Python object, as an object of the named class; null for
// other classes.
char* place_of(const py::object& object, const std::string& class_name) {
  const auto* type =
      static_cast<const std::type_info*>(symbol("_ZTIN4yade" + mangled_name(class_name) + "E"));
  const auto* known = type ? py::converter::registry::query(py::type_info(*type)) : nullptr;
  return known ? static_cast<char*>(py::converter::get_lvalue_from_python(object.ptr(), *known))
               : nullptr;
}

// Shared pointer to that object; it keeps the Python object alive.
SharedPointer shared(const py::object& object, const std::string& class_name) {
  return {place_of(object, class_name), [object](void*) {}};
}

// Overwrites bytes of an object with those of a value and restores them at the end of the scope.
// Until then, the library reads the member at the offset that it was compiled with.
class ScopedOverride {
 public:
  ScopedOverride(char* place, const void* value, std::size_t bytes)
      : place_(place), kept_(place, bytes) {
    std::memcpy(place_, value, bytes);
  }
  ~ScopedOverride() { std::memcpy(place_, kept_.data(), kept_.size()); }
  ScopedOverride(const ScopedOverride&) = delete;
  ScopedOverride& operator=(const ScopedOverride&) = delete;
  // An empty vector or pointer consists of zero bytes.
  bool was_empty() const { return kept_.find_first_not_of('\0') == std::string::npos; }

 private:
  char* place_;
  std::string kept_;
};

// ---- sentinels: write a value at the declared offset, compare it with what Python shows --------

// Generates numbers that occur nowhere else.
class Sentinels {
 public:
  double number() { return next_ += 1.0078125; }
  int integer() { return static_cast<int>(1024 * number()); }

 private:
  double next_ = 100;
};

template <class Type>
bool shown(char* place, const py::object& object, const std::string& attribute, Type value) {
  const ScopedOverride overridden(place, &value, sizeof value);
  const py::object seen = object.attr(attribute.c_str());
  const py::extract<Type> number(seen);
  return number.check() && number() == value;
}

template <class Type, std::size_t length>
bool vector_shown(char* place, const py::object& object, const std::string& attribute,
                  const std::array<Type, length>& value) {
  const ScopedOverride overridden(place, value.data(), sizeof value);
  const py::object seen = object.attr(attribute.c_str());
  for (std::size_t i = 0; i < length; ++i) {
    const py::object part = seen[i];
    if (Type(py::extract<Type>(part)) != value[i]) return false;
  }
  return true;
}

bool sentinel_shown(Sentinels& next, const DeclaredMember& member, char* place,
                    const py::object& object) {
  const std::string& name = member.name;
  if (member.type == "double") return shown(place, object, name, next.number());
  if (member.type == "int") return shown(place, object, name, next.integer());
  if (member.type == "long") return shown<long>(place, object, name, next.integer());
  if (member.type == "bool") {
    return shown(place, object, name, true) && shown(place, object, name, false);
  }
  if (member.type == "Eigen::Matrix<double, 3, 1, 0, 3, 1>") {
    return vector_shown<double, 3>(place, object, name,
                                   {next.number(), next.number(), next.number()});
  }
  if (member.type == "Eigen::Matrix<int, 3, 1, 0, 3, 1>") {
    return vector_shown<int, 3>(place, object, name,
                                {next.integer(), next.integer(), next.integer()});
  }
  return true;  // pointers, strings and lists are checked only by their getter
}

// Pairs of a class with checked members and a class that can be instantiated in its place. The
// abstract bases of interaction physics have none.
constexpr std::array<std::pair<const char*, const char*>, 15> made_as = {
    {{"Shape", "Sphere"},
     {"Bound", "Aabb"},
     {"State", "State"},
     {"Material", "FrictMat"},
     {"ElastMat", "FrictMat"},
     {"FrictMat", "FrictMat"},
     {"GenericSpheresContact", "ScGeom"},
     {"NormPhys", "FrictPhys"},
     {"NormShearPhys", "FrictPhys"},
     {"FrictPhys", "FrictPhys"},
     {"Interaction", "Interaction"},
     {"Body", "Body"},
     {"Functor", "Bo1_Sphere_Aabb"},
     {"Engine", "NewtonIntegrator"},
     {"Scene", "Scene"}}};

// ---- values ------------------------------------------------------------------------------------

// Members that Python does not expose. The type follows from the way in which the member is found.
struct HiddenMember {
  const char* class_name;
  const char* name;
  const char* type;
};
constexpr std::array<HiddenMember, 12> hidden_members = {
    {{"State", "blockedDOFs", "unsigned int"},
     {"Engine", "scene", "yade::Scene*"},
     {"Functor", "scene", "yade::Scene*"},
     {"Scene", "forces", "yade::ForceContainer"},
     {"ForceContainer", "lastReset", "long"},
     {"Scene", "engines",
      "std::vector<boost::shared_ptr<yade::Engine>, "
      "std::allocator<boost::shared_ptr<yade::Engine> > >"},
     {"Scene", "bodies", "boost::shared_ptr<yade::BodyContainer>"},
     {"Scene", "interactions", "boost::shared_ptr<yade::InteractionContainer>"},
     {"Scene", "energy", "boost::shared_ptr<yade::EnergyTracker>"},
     {"BodyContainer", "body",
      "std::vector<boost::shared_ptr<yade::Body>, "
      "std::allocator<boost::shared_ptr<yade::Body> > >"},
     {"InteractionContainer", "linIntrs",
      "std::vector<boost::shared_ptr<yade::Interaction>, "
      "std::allocator<boost::shared_ptr<yade::Interaction> > >"},
     {"InteractionContainer", "currSize", "unsigned long"}}};

// Runs the value checks one by one. It stops at the first difference and writes nothing after it.
class Search {
 public:
  Search(const DeclaredInterface& declared, const py::object& wrapper)
      : declared_(declared), wrapper_(wrapper) {}

  std::string run() {
    for (const auto part :
         {&Search::state, &Search::user_scene, &Search::scene_pointers, &Search::engines,
          &Search::forces, &Search::functor, &Search::bodies, &Search::interactions}) {
      (this->*part)();
      if (!difference_.empty()) return difference_;
    }
    return "";
  }

 private:
  struct Place {
    py::object object;
    char* start;
    std::size_t size;
    std::string as;  // the class that `size` belongs to
  };
  Place make(const char* made, const char* as) {
    const py::object object = wrapper_.attr(made)();
    char* start = place_of(object, as);
    if (!start) report(std::string("an object of the class ") + made + " cannot be found");
    return {object, start, start ? declared_.find_class(as)->size : 0, as};
  }
  void report(const std::string& sentence) {
    if (difference_.empty()) difference_ = sentence;
  }
  const DeclaredMember* member(const char* class_name, const char* name) const {
    return declared_.find_member(class_name, name);
  }

  template <class Type>
  Offsets where(const char* start, std::size_t size, const std::function<bool(Type)>& holds) const {
    Offsets result;
    for (std::size_t i = 0; i + sizeof(Type) <= size; i += sizeof(Type)) {
      if (holds(read_as<Type>(start + i))) result.push_back(i);
    }
    return result;
  }
  Offsets where_word(const Place& place, Word value) const {
    return where<Word>(place.start, place.size, [value](Word word) { return word == value; });
  }
  // Offsets of words that point to an object of the class.
  Offsets where_pointer(const char* start, std::size_t size, const std::string& pointee) const {
    const Word table = table_pointer(pointee);
    return where<Word>(start, size, [this, table](Word word) {
      return table != 0 && word % sizeof(Word) == 0 && memory_.word(word) == table;
    });
  }
  // Checks that a value was found at the declared offset of a member and nowhere else.
  void expect_at(const char* class_name, const char* name, const Offsets& found) {
    const auto* declared = member(class_name, name);
    if (!declared || found == Offsets{declared->offset}) return;
    std::ostringstream text;
    text << class_name << "." << name << " was found ";
    if (found.empty()) text << "nowhere";
    for (std::size_t i = 0; i < found.size(); ++i) text << (i ? ", " : "at byte ") << found[i];
    text << ", declared at " << declared->offset;
    report(text.str());
  }
  void expect(bool holds, const char* class_name, const char* name) {
    if (!holds) report(std::string(class_name) + "." + name + " is not at the declared place");
  }

  void state() {
    Place place = make("State", "State");
    if (!place.start) return;
    place.object.attr("blockedDOFs") = "xZ";
    constexpr unsigned x_and_z_rotation = 1 + 32;
    expect_at("State", "blockedDOFs", where<unsigned>(place.start, place.size, [](unsigned word) {
                return word == x_and_z_rotation;
              }));
  }

  // Only reads the user's scene.
  void user_scene() {
    const auto instance = function<void*()>("_ZN9SingletonIN4yade5OmegaEE8instanceEv");
    const auto get_scene =
        function<const SharedPointer&(const void*)>("_ZNK4yade5Omega8getSceneEv");
    const py::object omega = wrapper_.attr("Omega")();
    const py::object shown = omega.attr("_sceneObj");
    const char* scene = place_of(shown, "Scene");
    if (!instance || !get_scene || !scene || get_scene(instance()).get() != scene) {
      report("O._sceneObj is not what Omega::getScene gives");
      return;
    }
    // The constructor of an engine stores a pointer to the current scene.
    const Place engine = make("NewtonIntegrator", "Engine");
    if (engine.start) expect_at("Engine", "scene", where_word(engine, address_of(scene)));
  }

  void scene_pointers() {
    scene_ = make("Scene", "Scene");
    if (!scene_.start) return;
    for (const auto& [name, pointee] :
         {std::pair{"bodies", "BodyContainer"}, std::pair{"interactions", "InteractionContainer"},
          std::pair{"energy", "EnergyTracker"}}) {
      expect_at("Scene", name, where_pointer(scene_.start, scene_.size, pointee));
    }
  }

  // Scene::engineByName searches the list of engines and compares class names.
  void engines() {
    const auto by_name = function<SharedPointer(void*, const std::string&)>(
        "_ZN4yade5Scene12engineByNameERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEE");
    const Place engine = make("NewtonIntegrator", "Engine");
    if (!engine.start) return;
    const std::vector<SharedPointer> list = {shared(engine.object, "Engine")};
    const ScopedOverride overridden(scene_.start + member("Scene", "engines")->offset, &list,
                                    sizeof list);
    expect(by_name && overridden.was_empty() &&
               by_name(scene_.start, "NewtonIntegrator").get() == list.front().get(),
           "Scene", "engines");
  }

  // ForceResetter stores the number of the step in ForceContainer::lastReset.
  void forces() {
    const auto action = function<void(void*)>("_ZN4yade13ForceResetter6actionEv");
    const auto threads =
        function<int(const void*)>("_ZNK4yade14ForceContainer22getNumAllocatedThreadsEv");
    const Place engine = make("ForceResetter", "Engine");
    if (!engine.start) return;
    const auto* place = member("Scene", "forces");
    expect(action && threads && threads(scene_.start + place->offset) == omp_get_max_threads(),
           "Scene", "forces");
    if (!difference_.empty()) return;
    const Word step = 0x5a5a3c3c0f;
    const std::size_t iter = member("Scene", "iter")->offset;
    Offsets found;
    {
      const void* scene = scene_.start;
      const ScopedOverride overridden_scene(engine.start + member("Engine", "scene")->offset,
                                            &scene, sizeof scene);
      const ScopedOverride overridden_step(scene_.start + iter, &step, sizeof step);
      action(engine.start);
      for (const std::size_t offset : where_word(scene_, step)) {
        if (offset != iter) found.push_back(offset);
      }
    }
    // Private in YADE's own headers.
    const auto* noted = member("ForceContainer", "lastReset");
    expect(found.size() == 1 && (!noted || found[0] == place->offset + noted->offset), "Scene",
           "forces");
  }

  // A dispatcher stores its scene in its functors. This dispatcher gets a fresh, empty scene.
  void functor() {
    const auto action = function<void(void*)>("_ZN4yade15BoundDispatcher6actionEv");
    const Place functor = make("Bo1_Sphere_Aabb", "Functor");
    if (!functor.start) return;
    py::list functors;
    functors.append(functor.object);
    const py::object dispatcher = wrapper_.attr("BoundDispatcher")(functors);
    char* engine = place_of(dispatcher, "Engine");
    if (!action || !engine) {
      report("BoundDispatcher is not the engine that is expected");
      return;
    }
    const void* scene = scene_.start;
    const ScopedOverride overridden(engine + member("Engine", "scene")->offset, &scene,
                                    sizeof scene);
    action(engine);
    expect_at("Functor", "scene", where_word(functor, address_of(scene)));
  }

  char* part_of_scene(const char* name) const {
    return read_as<char*>(scene_.start + member("Scene", name)->offset);
  }

  // Adds two bodies to the list; the library then counts them.
  void bodies() {
    const auto* list = member("BodyContainer", "body");
    if (!list) return;  // private in YADE's own headers
    for (int id = 0; id < 2; ++id) {
      const Place body = make("Body", "Body");
      if (!body.start) return;
      std::memcpy(body.start + member("Body", "id")->offset, &id, sizeof id);
      bodies_.push_back(shared(body.object, "Body"));
    }
    const auto size = function<std::size_t(const void*)>("_ZNK4yade13BodyContainer4sizeEv");
    const ScopedOverride overridden(part_of_scene("bodies") + list->offset, &bodies_,
                                    sizeof bodies_);
    expect(size && overridden.was_empty() && size(part_of_scene("bodies")) == 2, "BodyContainer",
           "body");
  }

  // Makes the library add an interaction of two bodies and searches for it in the container.
  void interactions() {
    const auto* list = member("BodyContainer", "body");
    if (!list) return;
    const auto insert = function<bool(void*, int, int)>("_ZN4yade20InteractionContainer6insertEii");
    const auto clear = function<void(void*)>("_ZN4yade20InteractionContainer5clearEv");
    if (!insert || !clear) {
      report("InteractionContainer has not the functions that are expected");
      return;
    }
    char* container = part_of_scene("interactions");
    const std::size_t size = declared_.find_class("InteractionContainer")->size;
    const ScopedOverride overridden(part_of_scene("bodies") + list->offset, &bodies_,
                                    sizeof bodies_);
    const std::string before(container, size);
    insert(container, 0, 1);
    Offsets count;
    for (const std::size_t i : where<Word>(container, size, [](Word word) { return word == 1; })) {
      if (read_as<Word>(before.data() + i) == 0) count.push_back(i);
    }
    expect_at("InteractionContainer", "currSize", count);
    // The list starts with a pointer to its array, and the array with a pointer to the interaction.
    const Word table = table_pointer("Interaction");
    Word found = 0;
    const auto starts_list = [this, table](Word word) {
      if (word % sizeof(Word) != 0) return false;
      const auto first = memory_.word(word);
      return first && memory_.word(*first) == table;
    };
    const Offsets starts = without_ends(container, where<Word>(container, size, starts_list));
    for (const std::size_t i : starts) found = *memory_.word(read_as<Word>(container + i));
    expect_at("InteractionContainer", "linIntrs", starts);
    if (difference_.empty()) {
      const char* interaction = reinterpret_cast<const char*>(found);
      expect(read_as<int>(interaction + member("Interaction", "id1")->offset) == 0 &&
                 read_as<int>(interaction + member("Interaction", "id2")->offset) == 1,
             "InteractionContainer", "linIntrs");
    }
    clear(container);
  }

  // A list has the pointers to its array, to the end of its entries and to the end of the array.
  // The last two point to memory without entries, where freed memory may look like one.
  static Offsets without_ends(const char* container, const Offsets& found) {
    const auto follows = [&](std::size_t i, std::size_t words) {
      const std::size_t back = words * sizeof(Word);
      if (i < back || std::find(found.begin(), found.end(), i - back) == found.end()) return false;
      return read_as<Word>(container + i) > read_as<Word>(container + (i - back));
    };
    Offsets starts;
    for (const std::size_t i : found) {
      if (!follows(i, 1) && !follows(i, 2)) starts.push_back(i);
    }
    return starts;
  }

  const DeclaredInterface& declared_;
  py::object wrapper_;
  Memory memory_;
  std::string difference_;
  Place scene_{};
  std::vector<SharedPointer> bodies_;
};

}  // namespace

std::string coverage_difference(const DeclaredInterface& declared) {
  for (const auto& member : declared.members) {
    if (member.has_getter) continue;
    const std::string name = member.class_name + "." + member.name;
    const HiddenMember* known = nullptr;
    for (const auto& one : hidden_members) {
      if (member.class_name == one.class_name && member.name == one.name) known = &one;
    }
    if (!known) return "no check sees " + name;
    if (member.type != known->type) {
      return "type of " + name + " is " + known->type + ", declared " + member.type;
    }
  }
  return "";
}

std::string sentinel_difference(const DeclaredInterface& declared, const py::object& wrapper) {
  Sentinels next;
  for (const auto& [class_name, made] : made_as) {
    const py::object object = wrapper.attr(made)();
    char* place = place_of(object, class_name);
    if (!place) return std::string("an object of the class ") + made + " cannot be found";
    for (const auto& member : declared.members) {
      if (!member.has_getter || member.class_name != class_name) continue;
      if (!sentinel_shown(next, member, place + member.offset, object)) {
        return member.class_name + "." + member.name + " is not at the declared place";
      }
    }
  }
  return "";
}

std::string value_difference(const DeclaredInterface& declared, const py::object& wrapper) {
  return Search(declared, wrapper).run();
}

}  // namespace statejump::yade_abi
