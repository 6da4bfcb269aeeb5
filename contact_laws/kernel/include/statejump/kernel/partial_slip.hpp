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

/// One step, from the trial state to the new memory.
class PartialSlipStep {
 public:
  /// @param memory before the step; run() leaves in it what is remembered after
  PartialSlipStep(double stiffness, double limit, const Tangent& slide, PartialSlipMemory& memory)
      : edge_(stiffness),
        square_(stiffness * stiffness),
        slope_(1.5 * limit / (stiffness * square_)),
        slide_(slide),
        old_(memory),
        old_edge_(memory.edge()),
        accounts_(memory.accounts()),
        smallest_(1e-15 * slope_ * square_) {}

  /// Loss of rings that lose what presses them together evenly over a step [J].
  static double released(const Tangent& slide, PartialSlipMemory& memory) {
    const PartialSlipStep step(memory.edge() * 1e-9, 0.0, slide, memory);
    double sum = 0.0;
    for (int i = 1; i < memory.size(); ++i) {
      sum += step.left(memory[i - 1], memory[i], memory.edge() * memory.edge());
    }
    return sum;
  }

  PartialSlipResponse run() {
    stuck_ = stuck();
    if (stuck_ < old_.held().count) old_.release();
    trial();
    slipping_ = stuck_ == 0;  // all rings but the rim's, which carries nothing
    for (int i = 0; slipping_ && i + 1 < knots_; ++i) slipping_ = at(i).outside;
    add(at(0).x, at(0).outside ? bent(at(0)) : at(0).trial, false);
    for (int i = 1; i < knots_; ++i) {
      pieces_left_ = knots_ - i;
      if (at(i - 1).outside || at(i).outside) {
        piece(at(i - 1), at(i));
      } else {
        add_stuck(at(i).x, at(i).trial);
      }
    }
    store();
    return answer(old_, loss_, slipping_);
  }

 private:
  /// A point of the trial state: the old profile and what the step does to it.
  struct Knot {
    double x;
    Tangent old;
    double share;   ///< of the slide that this ring takes part in
    Tangent trial;  ///< old + share slide
    double bound;   ///< on |U| now
    bool outside;
  };

  /// Points from the centre on that stick and lie well within what the step changes: they move with
  /// the slide and nothing else happens to them. Rings slip from the rim inwards, so that these are
  /// nearly all of a contact that is held; the rest is bent and tidied up by itself, with
  /// `neighbours` of them. What the memory holds is not looked at while it is held well enough.
  int stuck() {
    constexpr int neighbours = 2;
    const int most = old_.size() - neighbours + 1;
    if (most <= neighbours) return 0;
    const int held = old_.held().count;
    if (held > 0 && !old_.holds(slide_, bound(0.0), bound(old_[held - 1].x))) old_.release();
    int inside = old_.held().count;
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

  Knot knot(double x, const Tangent& old, double share) const {
    const Tangent trial = old + share * slide_;
    const double most = bound(x);
    const double outer = most + smallest_;
    return {x, old, share, trial, most, trial.squared() > outer * outer};
  }

  static Tangent bent(const Knot& k) {
    const double size = k.trial.norm();
    return size > 0.0 ? (k.bound / size) * k.trial : Tangent{};
  }

  /// The knots between which everything is straight over x^2; what leaves the contact is lost.
  void trial() {
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
      leave(cut, old_[i]);
      cut = old_[i];
    }
  }

  void push(const Knot& k) { knot_[static_cast<std::size_t>(knots_++)] = k; }

  static Tangent between(const PartialSlipMemory::Point& a, const PartialSlipMemory::Point& b,
                         double x) {
    return a.u + ((x - a.x) * (x + a.x) / ((b.x - a.x) * (b.x + a.x))) * (b.u - a.u);
  }

