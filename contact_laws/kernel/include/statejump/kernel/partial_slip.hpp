// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "statejump/kernel/partial_slip_loss.hpp"
#include "statejump/kernel/partial_slip_memory.hpp"

namespace statejump::kernel {

namespace detail {

/// Computes one step, from the trial state to the new memory.
class PartialSlipStep {
 public:
  /// @param memory state before the step; run() updates it
  PartialSlipStep(double stiffness, double limit, const Tangent& slide, PartialSlipMemory& memory)
      : edge_(stiffness),
        square_(stiffness * stiffness),
        slope_(1.5 * limit / (stiffness * square_)),
        slide_(slide),
        old_(memory),
        old_edge_(memory.edge()),
        tracks_energy_(memory.tracks_energy()),
        smallest_(1e-15 * slope_ * square_) {}

  /// Loss [J] of annuli whose pressure decreases uniformly to zero during a step.
  static double released(const Tangent& slide, PartialSlipMemory& memory) {
    const PartialSlipStep step(memory.edge() * 1e-9, 0.0, slide, memory);
    double sum = 0.0;
    for (int i = 1; i < memory.size(); ++i) {
      sum += step.leaving_loss(memory[i - 1], memory[i], memory.edge() * memory.edge());
    }
    return sum;
  }

  PartialSlipResponse run() {
    stuck_ = count_stuck();
    if (stuck_ < old_.prefix().count) old_.flush_prefix();
    make_trial();
    slipping_ = stuck_ == 0;  // no annulus sticks, except the rim, which carries no force
    for (int i = 0; slipping_ && i + 1 < knots_; ++i) slipping_ = at(i).outside;
    add(at(0).x, at(0).outside ? projected(at(0)) : at(0).trial, false);
    for (int i = 1; i < knots_; ++i) {
      pieces_left_ = knots_ - i;
      if (at(i - 1).outside || at(i).outside) {
        add_piece(at(i - 1), at(i));
      } else {
        add_stuck(at(i).x, at(i).trial);
      }
    }
    store_memory();
    return response_of(old_, loss_, slipping_);
  }

 private:
  /// A point of the trial state: the old profile and its change in this step.
  struct Knot {
    double x;
    Tangent old;
    double fraction;  ///< fraction of the slide during which this annulus is in contact
    Tangent trial;    ///< old + fraction slide
    double bound;     ///< current bound on |U|
    bool outside;
  };

  /// Number of points, counted from the centre, that certainly stick and hence only move with the
  /// slide. Slip starts at the rim, so these are nearly all points of a sticking contact. The count
  /// ends `neighbours` points before the first point that may slip. Only the points after it are
  /// examined for slip; the counted points are stored as a prefix with one common displacement.
  int count_stuck() {
    constexpr int neighbours = 2;
    const int most = old_.size() - neighbours + 1;
    if (most <= neighbours) return 0;
    const int prefix = old_.prefix().count;
    if (prefix > 0 && !old_.prefix_fits(slide_, bound(0.0), bound(old_[prefix - 1].x))) {
      old_.flush_prefix();
    }
    int inside = old_.prefix().count;
    while (inside < most && !outside(old_[inside])) ++inside;
    return std::max(0, (inside < most ? inside : most) - neighbours);
  }

  bool outside(const PartialSlipMemory::Point& point) const {
    const double outer = bound(point.x) + smallest_;
    return !(point.x < edge_) || (point.u + slide_).squared() > outer * outer;
  }

  const Knot& at(int i) const { return knot_[static_cast<std::size_t>(i)]; }

  double bound(double x) const { return slope_ * (edge_ - x) * (edge_ + x); }
  double old_bound(double x) const {
    return std::max(0.0, old_.slope() * (old_edge_ - x) * (old_edge_ + x));
  }

  Knot knot(double x, const Tangent& old, double fraction) const {
    const Tangent trial = old + fraction * slide_;
    const double most = bound(x);
    const double outer = most + smallest_;
    return {x, old, fraction, trial, most, trial.squared() > outer * outer};
  }

  static Tangent projected(const Knot& k) {
    const double size = k.trial.norm();
    return size > 0.0 ? (k.bound / size) * k.trial : Tangent{};
  }

