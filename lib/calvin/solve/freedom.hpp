// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which parameters of a model a solve may move, and along which directions. Internal.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/result.hpp"

namespace calvin {

struct Freedom {
  Eigen::MatrixXd basis;        // parameters x directions; 0 or 1 each
  std::vector<bool> estimated;  // per parameter
  bool aspect = false;          // fx = fy
  bool center_x = false;        // held at the centre of the image
  bool center_y = false;

  // How many of fx fy cx cy the boards have to determine.
  [[nodiscard]] int pinhole_directions() const;
};

// `names`: parameters of the model, fx fy cx cy first. `fix` as in SolveOptions.
[[nodiscard]] Result<Freedom> make_freedom(std::span<const std::string_view> names,
                                           std::span<const std::string> fix);

}  // namespace calvin
