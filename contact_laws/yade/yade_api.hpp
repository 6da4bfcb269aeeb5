// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses the plugin's YADE interface: the declared one (stock Debian YADE, no headers needed) or
// the real headers of a YADE source tree (-DYADE_SOURCE_DIR, any other version).
#pragma once

#ifdef STATEJUMP_REAL_YADE_HEADERS
#include <core/Aabb.hpp>
#include <core/Body.hpp>
#include <core/Dispatching.hpp>
#include <core/GlobalEngine.hpp>
#include <core/Omega.hpp>
#include <core/Scene.hpp>
#include <pkg/common/ElastMat.hpp>
#include <pkg/common/NormShearPhys.hpp>
#include <pkg/dem/FrictPhys.hpp>
#include <pkg/dem/ScGeom.hpp>
#ifdef YADE_OPENGL
#include <pkg/common/GLDrawFunctors.hpp>
#include <pkg/common/OpenGLRenderer.hpp>
#define STATEJUMP_HAS_VIEW
#endif
#else
#include "statejump/yade_abi/dispatch.hpp"
#define STATEJUMP_HAS_VIEW  // the declared interface includes Debian's 3-D view
#endif

#include <string>
#include <vector>

namespace statejump::dem {

// Functions that the plugin's declarations and YADE's own headers offer under different names or
// access rights. A null pointer to a body means that the body was erased.
inline std::size_t number_of_bodies(const yade::Scene& scene) {
  return scene.bodies->size();
}
inline const yade::shared_ptr<yade::Body>& body_at(const yade::Scene& scene, std::size_t id) {
  return (*scene.bodies)[static_cast<unsigned int>(id)];
}
inline std::size_t number_of_interactions(const yade::Scene& scene) {
  return scene.interactions->size();
}
inline const yade::Interaction& interaction_at(const yade::Scene& scene, std::size_t i) {
  return *(*scene.interactions)[i];
}

inline yade::Interaction& interaction_to_change(const yade::Scene& scene, std::size_t i) {
  return *(*scene.interactions)[i];
}

// Creates the Python classes of factory classes, base classes first.
inline void register_python_classes(const std::vector<std::string>& class_names) {
#ifdef STATEJUMP_REAL_YADE_HEADERS
  // YADE's headers declare buildDynlibDatabase() private. YADE's plugin loader calls it with the
  // list of pending classes.
  auto& pending = yade::ClassFactory::instance().pluginClasses;
  const auto kept = pending;
  pending.assign(class_names.begin(), class_names.end());
  yade::Omega::instance().loadPlugins({});
  pending = kept;
#else
  yade::Omega::instance().buildDynlibDatabase(class_names);
#endif
}

}  // namespace statejump::dem
