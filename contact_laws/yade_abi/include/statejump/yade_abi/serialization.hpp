// SPDX-License-Identifier: GPL-3.0-or-later
// YADE's own serialization of the base classes. YADE's libraries instantiate the (de)serializers of
// each archive; this header only declares them.
#pragma once

#include <boost/archive/binary_iarchive.hpp>
#include <boost/archive/binary_oarchive.hpp>
#include <boost/archive/xml_iarchive.hpp>
#include <boost/archive/xml_oarchive.hpp>
#include <boost/serialization/base_object.hpp>
#include <boost/serialization/shared_ptr.hpp>

#include "statejump/yade_abi/dispatch.hpp"

namespace boost::archive::detail {

// A macro, because a list of explicit instantiations cannot be a template.
#define STATEJUMP_SERIALIZED_BY_YADE(Class)                                  \
  extern template class iserializer<boost::archive::binary_iarchive, Class>; \
  extern template class oserializer<boost::archive::binary_oarchive, Class>; \
  extern template class iserializer<boost::archive::xml_iarchive, Class>;    \
  extern template class oserializer<boost::archive::xml_oarchive, Class>;
STATEJUMP_SERIALIZED_BY_YADE(yade::Serializable)
STATEJUMP_SERIALIZED_BY_YADE(yade::Shape)
STATEJUMP_SERIALIZED_BY_YADE(yade::FrictMat)
STATEJUMP_SERIALIZED_BY_YADE(yade::GenericSpheresContact)
STATEJUMP_SERIALIZED_BY_YADE(yade::FrictPhys)
STATEJUMP_SERIALIZED_BY_YADE(yade::BoundFunctor)
STATEJUMP_SERIALIZED_BY_YADE(yade::IGeomFunctor)
STATEJUMP_SERIALIZED_BY_YADE(yade::IPhysFunctor)
STATEJUMP_SERIALIZED_BY_YADE(yade::LawFunctor)
STATEJUMP_SERIALIZED_BY_YADE(yade::GlShapeFunctor)
STATEJUMP_SERIALIZED_BY_YADE(yade::GlobalEngine)
#undef STATEJUMP_SERIALIZED_BY_YADE

}  // namespace boost::archive::detail
