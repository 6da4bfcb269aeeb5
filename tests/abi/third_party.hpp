// SPDX-License-Identifier: GPL-3.0-or-later
// What the declared headers include, precompiled once for all mutations.
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <boost/enable_shared_from_this.hpp>
#include <boost/mpl/at.hpp>
#include <boost/mpl/vector.hpp>
#include <boost/python.hpp>
#include <boost/shared_ptr.hpp>
#include <list>
#include <map>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>
