// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether a calibration still holds, judged by the boards that its camera sees.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/core/result.hpp"
#include "calvin/solve/options.hpp"
#include "calvin/solve/solution.hpp"
#include "calvin/solve/view.hpp"

namespace calvin {

struct PlacedGrid;
struct PointSet;
struct SE3;

struct RecheckReport {
  Pose camera_from_board;
  double rms = 0;  // px, of this view's corners around its best pose
  // px, by all views so far, and 1 sigma of it: see Recheck. Where nothing is proved the first is 0
  // and the second that of the worst place where boards were seen.
  double displacement = 0;
  double displacement_sigma = 0;
  double region_sigma = 0;  // px, 1 sigma at the worst place where boards were seen
  int points = 0;
};

// What to tell the user; empty where nothing has moved by more than 4 sigma and .3 px.
[[nodiscard]] std::string advice(const RecheckReport& report);

// Each view gets the pose that fits it best; the camera stays as it is. The residuals are reduced
// to their normal equations over the parameters, which give one Gauss-Newton step from the
// calibration over the latest views that differ from each other, with a weak prior (any one
// parameter moves the picture by 2 % of its width at most, 1 sigma). `displacement` is the largest
// change of projection that this step makes where these views saw corners, a mere turn of the
// camera left out; 0 unless the change is larger than the noise of the corners, what views
// contradict each other by and the covariance of the calibration explain: 2 sigma. For a camera
// that moved much it is an estimate of first order. The board that the calibration was made with is
// bent as it was then. Corners that move are seen where they were when their row was read: the
// readout is one more unknown, of which no more is known than is given.
//
// Not thread-safe.
class Recheck {
 public:
  // `camera` is that of the frames; `calibration`, which it was made of, gives the covariance and
  // what was estimated; `readout` is what is known of the readout of views with velocities, which
  // are taken to stand still without it.
  Recheck(const Camera& camera, const Calibration& calibration,
          std::optional<ReadoutTime> readout = {});

  // Fails as solve_pose() does for a view that determines no pose.
  [[nodiscard]] Result<RecheckReport> add(const View& view);
  // Of that many views at once, none of which need tell a pose: what the last add() would report,
  // without a pose, rms and points. Of more than 30, every other or third one and so on is taken.
  [[nodiscard]] RecheckReport add(std::span<const View> views);

 private:
  // One view, its pose eliminated: information and gradient over the parameters in `columns_` and,
  // where has_readout(), that of the readout behind them.
  struct Condensed {
    std::string board;
    std::vector<Pixel> corners;  // of the box around its points, by which views are told apart
    std::vector<Pixel> hull;     // of its points
    Eigen::MatrixXd information;
    Eigen::VectorXd gradient;
    double cost = 0;     // squares of residuals over their sigmas
    double degrees = 0;  // residuals less the pose's parameters
  };

  [[nodiscard]] bool has_readout() const { return readout_ && readout_->sigma > 0; }
  [[nodiscard]] std::optional<Condensed> condense(const View& view, const PointSet& points,
                                                  const SE3& pose) const;
  [[nodiscard]] Result<RecheckReport> gather(const View& view);
  void keep(Condensed view);
  struct Step;
  [[nodiscard]] std::optional<Step> step() const;
  [[nodiscard]] double contradiction(const Eigen::MatrixXd& inverse, const Eigen::VectorXd& step,
                                     double variance) const;
  static void judge(const Step& step, const PlacedGrid& region, RecheckReport& report);
  void judge(RecheckReport& report) const;

  Camera camera_;
  std::vector<int> columns_;  // of projection_grid()
  std::optional<ReadoutTime> readout_;
  // Over the unknowns of Condensed.
  Eigen::MatrixXd prior_;         // information
  Eigen::MatrixXd covariance_;    // of the calibration, and what is known of the readout
  double contradiction_before_;   // of the views that it was made of, see contradiction()
  std::string board_;             // of the calibration
  BoardWarp warp_;                // of that board
  std::vector<Condensed> views_;  // in order of time
};

// What the views of a calibration's camera prove that it has moved by, where that is more than 3
// sigma and .3 px. `readout`: as for Recheck.
[[nodiscard]] std::optional<RecheckReport> proved_displacement(
    const Camera& camera, const Calibration& calibration, std::span<const View> views,
    std::optional<ReadoutTime> readout = {});

// The verdict on the camera that solve_poses() held, of which nothing but these views tells that it
// is theirs: misfit, and a remark where it is not.
void judge_held_camera(Solution& solution, std::span<const View> views,
                       const SolveOptions& options);

}  // namespace calvin
