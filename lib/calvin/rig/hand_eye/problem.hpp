// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Hand-eye calibration as a problem for minimise(): at every pose of the robot there are the
// distances of the corners that one camera or several see, and the error of the loop, all in px.
// Internal.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/rig/hand_eye/loop.hpp"
#include "calvin/solve/linear/arrowhead.hpp"
#include "calvin/solve/parameters/parameter_table.hpp"
#include "calvin/solve/residuals/row_plan.hpp"
#include "calvin/solve/residuals/view_points.hpp"

namespace calvin::rig {

// What one camera sees of the board; the arrays must outlive the problem.
struct SeenByCamera {
  const ViewPoints* points = nullptr;  // with the labels of the board
  std::size_t camera = 0;              // of the table
};

// One pose of the robot.
struct HandEyeBlock {
  std::vector<SeenByCamera> seen;
  SE3 base_from_hand;
};

// What an error of a pose of the robot weighs: a corner's sigma over that of the robot.
struct LoopWeights {
  double turn = 1;   // px/rad
  double place = 1;  // px/m
};

// A value of every unknown.
struct HandEyePoint {
  HandEyePlaces places;
  std::vector<SE3> camera_from_board;  // of every block, by the first camera
  std::vector<double> shared;          // in the order of the table
  std::vector<SE3> camera_from_first;  // of every camera; the identity for the first one
};

// Sums over loops, and over their rows of a turn and of a place apart.
struct LoopSums {
  double turn = 0;
  double place = 0;
};

// The unknowns: camera_from_board of each block as a small block; those of the table, which are
// intrinsics, places of further cameras before the first one and the aspect of the board, each held
// or free as the table has it; and then HandEyePlaces as what all blocks share.
class HandEyeProblem {
 public:
  HandEyeProblem(ParameterTable table, std::vector<HandEyeBlock> blocks, EyeSetup setup,
                 const LoopWeights& weights, bool free_scale, HandEyePoint start);
  // Plans refer to the table.
  HandEyeProblem(const HandEyeProblem&) = delete;
  HandEyeProblem& operator=(const HandEyeProblem&) = delete;

  // False where a corner has no projection at the start.
  [[nodiscard]] bool valid() const { return valid_; }
  [[nodiscard]] const HandEyePoint& point() const { return current_.point; }
  [[nodiscard]] const ParameterTable& table() const { return table_; }
  // The place of the first unknown of HandEyePlaces among all shared ones, how many of those are
  // free, and how many of all shared ones.
  [[nodiscard]] int first_place() const { return table_.count(); }
  [[nodiscard]] int free_places() const { return free_scale_ ? kPlaceColumns : kScaleColumn; }
  [[nodiscard]] int free_unknowns() const { return static_cast<int>(basis_.cols()); }

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
  // The covariance of all shared unknowns, likewise, 0 for those that are held. Absent where one of
  // the others is not determined.
  [[nodiscard]] std::optional<Eigen::MatrixXd> covariance();
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
  bool add_corners(std::size_t block, State& state);

  ParameterTable table_;
  std::vector<HandEyeBlock> blocks_;
  EyeSetup setup_;
  LoopWeights weights_;
  bool free_scale_;
  Eigen::MatrixXd basis_;
  RowPlans plans_;  // of each camera
  ArrowColumns place_columns_;
  ArrowElimination elimination_;
  State current_;
  State trial_;
  std::vector<double> block_steps_;
  bool valid_ = false;
};

}  // namespace calvin::rig
