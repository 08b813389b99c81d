// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The options of solve(): the model, the unknowns, and what is known of them before.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calvin/core/calibration.hpp"

namespace calvin {

struct BoardMeasurement;

// How long a camera takes from the first row of a frame to the last, s; negative where it begins
// with the last. A sigma of 0: it is known.
struct ReadoutTime {
  double value = 0;
  double sigma = 0;
};

struct SolveOptions {
  // One of model_names(), or "auto": the simplest model for which no richer one predicts the views
  // that were held out better by more than 2 sigma.
  // The result may be of a simpler model than this one, and a remark says so, where the views leave
  // open what the richer one has: ucm instead of doublesphere.
  std::string model = "brown5";
  std::string camera;           // name for the result; empty: that of the first view
  int max_iterations = 100;     // of each least-squares solve, 1 at least
  bool reject_outliers = true;  // false: plain least squares over all corners

  // One of the methods of the tools that came before (docs/methods.md), from which the solve
  // starts, as "zhang", or which is all of it, as "discorpy"; check() says which there are. Empty:
  // starts are searched.
  std::string method;
  // False: what `method` finds by itself, in its own model, without the least squares after it, or
  // with plain ones alone where they are a step of its own ("heikkila").
  bool refine = true;

  // The places of round dots are the centres of their images, as other programs measure them, and
  // not the images of their centres: the difference is taken off, as the result has it, and the
  // views are solved anew. Of boards of dots with diameters (points:FILE) only, in the plane z = 0
  // or with normals.
  bool ellipse_centers = false;

  // A calibration of images of the same size to start from: it makes a solve sure where the views
  // alone are few, and gives the values at which parameters are held. Coefficients of an unrelated
  // model do not count.
  std::optional<Calibration> initial;
  // Whether each parameter of `initial` counts as a measurement with its sigma.
  bool initial_is_prior = false;

  // Whether the covariance is checked too: expected error, chi and split-half ratio, see Solution.
  // False: the fit and its covariance alone.
  bool checks = true;

  // Estimates the two curvatures of the board (BoardWarp) too, from 8 views of one board on.
  bool warp = true;

  // Estimates the aspect of the board too, and the place of every single corner with the
  // curvatures, from 8 views that are not ambiguous on: see Solution.
  bool aspect = false;
  bool offsets = false;

  // What other views say of the places of the corners, with a covariance. The corners are there,
  // and what is left unknown of them is a part of the result's covariance; with `offsets` they are
  // estimated anew, and it is their prior. It is left out, and a remark says so, where the views
  // contradict it or are among those that it was made of. Null: nothing is known.
  std::shared_ptr<const BoardMeasurement> measured;

  // What was known of the readout before: corners of views with velocities are put where the middle
  // row of the frame would have shown them, and the readout is estimated where it has a sigma and
  // the velocities tell. Absent: velocities do not count.
  std::optional<ReadoutTime> readout;

  // Estimates the skew of the pixel axes (u = fx x + skew y + cx) too; else the skew of `initial`
  // is kept, or 0.
  bool skew = false;

  // Parameters that are held or tied. A name holds a parameter at its value in `initial`, or else a
  // coefficient where it bends nothing (at 0, but at 1 for beta) and "cx", "cy" at
  // the centre of the image; "center" holds both of these.
  // "aspect" ties fy / fx as in `initial`, or else at 1; "fx=fy" or "k1=k2" gives two parameters
  // one value; "fx=800" holds one at a number. "all" holds the whole camera of `initial`: the solve
  // then tells where the boards are, and nothing else.
  std::vector<std::string> fix;
};

}  // namespace calvin
