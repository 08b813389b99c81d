// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where a solve starts: the valley of the true optimum, tried on a few views. Internal.
#pragma once

#include <limits>
#include <vector>

#include "calvin/solve/least_squares.hpp"
#include "calvin/solve/start.hpp"

namespace calvin {

struct Candidate {
  std::vector<double> shared;
  Poses poses;
  double scale = std::numeric_limits<double>::infinity();  // px, see robust_scale()
};

class StartSearch {
 public:
  StartSearch(LeastSquares& least_squares, const Freedom& freedom, ImageSize size)
      : least_squares_(least_squares), freedom_(freedom), size_(size) {}

  // Shared unknowns and a pose for each view; the scale is infinite where nothing leads anywhere.
  //
  // The closed form, for many views through a lens near enough to a pinhole: nearly always right,
  // and hundreds of times cheaper than what follows.
  [[nodiscard]] Candidate quick(const std::vector<const FitView*>& views);
  // The best of all the starts there are, each tried on a few views.
  [[nodiscard]] Candidate thorough(const std::vector<const FitView*>& views);

  // Whether what is left of a fit, as robust_scale(), is too much for the right valley.
  [[nodiscard]] bool far(double scale) const;

 private:
  [[nodiscard]] std::vector<Candidate> guesses(const std::vector<const FitView*>& sample) const;
  [[nodiscard]] Candidate with(const Guess& guess, const std::vector<double>& coefficients) const;
  [[nodiscard]] std::vector<Candidate> from_initial() const;
  [[nodiscard]] Candidate best_of(std::vector<Candidate> candidates,
                                  const std::vector<const FitView*>& sample, std::size_t trials);
  void improve(Candidate& c, const std::vector<const FitView*>& sample,
               const Eigen::MatrixXd& basis, int iterations);
  [[nodiscard]] double scale_of(const Candidate& c, const std::vector<const FitView*>& views);

  LeastSquares& least_squares_;
  const Freedom& freedom_;
  ImageSize size_;
};

}  // namespace calvin