  /// Creates knots, between which all functions are linear in x^2. Annuli that leave the contact
  /// lose their energy.
  void make_trial() {
    if (old_.size() == 0) push(knot(0.0, {}, 1.0));
    int i = stuck_;
    for (; i < old_.size() && old_[i].x < edge_; ++i) push(knot(old_[i].x, old_[i].u, 1.0));
    if (edge_ > old_edge_) {
      push(knot(edge_, {}, 0.0));
      return;
    }
    PartialSlipMemory::Point cut = old_[i];
    if (i > 0 && cut.x > edge_) cut = {edge_, between(old_[i - 1], cut, edge_)};
    push(knot(edge_, cut.u, 1.0));
    for (; i < old_.size(); ++i) {
      add_leaving_loss(cut, old_[i]);
      cut = old_[i];
    }
  }

  void push(const Knot& k) { knot_[static_cast<std::size_t>(knots_++)] = k; }

  static Tangent between(const PartialSlipMemory::Point& a, const PartialSlipMemory::Point& b,
                         double x) {
    return a.u + ((x - a.x) * (x + a.x) / ((b.x - a.x) * (b.x + a.x))) * (b.u - a.u);
  }

  /// Adds the loss of annuli that leave the contact during the step. The square of the edge radius
  /// decreases linearly in time.
  void add_leaving_loss(const PartialSlipMemory::Point& a, const PartialSlipMemory::Point& b) {
    if (!tracks_energy_) return;
    const double fall = (old_edge_ - edge_) * (old_edge_ + edge_);
    if (b.x > a.x && fall > 0.0) loss_ += leaving_loss(a, b, fall);
  }
  double leaving_loss(const PartialSlipMemory::Point& a, const PartialSlipMemory::Point& b,
                      double fall) const {
    const auto annulus = [&](double x, const Tangent& u) {
      return std::pair{u, ((old_edge_ - x) * (old_edge_ + x) / fall) * slide_};
    };
    const auto [start_a, slide_a] = annulus(a.x, a.u);
    const auto [start_b, slide_b] = annulus(b.x, b.u);
    const Tangent end_a = start_a + slide_a;
    const Tangent end_b = start_b + slide_b;
    if (end_a.dot(end_b) < 0.0) {  // the two ends leave in opposite directions: split where U is 0
      const double size_a = end_a.norm();
      const double s = size_a / (size_a + end_b.norm());
      const double x = std::sqrt(a.x * a.x + s * (b.x - a.x) * (b.x + a.x));
      if (x > a.x && x < b.x) {
        const PartialSlipMemory::Point middle{x, between(a, b, x)};
        return leaving_loss(a, middle, fall) + leaving_loss(middle, b, fall);
      }
    }
    const Tangent axis = direction(end_a + end_b);
    return loss(a.x, {start_a.dot(axis), slide_a.dot(axis), old_bound(a.x), 0.0}, b.x,
                {start_b.dot(axis), slide_b.dot(axis), old_bound(b.x), 0.0});
  }

  static Tangent direction(const Tangent& v) {
    const double size = v.norm();
    return size > 0.0 ? (1.0 / size) * v : Tangent{1.0, 0.0};
  }

  /// Adds the piece between two knots. Annuli outside the bound are projected onto it.
  void add_piece(const Knot& a, const Knot& b) {
    if (a.outside && b.outside && is_chord_of_bound(a, b)) {
      slip(a, b);
    } else if (a.outside && b.outside) {
      const double first = crossing(a, b);
      const double second = 1.0 - crossing(b, a);
      if (first < second) {
        const Knot in = knot_at(a, b, first);
        const Knot out = knot_at(a, b, second);
        slip(a, in);
        add(out.x, out.trial, false);
        slip(out, b);
      } else {
        slip(a, b);
      }
    } else if (b.outside) {
      const Knot edge = knot_at(a, b, 1.0 - std::min(1.0, crossing(b, a)));
      add(edge.x, edge.trial, false);
      slip(edge, b);
    } else {
      slip(a, knot_at(a, b, std::min(1.0, crossing(a, b))));
      add(b.x, b.trial, false);
    }
  }

