// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The verdict, and remarks: sentences on what is weak in a result, and what to do.

#include "calvin/solve/judge/remarks.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "calvin/camera/monotone.hpp"
#include "calvin/core/expected_error.hpp"
#include "calvin/solve/judge/projection_error.hpp"

namespace calvin {

namespace {

// A solve with a larger sigma than these gets a remark.
constexpr double kWeakFocalSigma = 0.02;   // of the focal length
constexpr double kWeakCenterSigma = 0.02;  // of the image width

// Pixels that are clearly no squares: cameras have such ones rarely.
std::optional<std::string> oblong_pixels(const Calibration& calibration, const Eigen::MatrixXd& c,
                                         ParameterRange focal) {
  constexpr double kMuch = 0.01;
  constexpr double kClearly = 4;  // sigmas
  if (focal.count != 2) return std::nullopt;
  const auto at = static_cast<std::size_t>(focal.first);
  const double fx = calibration.parameters[at].value;
  const double fy = calibration.parameters[at + 1].value;
  const int i = focal.first;
  const double variance =
      c(i, i) / (fx * fx) + c(i + 1, i + 1) / (fy * fy) - 2 * c(i, i + 1) / (fx * fy);
  const double longer = std::abs(std::log(fx / fy));
  if (longer < kMuch || longer < kClearly * std::sqrt(std::max(variance, 0.0))) {
    return std::nullopt;
  }
  return fmt::format(
      "fx and fy differ by {:.2g} %: if the pixels of the camera are square, the print is "
      "stretched, or the picture was. Measure the sides of the board.",
      100 * longer);
}

// Ratio: the detector's sigmas may be too small by this much before chi counts as a misfit.
constexpr double kSigmaTolerance = 1.25;
// px: the error that corners nearby have in common by the detector itself, whose model of an edge
// is never exact. Misfits of this size are not reported, however significant.
constexpr double kDetectorBias = 0.003;
// Of the variance: a smaller part may be significant but does not matter.
constexpr double kSmallPart = 0.01;
// A promise that holds what was found is a misfit where all of it counts: it is this many times
// what noise would leave (or chi is that large), and more than a pixel. A smaller one is good
// whatever it was made of, and one that noise alone makes as large asks for more views.
constexpr double kMuchWorse = 3;
constexpr double kMuchNoise = 10;
constexpr double kPixel = 1;

// Whether a part of the variance matters, of residuals that are `rms` px altogether.
bool matters(double part, double rms) {
  return part > kSmallPart && part * rms * rms > kDetectorBias * kDetectorBias;
}

bool significant(const ChiSquare& c, double all, double rms) {
  return c.deviations() > kSignificant && matters((c.sum - c.degrees) / all, rms);
}

// The likely cause of what is no noise.
Misfit::Cause noticed(const FitDiagnostics& diagnostics, std::optional<double> chi, double degrees,
                      double rms) {
  const double chi_limit = kSigmaTolerance * (1 + kSignificant / std::sqrt(2 * degrees));
  const bool noisy = chi && *chi > chi_limit && matters(1 - 1 / (*chi * *chi), rms);
  // Lens or board: the cause is the one that explains more of the residuals, where views agree
  // that it is one. Either makes views contradict each other too, so motion is the cause only where
  // neither is.
  const bool picture =
      significant(diagnostics.picture, degrees, rms) && diagnostics.picture_agrees > kSignificant;
  const bool board =
      significant(diagnostics.board, degrees, rms) && diagnostics.board_agrees > kSignificant;
  if (picture || board) {
    const bool corner = diagnostics.board.sum - diagnostics.board.degrees >
                        diagnostics.picture.sum - diagnostics.picture.degrees;
    return board && (corner || !picture) ? Misfit::Cause::kBoard : Misfit::Cause::kModel;
  }
  if (significant(diagnostics.views, degrees, rms)) return Misfit::Cause::kMotion;
  return noisy ? Misfit::Cause::kNoise : Misfit::Cause::kNone;
}

// Whether corners are so far from where the text of the board has them that it may be of another
// board: offsets of a printed one are far less.
bool is_of_another_text(const Misfit& misfit) {
  return misfit.noticed == Misfit::Cause::kBoard && misfit.board_residual > kPixel;
}

// Whether the promise holds what was noticed.
bool is_held(const Misfit& misfit, const FitDiagnostics& diagnostics, const PromiseParts& promise) {
  if (is_of_another_text(misfit)) return false;
  if (misfit.noticed == Misfit::Cause::kBoard) return diagnostics.bends_known;
  if (misfit.noticed == Misfit::Cause::kModel) return misfit.lens_residual < promise.all;
  return true;
}

// What made the promise large: offsets of the board's corners only where it were much smaller
// without them.
Misfit::Cause large_by(Misfit::Cause noticed, const PromiseParts& promise) {
  const double all = promise.all * promise.all;
  const double left = promise.board_known.value_or(0) * promise.board_known.value_or(0);
  if (noticed == Misfit::Cause::kBoard && left > all / 2) return Misfit::Cause::kMotion;
  return noticed;
}

// Where the corners of a board are, in a sentence or two.
std::string board_finding(const Misfit& misfit, const FitDiagnostics& diagnostics) {
  const auto& pattern = diagnostics.board_pattern;
  const std::string as = pattern ? ", " + to_words(*pattern) : std::string();
  if (is_of_another_text(misfit)) {
    return fmt::format(
        "The corners of the board are not where its text has them, in all views alike, by "
        "{:.2g} px{}. See that its sides, gaps and numbers are those of the text.",
        misfit.board_residual, as);
  }
  // What views agree on is in the plane of the board, or else out of it.
  if (!(diagnostics.board_variance > 0)) return "The board is not flat.";
  return fmt::format("The corners of the board are {:.2g} mm from where they were printed{}.",
                     1e3 * std::sqrt(diagnostics.board_variance), as);
}

// What was found, in a sentence.
std::string finding(Misfit::Cause cause, const Misfit& misfit, const FitDiagnostics& diagnostics,
                    std::optional<double> chi) {
  switch (cause) {
    case Misfit::Cause::kNone:
      return {};
    case Misfit::Cause::kNoise:
      return fmt::format(
          "The corners are {:.1f} times less exact than the detector believes, by blur, low light "
          "or compression.",
          chi.value_or(1));
    case Misfit::Cause::kModel:
      return fmt::format(
          "All views share a pattern of {:.2g} px in the picture that the camera model does not "
          "have.",
          misfit.lens_residual);
    case Misfit::Cause::kBoard:
      return board_finding(misfit, diagnostics);
    case Misfit::Cause::kMotion:
      return "The views contradict each other by more than noise, as where the board bends or "
             "moves from view to view.";
  }
  return {};
}

// What the promise makes of it.
std::string effect(Misfit::Cause cause, const PromiseParts& promise) {
  const double accuracy = 2 * promise.all;
  const std::string held = fmt::format(" That is in the accuracy of {:.2g} px", accuracy);
  if (cause == Misfit::Cause::kBoard && promise.board_known) {
    const double known = 2 * *promise.board_known;
    constexpr double kHardly = 0.9;
    if (known > kHardly * accuracy) return held + ", which would hardly be better without.";
    return held +
           fmt::format(", which a measured or stiffer board would bring to {:.2g} px.", known);
  }
  constexpr double kWorthSaying = 1.1;
  if (cause == Misfit::Cause::kMotion && promise.all > kWorthSaying * promise.by_noise) {
    return held + fmt::format("; noise alone would leave {:.2g} px.", 2 * promise.by_noise);
  }
  return held + ".";
}

}  // namespace

std::optional<std::string> uncovered(const Calibration& calibration) {
  constexpr double kMuchWorse = 3;
  constexpr double kWorthAView = 0.5;  // px
  const auto& worst = calibration.worst_place;
  const double anywhere = calibration.expected_error_anywhere.value_or(0);
  const double covered = calibration.expected_error.value_or(0);
  if (!worst || anywhere < std::max(kMuchWorse * covered, kWorthAView)) return std::nullopt;
  const std::string place = part_of_picture(*worst, calibration.image_size);
  if (anywhere > kNothingKnown) {
    return fmt::format(
        "No corner was seen in the {}, of which nothing is known; the picture is accurate to "
        "{:.3g} "
        "px among the corners: show the board there.",
        place, 2 * covered);
  }
  return fmt::format(
      "No corner was seen in the {}, where the picture is accurate to {:.3g} px only, against "
      "{:.3g} px among the corners: show the board there.",
      place, 2 * anywhere, 2 * covered);
}

void renew_uncovered(Calibration& calibration, const std::optional<std::string>& before) {
  auto& remarks = calibration.remarks;
  auto at = before ? std::ranges::find(remarks, *before) : remarks.end();
  if (at != remarks.end()) at = remarks.erase(at);
  if (auto now = uncovered(calibration)) remarks.insert(at, *std::move(now));
}

Misfit misfit(const FitDiagnostics& diagnostics, std::optional<double> chi, double degrees,
              double rms, const PromiseParts& promise) {
  Misfit result;
  result.split_half_ratio = diagnostics.split_half_ratio;
  const auto beyond_noise = [&](const ChiSquare& c) {
    return rms * std::sqrt(std::max((c.sum - c.degrees) / degrees, 0.0));
  };
  result.lens_residual = beyond_noise(diagnostics.picture);
  result.board_residual = beyond_noise(diagnostics.board);
  result.noticed = noticed(diagnostics, chi, degrees, rms);
  const bool grown = promise.all > kMuchWorse * promise.by_noise || chi.value_or(1) > kMuchNoise;
  if (!is_held(result, diagnostics, promise)) {
    result.cause = result.noticed;
  } else if (grown && promise.all > kPixel) {
    result.cause = large_by(result.noticed, promise);
  }
  return result;
}

std::string explain(const Misfit& misfit, const FitDiagnostics& diagnostics,
                    std::optional<double> chi, const PromiseParts& promise) {
  const Misfit::Cause cause = misfit.found() ? misfit.cause : misfit.noticed;
  if (cause == Misfit::Cause::kNone) return {};
  std::string text = finding(cause, misfit, diagnostics, chi);
  text += is_held(misfit, diagnostics, promise) ? effect(cause, promise)
                                                : " The expected error does not hold that.";
  if (cause == Misfit::Cause::kBoard && diagnostics.board_pattern) {
    return text + " " + advice(*diagnostics.board_pattern);
  }
  return misfit.found() ? text + " " + advice(cause) : text;
}

std::string measured_otherwise(const std::vector<Eigen::Vector3d>& offsets,
                               const BoardPattern& pattern) {
  double squares = 0;
  for (const Eigen::Vector3d& o : offsets) squares += o.head<2>().squaredNorm() / 2;
  const double rms = std::sqrt(squares / static_cast<double>(offsets.size()));
  return fmt::format(
      "The corners of the board were measured {:.2g} mm from where its text has them, {}. {}",
      1e3 * rms, to_words(pattern), advice(pattern));
}

void add_remarks(Solution& solution, const Eigen::MatrixXd& c, const Camera& camera,
                 const Parameterization& parameterization) {
  const ImageSize size = camera.image_size();
  auto& remarks = solution.calibration.remarks;
  const auto variances = [&c](ParameterRange range) {
    return c.diagonal().segment(range.first, range.count);
  };
  const double center = std::sqrt(variances(parameterization.table.center(0)).maxCoeff());
  if (center > kWeakCenterSigma * size.width) {
    remarks.push_back(fmt::format(
        "The principal point is weak (+- {:.1f} px): all views are tilted much the same way. Tilt "
        "the board to the other side too.",
        center));
  }
  const ParameterRange range = parameterization.table.focal(0);
  double focal = 0;
  for (int i = range.first; i < range.end(); ++i) {
    const double value = solution.calibration.parameters[static_cast<std::size_t>(i)].value;
    focal = std::max(focal, std::sqrt(c(i, i)) / value);
  }
  if (focal > kWeakFocalSigma) {
    remarks.push_back(fmt::format(
        "The focal length is weak (+- {:.1f} %): tilt the board more, 30 to 45 degrees.",
        100 * focal));
  }
  if (auto oblong = oblong_pixels(solution.calibration, c, range)) {
    remarks.push_back(std::move(*oblong));
  }
  if (auto where = uncovered(solution.calibration)) remarks.push_back(std::move(*where));
  // The picture of a lens that sees past 90 degrees may end before the image does.
  if (!parameterization.lens.perspective) return;
  if (const Status one = check_monotone(camera); !one) {
    remarks.push_back(one.error().message);
  }
}

}  // namespace calvin
