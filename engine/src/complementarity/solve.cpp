// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/complementarity/solve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "gauss_seidel.hpp"
#include "interior_point.hpp"
#include "lemke.hpp"
#include "newton.hpp"
#include "statejump/kernel/require.hpp"

namespace statejump::complementarity {

namespace {

using kernel::require;

/// Number of sweeps before the first Newton attempt. These sweeps find the statuses of most
/// contacts and cost less than one linear system.
constexpr int first_sweeps = 20;
/// Sweeps after the other methods have failed; doubled each time.
constexpr int more_sweeps = 200;
/// Largest number of linear systems in one Newton attempt. From a good start ten suffice.
constexpr int newton_systems = 30;
/// Largest number of factorisations of the interior point. Usually twenty suffice; with lagged
/// friction up to a hundred.
constexpr int interior_factors = 300;
/// The interior point stops if this many steps do not halve its merit.
constexpr int steps_without_progress = 100;
/// Limits for Lemke's method: contacts up to which it is cheaper than the interior point; contacts
/// up to which it is tried (seconds); pivots per contact.
constexpr Eigen::Index few_contacts = 40;
constexpr Eigen::Index many_contacts = 250;
constexpr int pivots_per_contact = 50;
/// Handover from interior point to Newton: merit at the first Newton attempt; ratio of merits and
/// number of steps before the next; linear systems per attempt.
constexpr double first_handover = 1e-2;
constexpr double handover_ratio = 0.1;
constexpr int steps_per_handover = 10;
constexpr int handover_systems = 4;

/// Runs the methods in turn and keeps the best result.
class Driver {
 public:
  Driver(const Problem& problem, const Options& options)
      : problem_(problem),
        scaled_(problem),
        options_(options),
        best_(scaled_, options.guess ? Eigen::VectorXd(*options.guess / scaled_.reaction_unit())
                                     : Eigen::VectorXd::Zero(problem.q.size())) {
    judge(best_, Method::gauss_seidel);
  }

  Solution run() {
    if (!ended()) {
      switch (options_.method) {
        case Method::automatic:
          automatic();
          break;
        case Method::gauss_seidel:
          sweep(best_, options_.most_sweeps);
          break;
        case Method::newton:
          run_newton(best_, newton_systems);
          break;
        case Method::interior_point:
          run_interior_point();
          break;
        case Method::lemke:
          run_lemke();
          break;
      }
    }
    Solution solution;
    solution.reactions = best_.r * scaled_.reaction_unit();
    solution.velocities = velocities(problem_, solution.reactions);
    solution.merit = merit_;
    solution.iterations = counted_;
    solution.method = method_;
    solution.status = cancelled_                               ? Status::cancelled
                      : merit_.largest() <= options_.tolerance ? Status::solved
                                                               : Status::not_converged;
    return solution;
  }

 private:
  void automatic() {
    Iterate swept = sweep(best_, std::min(first_sweeps, options_.most_sweeps));
    if (!ended()) run_newton(best_, newton_systems);
    const Eigen::Index planar_contacts = problem_.dimension == 2 ? problem_.contacts() : 0;
    const bool is_small = planar_contacts > 0 && planar_contacts <= few_contacts;
    if (!ended() && is_small) run_lemke();
    if (!ended()) run_interior_point();
    if (!ended() && !is_small && planar_contacts > 0 && planar_contacts <= many_contacts)
      run_lemke();
    // Few sweeps from the best result may find the statuses that Newton's method did not find. Many
    // sweeps may be needed from the iterate at which earlier sweeps ended.
    if (!ended()) finish(best_, more_sweeps);
    for (int sweeps = more_sweeps; !ended() && sweeps_left() > 0; sweeps *= 2) {
      swept = finish(std::move(swept), sweeps);
    }
  }

  /// Sweeps, then tries Newton's method from the resulting iterate.
  /// @return the iterate after the sweeps
  Iterate finish(Iterate from, int sweeps) {
    Iterate swept = sweep(std::move(from), std::min(sweeps, sweeps_left()));
    if (!ended()) run_newton(swept, newton_systems);
    return swept;
  }
  int sweeps_left() const { return options_.most_sweeps - counted_.gauss_seidel; }

