// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/complementarity/solve.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "gauss_seidel.hpp"
#include "interior_point.hpp"
#include "lemke.hpp"
#include "newton.hpp"
#include "statejump/kernel/require.hpp"

namespace statejump::complementarity {

namespace {

using kernel::require;

/// Sweeps before Newton is tried: enough to know most contacts' statuses, cheaper than one of
/// Newton's linear systems.
constexpr int first_sweeps = 20;
/// Linear systems of one attempt of Newton's: it converges within ten or not from there.
constexpr int newton_systems = 30;
/// Factorisations of the interior point: each lowers the gap by a factor of some five.
constexpr int interior_factors = 100;
/// Contacts up to which Lemke's table is smaller work than the interior point, and the pivots after
/// which it is given up: random problems take about six a contact.
constexpr int lemke_contacts = 40;
constexpr int pivots_per_contact = 100;
/// Merit of the interior point at which it is first seen whether Newton converges from there, the
/// ratio of merits or the steps until it is seen again, and the linear systems that it may then
/// take.
constexpr double first_handover = 1e-2;
constexpr double handover_ratio = 0.1;
constexpr int steps_per_handover = 10;
constexpr int handover_systems = 4;

/// The methods in turn, with the best that any of them found.
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
          sweep(options_.most_sweeps);
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
    sweep(std::min(first_sweeps, options_.most_sweeps));
    if (!ended()) run_newton(best_, newton_systems);
    if (!ended() && problem_.dimension == 2 && problem_.contacts() <= lemke_contacts) run_lemke();
    if (!ended()) run_interior_point();
    int sweeps = 10 * first_sweeps;
    while (!ended() && counted_.gauss_seidel < options_.most_sweeps) {
      sweep(std::min(sweeps, options_.most_sweeps - counted_.gauss_seidel));
      if (!ended()) run_newton(best_, newton_systems);
      sweeps *= 2;
    }
  }

  void sweep(int sweeps) {
    constexpr int sweeps_per_report = 500;
    while (sweeps > 0 && !ended()) {
      const int now = std::min(sweeps, sweeps_per_report);
      judge(gauss_seidel(scaled_, swept_ ? *swept_ : best_, now, aim(), counted_.gauss_seidel),
            Method::gauss_seidel);
      sweeps -= now;
    }
  }
  void run_newton(Iterate from, int systems) {
    judge(newton(scaled_, std::move(from), systems, aim(), counted_.newton), Method::newton);
  }
  void run_lemke() {
    const int most = pivots_per_contact * static_cast<int>(problem_.contacts());
    if (std::optional<Eigen::VectorXd> r = lemke(scaled_, most, counted_.pivots)) {
      Iterate now(scaled_, std::move(*r));
      judge(now, Method::lemke);
      // Takes off the rounding of the pivots.
      if (!ended()) run_newton(std::move(now), handover_systems);
    }
  }
  void run_interior_point() {
    InteriorPoint path(scaled_);
    double next_merit = first_handover;
    int next_step = steps_per_handover;
    for (int k = 1; k <= interior_factors && !ended(); ++k) {
      const double step = path.advance();
      ++counted_.interior_point;
      if (step == 0.0) break;
      Iterate now(scaled_, path.reactions());
      if (!std::isfinite(now.merit)) break;
      judge(now, Method::interior_point);
      if (options_.method == Method::automatic && (now.merit <= next_merit || k >= next_step)) {
        next_merit = handover_ratio * now.merit;
        next_step = k + steps_per_handover;
        if (!ended()) run_newton(std::move(now), handover_systems);
      }
    }
  }

  /// Tolerance of the scaled merit: a tenth leaves room for the natural map in the caller's units.
  double aim() const { return 0.1 * options_.tolerance; }

  void judge(Iterate iterate, Method method) {
    const Eigen::VectorXd r = iterate.r * scaled_.reaction_unit();
    const Merit merit{natural_map_merit(problem_, r, velocities(problem_, r)), iterate.merit};
    if (method == Method::gauss_seidel) swept_ = iterate;
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
  std::optional<Iterate> swept_;  ///< Where Gauss-Seidel stands, though another was better.
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