  /// Position where |U| reaches the bound, as a fraction of the distance in x^2 from a knot outside
  /// the bound to another one; 2 if |U| does not reach it. The function |U| - bound is convex
  /// there, so Newton's method does not overshoot. If U has one direction, the first Newton step is
  /// exact.
  double crossing(const Knot& out, const Knot& other) const {
    const Tangent span = other.trial - out.trial;
    const double fall = other.bound - out.bound;
    double s = 0.0;
    for (int i = 0; i < 30; ++i) {
      const Tangent u = out.trial + s * span;
      const double size = u.norm();
      const double beyond = size - (out.bound + s * fall);
      if (i > 0 && beyond <= smallest_) return s;
      const double change = u.dot(span) - size * fall;
      if (!(change < 0.0)) return 2.0;
      s -= beyond * size / change;
      if (s > 1.0) return 2.0;
    }
    return s;
  }

  /// The knot at a fraction of the distance in x^2.
  Knot knot_at(const Knot& a, const Knot& b, double s) const {
    const double x = std::sqrt(a.x * a.x + s * (b.x - a.x) * (b.x + a.x));
    Knot k{std::clamp(x, a.x, b.x),
           a.old + s * (b.old - a.old),
           a.fraction + s * (b.fraction - a.fraction),
           a.trial + s * (b.trial - a.trial),
           0.0,
           false};
    k.bound = bound(k.x);
    return k;
  }

  /// Adds a piece that slips as a whole. If its old direction differs from the slide, the direction
  /// changes along the piece. Chords then approximate it, each within chord_tolerance() in this
  /// step.
  void slip(const Knot& a, const Knot& b, int depth = 0) {
    if (!(b.x > a.x)) return;
    const double cross = a.trial.a * b.trial.b - a.trial.b * b.trial.a;
    const double along = a.trial.dot(b.trial);
    const bool turns = std::abs(cross) > straight * std::abs(along) || along < 0.0;
    if (turns && depth < most_divisions && knots_left()) {
      const Knot middle = knot_at(a, b, 0.5);
      // The annulus in the middle gets the mean |U| of the two end annuli. Thus its distance from
      // its slip limit is the mean of their distances.
      Knot annulus = middle;
      annulus.old = (0.5 * (a.old.norm() + b.old.norm())) * direction(middle.old);
      annulus.trial = annulus.old + annulus.fraction * slide_;
      const Tangent off = (projected(annulus) - annulus.old) -
                          0.5 * ((projected(a) - a.old) + (projected(b) - b.old));
      if (off.norm() * (b.x - a.x) > chord_tolerance()) {
        slip(a, middle, depth + 1);
        slip(middle, b, depth + 1);
        return;
      }
    }
    if (!tracks_energy_) {
      // energies are not requested
    } else if (turns && on_old_bound(a) && on_old_bound(b)) {
      loss_ += loss_of_chord(a, b);
    } else {
      const Tangent axis = direction(a.trial + b.trial);
      const auto annulus = [&](const Knot& k) {
        const Tangent own = turns ? direction(k.trial) : axis;
        return SlipAnnulus{k.old.dot(own), k.fraction * slide_.dot(own), old_bound(k.x), k.bound};
      };
      loss_ += loss(a.x, annulus(a), b.x, annulus(b));
    }
    add(b.x, projected(b), true);
  }

  /// Allowed change of force by one chord in this step [N]. During the slide that erases the
  /// memory, these changes sum to `chord` times the limit, for any number of steps.
  double chord_tolerance() const {
    return chord * edge_ * std::min(slope_ * square_, slide_.norm());
  }

  bool on_old_bound(const Knot& k) const { return k.old.norm() >= (1.0 - 1e-9) * old_bound(k.x); }
  static bool differ_in_direction(const Tangent& a, const Tangent& b) {
    const double cross = a.a * b.b - a.b * b.a;
    return cross * cross > straight * straight * (a.squared() * b.squared());
  }

  /// Returns whether the piece is a chord of the bound: the annuli between the two knots slipped,
  /// in directions between those of the knots. The chord itself lies within the bound, so without
  /// this test its annuli would seem to stick.
  bool is_chord_of_bound(const Knot& a, const Knot& b) const {
    constexpr double near = 0.8;  // cosine; slipping chords are divided at much smaller angles, a
                                  // kink is not such a chord
    return differ_in_direction(a.old, b.old) &&
           a.old.dot(b.old) > near * std::sqrt(a.old.squared() * b.old.squared()) &&
           on_old_bound(a) && on_old_bound(b);
  }

