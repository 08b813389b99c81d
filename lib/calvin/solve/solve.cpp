// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Checks what the caller gives, makes points of it, and lets one model or several be solved.

#include "calvin/solve/solve.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/camera/camera.hpp"
#include "calvin/core/text.hpp"
#include "calvin/solve/auto_model.hpp"
#include "calvin/solve/simpler_model.hpp"
#include "calvin/solve/judge/solve_points.hpp"
#include "calvin/solve/parameters/parameterization.hpp"
#include "calvin/solve/residuals/board_shape.hpp"
#include "calvin/solve/residuals/points.hpp"

namespace calvin {

namespace {

struct UsableViews {
  std::vector<PointSet> views;
  std::vector<RejectedView> rejected;
};

Result<UsableViews> usable_views(std::span<const View> views, ImageSize size) {
  UsableViews usable;
  struct Printed {
    const Board* board;
    std::vector<Eigen::Vector3d> points;
  };
  std::vector<Printed> boards;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Observation& seen = views[i].observation;
    if (!seen.found()) {
      usable.rejected.push_back({i, Reason::kNotFound});
      continue;
    }
    if (seen.image_size.width > 0 && seen.image_size != size) {
      usable.rejected.push_back({i, Reason::kOffSize});
      continue;
    }
    if (const Status status = check(views[i], size); !status) {
      return make_error(status.error().code, fmt::format("View {}: {}", i, status.error().message));
    }
    const Board& board = views[i].board;
    const auto known = std::find_if(boards.begin(), boards.end(),
                                    [&board](const Printed& p) { return *p.board == board; });
    const auto number = static_cast<std::size_t>(known - boards.begin());
    if (known == boards.end()) boards.push_back({&board, board.points()});
    PointSet points = to_points(board, boards[number].points, seen);
    points.index = i;
    points.board = number;
    points.motion = row_motion(seen, size.height);
    if (!spans_plane(points)) {
      usable.rejected.push_back({i, Reason::kTooFewPoints});
      continue;
    }
    usable.views.push_back(std::move(points));
  }
  return usable;
}

// Views that tell the shape of their board, or one lens from another.
constexpr std::size_t kViewsEnough = 8;

// The shape that the options ask for; none unless there are views enough, all of one board.
BoardShape shape_for(std::span<const View> views, std::size_t count, const SolveOptions& options) {
  if (count < kViewsEnough) return {};
  const Board& board = views.front().board;
  const auto same = [&board](const View& view) { return view.board == board; };
  return std::all_of(views.begin(), views.end(), same) ? make_shape(board, options) : BoardShape();
}

// The boards of the views used, each once, in the order of their first view.
std::string board_text(std::span<const View> views, const std::vector<RejectedView>& rejected) {
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const auto is_this = [i](const RejectedView& r) { return r.index == i; };
    if (std::any_of(rejected.begin(), rejected.end(), is_this)) continue;
    std::string text = views[i].board.text();
    if (std::find(texts.begin(), texts.end(), text) == texts.end()) {
      texts.push_back(std::move(text));
    }
  }
  return join(texts, ";");
}

// Makes ids of what the solver has for them: places in the list of the ids of the view's board.
void give_ids(std::span<const View> views, std::vector<RejectedCorner>& corners) {
  std::optional<std::size_t> of;  // corners of a view stand together
  std::vector<int> ids;           // of its board, which may have thousands of points
  for (RejectedCorner& corner : corners) {
    if (of != corner.view) ids = views[corner.view].board.ids();
    of = corner.view;
    corner.id = ids[static_cast<std::size_t>(corner.id)];
  }
}

// The solve of one model. Where the views leave it open a simpler one takes its place; where it
// finds fault, others are tried.
Result<Solution> solve_model(std::span<const View> views, std::vector<PointSet> points,
                             const BoardShape& shape, ImageSize size, const SolveOptions& options,
                             const std::stop_token& stop) {
  auto solution = solve_points(std::move(points), shape, size, options, stop);
  // Of two views all models are open, and without checks nobody knows whether a simpler one fits.
  if (options.checks && views.size() > 2 && leaves_open(solution, size)) {
    if (const auto again = usable_views(views, size)) {
      solution = solve_simpler(std::move(solution), again->views, shape, size, options, stop);
    }
    if (solution && solution->calibration.model != options.model) return solution;
  }
  // Others take their time, tenths of a second each where every corner's offset is an unknown.
  if (!solution || options.offsets || solution->calibration.views.size() < kViewsEnough) {
    return solution;
  }
  const Misfit& misfit = solution->misfit;
  if (!misfit.found() && misfit.noticed != Misfit::Cause::kModel) return solution;
  if (const auto again = usable_views(views, size)) {
    try_other_models(*solution, again->views, shape, size, options, stop);
  }
  if (stop.stop_requested()) return make_error(ErrorCode::kCancelled, "The solve was stopped.");
  return solution;
}

}  // namespace

Status check(const SolveOptions& options) {
  SolveOptions any = options;
  if (any.model == kAutoModel) any.model = "brown5";
  const auto parameterization = make_parameterization(any, {});
  if (!parameterization) return tl::unexpected<Error>(parameterization.error());
  return {};
}

Result<Solution> solve(std::span<const View> views, ImageSize image_size,
                       const SolveOptions& options, std::stop_token stop) {
  if (const Status status = check_image_size(image_size); !status) {
    return tl::unexpected<Error>(status.error());
  }
  auto usable = usable_views(views, image_size);
  if (!usable) return tl::unexpected<Error>(usable.error());
  const BoardShape shape = shape_for(views, usable->views.size(), options);
  auto solution =
      options.model == kAutoModel
          ? solve_auto(usable->views, shape, image_size, options, stop)
          : solve_model(views, std::move(usable->views), shape, image_size, options, stop);
  if (!solution) return solution;
  give_ids(views, solution->rejected_corners);
  auto& rejected = solution->rejected;
  rejected.insert(rejected.end(), usable->rejected.begin(), usable->rejected.end());
  std::sort(rejected.begin(), rejected.end(),
            [](const RejectedView& a, const RejectedView& b) { return a.index < b.index; });
  solution->calibration.camera =
      options.camera.empty() ? views.front().observation.camera : options.camera;
  solution->calibration.board = board_text(views, rejected);
  return solution;
}

}  // namespace calvin