  /// Rings that leave the contact on the way, x^2 falling evenly.
  void leave(const PartialSlipMemory::Point& a, const PartialSlipMemory::Point& b) {
    if (!accounts_) return;
    const double fall = (old_edge_ - edge_) * (old_edge_ + edge_);
    if (b.x > a.x && fall > 0.0) loss_ += left(a, b, fall);
  }
  double left(const PartialSlipMemory::Point& a, const PartialSlipMemory::Point& b,
              double fall) const {
    const auto ring = [&](double x, const Tangent& u) {
      return std::pair{u, ((old_edge_ - x) * (old_edge_ + x) / fall) * slide_};
    };
    const auto [start_a, slide_a] = ring(a.x, a.u);
    const auto [start_b, slide_b] = ring(b.x, b.u);
    const Tangent end_a = start_a + slide_a;
    const Tangent end_b = start_b + slide_b;
    if (end_a.dot(end_b) < 0.0) {  // they leave to opposite sides: each by itself
      const double size_a = end_a.norm();
      const double s = size_a / (size_a + end_b.norm());
      const double x = std::sqrt(a.x * a.x + s * (b.x - a.x) * (b.x + a.x));
      if (x > a.x && x < b.x) {
        const PartialSlipMemory::Point middle{x, between(a, b, x)};
        return left(a, middle, fall) + left(middle, b, fall);
      }
    }
    const Tangent way = direction(end_a + end_b);
    return loss(a.x, {start_a.dot(way), slide_a.dot(way), old_bound(a.x), 0.0}, b.x,
                {start_b.dot(way), slide_b.dot(way), old_bound(b.x), 0.0});
  }

  static Tangent direction(const Tangent& v) {
    const double size = v.norm();
    return size > 0.0 ? (1.0 / size) * v : Tangent{1.0, 0.0};
  }

  /// Between two knots: parts inside the bound stay, the others are bent back to it.
  void piece(const Knot& a, const Knot& b) {
    if (a.outside && b.outside && is_chord_of_bound(a, b)) {
      slip(a, b);
    } else if (a.outside && b.outside) {
      const double first = crossing(a, b);
      const double second = 1.0 - crossing(b, a);
      if (first < second) {
        const Knot in = on(a, b, first);
        const Knot out = on(a, b, second);
        slip(a, in);
        add(out.x, out.trial, false);
        slip(out, b);
      } else {
        slip(a, b);
      }
    } else if (b.outside) {
      const Knot edge = on(a, b, 1.0 - std::min(1.0, crossing(b, a)));
      add(edge.x, edge.trial, false);
      slip(edge, b);
    } else {
      slip(a, on(a, b, std::min(1.0, crossing(a, b))));
      add(b.x, b.trial, false);
    }
  }

  /// Share of the way over x^2 from a knot outside the bound towards another at which the bound is
  /// met; 2: nowhere. |U| - bound is convex along it, so that Newton's steps do not go too far; in
  /// one direction the first one is exact.
  double crossing(const Knot& out, const Knot& other) const {
    const Tangent way = other.trial - out.trial;
    const double fall = other.bound - out.bound;
    double s = 0.0;
    for (int i = 0; i < 30; ++i) {
      const Tangent u = out.trial + s * way;
      const double size = u.norm();
      const double beyond = size - (out.bound + s * fall);
      if (i > 0 && beyond <= smallest_) return s;
      const double change = u.dot(way) - size * fall;
      if (!(change < 0.0)) return 2.0;
      s -= beyond * size / change;
      if (s > 1.0) return 2.0;
    }
    return s;
  }

  /// The knot at a share of the way over x^2.
  Knot on(const Knot& a, const Knot& b, double s) const {
    const double x = std::sqrt(a.x * a.x + s * (b.x - a.x) * (b.x + a.x));
    Knot k{std::clamp(x, a.x, b.x),
           a.old + s * (b.old - a.old),
           a.share + s * (b.share - a.share),
           a.trial + s * (b.trial - a.trial),
           0.0,
           false};
    k.bound = bound(k.x);
    return k;
  }