  /// Loss of annuli that slip during the whole step, as they do on a chord of the bound: the mean
  /// of U at both ends of the step, times the slip. With this value the energies balance.
  static double loss_of_chord(const Knot& a, const Knot& b) {
    const auto mean = [](const Knot& k) { return 0.5 * (k.old + projected(k)); };
    const auto slipped = [](const Knot& k) { return k.trial - projected(k); };
    const ProductWeights w(a.x, b.x);
    return std::max(0.0, w.weight_aa * mean(a).dot(slipped(a)) +
                             w.weight_bb * mean(b).dot(slipped(b)) +
                             w.weight_ab * (mean(a).dot(slipped(b)) + mean(b).dot(slipped(a))));
  }

  /// Returns whether the arrays have room to divide a chord. Each remaining piece may add three
  /// points, each half of a divided chord one point.
  bool knots_left() const {
    return stuck_ + size_ + 3 * pieces_left_ + 2 * most_divisions < largest;
  }

  /// Adds a point of the new profile.
  /// @param on_bound whether the piece that ends at this point follows the bound
  void add(double x, const Tangent& u, bool on_bound) {
    add_checked(x, u, on_bound);
    turns_ =
        size_ > 1 && differ_in_direction(point_[static_cast<std::size_t>(size_ - 2)].u, last().u);
  }

  /// Adds a point within the bound after at least one other point. It usually needs no comparison
  /// with earlier points.
  void add_stuck(double x, const Tangent& u) {
    if (turns_ || !(x > last().x) || differ_in_direction(last().u, u)) {
      add(x, u, false);
      return;
    }
    follows_ = false;
    point_[static_cast<std::size_t>(size_++)] = {x, u};
  }

  void add_checked(double x, const Tangent& u, bool on_bound) {
    if (size_ > 0 && !(x > last().x)) {
      if (on_bound) last().u = u;
      return;
    }
    if (on_bound && follows_ && size_ > 1) {
      // two adjacent pieces on the bound with the same direction become one piece
      const Tangent& p = last().u;
      const Tangent& q = point_[static_cast<std::size_t>(size_ - 2)].u;
      const double cross = p.a * q.b - p.b * q.a;
      const bool end = !(u.squared() > 0.0);
      const double next = end ? 0.0 : p.a * u.b - p.b * u.a;
      if (std::abs(cross) <= straight * std::sqrt(p.squared() * q.squared()) && p.dot(q) > 0.0 &&
          std::abs(next) <= straight * std::sqrt(p.squared() * u.squared()) && p.dot(u) >= 0.0) {
        last() = {x, u};
        return;
      }
    }
    if (size_ > 1) {
      // drop the last point if its removal changes the force by less than the tolerance of a chord
      const PartialSlipMemory::Point& before = point_[static_cast<std::size_t>(size_ - 2)];
      if ((turns_ || differ_in_direction(last().u, u)) &&
          point_removal(before, last(), {x, u}).force() <= 0.25 * chord_tolerance()) {
        last() = {x, u};
        follows_ = follows_ && on_bound;
        return;
      }
    }
    follows_ = on_bound;
    point_[static_cast<std::size_t>(size_++)] = {x, u};
  }

  PartialSlipMemory::Point& last() { return point_[static_cast<std::size_t>(size_ - 1)]; }

  /// Writes the new profile. Removes points without effect. If too many points remain, merges those
  /// that change the force least.
  void store_memory() {
    double merged = old_.merged();
    // When the contact grows, its old edge lies on a line between neighbours if the path is
    // straight, and near one in small steps of a curve. The threshold is a thousandth of the least
    // merged change.
    const double nothing = edge_ > old_edge_ ? 1e-3 * least_merged * limit() : 0.0;
    for (int i = size_ - 2; i > 0 && i >= size_ - 3; --i) {
      const auto j = static_cast<std::size_t>(i);
      const PointRemoval removal = point_removal(point_[j - 1], point_[j], point_[j + 1]);
      if (removal.squared_offset > 100.0 * smallest_ * smallest_) {
        if (removal.exceeds(nothing)) continue;
        merged += removal.force();
      }
      drop(i);
    }
    if (stuck_ + size_ > PartialSlipMemory::capacity) merged += merge();
    old_.keep(stuck_, slide_, slope_, merged);
    update_prefix();
    old_.append(point_.data(), size_);
  }

