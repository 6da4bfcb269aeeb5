// Measured sizes and offsets of YADE 2023.02a (Debian 12, amd64, double), held against the
// declarations at compile time. The running libraries are held against them in guard.cpp.
#pragma once

#include <cstddef>

#include "statejump/yade_abi/dispatch.hpp"

namespace statejump::yade_abi {

#pragma GCC diagnostic push
// The classes have virtual functions; GCC lays out their single bases as offsetof assumes.
#pragma GCC diagnostic ignored "-Winvalid-offsetof"

static_assert(sizeof(yade::Vector3r) == 24 && sizeof(yade::Quaternionr) == 32);
static_assert(sizeof(yade::Factorable) == 24 && sizeof(yade::Serializable) == 24);
static_assert(sizeof(yade::Indexable) == 8);

static_assert(sizeof(yade::Shape) == 96);
static_assert(offsetof(yade::Shape, boundFunctor) == 32);
static_assert(offsetof(yade::Shape, color) == 64);
static_assert(offsetof(yade::Shape, wire) == 88);
static_assert(offsetof(yade::Shape, highlight) == 89);

static_assert(sizeof(yade::Bound) == 144 && sizeof(yade::Aabb) == 144);
static_assert(offsetof(yade::Bound, lastUpdateIter) == 32);
static_assert(offsetof(yade::Bound, refPos) == 40);
static_assert(offsetof(yade::Bound, sweepLength) == 64);
static_assert(offsetof(yade::Bound, color) == 72);
static_assert(offsetof(yade::Bound, min) == 96);
static_assert(offsetof(yade::Bound, max) == 120);

static_assert(sizeof(yade::Material) == 80);
static_assert(offsetof(yade::Material, id) == 32);
static_assert(offsetof(yade::Material, label) == 40);
static_assert(offsetof(yade::Material, density) == 72);
static_assert(sizeof(yade::ElastMat) == 96 && sizeof(yade::FrictMat) == 104);
static_assert(offsetof(yade::FrictMat, young) == 80);
static_assert(offsetof(yade::FrictMat, poisson) == 88);
static_assert(offsetof(yade::FrictMat, frictionAngle) == 96);

static_assert(sizeof(yade::State) == 320);
static_assert(offsetof(yade::State, se3) == 88);
static_assert(offsetof(yade::State, vel) == 144);
static_assert(offsetof(yade::State, mass) == 168);
static_assert(offsetof(yade::State, angVel) == 176);
static_assert(offsetof(yade::State, inertia) == 224);
static_assert(offsetof(yade::State, refOri) == 272);
static_assert(offsetof(yade::State, blockedDOFs) == 304);
static_assert(offsetof(yade::State, isDamped) == 308);
static_assert(offsetof(yade::State, densityScaling) == 312);

static_assert(sizeof(yade::Body) == 176);
static_assert(offsetof(yade::Body, id) == 24);
static_assert(offsetof(yade::Body, flags) == 32);
static_assert(offsetof(yade::Body, material) == 40);
static_assert(offsetof(yade::Body, state) == 56);
static_assert(offsetof(yade::Body, shape) == 72);
static_assert(offsetof(yade::Body, bound) == 88);
static_assert(offsetof(yade::Body, intrs) == 104);
static_assert(offsetof(yade::Body, clumpId) == 152);

static_assert(sizeof(yade::IGeom) == 32 && sizeof(yade::IPhys) == 32);
static_assert(sizeof(yade::GenericSpheresContact) == 96);
static_assert(offsetof(yade::GenericSpheresContact, normal) == 32);
static_assert(offsetof(yade::GenericSpheresContact, contactPoint) == 56);
static_assert(offsetof(yade::GenericSpheresContact, refR1) == 80);
static_assert(offsetof(yade::GenericSpheresContact, refR2) == 88);
static_assert(sizeof(yade::NormPhys) == 64 && sizeof(yade::NormShearPhys) == 96);
static_assert(sizeof(yade::FrictPhys) == 104);
static_assert(offsetof(yade::FrictPhys, kn) == 32);
static_assert(offsetof(yade::FrictPhys, normalForce) == 40);
static_assert(offsetof(yade::FrictPhys, ks) == 64);
static_assert(offsetof(yade::FrictPhys, shearForce) == 72);
static_assert(offsetof(yade::FrictPhys, tangensOfFrictionAngle) == 96);

static_assert(sizeof(yade::Interaction) == 168);
static_assert(offsetof(yade::Interaction, functorCache) == 32);
static_assert(offsetof(yade::Interaction, id1) == 88);
static_assert(offsetof(yade::Interaction, id2) == 92);
static_assert(offsetof(yade::Interaction, geom) == 112);
static_assert(offsetof(yade::Interaction, phys) == 128);
static_assert(offsetof(yade::Interaction, linIx) == 156);

static_assert(sizeof(yade::Functor) == 80);
static_assert(offsetof(yade::Functor, scene) == 40);
static_assert(offsetof(yade::Functor, label) == 48);
static_assert(sizeof(yade::BoundFunctor) == 88 && sizeof(yade::IGeomFunctor) == 88);
static_assert(sizeof(yade::IPhysFunctor) == 88 && sizeof(yade::LawFunctor) == 88);

static_assert(sizeof(yade::Engine) == 104 && sizeof(yade::GlobalEngine) == 104);
static_assert(offsetof(yade::Engine, scene) == 24);
static_assert(offsetof(yade::Engine, timingInfo) == 32);
static_assert(offsetof(yade::Engine, dead) == 64);
static_assert(offsetof(yade::Engine, ompThreads) == 68);
static_assert(offsetof(yade::Engine, label) == 72);

// Scene is declared up to `energy` only: it is never created or copied here.
static_assert(offsetof(yade::Scene, forces) == 32);
static_assert(sizeof(yade::ForceContainer) == 304);
static_assert(offsetof(yade::Scene, dt) == 440);
static_assert(offsetof(yade::Scene, iter) == 448);
static_assert(offsetof(yade::Scene, time) == 464);
static_assert(offsetof(yade::Scene, stopAtIter) == 480);
static_assert(offsetof(yade::Scene, isPeriodic) == 496);
static_assert(offsetof(yade::Scene, trackEnergy) == 497);
static_assert(offsetof(yade::Scene, engines) == 552);
static_assert(offsetof(yade::Scene, bodies) == 600);
static_assert(offsetof(yade::Scene, interactions) == 616);
static_assert(offsetof(yade::Scene, energy) == 632);
static_assert(offsetof(yade::BodyContainer, body) == 24);
static_assert(offsetof(yade::InteractionContainer, linIntrs) == 24);
static_assert(offsetof(yade::InteractionContainer, currSize) == 80);

#pragma GCC diagnostic pop

}  // namespace statejump::yade_abi