  /// A piece that slips as a whole. Its direction turns along it where the old one differs from
  /// that of the slide: chords, none of which goes further off in this step than its budget().
  void slip(const Knot& a, const Knot& b, int depth = 0) {
    if (!(b.x > a.x)) return;
    const double cross = a.trial.a * b.trial.b - a.trial.b * b.trial.a;
    const double along = a.trial.dot(b.trial);
    const bool turns = std::abs(cross) > straight * std::abs(along) || along < 0.0;
    if (turns && depth < deepest && knots_left()) {
      const Knot middle = on(a, b, 0.5);
      // a ring between them that is as near to its bound as they are
      Knot ring = middle;
      ring.old = (0.5 * (a.old.norm() + b.old.norm())) * direction(middle.old);
      ring.trial = ring.old + ring.share * slide_;
      const Tangent off = (bent(ring) - ring.old) - 0.5 * ((bent(a) - a.old) + (bent(b) - b.old));
      if (off.norm() * (b.x - a.x) > budget()) {
        slip(a, middle, depth + 1);
        slip(middle, b, depth + 1);
        return;
      }
    }
    if (!accounts_) {
      // nobody asks for the loss
    } else if (turns && on_old_bound(a) && on_old_bound(b)) {
      loss_ += loss_of_chord(a, b);
    } else {
      const Tangent way = direction(a.trial + b.trial);
      const auto ring = [&](const Knot& k) {
        const Tangent own = turns ? direction(k.trial) : way;
        return Ring{k.old.dot(own), k.share * slide_.dot(own), old_bound(k.x), k.bound};
      };
      loss_ += loss(a.x, ring(a), b.x, ring(b));
    }
    add(b.x, bent(b), true);
  }

  /// By how much one chord may change the force in this step [N]: over the slide after which rings
  /// forget, however many steps it takes, by `chord` of the limit.
  double budget() const { return chord * edge_ * std::min(slope_ * square_, slide_.norm()); }

  bool on_old_bound(const Knot& k) const { return k.old.norm() >= (1.0 - 1e-9) * old_bound(k.x); }
  static bool turned(const Tangent& a, const Tangent& b) {
    const double cross = a.a * b.b - a.b * b.a;
    return cross * cross > straight * straight * (a.squared() * b.squared());
  }

  /// Whether rings between two knots slipped in directions between theirs. The chord lies within
  /// the bound; that its rings stuck would be an answer to the chord.
  bool is_chord_of_bound(const Knot& a, const Knot& b) const {
    constexpr double near = 0.8;  // chords are divided long before; after a kink they are not
    return turned(a.old, b.old) &&
           a.old.dot(b.old) > near * std::sqrt(a.old.squared() * b.old.squared()) &&
           on_old_bound(a) && on_old_bound(b);
  }

  /// Mean of U at both ends of the step, times its slip: of rings that slip all through it, as
  /// chords have them, so that energies close.
  static double loss_of_chord(const Knot& a, const Knot& b) {
    const auto mean = [](const Knot& k) { return 0.5 * (k.old + bent(k)); };
    const auto slipped = [](const Knot& k) { return k.trial - bent(k); };
    const Piece w(a.x, b.x);
    return std::max(0.0, w.both_at_a * mean(a).dot(slipped(a)) +
                             w.both_at_b * mean(b).dot(slipped(b)) +
                             w.one_each * (mean(a).dot(slipped(b)) + mean(b).dot(slipped(a))));
  }

  /// Whether a chord may be divided: each piece that is still to come may add three points, and
  /// each half of a chord that is being divided one.
  bool knots_left() const { return stuck_ + size_ + 3 * pieces_left_ + 2 * deepest < largest; }

  /// Adds a point of the new profile. @param on_bound the piece that ends here follows the bound
  void add(double x, const Tangent& u, bool on_bound) {
    look_and_add(x, u, on_bound);
    bends_ = size_ > 1 && turned(point_[static_cast<std::size_t>(size_ - 2)].u, last().u);
  }

  /// The same of a piece inside the bound, mostly without a look at the points before, of which
  /// there is one at least.
  void add_stuck(double x, const Tangent& u) {
    if (bends_ || !(x > last().x) || turned(last().u, u)) {
      add(x, u, false);
      return;
    }
    follows_ = false;
    point_[static_cast<std::size_t>(size_++)] = {x, u};
  }

