// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Checks what the caller gives, makes points of it, and lets one model or several be solved.

#include "calvin/solve/solve.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/camera/camera.hpp"
#include "calvin/core/text.hpp"
#include "calvin/solve/auto_model.hpp"
#include "calvin/solve/heikkila/ellipse_centers.hpp"
#include "calvin/solve/judge/solve_points.hpp"
#include "calvin/solve/methods/method_solution.hpp"
#include "calvin/solve/methods/methods.hpp"
#include "calvin/solve/models/simpler_model.hpp"
#include "calvin/solve/other_models.hpp"
#include "calvin/solve/parameters/parameterization.hpp"
#include "calvin/solve/pose.hpp"
#include "calvin/solve/recheck.hpp"
#include "calvin/solve/residuals/board_shape.hpp"
#include "calvin/solve/residuals/points.hpp"
#include "calvin/target/measured/board_measurement.hpp"
#include "calvin/target/unbounded_grid.hpp"

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
    if (is_off_size(seen, size)) {
      usable.rejected.push_back({i, Reason::kOffSize});
      continue;
    }
    if (const Status status = check_has_pose(views[i].board); !status) {
      return tl::unexpected<Error>(status.error());
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

// Whether all views show the same points.
bool of_one_board(std::span<const View> views) {
  const Board& board = views.front().board;
  // Of a grid that goes on beyond the picture each view shows other points.
  if (!check_names_points(board)) return false;
  return std::all_of(views.begin(), views.end(),
                     [&board](const View& view) { return view.board == board; });
}

// The modes that the options ask for; none unless there are views enough, all of one board.
BoardShape shape_for(std::span<const View> views, std::size_t count, const SolveOptions& options) {
  if (count < kViewsEnough || !of_one_board(views)) return {};
  return make_shape(views.front().board, options);
}

// The same with the offsets of a board, of which the curvatures are a part.
BoardShape shape_of(std::shared_ptr<const BoardMeasurement> known, std::size_t count,
                    SolveOptions options) {
  options.warp = false;
  options.aspect = options.aspect && count >= kViewsEnough;
  BoardShape shape = make_shape(known->board, options);
  shape.offsets = std::move(known);
  return shape;
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

constexpr const char* kOwnViews =
    "The measured board is not used: views of this session are among those that measured it, and "
    "count once.";
constexpr const char* kOtherBoard =
    "The measured board is not used, for these views show it otherwise: it is another sheet, or it "
    "is bent. Measure it anew under a name of its own (calvin-board measure).";

constexpr const char* kReadoutIdle =
    "The readout time has no effect: nothing tells how fast the board moved. That takes frames "
    "with "
    "timestamps, or a framerate in their caps, which show the board one after the other.";

// Whether a readout was given that moves no corner, for want of their velocities.
bool is_readout_idle(std::span<const View> views, const SolveOptions& options) {
  constexpr double kAllAtOnce = 1e-6;  // s
  const auto& readout = options.readout;
  return options.checks && readout &&
         std::abs(readout->value) > std::max(readout->sigma, kAllAtOnce) &&
         std::ranges::all_of(views, [](const View& v) { return v.observation.velocity.empty(); });
}

// Whether views that could be labelled in one way alone are enough to be trusted with the offsets
// of points: most of them.
bool mostly_unambiguous(const std::vector<PointSet>& views, std::size_t least) {
  const auto sure = static_cast<std::size_t>(std::count_if(
      views.begin(), views.end(), [](const PointSet& view) { return !view.ambiguous; }));
  return sure >= least && 2 * sure > views.size();
}

std::vector<ViewMark> marks_of(std::span<const View> views, const std::vector<PointSet>& used) {
  std::vector<ViewMark> marks;
  for (const PointSet& view : used) {
    if (!view.ambiguous) marks.push_back(mark_of(views[view.index].observation));
  }
  return marks;
}

bool any_of_them(const std::vector<ViewMark>& views, const std::vector<ViewMark>& known) {
  return std::any_of(views.begin(), views.end(), [&known](const ViewMark& view) {
    return std::any_of(known.begin(), known.end(),
                       [&view](const ViewMark& k) { return same_view(view, k); });
  });
}

// The shape of a board that may be stretched, too; absent where the views do not tell that.
std::optional<BoardShape> stretched_shape(std::span<const View> views,
                                          const std::vector<PointSet>& points,
                                          const BoardShape& shape, SolveOptions options) {
  if (shape.offsets || options.aspect || !mostly_unambiguous(points, kViewsEnough)) {
    return std::nullopt;
  }
  options.aspect = true;
  BoardShape stretched = shape_for(views, points.size(), options);
  return stretched.unknowns.has_aspect ? std::optional(std::move(stretched)) : std::nullopt;
}

// Where a solve finds fault, others are tried.
Result<Solution> beside_others(Result<Solution> solution, std::span<const View> views,
                               const BoardShape& shape, ImageSize size, const SolveOptions& options,
                               const std::stop_token& stop) {
  if (!solution || solution->calibration.views.size() < kViewsEnough) return solution;
  if (!may_be_the_lens(solution->misfit)) return solution;
  if (const auto again = usable_views(views, size)) {
    try_others(*solution, again->views, shape, stretched_shape(views, again->views, shape, options),
               size, options, stop);
  }
  if (stop.stop_requested()) return make_error(ErrorCode::kCancelled, "The solve was stopped.");
  return solution;
}

// The solve of one model. Where the views leave it open a simpler one takes its place.
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
  return beside_others(std::move(solution), views, shape, size, options, stop);
}

Result<Solution> solve_shaped(std::span<const View> views, std::vector<PointSet> points,
                              const BoardShape& shape, ImageSize size, const SolveOptions& options,
                              const std::stop_token& stop) {
  return options.model == kAutoModel
             ? beside_others(solve_auto(points, shape, size, options, stop), views, shape, size,
                             options, stop)
             : solve_model(views, std::move(points), shape, size, options, stop);
}

// The solve with the offsets of points, from how the board is bent as far as curvatures tell.
Result<Solution> solve_offsets(std::span<const View> views, std::vector<PointSet> points,
                               BoardShape shape, ImageSize size, const SolveOptions& options,
                               const std::stop_token& stop) {
  if (!options.measured) {
    SolveOptions bends = options;
    bends.checks = false;
    bends.warp = true;
    const auto bent =
        solve_shaped(views, points, shape_for(views, points.size(), bends), size, bends, stop);
    if (!bent) return bent;
    shape.start = bent->calibration.warp;
  }
  return solve_shaped(views, std::move(points), shape, size, options, stop);
}

// What is known of the points of the board of these views before they are solved; null where their
// offsets are not asked for, or cannot be told. `why` is what the user is told of a measured board
// that is not used.
std::shared_ptr<const BoardMeasurement> known_board(std::span<const View> views,
                                                    const std::vector<PointSet>& points,
                                                    const SolveOptions& options, const char*& why) {
  if (points.empty() || !of_one_board(views)) return nullptr;
  if (options.measured && options.measured->board == views.front().board &&
      mostly_unambiguous(points, 1)) {
    if (!any_of_them(marks_of(views, points), options.measured->views)) return options.measured;
    why = kOwnViews;
  }
  if (!options.offsets || !mostly_unambiguous(points, kViewsEnough)) return nullptr;
  auto unknown = unmeasured(views.front().board);
  return unknown ? std::make_shared<const BoardMeasurement>(*std::move(unknown)) : nullptr;
}

// The solve by all that the options ask for of the board.
Result<Solution> solve_board(std::span<const View> views, std::vector<PointSet> points,
                             ImageSize size, const SolveOptions& options,
                             const std::stop_token& stop);

// The solve with offsets of points, or with those that are known. Views that contradict what is
// known of the board are solved without.
Result<Solution> solve_known(std::span<const View> views, const std::vector<PointSet>& points,
                             std::shared_ptr<const BoardMeasurement> known, ImageSize size,
                             const SolveOptions& options, const std::stop_token& stop) {
  auto solution = solve_offsets(views, points, shape_of(std::move(known), points.size(), options),
                                size, options, stop);
  if (!solution) return solution;
  if (solution->other_board) {
    SolveOptions without = options;
    without.measured = nullptr;
    solution = solve_board(views, points, size, without, stop);
    if (!solution) return solution;
    solution->other_board = true;
    solution->calibration.remarks.emplace_back(kOtherBoard);
  } else if (solution->measured) {
    auto measured = std::make_shared<BoardMeasurement>(*solution->measured);
    const auto marks = marks_of(views, points);
    measured->views.insert(measured->views.end(), marks.begin(), marks.end());
    solution->measured = std::move(measured);
  }
  return solution;
}

Result<Solution> solve_board(std::span<const View> views, std::vector<PointSet> points,
                             ImageSize size, const SolveOptions& options,
                             const std::stop_token& stop) {
  SolveOptions asked = options;
  const char* why = nullptr;
  const auto known = known_board(views, points, options, why);
  if (known != options.measured) asked.measured = nullptr;
  if (known) {
    auto solution = solve_known(views, points, known, size, asked, stop);
    if (solution && why) solution->calibration.remarks.emplace_back(why);
    return solution;
  }
  const BoardShape shape = shape_for(views, points.size(), asked);
  auto solution = solve_shaped(views, std::move(points), shape, size, asked, stop);
  if (solution && why) solution->calibration.remarks.emplace_back(why);
  return solution;
}

// Says of which camera and of which boards a solution is.
Result<Solution> named(Result<Solution> solution, std::span<const View> views,
                       const SolveOptions& options) {
  if (!solution) return solution;
  solution->calibration.camera =
      options.camera.empty() ? views.front().observation.camera : options.camera;
  solution->calibration.board = board_text(views, solution->rejected);
  if (is_readout_idle(views, options)) solution->calibration.remarks.emplace_back(kReadoutIdle);
  return solution;
}

Result<Solution> solve_held(std::span<const View> views, ImageSize image_size,
                            const SolveOptions& options) {
  auto solution = solve_poses(views, image_size, options);
  if (solution) judge_held_camera(*solution, views, options);
  return named(std::move(solution), views, options);
}

Result<Solution> solve_views(std::span<const View> views, ImageSize image_size,
                             const SolveOptions& options, const std::stop_token& stop) {
  if (const Status status = check_image_size(image_size); !status) {
    return tl::unexpected<Error>(status.error());
  }
  if (const Status sized = check_sizes(views, image_size); !sized) {
    return tl::unexpected<Error>(sized.error());
  }
  if (holds_camera(options)) return solve_held(views, image_size, options);
  auto usable = usable_views(views, image_size);
  if (!usable) return tl::unexpected<Error>(usable.error());
  auto solution = options.refine && is_refined(options.method)
                      ? solve_board(views, std::move(usable->views), image_size, options, stop)
                      : method_solution(std::move(usable->views), image_size, options);
  if (!solution) return solution;
  give_ids(views, solution->rejected_corners);
  auto& rejected = solution->rejected;
  rejected.insert(rejected.end(), usable->rejected.begin(), usable->rejected.end());
  std::sort(rejected.begin(), rejected.end(),
            [](const RejectedView& a, const RejectedView& b) { return a.index < b.index; });
  return named(std::move(solution), views, options);
}

// solve_views() for the images of the centres of dots.
Result<Solution> solve_centers(std::span<const View> views, ImageSize size,
                               const SolveOptions& options, const std::stop_token& stop, int rounds,
                               DiscBias bias) {
  auto solution = solve_views(views, size, options, stop);
  for (int i = 0; i < rounds && solution; ++i) {
    solution = solve_views(without_center_bias(views, *solution, bias), size, options, stop);
  }
  return solution;
}

// Corners that count alike.
std::vector<View> without_sigmas(std::span<const View> views) {
  std::vector<View> alike(views.begin(), views.end());
  for (View& view : alike) view.observation.sigma.clear();
  return alike;
}

Result<Solution> solve_steps(std::span<const View> views, ImageSize size,
                             const SolveOptions& options, const std::stop_token& stop) {
  constexpr int kRounds = 2;  // the second one changes a centre by a thousandth of its bias
  if (const auto own = own_least_squares(options)) {
    const int rounds = own->ellipse_centers ? 1 : 0;
    return solve_centers(without_sigmas(views), size, *own, stop, rounds, conic_bias);
  }
  const int rounds = options.ellipse_centers ? kRounds : 0;
  return solve_centers(views, size, options, stop, rounds, center_bias);
}

}  // namespace

