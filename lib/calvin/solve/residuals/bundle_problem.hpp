// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cameras on a rig, the boards that they see and free points as a problem for minimise(). Internal.
//
// A residual block says what one camera sees of one board, or of free points, at one time. It
// depends on
//   - the unknowns of its camera, the place of that camera in the rig and the modes of its board,
//     which are shared by all blocks: ParameterTable;
//   - one small block: the pose of the board (6 unknowns), or a free point (3 unknowns).
// Small blocks know nothing of each other, so that each is eliminated by itself. For that a free
// point has to be seen from where it is known: it has a place in a world to which the rig has a
// known pose, the identity for a rig that stands still. A rig that moves by unknown poses couples
// these with the points; such poses are to be shared unknowns. A single camera is a rig of its own.
#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include <Eigen/Core>

#include "calvin/geometry/se3.hpp"
#include "calvin/solve/linear/arrowhead.hpp"
#include "calvin/solve/parameters/parameter_table.hpp"
#include "calvin/solve/residuals/loss.hpp"
#include "calvin/solve/residuals/points.hpp"
#include "calvin/solve/residuals/row_plan.hpp"
#include "calvin/solve/residuals/view_points.hpp"

namespace calvin {

// exp(d) * pose, d as in RowLayout.
[[nodiscard]] SE3 retract(const SE3& pose, const double* d);

// Corners at camera_from_rig * rig_from_board * (printed point + modes).
struct BoardResiduals {
  const ViewPoints* seen = nullptr;
  std::size_t pose = 0;    // the number of rig_from_board in BundlePoint
  std::size_t camera = 0;  // of the table
  std::size_t board = 0;   // of the table
};

// Points at camera_from_rig * rig_from_world * point.
struct PointResiduals {
  PointSet seen;           // `ids` are the numbers of the points in BundlePoint
  std::size_t camera = 0;  // of the table
  SE3 rig_from_world;      // known
};

struct ResidualBlocks {
  std::vector<BoardResiduals> boards;
  std::vector<PointResiduals> points;
  // The numbers of poses of boards whose points all lie on the x axis of the board. A turn about it
  // shows in no picture and is kept from moving, which changes nothing else.
  std::vector<std::size_t> lines;
};

// The shared unknowns, the directions in which they may move, and their priors.
struct SharedUnknowns {
  const ParameterTable* table = nullptr;
  Eigen::MatrixXd basis;  // unknowns x directions: they move in its span only
  std::vector<ParameterTable::Prior> priors;
};

// A value of every unknown.
struct BundlePoint {
  std::vector<double> shared;  // in the order of ParameterTable
  // camera_from_board where the cameras are no rig.
  std::vector<SE3> rig_from_board;
  // Per camera; those without a rig pose in the table stay where they are. Empty: no rig.
  std::vector<SE3> camera_from_rig;
  std::vector<Eigen::Vector3d> points;  // free, m, world
};

class BundleProblem {
 public:
  // Views and table must outlive the problem. Once `stop` is requested, a linearisation over many
  // blocks ends early, as if points had no projection.
  BundleProblem(ResidualBlocks blocks, SharedUnknowns unknowns, BundlePoint start, const Loss& loss,
                std::stop_token stop = {});

  // False where nothing can be minimised: a point has no projection at the start; the table has a
  // place in the rig and `start` has no rig, or one of another number of cameras; a block names a
  // camera, board or pose that is not there.
  [[nodiscard]] bool valid() const { return valid_; }
  [[nodiscard]] const BundlePoint& point() const { return current_.point; }

  // Goes on from where it stands with another loss; what valid() says then.
  bool restart(const Loss& loss) {
    loss_ = loss;
    return valid_ = linearise(current_);
  }

  // For minimise().
  [[nodiscard]] double cost() const { return current_.cost; }
  [[nodiscard]] std::optional<double> propose(double lambda);
  [[nodiscard]] std::optional<double> evaluate_trial();
  void accept() { std::swap(current_, trial_); }
  void accept_unseen(double predicted) {
    std::swap(current_.point, trial_.point);
    current_.cost = std::max(0.0, current_.cost - predicted);
  }

  // The normal equations over the directions of the basis, poses and points eliminated, not damped,
  // for residuals of 1 px. `information` is the inverse of the marginal covariance. Absent where a
  // pose or a point is not determined.
  struct Reduced {
    Eigen::MatrixXd information;
    Eigen::VectorXd gradient;
    double cost = 0;  // px^2
  };
  [[nodiscard]] std::optional<Reduced> reduced();

  // The normal equations of one board's pose, not damped, for residuals of 1 px: 6 x 6, and by the
  // shared unknowns, whatever the basis leaves of them.
  struct PoseEquations {
    Eigen::MatrixXd own;
    Eigen::MatrixXd by_shared;
  };
  [[nodiscard]] PoseEquations pose_equations(std::size_t pose) const;

 private:
  struct State {
    BundlePoint point;
    ArrowEquations equations;
    double cost = 0;
  };

  bool linearise(State& state);
  bool add_board(const BoardResiduals& block, RowPlan& plan, State& state);
  bool add_points(std::size_t block, State& state);
  void hold_turns(State& state) const;
  void add_priors(State& state) const;
  void move_shared(const Eigen::VectorXd& move);

  ResidualBlocks blocks_;
  SharedUnknowns unknowns_;
  RowPlans plans_;
  std::vector<std::size_t> plan_of_board_;   // per block
  std::vector<std::size_t> plan_of_points_;  // per block
  std::vector<ViewPoints> points_;           // per block of free points: the arrays of a state
  Loss loss_;
  std::stop_token stop_;
  ArrowElimination elimination_;
  State current_;
  State trial_;
  std::vector<double> block_steps_;  // of the last step
  bool valid_ = false;
};

// Of the last elimination of small blocks, over the directions of a basis.
[[nodiscard]] BundleProblem::Reduced reduced_to(const Eigen::MatrixXd& basis,
                                                const ArrowElimination& elimination);

}  // namespace calvin