  void look_and_add(double x, const Tangent& u, bool on_bound) {
    if (size_ > 0 && !(x > last().x)) {
      if (on_bound) last().u = u;
      return;
    }
    if (on_bound && follows_ && size_ > 1) {
      // two pieces of the bound in one direction are one
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
      // a point where the direction turns, but less than a chord may
      const PartialSlipMemory::Point& before = point_[static_cast<std::size_t>(size_ - 2)];
      if ((bends_ || turned(last().u, u)) &&
          left_out(before, last(), {x, u}).force() <= 0.25 * budget()) {
        last() = {x, u};
        follows_ = follows_ && on_bound;
        return;
      }
    }
    follows_ = on_bound;
    point_[static_cast<std::size_t>(size_++)] = {x, u};
  }

  PartialSlipMemory::Point& last() { return point_[static_cast<std::size_t>(size_ - 1)]; }

  /// Points that say nothing go; if there are still too many, those that say least.
  void store() {
    double merged = old_.merged();
    // Where the contact grows its old edge lies on a straight line if the path is straight, and
    // close to one in small steps of a curve: a thousandth of the least that is merged.
    const double nothing = edge_ > old_edge_ ? 1e-3 * least_merged * limit() : 0.0;
    for (int i = size_ - 2; i > 0 && i >= size_ - 3; --i) {
      const auto j = static_cast<std::size_t>(i);
      const LeftOut left = left_out(point_[j - 1], point_[j], point_[j + 1]);
      if (left.squared_offset > 100.0 * smallest_ * smallest_) {
        if (left.is_more_than(nothing)) continue;
        merged += left.force();
      }
      drop(i);
    }
    if (stuck_ + size_ > PartialSlipMemory::capacity) merged += merge();
    old_.keep(stuck_, slide_, slope_, merged);
    hold();
    old_.append(point_.data(), size_);
  }

  /// Holds the points that stick and will do so for `steps` like this one, if these are `least`
  /// more than are held: holding costs a look at all of them.
  void hold() {
    constexpr int least = 4;
    constexpr int loose = 2;  // next to the others: they come and go with these
    constexpr double steps = 32.0;
    const int held = old_.held().count;
    const int most = stuck_ - loose;
    if (most < held + least) return;
    const double wanted =
        steps * (std::abs(slide_.a) + std::abs(slide_.b) + std::abs(bound(0.0) - old_bound(0.0)));
    double room = bound(0.0);  // of the points looked at
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
    if (end_from(held, held + least) < held + least) return;
    old_.release();
    room = bound(0.0);
    const int end = end_from(0, most);
    if (end >= least) old_.hold(end, bound(0.0) - room, bound(old_[end - 1].x) - room);
  }

  /// Replaces points that say least by chords. @return sum of the changes of force [N]
  double merge() {
    old_.release();
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
        const double change = left_out(point_[j - 1], point_[j], point_[j + 1]).force();
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

  static constexpr double least_merged = 1e-9;  // of the force limit
  static constexpr double straight = 1e-8;      // rad: a chord is 1e-17 short
  static constexpr double chord = 1e-4;
  static constexpr int deepest = 8;  // times that a chord is divided
  static constexpr int largest = 4 * PartialSlipMemory::capacity;

  double edge_;    // 8 G* a now
  double square_;  // its square
  double slope_;   // bound on |U| = slope_ (edge_^2 - x^2)
  Tangent slide_;
  PartialSlipMemory& old_;  // until store()
  double old_edge_;
  bool accounts_;    // whether energies are asked for
  double smallest_;  // rounding of the largest bound
  double loss_ = 0.0;
  bool slipping_ = false;
  bool follows_ = false;  // the last piece follows the bound
  bool bends_ = false;    // U turns along the last piece
  int stuck_ = 0;         // points that only move with the slide; the others are below
  int knots_ = 0;
  int pieces_left_ = 0;  // with the present one
  int size_ = 0;
  std::array<Knot, static_cast<std::size_t>(PartialSlipMemory::capacity) + 2> knot_;
  std::array<PartialSlipMemory::Point, static_cast<std::size_t>(largest)> point_;
};

}  // namespace detail