  /// Sweeps from an iterate.
  /// @return the last iterate
  Iterate sweep(Iterate from, int sweeps) {
    constexpr int sweeps_per_report = 500;
    while (sweeps > 0 && !ended()) {
      const int now = std::min(sweeps, sweeps_per_report);
      Iterate next =
          gauss_seidel(scaled_, std::move(from), now, scaled_tolerance(), counted_.gauss_seidel);
      from = next;
      judge(std::move(next), Method::gauss_seidel);
      sweeps -= now;
    }
    return from;
  }
  void run_newton(Iterate from, int systems) {
    judge(newton(scaled_, std::move(from), systems, scaled_tolerance(), counted_.newton),
          Method::newton);
  }
  void run_lemke() {
    const int most = pivots_per_contact * static_cast<int>(problem_.contacts());
    if (std::optional<Eigen::VectorXd> r = lemke(scaled_, most, counted_.pivots)) {
      Iterate now(scaled_, std::move(*r));
      judge(now, Method::lemke);
      // Removes the rounding of the pivots.
      if (!ended()) run_newton(std::move(now), handover_systems);
    }
  }
  void run_interior_point() {
    InteriorPoint path(scaled_);
    double next_merit = first_handover;
    int next_step = steps_per_handover;
    double progress = std::numeric_limits<double>::infinity();
    int last_progress = 0;
    for (int k = 1; k <= interior_factors && !ended(); ++k) {
      const double step = path.advance();
      ++counted_.interior_point;
      if (step == 0.0) break;
      Iterate now(scaled_, path.reactions());
      if (!std::isfinite(now.merit)) break;
      if (now.merit < 0.5 * progress) {
        progress = now.merit;
        last_progress = k;
      }
      if (k - last_progress > steps_without_progress) break;
      judge(now, Method::interior_point);
      if (options_.method == Method::automatic && (now.merit <= next_merit || k >= next_step)) {
        next_merit = handover_ratio * now.merit;
        next_step = k + steps_per_handover;
        if (!ended()) run_newton(std::move(now), handover_systems);
      }
    }
  }

  /// Tolerance of the scaled merit. The factor 0.1 is a margin for the natural map in the caller's
  /// units.
  double scaled_tolerance() const { return 0.1 * options_.tolerance; }

  void judge(Iterate iterate, Method method) {
    const Eigen::VectorXd r = iterate.r * scaled_.reaction_unit();
    const Merit merit{natural_map_merit(problem_, r, velocities(problem_, r)), iterate.merit};
    if (!judged_ || merit.largest() < merit_.largest()) {
      merit_ = merit;
      best_ = std::move(iterate);
      method_ = method;
      judged_ = true;
    }
    if (options_.progress && !options_.progress(merit_.largest())) cancelled_ = true;
  }
  bool ended() const { return cancelled_ || merit_.largest() <= options_.tolerance; }

  const Problem& problem_;
  const ScaledProblem scaled_;
  const Options& options_;
  Iterate best_;
  Merit merit_;
  Iterations counted_;
  Method method_ = Method::gauss_seidel;
  bool judged_ = false;
  bool cancelled_ = false;
};

}  // namespace

const char* to_string(Method method) {
  switch (method) {
    case Method::automatic:
      return "automatic";
    case Method::gauss_seidel:
      return "gauss_seidel";
    case Method::newton:
      return "newton";
    case Method::interior_point:
      return "interior_point";
    case Method::lemke:
      return "lemke";
  }
  return "unknown";
}

const char* to_string(Status status) {
  switch (status) {
    case Status::solved:
      return "solved";
    case Status::not_converged:
      return "not_converged";
    case Status::cancelled:
      return "cancelled";
  }
  return "unknown";
}

Solution solve(const Problem& problem, const Options& options) {
  validate(problem);
  require(options.tolerance > 0.0, "tolerance", options.tolerance, "> 0");
  require(options.most_sweeps >= 0, "most_sweeps", options.most_sweeps, ">= 0");
  require(options.method != Method::lemke || problem.dimension == 2, "dimension", problem.dimension,
          "2 for Lemke's method");
  if (options.guess) {
    const auto size = static_cast<double>(options.guess->size());
    require(options.guess->size() == problem.q.size(), "size of the guess", size,
            (std::to_string(problem.q.size()) + ", contacts times dimension").c_str());
    require(options.guess->allFinite(), "guess", std::nan(""), "finite");
  }
  return Driver(problem, options).run();
}

}  // namespace statejump::complementarity