Status check(const SolveOptions& options) {
  if (options.max_iterations < 1) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("No solve takes {} iterations: give 1 or more (max_iterations).",
                                  options.max_iterations));
  }
  if (options.readout) {
    if (Status good = check_readout(*options.readout); !good) return good;
  }
  if (!options.method.empty() || !options.refine) {
    if (const Status known = check_method(options.method); !known) return known;
  }
  if (holds_camera(options)) return check_held_camera(options);
  SolveOptions any = options;
  if (any.model == kAutoModel) any.model = "brown5";
  const auto parameterization = make_parameterization(any, {});
  if (!parameterization) return tl::unexpected<Error>(parameterization.error());
  return {};
}

Result<Solution> solve(std::span<const View> views, ImageSize image_size,
                       const SolveOptions& options, std::stop_token stop) {
  if (const Status good = check(options); !good) return tl::unexpected<Error>(good.error());
  if (options.ellipse_centers) {
    if (const Status known = have_diameters(views); !known) {
      return tl::unexpected<Error>(known.error());
    }
  }
  auto solution = solve_steps(views, image_size, options, stop);
  if (!solution) return solution;
  const auto camera = Camera::make(solution->calibration);
  const auto remark = camera ? closing_remark(options.method, *camera) : std::nullopt;
  if (remark) solution->calibration.remarks.push_back(*remark);
  return solution;
}

}  // namespace calvin
