// Measured sizes and offsets of YADE 2023.02a (Debian 12, amd64, double), held against the
// declarations at compile time. The running libraries are held against them in guard.cpp.
#pragma once

#include <cstddef>

#include "statejump/yade_abi/dispatch.hpp"

namespace statejump::yade_abi {

#pragma GCC diagnostic push
// The classes have virtual functions; GCC lays out their single bases as offsetof assumes.
#pragma GCC diagnostic ignored "-Winvalid-offsetof"

// Class, member, offset and size in bytes; offsetof takes no function.
#define STATEJUMP_MEMBER(Class, member, offset, size)       \
  static_assert(offsetof(yade::Class, member) == (offset)); \
  static_assert(sizeof(yade::Class::member) == (size));

static_assert(sizeof(yade::Vector3r) == 24 && alignof(yade::Vector3r) == 8);
static_assert(sizeof(yade::Quaternionr) == 32 && alignof(yade::Quaternionr) == 8);
static_assert(sizeof(yade::Se3r) == 56);

static_assert(sizeof(yade::Factorable) == 24);

static_assert(sizeof(yade::Serializable) == 24);

static_assert(sizeof(yade::Indexable) == 8);

static_assert(sizeof(yade::Shape) == 96);
STATEJUMP_MEMBER(Shape, boundFunctor, 32, 16)
STATEJUMP_MEMBER(Shape, internalforcefunctor, 48, 16)
STATEJUMP_MEMBER(Shape, color, 64, 24)
STATEJUMP_MEMBER(Shape, wire, 88, 1)
STATEJUMP_MEMBER(Shape, highlight, 89, 1)

static_assert(sizeof(yade::Bound) == 144);
STATEJUMP_MEMBER(Bound, lastUpdateIter, 32, 4)
STATEJUMP_MEMBER(Bound, refPos, 40, 24)
STATEJUMP_MEMBER(Bound, sweepLength, 64, 8)
STATEJUMP_MEMBER(Bound, color, 72, 24)
STATEJUMP_MEMBER(Bound, min, 96, 24)
STATEJUMP_MEMBER(Bound, max, 120, 24)

static_assert(sizeof(yade::Aabb) == 144);

static_assert(sizeof(yade::State) == 320);
STATEJUMP_MEMBER(State, updateMutex, 48, 40)
STATEJUMP_MEMBER(State, se3, 88, 56)
STATEJUMP_MEMBER(State, vel, 144, 24)
STATEJUMP_MEMBER(State, mass, 168, 8)
STATEJUMP_MEMBER(State, angVel, 176, 24)
STATEJUMP_MEMBER(State, angMom, 200, 24)
STATEJUMP_MEMBER(State, inertia, 224, 24)
STATEJUMP_MEMBER(State, refPos, 248, 24)
STATEJUMP_MEMBER(State, refOri, 272, 32)
STATEJUMP_MEMBER(State, blockedDOFs, 304, 4)
STATEJUMP_MEMBER(State, isDamped, 308, 1)
STATEJUMP_MEMBER(State, densityScaling, 312, 8)

static_assert(sizeof(yade::Material) == 80);
STATEJUMP_MEMBER(Material, id, 32, 4)
STATEJUMP_MEMBER(Material, label, 40, 32)
STATEJUMP_MEMBER(Material, density, 72, 8)

static_assert(sizeof(yade::ElastMat) == 96);
STATEJUMP_MEMBER(ElastMat, young, 80, 8)
STATEJUMP_MEMBER(ElastMat, poisson, 88, 8)

static_assert(sizeof(yade::FrictMat) == 104);
STATEJUMP_MEMBER(FrictMat, frictionAngle, 96, 8)

static_assert(sizeof(yade::IGeom) == 32);

static_assert(sizeof(yade::GenericSpheresContact) == 96);
STATEJUMP_MEMBER(GenericSpheresContact, normal, 32, 24)
STATEJUMP_MEMBER(GenericSpheresContact, contactPoint, 56, 24)
STATEJUMP_MEMBER(GenericSpheresContact, refR1, 80, 8)
STATEJUMP_MEMBER(GenericSpheresContact, refR2, 88, 8)

static_assert(sizeof(yade::IPhys) == 32);

static_assert(sizeof(yade::NormPhys) == 64);
STATEJUMP_MEMBER(NormPhys, kn, 32, 8)
STATEJUMP_MEMBER(NormPhys, normalForce, 40, 24)

static_assert(sizeof(yade::NormShearPhys) == 96);
STATEJUMP_MEMBER(NormShearPhys, ks, 64, 8)
STATEJUMP_MEMBER(NormShearPhys, shearForce, 72, 24)

static_assert(sizeof(yade::FrictPhys) == 104);
STATEJUMP_MEMBER(FrictPhys, tangensOfFrictionAngle, 96, 8)

static_assert(sizeof(yade::Interaction) == 168);
STATEJUMP_MEMBER(Interaction, isActive, 24, 1)
STATEJUMP_MEMBER(Interaction, functorCache, 32, 56)
STATEJUMP_MEMBER(Interaction, id1, 88, 4)
STATEJUMP_MEMBER(Interaction, id2, 92, 4)
STATEJUMP_MEMBER(Interaction, iterMadeReal, 96, 8)
STATEJUMP_MEMBER(Interaction, iterLastSeen, 104, 8)
STATEJUMP_MEMBER(Interaction, geom, 112, 16)
STATEJUMP_MEMBER(Interaction, phys, 128, 16)
STATEJUMP_MEMBER(Interaction, cellDist, 144, 12)
STATEJUMP_MEMBER(Interaction, linIx, 156, 4)
STATEJUMP_MEMBER(Interaction, iterBorn, 160, 8)

static_assert(sizeof(yade::Body) == 176);
STATEJUMP_MEMBER(Body, id, 24, 4)
STATEJUMP_MEMBER(Body, groupMask, 28, 4)
STATEJUMP_MEMBER(Body, flags, 32, 4)
STATEJUMP_MEMBER(Body, subdomain, 36, 4)
STATEJUMP_MEMBER(Body, material, 40, 16)
STATEJUMP_MEMBER(Body, state, 56, 16)
STATEJUMP_MEMBER(Body, shape, 72, 16)
STATEJUMP_MEMBER(Body, bound, 88, 16)
STATEJUMP_MEMBER(Body, intrs, 104, 48)
STATEJUMP_MEMBER(Body, clumpId, 152, 4)
STATEJUMP_MEMBER(Body, iterBorn, 160, 8)
STATEJUMP_MEMBER(Body, timeBorn, 168, 8)

static_assert(sizeof(yade::ForceContainer) == 304);

static_assert(sizeof(yade::BodyContainer) == 200);
STATEJUMP_MEMBER(BodyContainer, body, 24, 24)
STATEJUMP_MEMBER(BodyContainer, dirty, 48, 1)
STATEJUMP_MEMBER(BodyContainer, checkedByCollider, 49, 1)
STATEJUMP_MEMBER(BodyContainer, insertedBodies, 56, 24)
STATEJUMP_MEMBER(BodyContainer, erasedBodies, 80, 24)
STATEJUMP_MEMBER(BodyContainer, realBodies, 104, 24)
STATEJUMP_MEMBER(BodyContainer, useRedirection, 128, 1)
STATEJUMP_MEMBER(BodyContainer, enableRedirection, 129, 1)
STATEJUMP_MEMBER(BodyContainer, subdomainBodies, 136, 24)
STATEJUMP_MEMBER(BodyContainer, drawloopmutex, 160, 40)

static_assert(sizeof(yade::InteractionContainer) == 192);
STATEJUMP_MEMBER(InteractionContainer, linIntrs, 24, 24)
STATEJUMP_MEMBER(InteractionContainer, sortedIntrs, 48, 24)
STATEJUMP_MEMBER(InteractionContainer, bodies, 72, 8)
STATEJUMP_MEMBER(InteractionContainer, currSize, 80, 8)
STATEJUMP_MEMBER(InteractionContainer, empty, 88, 16)
STATEJUMP_MEMBER(InteractionContainer, interaction, 104, 24)
STATEJUMP_MEMBER(InteractionContainer, dirty, 128, 1)
STATEJUMP_MEMBER(InteractionContainer, drawloopmutex, 136, 40)
STATEJUMP_MEMBER(InteractionContainer, serializeSorted, 176, 1)
STATEJUMP_MEMBER(InteractionContainer, iterColliderLastRun, 184, 8)

static_assert(sizeof(yade::EnergyTracker) == 176);

static_assert(sizeof(yade::Scene) == 752);
STATEJUMP_MEMBER(Scene, hostNameMax, 24, 4)
STATEJUMP_MEMBER(Scene, forces, 32, 304)
STATEJUMP_MEMBER(Scene, speedElements, 336, 80)
STATEJUMP_MEMBER(Scene, renderer, 416, 16)
STATEJUMP_MEMBER(Scene, prevTime, 432, 8)
STATEJUMP_MEMBER(Scene, dt, 440, 8)
STATEJUMP_MEMBER(Scene, iter, 448, 8)
STATEJUMP_MEMBER(Scene, subStepping, 456, 1)
STATEJUMP_MEMBER(Scene, subStep, 460, 4)
STATEJUMP_MEMBER(Scene, time, 464, 8)
STATEJUMP_MEMBER(Scene, speed, 472, 8)
STATEJUMP_MEMBER(Scene, stopAtIter, 480, 8)
STATEJUMP_MEMBER(Scene, stopAtTime, 488, 8)
STATEJUMP_MEMBER(Scene, isPeriodic, 496, 1)
STATEJUMP_MEMBER(Scene, trackEnergy, 497, 1)
STATEJUMP_MEMBER(Scene, doSort, 498, 1)
STATEJUMP_MEMBER(Scene, runInternalConsistencyChecks, 499, 1)
STATEJUMP_MEMBER(Scene, selectedBody, 500, 4)
STATEJUMP_MEMBER(Scene, subdomain, 504, 4)
STATEJUMP_MEMBER(Scene, subD, 512, 16)
STATEJUMP_MEMBER(Scene, tags, 528, 24)
STATEJUMP_MEMBER(Scene, engines, 552, 24)
STATEJUMP_MEMBER(Scene, nextEngines, 576, 24)
STATEJUMP_MEMBER(Scene, bodies, 600, 16)
STATEJUMP_MEMBER(Scene, interactions, 616, 16)
STATEJUMP_MEMBER(Scene, energy, 632, 16)
STATEJUMP_MEMBER(Scene, materials, 648, 24)
STATEJUMP_MEMBER(Scene, bound, 672, 16)
STATEJUMP_MEMBER(Scene, cell, 688, 16)
STATEJUMP_MEMBER(Scene, miscParams, 704, 24)
STATEJUMP_MEMBER(Scene, dispParams, 728, 24)

static_assert(sizeof(yade::Functor) == 80);
STATEJUMP_MEMBER(Functor, timingDeltas, 24, 16)
STATEJUMP_MEMBER(Functor, scene, 40, 8)
STATEJUMP_MEMBER(Functor, label, 48, 32)

static_assert(sizeof(yade::BoundFunctor) == 88);

static_assert(sizeof(yade::IGeomFunctor) == 88);

static_assert(sizeof(yade::IPhysFunctor) == 88);

static_assert(sizeof(yade::LawFunctor) == 88);

static_assert(sizeof(yade::GlShapeFunctor) == 88);

static_assert(sizeof(yade::TimingInfo) == 16);
STATEJUMP_MEMBER(TimingInfo, nExec, 0, 8)
STATEJUMP_MEMBER(TimingInfo, nsec, 8, 8)

static_assert(sizeof(yade::Engine) == 104);
STATEJUMP_MEMBER(Engine, scene, 24, 8)
STATEJUMP_MEMBER(Engine, timingInfo, 32, 16)
STATEJUMP_MEMBER(Engine, timingDeltas, 48, 16)
STATEJUMP_MEMBER(Engine, dead, 64, 1)
STATEJUMP_MEMBER(Engine, ompThreads, 68, 4)
STATEJUMP_MEMBER(Engine, label, 72, 32)

static_assert(sizeof(yade::GlobalEngine) == 104);

// The parts of ForceContainer and EnergyTracker stay opaque.
// offsetof takes no references: State::pos and State::ori fill what is left before the mutex, and
// guard.cpp checks where they point to.
static_assert(offsetof(yade::State, updateMutex) ==
              sizeof(yade::Serializable) + sizeof(yade::Indexable) + 2 * sizeof(void*));

// A member that is a structure of its own.
using FunctorCache = yade::Interaction::FunctorCache;
static_assert(offsetof(FunctorCache, geomExists) == 0 && offsetof(FunctorCache, geom) == 8);
static_assert(offsetof(FunctorCache, phys) == 24 && offsetof(FunctorCache, constLaw) == 40);

// The second base of a functor, where multiple dispatch calls it.
static_assert(sizeof(yade::Functor) == 80 && sizeof(yade::BoundFunctor) == 80 + sizeof(void*));

#undef STATEJUMP_MEMBER
#pragma GCC diagnostic pop

}  // namespace statejump::yade_abi
