// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which parameters of a model a solve may move, along which directions, and from where. Internal.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/lens_traits.hpp"
#include "calvin/core/image.hpp"
#include "calvin/core/result.hpp"
#include "calvin/solve/options.hpp"
#include "calvin/solve/parameters/parameter_table.hpp"

namespace calvin {

// One camera and one board, whose number in the table is 0.
struct Parameterization {
  std::string model;
  LensTraits lens;
  ParameterTable table;
  Eigen::MatrixXd basis;        // of the table
  std::vector<double> initial;  // all unknowns of SolveOptions::initial, or empty
  std::vector<double> start;    // all unknowns where SolveOptions::method puts them, or empty

  // How many of fx fy cx cy the boards have to determine.
  [[nodiscard]] int pinhole_directions() const;
  // fy / fx where the two are tied or both held, else 1.
  [[nodiscard]] double aspect() const;
};

// The parameterisation for the model, `fix` and `initial` of the options, and the modes of the
// board, which are estimated from zero. `size` is that of the image, px; 0x0 where only the options
// are to be checked.
[[nodiscard]] Result<Parameterization> make_parameterization(const SolveOptions& options,
                                                             ImageSize size,
                                                             const BoardUnknowns& board = {});

// kInvalidArgument for what is no time from row to row of a frame.
[[nodiscard]] Status check_readout(const ReadoutTime& readout);

// Lets the solve start from a camera of any model; coefficients of an unrelated one do not count.
void start_from(const Calibration& camera, Parameterization& parameterization);

}  // namespace calvin
