// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Fits each corner again with the local picture of the board that the known camera predicts, then
// solves with the new corners.

#include "calvin/session/refine_with_camera.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/LU>

#include "calvin/detect/checkerboard/code/pattern.hpp"
#include "calvin/detect/checkerboard/corners/fit_radius.hpp"
#include "calvin/detect/checkerboard/corners/saddle_fit.hpp"
#include "calvin/detect/patches.hpp"
#include "calvin/solve/methods/methods.hpp"

namespace calvin {

namespace {

using detect::SaddleFit;

constexpr int kIterations = 10;
constexpr float kTolerance = 0.002F;  // px
constexpr double kFarthest = 1.5;     // px, of a corner from its first place
constexpr double kRoom = 2.5;         // px, of a patch around a window

// The picture of the board around one of its corners, in px per square: on an AprilGrid, per dark
// square beside it.
struct Local {
  Eigen::Vector2d at;
  Eigen::Vector2d along;  // by the column
  Eigen::Vector2d down;   // by the row
  Eigen::Vector2d along_twice;
  Eigen::Vector2d down_twice;

  [[nodiscard]] double turn() const { return along[0] * down[1] - along[1] * down[0]; }
  // The distance to the next edge, px.
  [[nodiscard]] double spacing() const {
    return std::abs(turn()) / std::max(along.norm(), down.norm());
  }
};

std::optional<Local> local_picture(const Camera& camera, const SE3& camera_from_board,
                                   const Eigen::Vector3d& point, double square) {
  constexpr double kStep = 0.25;  // squares
  bool seen = true;
  const auto project = [&](double columns, double rows) -> Eigen::Vector2d {
    const Eigen::Vector3d p = point + square * Eigen::Vector3d(columns, rows, 0);
    const auto pixel = camera.project(camera_from_board * p);
    seen = seen && pixel;
    return pixel ? Eigen::Vector2d(pixel->u, pixel->v) : Eigen::Vector2d::Zero();
  };
  Local local;
  local.at = project(0, 0);
  const auto derive = [&](const Eigen::Vector2d& before, const Eigen::Vector2d& after,
                          Eigen::Vector2d& once, Eigen::Vector2d& twice) {
    once = (after - before) / (2 * kStep);
    twice = (after - 2 * local.at + before) / (kStep * kStep);
  };
  derive(project(-kStep, 0), project(kStep, 0), local.along, local.along_twice);
  derive(project(0, -kStep), project(0, kStep), local.down, local.down_twice);
  if (!seen || !(std::abs(local.turn()) > 0)) return std::nullopt;
  return local;
}

detect::Direction direction(const Eigen::Vector2d& v) {
  return {static_cast<float>(v[0] / v.norm()), static_cast<float>(v[1] / v.norm())};
}

// How the edge that runs along v bends to the side of `other`, 1/px.
float bend(const Eigen::Vector2d& v, const Eigen::Vector2d& twice, const Eigen::Vector2d& other) {
  const double side = v[0] * other[1] - v[1] * other[0] > 0 ? 1 : -1;
  return static_cast<float>(side * (v[0] * twice[1] - v[1] * twice[0]) / std::pow(v.norm(), 3));
}

class CornerRefinement {
 public:
  CornerRefinement(const Observation& seen, const detect::Pattern& pattern, const Camera& camera,
                   const SE3& camera_from_board)
      : seen_(seen),
        grid_(pattern.grid),
        surroundings_(pattern.surroundings),
        at_(static_cast<std::size_t>(grid_.count()), kNone) {
    const auto points = grid_.points();
    for (std::size_t i = 0; i < seen.ids.size(); ++i) {
      const auto id = static_cast<std::size_t>(seen.ids[i]);
      local_.push_back(local_picture(camera, camera_from_board, points[id], grid_.least_step()));
      fits_.push_back(local_.back() ? first_guess(i) : std::nullopt);
      at_[id] = i;
    }
  }

