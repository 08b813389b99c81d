// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where a solve starts: the basin of the true optimum, searched on a few views. Internal.
#pragma once

#include <limits>
#include <vector>

#include "calvin/solve/start/bundle_adjustment.hpp"
#include "calvin/solve/start/camera_guess.hpp"

namespace calvin {

// Fewer views than this may have several optima.
inline constexpr std::size_t kFewViews = 8;

struct Candidate : Estimate {
  double scale = std::numeric_limits<double>::infinity();  // px, see robust_scale()
};

class StartSearch {
 public:
  using Views = std::vector<const FitView*>;

  StartSearch(BundleAdjustment& adjustment, const Parameterization& parameterization,
              const BoardShape& shape, ImageSize size)
      : adjustment_(adjustment), parameterization_(parameterization), shape_(shape), size_(size) {}

  // Shared unknowns and a pose for each view; the scale is infinite where nothing leads anywhere.
  //
  // From a few corners of a few views, by the closed form for a lens near enough to a pinhole and
  // at several focal lengths for others; not for a lens with several starts or for few views of one
  // that is_rich(). Nearly always right, and ten to hundreds of times cheaper than thorough().
  [[nodiscard]] Candidate quick(const Views& views);
  // All starts there are, each tried on a few views: the different cameras that they lead to and
  // that may be right, the likeliest first.
  [[nodiscard]] std::vector<Candidate> thorough(const Views& views);

  // Whether a robust_scale() of the distances is too large for the basin of the true optimum.
  [[nodiscard]] bool is_far(double scale) const;
  // Whether there may be more than one basin in which a fit looks right.
  [[nodiscard]] bool many_basins(const Views& views) const;

  // Whether the lens has so many coefficients that they can conspire.
  [[nodiscard]] bool is_rich() const;

  // The directions that move no coefficient but the first ones, `most` of them. A lens of many
  // coefficients finds its basin as a lens of few.
  [[nodiscard]] Eigen::MatrixXd leading(int most) const;

 private:
  [[nodiscard]] int coefficients() const;  // how many the lens has
  [[nodiscard]] Candidate by_closed_form(const Views& sample);
  [[nodiscard]] Candidate by_focal_lengths(const Views& sample);
  [[nodiscard]] std::vector<Candidate> guesses(const Views& sample,
                                               const std::vector<double>& start) const;
  [[nodiscard]] Candidate with(const Guess& guess, const std::vector<double>& coefficients) const;
  [[nodiscard]] std::vector<Candidate> from_initial() const;
  // The `trials` best of the candidates by a few corners of the sample, improved over all of them.
  // A rich lens begins with regularised coefficients: small ones, which grow as the views demand.
  [[nodiscard]] std::vector<Candidate> best_of(std::vector<Candidate> candidates,
                                               const Views& sample, std::size_t trials);
  // Follows each a little way by a few corners, and keeps one of those that lead to one camera.
  void drop_copies(std::vector<Candidate>& candidates, const Views& few);
  enum class Regularization { kPriors, kNone };
  using Priors = std::vector<ParameterTable::Prior>;
  [[nodiscard]] Priors small(double sigma) const;  // px, as weighted residuals are
  // What the least squares make of a candidate. `kPriors`: with those of small(), loosened step by
  // step, for a rich lens.
  [[nodiscard]] Candidate improved(Candidate c, const Views& sample, Regularization regularization);
  [[nodiscard]] Candidate minimised(Candidate c, const Views& sample, const Eigen::MatrixXd& basis,
                                    const LmOptions& options, const Priors& priors);
  [[nodiscard]] std::vector<Eigen::MatrixXd> stages() const;
  [[nodiscard]] double scale_of(const Candidate& c, const Views& views);

  BundleAdjustment& adjustment_;
  const Parameterization& parameterization_;
  const BoardShape& shape_;
  ImageSize size_;
};

}  // namespace calvin
