// SPDX-License-Identifier: GPL-3.0-or-later
// Draws journals, bearings, balls, sockets, sliders and slots in YADE's 3-D view.
#pragma once

#include <type_traits>

#include "bore.hpp"
#include "registered.hpp"
#include "shapes.hpp"

#ifdef STATEJUMP_HAS_VIEW
namespace statejump::dem {

// Makes a 3-D view that started before the plugin was loaded find the plugin's drawing functors.
// Without this call, YADE ends with a failed assertion when such a view draws a shape of the
// plugin.
void refresh_view();

// Magnification of a journal's play in drawings. It is static, because YADE constructs the view
// functors itself and scripts cannot access them.
struct ViewSettings {
  static Real clearance_scale() { return clearance_scale_; }
  static void set_clearance_scale(Real scale);

 private:
  static Real clearance_scale_;
};

void draw(const Journal& journal, const yade::State& state, bool wire);
void draw(const Bearing& bearing, const yade::State& state, bool wire);
void draw(const Ball& ball, const yade::State& state, bool wire);
void draw(const Socket& socket, const yade::State& state, bool wire);
void draw(const MeshBore& bore, const yade::State& state, bool wire);
void draw(const Slider& slider, const yade::State& state, bool wire);
void draw(const SlotFace& face, const yade::State& state, bool wire);

template <class ShapeOfOurs>
struct Gl1 : Registered<Gl1<ShapeOfOurs>, yade::GlShapeFunctor> {
  static constexpr const char* class_name = ShapeOfOurs::view_functor_name;
  static constexpr const char* base_name = "GlShapeFunctor";
  static constexpr const char* doc =
      "Draws the shape at its current temperature in YADE's 3-D view. Import statejump_yade before "
      "the view opens. Gl1_Journal.clearanceScale, 1 at first, of the class and not of an "
      "instance: "
      "how many times larger than it is the play of each journal in its bearing is drawn [-]. The "
      "journal is drawn thinner and its offset from the centre of the nearest bearing longer by "
      "the same factor, so that touching stays touching; the factor is limited where the journal "
      "would shrink below 0.3 of the bearing.";
  using yade::GlShapeFunctor::go;
  void go(const yade::shared_ptr<yade::Shape>& shape, const yade::shared_ptr<yade::State>& state,
          bool wire, const yade::GLViewInfo&) override {
    draw(static_cast<const ShapeOfOurs&>(*shape), *state, wire || shape->wire);
  }
  std::string get1DFunctorType1() const override { return ShapeOfOurs::class_name; }
  std::string renders() const override { return ShapeOfOurs::class_name; }
  static auto attributes() { return std::make_tuple(); }
  template <class PythonClass>
  static void register_methods(PythonClass& entry) {
    if constexpr (std::is_same_v<ShapeOfOurs, Journal>) {
      entry.add_static_property("clearanceScale", &ViewSettings::clearance_scale,
                                &ViewSettings::set_clearance_scale);
    }
  }
};

}  // namespace statejump::dem
#endif