  Observation run() {
    for (std::size_t i = 0; i < fits_.size(); ++i) fit(i);
    const std::vector<std::optional<SaddleFit>> first = fits_;
    for (std::size_t i = 0; i < fits_.size(); ++i) {
      if (!fits_[i]) continue;
      set_slopes(i, first);
      fit(i);
    }
    Observation result = seen_;
    for (std::size_t i = 0; i < fits_.size(); ++i) {
      const auto& f = fits_[i] ? fits_[i] : first[i];
      if (f) result.uv[i] = place(i, *f);
    }
    return result;
  }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  [[nodiscard]] std::optional<SaddleFit> first_guess(std::size_t i) const {
    const Local& local = *local_[i];
    SaddleFit f;
    f.x = local.at[0] - seen_.patches->origin[i][0];
    f.y = local.at[1] - seen_.patches->origin[i][1];
    // The fit wants `down` on the left of `along` as the image has its axes.
    const bool right = local.turn() > 0;
    const auto& along = right ? local.along : local.down;
    const auto& down = right ? local.down : local.along;
    f.along = direction(along);
    f.down = direction(down);
    f.along_bend = bend(along, right ? local.along_twice : local.down_twice, down);
    f.down_bend = bend(down, right ? local.down_twice : local.along_twice, along);
    if (seen_.blur > 0) f.along_width = f.down_width = static_cast<float>(seen_.blur);
    return f;
  }

  [[nodiscard]] Pixel place(std::size_t i, const SaddleFit& f) const {
    return {f.x + seen_.patches->origin[i][0], f.y + seen_.patches->origin[i][1]};
  }

  // Fits the corner in its patch; none where there is nothing to be fitted.
  void fit(std::size_t i) {
    if (!fits_[i]) return;
    SaddleFit& f = *fits_[i];
    const ImageView patch = patch_view(*seen_.patches, i);
    const double room = std::min({f.x, f.y, patch.width - 1 - f.x, patch.height - 1 - f.y});
    const float width = std::max(f.along_width, f.down_width);
    const auto spacing = static_cast<float>(local_[i]->spacing());
    f.room = surroundings_.room(spacing, width);
    const int middle = patch.width / 2;
    const float radius = std::min(detect::last_radius(surroundings_.clear(spacing), width),
                                  static_cast<float>(middle - kRoom));
    const bool good = room > 1 && fit_saddle(patch, radius, kIterations, f, kTolerance);
    const Pixel to = place(i, f);
    if (!good || !(std::hypot(to.u - seen_.uv[i].u, to.v - seen_.uv[i].v) < kFarthest)) {
      fits_[i].reset();
    }
  }

  // Sets how level and contrast change across the corner, from its neighbours in row and column.
  void set_slopes(std::size_t i, const std::vector<std::optional<SaddleFit>>& first) {
    const GridPlace here = grid_.place(seen_.ids[i]);
    const auto neighbour = [&](int columns, int rows) -> const SaddleFit* {
      const GridPlace there = {here.col + columns, here.row + rows};
      if (!grid_.contains(there)) return nullptr;
      const std::size_t at = at_[static_cast<std::size_t>(grid_.id(there))];
      return at == kNone || !first[at] ? nullptr : &*first[at];
    };
    const auto slope = [&](int columns, int rows, auto number) {
      const SaddleFit* before = neighbour(-columns, -rows);
      const SaddleFit* after = neighbour(columns, rows);
      const auto place = [&](int side) {
        return columns != 0 ? grid_.distance_to(here.col + side)
                            : grid_.distance_to(here.row + side);
      };
      const double way = place(after == nullptr ? 0 : 1) - place(before == nullptr ? 0 : -1);
      if (way == 0) return 0.0;
      const double from = number(before == nullptr ? *first[i] : *before);
      const double to = number(after == nullptr ? *first[i] : *after);
      return (to - from) * grid_.least_step() / way;
    };
    const auto gradient = [&](auto number) {
      Eigen::Matrix2d squares;  // px per square, in rows
      squares << local_[i]->along.transpose(), local_[i]->down.transpose();
      const Eigen::Vector2d by_square(slope(1, 0, number), slope(0, 1, number));
      const Eigen::Vector2d g = squares.inverse() * by_square;
      return detect::Direction{static_cast<float>(g[0]), static_cast<float>(g[1])};
    };
    SaddleFit& f = *fits_[i];
    f.slope = gradient([](const SaddleFit& n) { return static_cast<double>(n.level); });
    const detect::Direction change =
        gradient([](const SaddleFit& n) { return std::abs(static_cast<double>(n.contrast)); });
    const float sign = f.contrast > 0 ? 1.0F : -1.0F;
    f.contrast_slope = {sign * change.x, sign * change.y};
  }

