// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Views of a board -> Calibration, by least squares on the reprojection error.
//
// Start: Zhang's closed form (A Flexible New Technique for Camera Calibration, PAMI 22(11), 2000)
// with tests of its signs, or several focal lengths tried where that form does not apply. Then
// Levenberg-Marquardt over the camera and all board poses at once, each pose eliminated by its
// 6x6 block. Gross corners and wholly wrong views are found by a robust solve, left out and named.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/calibration.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/core/reason.hpp"
#include "calvin/core/result.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

// One board as seen in one frame. A corner counts by 1 / sigma^2; a sigma that is missing or not
// positive counts as 1 px, and then none of them is believed but for their ratios. Where corners
// are worse than their sigmas say, a sigma that all have in common is added.
struct View {
  Observation observation;
  Board board;
};

struct SolveOptions {
  // One of model_names(), or "auto": the simplest of the sensible ones whose views, held out, are
  // not told better by a richer one by more than 2 sigma.
  std::string model = "brown5";
  std::string camera;           // name for the result; empty: that of the first view
  int max_iterations = 100;     // of each least-squares solve
  bool reject_outliers = true;  // false: plain least squares over all corners

  // A calibration of images of the same size to start from: it makes a solve sure where the views
  // alone are few, and gives the values at which parameters are held. Coefficients of an unrelated
  // model do not count.
  std::optional<Calibration> initial;
  // Whether `initial` is believed as far as its sigmas say: what it tells of a parameter counts as
  // a measurement of it.
  bool initial_is_prior = false;

  // Whether the promise is checked too: expected error, chi and halves, see Solution. False: the
  // fit and its covariance alone.
  bool checks = true;

  // Estimates the two curvatures of the board (BoardWarp) too, from 8 views of one board on.
  bool warp = true;

  // The same of its aspect, and of the place of every single corner: see Solution. With the offsets
  // a solve takes tenths of a second instead of a millisecond.
  bool aspect = false;
  bool offsets = false;

  // Estimates the skew of the pixel axes (u = fx x + skew y + cx) too; else it is that of
  // `initial`, or 0.
  bool skew = false;

  // What is not estimated: the name of a parameter, held at its value in `initial`, or else a
  // coefficient at 0 and "cx", "cy" at the centre of the image; "center" is both of these. What is
  // tied: "aspect" keeps fy / fx as in `initial`, or else at 1, and "fx=fy" or "k1=k2" gives two
  // parameters one value.
  std::vector<std::string> fix;
};

struct RejectedView {
  std::size_t index = 0;  // in the views given
  Reason reason = Reason::kOutlier;
};

struct RejectedCorner {
  std::size_t view = 0;  // index in the views given
  int id = 0;
};

// Why a fit may be worse than its covariance says, though it converged.
struct Misfit {
  enum class Cause {
    kNone,    // what is left over is noise
    kNoise,   // there is more of it than the detector's sigmas tell
    kModel,   // residuals belong to places in the image: the lens is richer than the model
    kBoard,   // they belong to corners: the board is not flat, or not as it was printed
    kMotion,  // views contradict each other: the board moved or bent while it was seen
  };
  Cause cause = Cause::kNone;
  double halves = 1;  // see docs/how-to-calibrate.md

  [[nodiscard]] bool found() const { return cause != Cause::kNone; }
};

// "none", "noise", "model", "board", "motion"; and a sentence for the user, empty for kNone.
[[nodiscard]] std::string_view to_string(Misfit::Cause cause);
[[nodiscard]] std::string advice(Misfit::Cause cause);

// How much farther apart the rows of the board are than its columns.
struct BoardAspect {
  double value = 1;
  double sigma = 0;
};

// How far a corner is from where it was printed, and 1 sigma of it, m, board frame.
struct CornerOffset {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();
};

struct Solution {
  // `created` is left empty. `views` lists the views used, in the order given; `covered` is the
  // convex hull of the corners used; `board` the boards of the views used, joined by ';'.
  Calibration calibration;
  std::vector<RejectedView> rejected;
  std::vector<RejectedCorner> rejected_corners;  // of views that are otherwise used
  int iterations = 0;                            // of all least-squares solves together
  // Where one is found, expected_error is multiplied by max(1, chi, halves).
  Misfit misfit;
  // Per view of calibration.views, in px^2 per corner: how far its corners are from where a camera
  // of all other views puts them, the 6 parameters of its pose allowed for; weighted, and to first
  // order. calibration.held_out_rms is their mean's root: information, it decides nothing.
  std::vector<double> held_out;
  // Of the board, where they were estimated. Offsets are by the id of the control point; the sum of
  // all is no shift, turn, scale, shear, tilt or curvature of the board.
  std::optional<BoardAspect> board_aspect;
  std::vector<CornerOffset> corner_offsets;
  std::vector<std::string> remarks;  // sentences for the user: what is weak, and what to do
};

// Whether a view can be fed to solve(): ids within the board and none twice, as many corners as
// ids, all finite and within the image (5 % of its size beyond the border are tolerated).
// kInvalidArgument otherwise. Says nothing of whether the corners are enough.
[[nodiscard]] Status check(const View& view, ImageSize image_size);

// Whether solve() knows the model, what is to be fixed, and can start from `initial`.
[[nodiscard]] Status check(const SolveOptions& options);

// kInvalidArgument: a broken view, option or image size. kUnsupported: unknown model.
// kDegenerate: too little or too uniform data to determine the camera. kCancelled: `stop` was
// requested, which is looked at in every iteration. The result is finite whenever there is one.
// Thread-safe; keeps nothing.
[[nodiscard]] Result<Solution> solve(std::span<const View> views, ImageSize image_size,
                                     const SolveOptions& options = {}, std::stop_token stop = {});

}  // namespace calvin
