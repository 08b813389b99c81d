// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The verdict, and what a user is told beside the numbers. Internal.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/solve/judge/fit_diagnostics.hpp"
#include "calvin/solve/parameters/parameterization.hpp"
#include "calvin/solve/solution.hpp"
#include "calvin/target/measured/board_pattern.hpp"

namespace calvin {

// What the promise of the covered region is made of, px, 1 sigma.
struct PromiseParts {
  double all = 0;
  double by_noise = 0;                // what it were if the residuals were noise
  std::optional<double> board_known;  // what it were with a measured board, where that is known
};

// The verdict. `chi` is absent where the detector gave no sigmas; `degrees` are the degrees of
// freedom of the fit, `rms` its residual, px.
[[nodiscard]] Misfit misfit(const FitDiagnostics& diagnostics, std::optional<double> chi,
                            double degrees, double rms, const PromiseParts& promise);

// What was noticed, how much it matters, and what would make the result better. Empty where nothing
// was.
[[nodiscard]] std::string explain(const Misfit& misfit, const FitDiagnostics& diagnostics,
                                  std::optional<double> chi, const PromiseParts& promise);

// That the text of a board whose corners were measured is likely wrong, and in what. `offsets` are
// m.
[[nodiscard]] std::string measured_otherwise(const std::vector<Eigen::Vector3d>& offsets,
                                             const BoardPattern& pattern);

// The remark on what no corner covered, where the picture is much worse than among the corners.
[[nodiscard]] std::optional<std::string> uncovered(const Calibration& calibration);
// Puts it as it is now in the place of what it was `before` the promises were changed.
void renew_uncovered(Calibration& calibration, const std::optional<std::string>& before);

// Adds remarks on parameters that are weak but not refused, on what no corner covered, and on the
// lens. `c` is the covariance of all unknowns.
void add_remarks(Solution& solution, const Eigen::MatrixXd& c, const Camera& camera,
                 const Parameterization& parameterization);

}  // namespace calvin