  const Observation& seen_;
  Grid grid_;
  detect::Surroundings surroundings_;
  std::vector<std::optional<Local>> local_;     // per corner
  std::vector<std::optional<SaddleFit>> fits_;  // per corner, in px of its patch
  std::vector<std::size_t> at_;                 // per id
};

// The options of a further run, which starts from the calibration of the last one.
SolveOptions from(const SolveOptions& options, const Calibration& calibration) {
  SolveOptions again = options;
  again.model = calibration.model;
  if (!options.initial_is_prior) again.initial = calibration;
  // A method is a start, but for one whose own least squares was asked for.
  if (!own_least_squares(options)) again.method.clear();
  return again;
}

// Whether two calibrations are so near that another run would change nothing.
bool same(const Calibration& a, const Calibration& b) {
  constexpr double kSame = 1e-3;  // sigma
  if (a.parameters.size() != b.parameters.size() || a.views.size() != b.views.size()) return false;
  for (std::size_t i = 0; i < a.parameters.size(); ++i) {
    const double change = std::abs(a.parameters[i].value - b.parameters[i].value);
    if (change > kSame * b.parameters[i].sigma.value_or(0)) return false;
  }
  return true;
}

}  // namespace

Observation refine_with_camera(const Observation& seen, const Board& board, const Camera& camera,
                               const SE3& camera_from_board) {
  const bool usable = seen.patches && seen.patches->pixels && seen.patches->side > 0 &&
                      seen.patches->origin.size() == seen.ids.size();
  const auto known = [&board](int id) { return board.index_of(id).has_value(); };
  if (!usable || !std::all_of(seen.ids.begin(), seen.ids.end(), known)) return seen;
  // The control points of other boards are no saddles.
  if (!detect::has_pattern(board)) return seen;
  return CornerRefinement(seen, detect::Pattern(board), camera, camera_from_board).run();
}

void refine_with_camera(std::vector<View>& views, const Solution& solution,
                        const std::stop_token& stop) {
  const auto camera = Camera::make(solution.calibration);
  if (!camera) return;
  std::vector<bool> rejected(views.size(), false);
  for (const RejectedView& view : solution.rejected) rejected[view.index] = true;
  std::size_t at = 0;
  for (std::size_t v = 0; v < views.size() && !stop.stop_requested(); ++v) {
    if (rejected[v]) continue;
    const SE3 pose = to_se3(solution.calibration.views[at++].camera_from_board);
    views[v].observation = refine_with_camera(views[v].observation, views[v].board, *camera, pose);
  }
}

Result<Solution> solve_in_runs(std::span<const View> views, ImageSize image_size,
                               const SolveOptions& options, int runs, const std::stop_token& stop) {
  auto solution = solve(views, image_size, options, stop);
  const auto has_patches = [](const View& view) { return view.observation.patches != nullptr; };
  if (runs < 2 || std::none_of(views.begin(), views.end(), has_patches)) return solution;
  std::vector<View> again(views.begin(), views.end());
  for (int run = 1; run < runs && solution && !stop.stop_requested(); ++run) {
    refine_with_camera(again, *solution, stop);
    auto next = solve(again, image_size, from(options, solution->calibration), stop);
    if (!next) break;
    const bool converged = same(solution->calibration, next->calibration);
    solution = std::move(next);
    if (converged) break;
  }
  if (stop.stop_requested()) return make_error(ErrorCode::kCancelled, "The solve was stopped.");
  return solution;
}

}  // namespace calvin