  /// Extends the prefix, i.e. the first points, whose common motion is stored once. Points are
  /// added if they would still stick after `steps` steps like this one. The extension visits all
  /// points, so it must gain at least `least` points.
  void update_prefix() {
    constexpr int least = 4;
    constexpr int loose = 2;  // neighbours of the changing points, which often change with them
    constexpr double steps = 32.0;
    const int prefix = old_.prefix().count;
    const int most = stuck_ - loose;
    if (most < prefix + least) return;
    const double wanted =
        steps * (std::abs(slide_.a) + std::abs(slide_.b) + std::abs(bound(0.0) - old_bound(0.0)));
    double room = bound(0.0);  // smallest distance to the bound of the visited points [m]
    const auto end_from = [&](int i, int last) {
      while (i < last) {
        const auto [x, u] = old_[i];
        const double next = std::min(room, bound(x) - std::abs(u.a) - std::abs(u.b));
        if (!(next >= wanted)) break;
        room = next;
        ++i;
      }
      return i;
    };
    if (end_from(prefix, prefix + least) < prefix + least) return;
    old_.flush_prefix();
    room = bound(0.0);
    const int end = end_from(0, most);
    if (end >= least) old_.set_prefix(end, bound(0.0) - room, bound(old_[end - 1].x) - room);
  }

  /// Replaces points that change the force least by chords.
  /// @return sum of the force changes [N]
  double merge() {
    old_.flush_prefix();
    std::copy_backward(point_.begin(), point_.begin() + size_, point_.begin() + stuck_ + size_);
    for (int i = 0; i < stuck_; ++i) {
      point_[static_cast<std::size_t>(i)] = {old_[i].x, old_[i].u + slide_};
    }
    size_ += stuck_;
    stuck_ = 0;
    constexpr int kept = 3 * PartialSlipMemory::capacity / 4;
    double least = least_merged * limit();
    double merged = 0.0;
    while (size_ > kept) {
      for (int i = size_ - 2; i > 0 && size_ > kept; i -= 2) {
        const auto j = static_cast<std::size_t>(i);
        const double change = point_removal(point_[j - 1], point_[j], point_[j + 1]).force();
        if (change > least) continue;
        merged += change;
        drop(i);
      }
      least *= 4.0;
    }
    return merged;
  }

  void drop(int i) {
    std::copy(point_.begin() + i + 1, point_.begin() + size_, point_.begin() + i);
    --size_;
  }

  double limit() const { return slope_ * square_ * edge_ / 1.5; }  ///< mu F_N [N]

  static constexpr double least_merged = 1e-9;  // fraction of the force limit
  static constexpr double straight = 1e-8;      // [rad]; such a chord is 1e-17 shorter than its arc
  static constexpr double chord = 1e-4;
  static constexpr int most_divisions = 8;  // largest number of divisions of a chord
  static constexpr int largest = 4 * PartialSlipMemory::capacity;

