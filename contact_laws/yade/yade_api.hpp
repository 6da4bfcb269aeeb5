// The one place where the plugin chooses its YADE interface: the declared one (stock Debian YADE,
// no headers needed) or the real headers of a YADE source tree (-DYADE_SOURCE_DIR, any other
// version).
#pragma once

#ifdef STATEJUMP_REAL_YADE_HEADERS
#include <core/Body.hpp>
#include <core/Dispatching.hpp>
#include <core/GlobalEngine.hpp>
#include <core/Omega.hpp>
#include <core/Scene.hpp>
#include <pkg/common/Aabb.hpp>
#include <pkg/common/ElastMat.hpp>
#include <pkg/common/NormShearPhys.hpp>
#include <pkg/dem/ScGeom.hpp>
#else
#include "statejump/yade_abi/dispatch.hpp"
#include "statejump/yade_abi/serialization.hpp"
#endif
