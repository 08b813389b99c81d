// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Residuals summed by part of the image and by corner of the board. Internal.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/image.hpp"
#include "calvin/solve/fit/camera_fit.hpp"
#include "calvin/solve/judge/agreement.hpp"
#include "calvin/solve/judge/contradiction.hpp"
#include "calvin/solve/residuals/view_rows.hpp"
#include "calvin/target/measured/board_pattern.hpp"

namespace calvin {

// Residuals in groups whose means should be 0: per group the score of a shift and its information.
class Scores {
 public:
  // More groups, of all views together.
  void add(const Agreement& groups);
  // `kept` is the share of the variance that the fit leaves in residuals; `absorbed` is the number
  // of means that the unknowns of the fit have set to 0.
  [[nodiscard]] ChiSquare chi_square(double variance, double kept, double absorbed) const;

 private:
  struct Score {
    double sum = 0;
    double information = 0;
  };
  std::vector<Score> scores_;
};

// What is left in the residuals of all views together: in parts of the image, where it is the lens
// that lacks something, and at corners of boards, where it is they that are not where they were
// printed.
class ResidualScores {
 public:
  // For the views in use of a fit, of which `residuals` are the coordinates.
  ResidualScores(const Fit& fit, ImageSize size, double residuals);

  // The rows are those of a view at the optimum of all; `rotation` is that of camera_from_board.
  void add(const PointSet& view, const Eigen::Matrix3d& rotation, ViewRows& rows);

  [[nodiscard]] Scores picture() const;
  [[nodiscard]] Scores board() const;  // along its three axes
  [[nodiscard]] const Agreement& picture_shared() const { return picture_shared_; }
  [[nodiscard]] const Agreement& board_shared() const { return board_shared_; }  // in its plane
  [[nodiscard]] const Agreement& board_bent() const { return board_bent_; }      // across it
  [[nodiscard]] std::size_t boards() const;
  // Of the corners of the only board in view, which is that grid; m, of all views together.
  [[nodiscard]] std::vector<SeenOffset> offsets(const Grid& grid) const;

 private:
  [[nodiscard]] std::size_t part_of(Pixel at) const;
  [[nodiscard]] std::size_t corners() const;

  ImageSize size_;
  int across_;  // parts of the image
  int down_;
  // Per board, by number, how many corners those before it have; one more for all.
  std::vector<std::size_t> first_;
  std::size_t views_ = 0;
  Agreement picture_shared_;
  Agreement board_shared_;
  Agreement board_bent_;
};

}  // namespace calvin
