// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Hand-eye calibration as a problem for minimise(): every view has the distances of its corners and
// the error of its loop, both in px. Internal.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/rig/hand_eye/loop.hpp"
#include "calvin/solve/linear/arrowhead.hpp"
#include "calvin/solve/parameters/parameter_table.hpp"
#include "calvin/solve/residuals/row_plan.hpp"
#include "calvin/solve/residuals/view_points.hpp"

namespace calvin::rig {

// A view; the arrays must outlive the problem.
struct HandEyeBlock {
  const ViewPoints* seen = nullptr;  // with the labels of the board
  SE3 base_from_hand;
};

// What an error of a pose of the robot weighs: a corner's sigma over that of the robot.
struct LoopWeights {
  double turn = 1;   // px/rad
  double place = 1;  // px/m
};

struct HandEyePoint {
  HandEyePlaces places;
  std::vector<SE3> camera_from_board;  // of every block
};

// Sums over loops, and over their rows of a turn and of a place apart.
struct LoopSums {
  double turn = 0;
  double place = 0;
};

// The unknowns: camera_from_board of each view as a small block; the intrinsics, which are held,
// and then HandEyePlaces as what all views share.
class HandEyeProblem {
 public:
  HandEyeProblem(const Camera& camera, std::vector<HandEyeBlock> blocks, EyeSetup setup,
                 const LoopWeights& weights, bool free_scale, HandEyePoint start);

  // False where a corner has no projection at the start.
  [[nodiscard]] bool valid() const { return valid_; }
  [[nodiscard]] const HandEyePoint& point() const { return current_.point; }
  [[nodiscard]] const ParameterTable& table() const { return table_; }
  // The unknowns of HandEyePlaces that are free, and the place of the first one.
  [[nodiscard]] int free_places() const { return static_cast<int>(basis_.cols()); }
  [[nodiscard]] int first_place() const { return table_.count(); }

  // For minimise().
  [[nodiscard]] double cost() const { return current_.cost; }
  [[nodiscard]] std::optional<double> propose(double lambda);
  [[nodiscard]] std::optional<double> evaluate_trial();
  void accept() { std::swap(current_, trial_); }
  void accept_unseen(double predicted);

  // At the current point, which has to be linearised: linearise_current() after minimise().
  [[nodiscard]] bool linearise_current() { return linearise(current_); }
  // The squares of weighted errors, px^2, of each loop.
  [[nodiscard]] const std::vector<LoopSums>& squares() const { return current_.squares; }
  // The information over all shared unknowns, the poses eliminated, for residuals of 1 px. Absent
  // where a pose is not determined.
  [[nodiscard]] std::optional<Eigen::MatrixXd> information();
  // How many residuals of the loops are beyond those that the unknowns are fitted to: the trace of
  // W Q_v (W. Foerstner, Ein Verfahren zur Schaetzung von Varianz- und Kovarianzkomponenten, 1979).
  [[nodiscard]] std::optional<LoopSums> redundancy();

 private:
  struct State {
    HandEyePoint point;
    ArrowEquations equations;
    std::vector<LoopSums> squares;
    double cost = 0;
  };
  using WeightedRows = Eigen::Matrix<double, 6, 6 + 1 + kPlaceColumns>;

  [[nodiscard]] WeightedRows weighted_rows(const HandEyePoint& point, std::size_t block) const;
  bool linearise(State& state);

  std::vector<HandEyeBlock> blocks_;
  EyeSetup setup_;
  LoopWeights weights_;
  ParameterTable table_;
  std::vector<double> values_;
  Eigen::MatrixXd basis_;
  RowPlan plan_;
  ArrowColumns place_columns_;
  ArrowElimination elimination_;
  State current_;
  State trial_;
  std::vector<double> block_steps_;
  bool valid_ = false;
};

}  // namespace calvin::rig