/// One step of Hertz's contact with partial slip, along a straight path: the contact that slides at
/// its rim before it slides (Cattaneo 1938; Mindlin 1949; Mindlin and Deresiewicz 1953).
///
/// Derivation. A normal contact that grows is a sequence of flat punches: where the radius grows
/// from r by dr the approach grows by d(delta) and the pressure by that of a rigid punch of radius
/// r. With x = 8 G* r, Mindlin's stiffness of that punch, and w = E*/(4 G*) delta (so that
/// dF_N = x dw), Hertz's sphere is w = 3/2 C x^2 and F_N = C x^3, C = F_N/k^3, k = 8 G* a. The same
/// punches, moved sideways by s(x) dw, carry the tractions s(x) times the pressure increments:
/// Cattaneo's and every later partial-slip solution is one s(x) with |s| <= mu (Jaeger, Arch.
/// Appl. Mech. 65, 1995; Ciavarella, J. Appl. Mech. 65, 1998). All rings inside x move together
/// with what the punches around them do, U(x) = integral of s dw from x to k. Then
///
///     force       T = integral of s dF_N = integral of U dx
///     energy      E = 1/2 integral of U^2 dx
///     friction    |U(x)| <= mu (w(k) - w(x)) = 3/2 mu F_N/k^3 (k^2 - x^2)
///     stick       dU = slide of the bodies
///
/// so the contact is a row of springs dx side by side, each with Coulomb's law of its own (the same
/// row as in the method of dimensionality reduction: Popov and Hess, 2015). U(x) is what has to be
/// remembered; s is its slope, the memory diagram of Aleshin, Bou Matar and Van Den Abeele (Int. J.
/// Solids Struct. 68, 2015). Under Cattaneo's load U = slide inside the stick radius c and follows
/// the bound outside, whence
///
///     slide = 3 mu F_N/(16 G* a) [1 - (1 - T/(mu F_N))^(2/3)].
///
/// Along a straight path of slide and approach the bound moves evenly, and each ring ends at
/// U + slide or, if that is beyond, on the bound: the step is exact whatever its length, in any
/// state, loss of rings included. U stays straight between points over x^2; reversals leave a point
/// each, a closing loop wipes them out. A path that bends while the load grows leaves a point per
/// step. Beyond PartialSlipMemory::capacity those that say least are replaced by chords:
/// merged() adds up what that changes. Curved paths are approximated by their chords, which is of
/// second order in the step.
///
/// Energy. The loss of a ring that slips is its bound times its slip, integrated over the step (in
/// t and, by Gauss' three points, in x: exact under constant load); no term is negative. Work of T
/// along the path, minus the change of E, is the loss. An integrator that takes the mean of T at
/// both ends differs from that work at second order, as it does for the normal force.
///
/// In the plane U and slide are vectors; a ring goes back to its bound along its own radius. Then
/// the row of springs is an approximation of the half-space, whose rings act on each other across
/// the slide, and U(x) of a piece that slips in a turning direction is approximated by chords, each
/// of which changes the force by at most 1e-4 of the limit over the slide after which rings forget,
/// in however many steps. Such a piece loses the mean of U times its slip in every step, which is
/// nearly always positive; where it is not it counts as nothing.
///
/// @param stiffness k = 8 G* a [N/m] at the end of the step, of the radius of contact; <= 0: the
///        contact is lost
/// @param limit mu F_N [N]; <= 0: no friction. Where F_N is not Hertz's alone (damping) all
///        pressures are scaled.
/// @param slide of body 1 against body 2 in this step [m]
/// @param memory of this contact; updated. Where it does not account() both energies are 0.
/// Limits: identical materials (or both incompressible), else normal and tangential tractions are
/// coupled; half-space, a << R; quasi-static; mu constant over the area; the small slip across the
/// slide that Poisson's ratio causes is left out, as in all these sources.
inline PartialSlipResponse partial_slip_step(double stiffness, double limit, const Tangent& slide,
                                             PartialSlipMemory& memory) {
  if (stiffness > 0.0 && limit > 0.0) {
    return detail::PartialSlipStep(stiffness, limit, slide, memory).run();
  }
  const double lost = memory.size() > 0 && memory.accounts()
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