  double edge_;    // 8 G* a now
  double square_;  // its square
  double slope_;   // |U| <= slope_ (edge_^2 - x^2)
  Tangent slide_;
  PartialSlipMemory& old_;  // memory before the step, overwritten by store()
  double old_edge_;
  bool tracks_energy_;  // whether energies are requested
  double smallest_;     // rounding error of the largest bound [m]
  double loss_ = 0.0;
  bool slipping_ = false;
  bool follows_ = false;  // the last piece follows the bound
  bool turns_ = false;    // U changes direction along the last piece
  int stuck_ = 0;         // points that only move with the slide; point_ holds the others
  int knots_ = 0;
  int pieces_left_ = 0;  // number of pieces to add, including the current one
  int size_ = 0;
  std::array<Knot, static_cast<std::size_t>(PartialSlipMemory::capacity) + 2> knot_;
  std::array<PartialSlipMemory::Point, static_cast<std::size_t>(largest)> point_;
};

}  // namespace detail

/// One step of Hertz's contact with partial slip, along a straight path. Slip starts at the rim,
/// before the contact slides as a whole (Cattaneo 1938; Mindlin 1949; Mindlin and Deresiewicz
/// 1953).
/// before the contact slides as a whole (Cattaneo 1938; Mindlin 1949; Mindlin and Deresiewicz
/// 1953).
///
/// Derivation. A growing normal contact is a sequence of flat punches. When the radius grows from r
/// by dr, the approach grows by d(delta) and the pressure by that of a rigid punch of radius r. Let
/// x = 8 G* r be Mindlin's stiffness of that punch and w = E*/(4 G*) delta (so that dF_N = x dw).
/// Then Hertz's sphere is w = 3/2 C x^2 and F_N = C x^3, with C = F_N/k^3 and k = 8 G* a. The same
/// punches, moved sideways by s(x) dw, carry the tractions s(x) times the pressure increments.
/// Every partial-slip solution from Cattaneo's on is one s(x) with |s| <= mu (Jaeger, Arch. Appl.
/// Mech. 65, 1995; Ciavarella, J. Appl. Mech. 65, 1998). Each annulus moves with all punches that
/// contain it, so its displacement is U(x) = integral of s dw from x to k. Then
///
///    force       T = integral of s dF_N = integral of U dx
///    energy      E = 1/2 integral of U^2 dx
///    friction    |U(x)| <= mu (w(k) - w(x)) = 3/2 mu F_N/k^3 (k^2 - x^2)
///    stick       dU = slide of the bodies
///
/// So the contact is a row of parallel springs dx, each with its own Coulomb limit, the row of the
/// method of dimensionality reduction (Popov and Hess, 2015). The memory is U(x). Its slope
/// s is the memory diagram of Aleshin, Bou Matar and Van Den Abeele (Int. J. Solids Struct. 68,
/// 2015). Under Cattaneo's load U = slide inside the stick radius c and U follows the bound
/// outside, whence
///
///    slide = 3 mu F_N/(16 G* a) [1 - (1 - T/(mu F_N))^(2/3)].
///
/// During a step with straight slide and approach, the bound moves uniformly. Each annulus ends at
/// U + slide or, if that exceeds the bound, on the bound. So the step is exact for any length and
/// state, also if annuli leave the contact. U stays linear in x^2 between points. A reversal adds a
/// point, a closed loop removes it. A curved path under growing load adds one point per step. Above
/// PartialSlipMemory::capacity points, chords replace those that change the force least; merged()
/// sums these changes. Curved paths are approximated by straight steps, with an error of second
/// order in the step.
///
/// Energy. The loss of a slipping annulus is its bound times its slip, integrated over time and,
/// with three Gauss points, over x: exact under constant load. No term is negative. The work of T
/// along the path equals the change of E plus the loss. An integrator that uses the mean of T at
/// both ends of a step has a second-order error in this work, as in that of the normal force.
///
/// In the plane, U and slide are vectors; a slipping annulus returns to its bound radially. The row
/// of springs then only approximates the half-space, whose annuli interact perpendicular to the
/// slide. If the slip direction of a piece changes, chords approximate U(x). During the slide that
/// erases the memory, each chord changes the force by at most 1e-4 of the limit. The loss of such a
/// piece is the mean of U times its slip. A rare negative value counts as zero.
///
/// @param stiffness k = 8 G* a [N/m], with the contact radius a at the end of the step; <= 0 means
///     that contact is lost
/// @param limit mu F_N [N]; <= 0 means no friction. If F_N includes viscous damping, all pressures
///        are scaled by the same factor.
/// @param slide slide of body 1 relative to body 2 in this step [m]
/// @param memory memory of this contact, updated; if its tracks_energy() is false, energies are 0
/// Limits: identical materials (or both incompressible), else normal and tangential tractions are
/// coupled; half-space, a << R; quasi-static; mu constant over the area. The small slip
/// perpendicular to the slide, caused by Poisson's ratio, is neglected, as in all these sources.
inline PartialSlipResponse partial_slip_step(double stiffness, double limit, const Tangent& slide,
                                             PartialSlipMemory& memory) {
  if (stiffness > 0.0 && limit > 0.0) {
    return detail::PartialSlipStep(stiffness, limit, slide, memory).run();
  }
  const double lost = memory.size() > 0 && memory.tracks_energy()
                          ? detail::PartialSlipStep::released(slide, memory)
                          : 0.0;
  memory.clear();
  const bool touching = stiffness > 0.0;
  if (touching) {
    memory.push({0.0, {}});
    memory.push({stiffness, {}});
  }
  return {{}, 0.0, lost, touching};
}

}  // namespace statejump::kernel
