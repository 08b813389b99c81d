// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Levenberg-Marquardt over any problem that can linearise itself. Internal.
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <stop_token>

namespace calvin {

struct LmOptions {
  int max_iterations = 100;
  // Of the predicted decrease, relative to the cost. A step below `tolerance` is the last one; a
  // step below `small` may be the last, and is then taken without evaluating where it leads. Below
  // 1e-15 rounding begins.
  double tolerance = 1e-13;
  double small = 0;
  double lambda = 1e-4;  // the damping to begin with
  // The iteration is given up where a step is predicted to leave a larger cost.
  double hopeless = std::numeric_limits<double>::infinity();
};

struct LmReport {
  bool converged = false;
  bool cancelled = false;
  int iterations = 0;
};

// Whether a step ends the iteration: its predicted decrease is small after one that was far larger,
// so that the next one will be far smaller; or it is next to nothing.
[[nodiscard]] inline bool ends_iteration(double predicted, double before, double small) {
  constexpr double kFast = 1e-2;     // of the decrease before
  constexpr double kNothing = 1e-4;  // of `small`
  return predicted <= kNothing * small || (predicted <= small && predicted <= kFast * before);
}

// A Problem has
//   double cost()                           at the current point, a sum of squares
//   std::optional<double> propose(lambda)   makes a trial point with every diagonal element of the
//                                           normal equations times 1 + lambda; the decrease of
//                                           the cost that the linearisation predicts
//   std::optional<double> evaluate_trial()  linearises there; its cost
//   void accept()                           the trial point, and its linearisation with it,
//                                           becomes the current one
//   void accept_unseen(predicted)           the trial point becomes the current one and keeps the
//                                           linearisation that led to it
// Damping after H. B. Nielsen, Damping Parameter in Marquardt's Method, IMM-REP-1999-05.
template <typename Problem>
LmReport minimise(Problem& problem, const LmOptions& options, const std::stop_token& stop) {
  constexpr double kRounding = 1e-20;  // px^2: rounding of a fit that is exact
  constexpr double kLeastLambda = 1e-14;
  constexpr double kMostLambda = 1e14;
  LmReport report;
  double lambda = options.lambda;
  double growth = 2;
  double before = 0;  // the last decrease predicted
  for (; report.iterations < options.max_iterations; ++report.iterations) {
    if (stop.stop_requested()) {
      report.cancelled = true;
      return report;
    }
    const double cost = problem.cost();
    const std::optional<double> predicted = problem.propose(lambda);
    if (predicted && cost - *predicted > options.hopeless) return report;
    if (predicted && ends_iteration(*predicted, before, options.small * cost)) {
      problem.accept_unseen(*predicted);
      report.converged = true;
      return report;
    }
    before = predicted.value_or(before);
    const bool last = predicted && *predicted <= options.tolerance * cost + kRounding;
    const std::optional<double> trial = predicted ? problem.evaluate_trial() : std::nullopt;
    if (trial && *trial <= cost) {
      problem.accept();
      const double q = 2 * (cost - *trial) / std::max(*predicted, kRounding) - 1;
      lambda = std::max(kLeastLambda, lambda * std::max(0.05, 1 - q * q * q));
      growth = 2;
    } else {
      lambda *= growth;
      growth *= 2;
    }
    if (last) {
      report.converged = true;
      return report;
    }
    if (lambda > kMostLambda) return report;
  }
  return report;
}

}  // namespace calvin
