// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which parameters of a model a solve may move, along which directions, and from where. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/lens_traits.hpp"
#include "calvin/core/result.hpp"
#include "calvin/solve/options.hpp"
#include "calvin/solve/residuals/camera_problem.hpp"
#include "calvin/solve/residuals/view_rows.hpp"

namespace calvin {

// "unknown" is a parameter of the model, its skew where that is estimated, or a mode of the board,
// in the order of RowLayout.
struct Parameterization {
  std::string model;
  LensTraits lens;
  RowLayout layout;
  double skew = 0;                          // px, where it is not estimated
  Eigen::MatrixXd basis;                    // unknowns x directions
  std::vector<bool> estimated;              // per unknown
  std::vector<std::optional<double>> held;  // per unknown: its value where it is not estimated
  std::vector<double> initial;              // all unknowns of SolveOptions::initial, or empty
  std::vector<CameraUnknowns::Prior> priors;

  // `parameter` (an unknown) moves as `ratio` times `with`.
  struct Tie {
    std::size_t parameter;
    std::size_t with;
    double ratio;
  };
  std::vector<Tie> ties;

  // The point at which rows are taken for these unknowns; refers to `shared`.
  [[nodiscard]] RowPoint row_point(const std::vector<double>& shared) const;
  // How many of fx fy cx cy the boards have to determine.
  [[nodiscard]] int pinhole_directions() const;
  // Sets held and tied parameters to their values. For tied focal lengths it keeps their product.
  void hold(double* parameters) const;
  // fy / fx where the two are tied or both held, else 1.
  [[nodiscard]] double aspect() const;
};

// The parameterisation for the model, `fix` and `initial` of the options, and `modes` of the
// board's shape, which are estimated from zero. `size` is that of the image, px; 0x0 where only the
// options are to be checked.
[[nodiscard]] Result<Parameterization> make_parameterization(const SolveOptions& options,
                                                             ImageSize size, int modes = 0);

}  // namespace calvin
