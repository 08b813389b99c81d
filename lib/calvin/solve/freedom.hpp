// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which parameters of a model a solve may move, along which directions, and from where. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/result.hpp"
#include "calvin/solve/solve.hpp"

namespace calvin {

struct Freedom {
  Eigen::MatrixXd basis;                    // parameters x directions
  std::vector<bool> estimated;              // per parameter
  std::vector<std::optional<double>> held;  // per parameter: its value where it is not estimated
  std::vector<double> initial;              // all parameters of SolveOptions::initial, or empty

  // `parameter` moves as `ratio` times `with`.
  struct Tie {
    std::size_t parameter;
    std::size_t with;
    double ratio;
  };
  std::vector<Tie> ties;

  // How many of fx fy cx cy the boards have to determine.
  [[nodiscard]] int pinhole_directions() const;
  // Puts parameters onto what is held and tied. For tied focal lengths it keeps their product.
  void hold(double* parameters) const;
  // fy / fx where the two are tied or both held, else 1.
  [[nodiscard]] double aspect() const;
};

// For the model, `fix` and `initial` of the options. `size` of the image, px; 0x0 where only the
// options are to be checked.
[[nodiscard]] Result<Freedom> make_freedom(const SolveOptions& options, ImageSize size);

}  // namespace calvin
