// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// ViewGuide: which view would tell most about a camera next, and how much others tell beside it.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/session/guidance/view_coverage.hpp"
#include "calvin/solve/options.hpp"
#include "calvin/solve/view.hpp"
#include "calvin/solve/view_information.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

class BoardPlacement;

class ViewGuide {
 public:
  using Views = std::vector<std::shared_ptr<const View>>;

  // For a camera that is known roughly, the views that a session keeps, and the board that is to be
  // seen next. `missed`: targets that nobody got to; another one is asked for. Absent where no
  // solve takes the options. Takes some tens of milliseconds.
  [[nodiscard]] static std::optional<ViewGuide> make(const Camera& camera,
                                                     const SolveOptions& options, const Views& kept,
                                                     const Board& board, const Views& missed = {});

  // camera_from_board of the view that lowers the variance of ViewScorer most and covers most of
  // what was not covered of the picture, both as logarithms: the board in the picture, large
  // enough to be found, tilted no more than a hand would, a little rolled, and unlike the views
  // that are kept. Absent where the picture has room for none.
  [[nodiscard]] std::optional<SE3> target() const;
  // As the camera would see it; null without a target.
  [[nodiscard]] std::shared_ptr<const View> target_view() const;
  // The outline of the corners there, px: what a person sees marked on the board that is held.
  [[nodiscard]] std::vector<Pixel> outline() const;
  // How the picture shows it there.
  [[nodiscard]] std::optional<BoardFootprint> footprint() const;
  // A hand does not get everywhere: the target is now the best one that is unlike those before,
  // leaves more room around the board and, where there is one, lies where corners were seen
  // already, not far from the first. There are a few of them.
  [[nodiscard]] bool has_another() const noexcept { return asked_ + 1 < targets_.size(); }
  void ask_for_another() noexcept;
  // Asks for what another guide asks for, so that an outline stays where it is; its own target is
  // the next one. False where that is like one of the views, cannot be seen or tells less than half
  // of what its own does: nothing is changed.
  bool keep_asking(const ViewGuide& before, const Views& kept);

  // What a view tells as a part of what the target would tell: 0 for nothing, 1 for as much; more
  // where the target is not the best. 0 for a view without a pose.
  [[nodiscard]] double share(const View& view) const;
  // RMS distance of the corners from where the target would show them, px; infinite without a
  // target, and where the view has no corner of its board.
  [[nodiscard]] double distance(const View& view) const;
  // Which of the views that are kept tells least, if the view would tell more in its place; else
  // null.
  [[nodiscard]] const View* exchange_for(const View& view) const;
  // Whether the target would: it tells most.
  [[nodiscard]] bool has_exchange() const noexcept { return has_exchange_; }

 private:
  ViewGuide(const Camera& camera, ViewScorer scorer);
  struct Target {
    SE3 pose;  // camera_from_board
    double gain = 0;
    std::shared_ptr<const View> view;
    std::vector<Pixel> outline;
    std::optional<BoardFootprint> footprint;

    void take(View seen);  // the view there, and its footprint
  };

  void find_weakest(const Views& kept, const std::vector<Eigen::MatrixXd>& information);
  // All that the camera could see and that tell anything, the better ones first.
  [[nodiscard]] std::vector<Target> candidates(const BoardPlacement& placement, double sigma) const;
  void find_targets(Views unlike, const Board& board, double sigma);
  // Whether corners were seen where the outline lies, or nearly so: elsewhere the camera may be
  // known so badly that the board is not seen where it is expected.
  [[nodiscard]] bool is_known(const std::vector<Pixel>& outline) const;
  [[nodiscard]] const Target* asked() const noexcept;
  [[nodiscard]] double gain(const View& view, const Eigen::MatrixXd& information) const;
  [[nodiscard]] double uncovered(const std::vector<Pixel>& hull) const;

  Camera camera_;
  double visible_area_ = 0;  // px^2, of the picture
  ViewScorer scorer_;
  Eigen::MatrixXd known_;  // the prior and the information of the views that are kept
  double variance_ = 0;    // px^2, of known_
  // The view without which the variance grows least, and what is known without it.
  std::shared_ptr<const View> weakest_;
  Eigen::MatrixXd without_weakest_;
  bool has_exchange_ = false;
  std::vector<Pixel> covered_;   // the convex hull of the corners of the views that are kept
  std::vector<Target> targets_;  // unlike each other, the better ones first
  std::size_t asked_ = 0;        // which of them is asked for
};

}  // namespace calvin
