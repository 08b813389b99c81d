// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The shapes of the overlay for one frame: rows of corners, where the board is wanted, the border.
// overlay_panel.cpp has the bars.

#include "calvin/draw/overlay.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>

#include <fmt/format.h>

#include "calvin/camera/image_transform.hpp"
#include "calvin/core/expected_error.hpp"
#include "calvin/core/utf8.hpp"
#include "calvin/draw/overlay_shapes.hpp"
#include "calvin/target/board.hpp"
#include "calvin/target/kinds.hpp"
#include "calvin_config.h"
#if CALVIN_HAVE_CAIRO
#include "calvin/draw/overlay_raster.hpp"
#endif

namespace calvin {

namespace {

constexpr std::size_t kLongestHint = 500;  // bytes: more than two lines of any frame

#if CALVIN_HAVE_CAIRO

using Kind = Shape::Kind;

constexpr int kSmallestFrame = 16;    // px: nothing can be read on less
constexpr int kLargestFrame = 32767;  // px, Cairo's limit
constexpr int kMostPoints = 1000000;  // of any board
// Of one frame. Anybody may write an observation, and each corner costs some 50 us of the stream.
constexpr std::size_t kMostBoards = 64;
constexpr std::size_t kMostCorners = 2000;
constexpr double kDarkest = 0.3;            // of a channel: pure blue is hard to see on black
constexpr std::size_t kMostGhost = 256;     // points of its outline
constexpr Colour kGhost{1, 0.85, 0.15, 1};  // on a white board too

// Red at 0, over yellow, green and blue to violet at 1.
Colour rainbow(double t) {
  const double hue = std::clamp(t, 0.0, 1.0) * 4.8;
  const auto channel = [hue](double peak) {
    return std::clamp(2 - std::abs(hue - peak), kDarkest, 1.0);
  };
  return {std::max(channel(0), std::clamp(hue - 4, kDarkest, 1.0)), channel(2), channel(4), 1};
}

struct Corner {
  int id = 0;
  Pixel at;
};

// In the order of their ids, in px of the frame, those that no camera can have seen left out.
std::vector<Corner> corners_on(ImageSize frame, const Observation& observation) {
  const ImageSize size = observation.image_size.width > 0 && observation.image_size.height > 0
                             ? observation.image_size
                             : frame;
  const ImageTransform to_frame = ImageTransform::scaled(size, frame);
  std::vector<Corner> corners;
  const std::size_t count = std::min(observation.ids.size(), observation.uv.size());
  for (std::size_t i = 0; i < count; ++i) {
    const Pixel at = to_frame(observation.uv[i]);
    const bool near = std::abs(at.u) < 2 * frame.width && std::abs(at.v) < 2 * frame.height;
    const bool sane = observation.ids[i] >= 0 && observation.ids[i] < kMostPoints;
    if (near && sane) corners.push_back({observation.ids[i], at});
  }
  std::sort(corners.begin(), corners.end(),
            [](const Corner& a, const Corner& b) { return a.id < b.id; });
  return corners;
}

// Whether b comes next to a in a row of the board.
bool same_row(const Corner& a, const Corner& b, const Grid& grid) {
  return b.id == a.id + 1 && grid.place(a.id).row == grid.place(b.id).row;
}

// A quarter of the smallest distance in a row, so that marks do not run into each other.
double mark_radius(const std::vector<Corner>& corners, const Grid& grid, double unit) {
  double closest = 1e9;
  for (std::size_t i = 1; i < corners.size(); ++i) {
    if (!same_row(corners[i - 1], corners[i], grid)) continue;
    closest = std::min(closest, std::hypot(corners[i].at.u - corners[i - 1].at.u,
                                           corners[i].at.v - corners[i - 1].at.v));
  }
  return std::clamp(closest / 4, 1.5 * unit, 4.5 * unit);
}

// From circle to circle: the corners themselves stay in sight.
void add_link(std::vector<Shape>& shapes, Pixel from, Pixel to, double radius, Shape line) {
  const double length = std::hypot(to.u - from.u, to.v - from.v);
  if (length <= 2 * radius) return;
  const double t = radius / length;
  line.from = {std::lerp(from.u, to.u, t), std::lerp(from.v, to.v, t)};
  line.to = {std::lerp(from.u, to.u, 1 - t), std::lerp(from.v, to.v, 1 - t)};
  shapes.push_back(line);
}

// Rings and a cross that leave the light itself in sight.
void add_light(std::vector<Shape>& shapes, Pixel at, double unit) {
  const double pen = std::max(1.0, 1.3 * unit);
  const double near = 8 * unit;
  const double far = 14 * unit;
  shapes.push_back({Kind::kCircle, at, {}, near, 1.5 * pen, rainbow(0), unit});
  shapes.push_back({Kind::kCircle, at, {}, near + 2 * pen, pen, kWhite, unit});
  for (const Pixel way : {Pixel{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
    shapes.push_back({Kind::kLine,
                      {at.u + near * way.u, at.v + near * way.v},
                      {at.u + far * way.u, at.v + far * way.v},
                      0,
                      pen,
                      rainbow(0),
                      unit});
  }
}

// Takes its corners from the `room` that is left for more.
void add_observation(std::vector<Shape>& shapes, ImageSize frame, const Observation& observation,
                     std::size_t& room) {
  std::vector<Corner> corners = corners_on(frame, observation);
  corners.resize(std::min(corners.size(), room));
  room -= corners.size();
  if (corners.empty()) return;
  const double unit = unit_of(frame);
  const auto board = parse_board(observation.board);
  if (board && board->as<PointLight>() != nullptr) {
    for (const Corner& corner : corners) add_light(shapes, corner.at, unit);
    return;
  }
  // All points of a board that is not known count as one row.
  const std::optional<Grid> known = board ? board->grid() : std::nullopt;
  const Grid grid = known.value_or(Grid{corners.back().id + 1, 1, 0});
  const double last = std::max(1, grid.count() - 1);
  const double radius = mark_radius(corners, grid, unit);
  const double pen = std::max(1.0, 1.3 * unit);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Colour colour = rainbow(corners[i].id / last);
    if (i > 0 && same_row(corners[i - 1], corners[i], grid)) {
      add_link(shapes, corners[i - 1].at, corners[i].at, radius,
               {Kind::kLine, {}, {}, 0, pen, colour, unit});
    }
    shapes.push_back({Kind::kCircle, corners[i].at, {}, radius, pen, colour, unit});
  }
  if (corners.front().id != 0) return;
  const Kind mark = observation.ambiguous.empty() ? Kind::kDisc : Kind::kCircle;
  shapes.push_back({mark, corners[0].at, {}, 1.3 * radius, 1.5 * pen, rainbow(0), unit});
  shapes.push_back({Kind::kCircle, corners[0].at, {}, 1.9 * radius, 1.2 * pen, kWhite, unit});
}

// Where the board is wanted: the outline of its corners, so much of it in green as the present view
// has of what is wanted. A program may write any outline.
void add_ghost(std::vector<Shape>& shapes, ImageSize frame, const Progress& progress) {
  const auto at = [&](std::size_t i) {
    const Pixel& part = progress.ghost[i % progress.ghost.size()];
    return Pixel{coordinate_at(part.u, frame.width), coordinate_at(part.v, frame.height)};
  };
  const std::size_t count = progress.ghost.size();
  const auto sane = [](const Pixel& part) {
    return std::abs(part.u - 0.5) < 1.5 && std::abs(part.v - 0.5) < 1.5;
  };
  if (count < 4 || count > kMostGhost || !std::ranges::all_of(progress.ghost, sane)) return;
  const double unit = unit_of(frame);
  const double pen = std::max(1.0, 2.5 * unit);
  const double share = std::clamp(progress.ghost_share / Progress::kEnoughShare, 0.0, 1.0);
  const auto filled = static_cast<std::size_t>(std::lround(share * static_cast<double>(count)));
  for (std::size_t i = 0; i < count; ++i) {
    const Colour& colour = i < filled ? kGreen : kGhost;
    shapes.push_back({Kind::kLine, at(i), at(i + 1), 0, pen, colour, unit});
  }
  // Which way round: the corner that is control point 0 has its mark.
  shapes.push_back({Kind::kDisc, at(0), {}, 5 * unit, pen, rainbow(0), unit});
  shapes.push_back({Kind::kCircle, at(0), {}, 7 * unit, pen, kGhost, unit});
}

void add_border(std::vector<Shape>& shapes, ImageSize frame, double pen, const Colour& colour) {
  add_box(shapes, 0, 0, frame.width, pen, colour);
  add_box(shapes, 0, frame.height - pen, frame.width, pen, colour);
  add_box(shapes, 0, pen, pen, frame.height - 2 * pen, colour);
  add_box(shapes, frame.width - pen, pen, pen, frame.height - 2 * pen, colour);
}

bool drawable(ImageSize frame) {
  return std::min(frame.width, frame.height) >= kSmallestFrame &&
         std::max(frame.width, frame.height) <= kLargestFrame;
}

std::vector<Shape> shapes_of(ImageSize frame, std::span<const Observation> observations,
                             const std::optional<Progress>& progress, const OverlayParts& parts) {
  std::vector<Shape> shapes;
  if (!drawable(frame)) return shapes;
  const double unit = unit_of(frame);
  if (progress && progress->captured) {
    add_border(shapes, frame, 4 * unit, kWhite);
  } else if (progress && progress->done) {
    add_border(shapes, frame, 2 * unit, kGreen);
  }
  if (progress && parts.ghost) add_ghost(shapes, frame, *progress);
  std::size_t room = kMostCorners;
  for (const Observation& observation :
       observations.first(std::min(observations.size(), kMostBoards))) {
    const std::size_t before = shapes.size();
    add_observation(shapes, frame, observation, room);
    for (std::size_t i = before; i < shapes.size(); ++i) shapes[i].moves = true;
  }
  if (progress) add_points(shapes, frame, *progress);
  if (progress && parts.coverage) add_panel(shapes, frame, *progress, parts);
  return shapes;
}

#endif

// "12 views, accurate to 0.36 px"; empty before the first one.
std::string figures_of(const Progress& progress) {
  if (progress.views < 1) return {};
  const std::string views =
      fmt::format("{} view{}", progress.views, progress.views == 1 ? "" : "s");
  const double covered = progress.expected_error.value_or(std::nan(""));
  const double anywhere = progress.expected_error_anywhere.value_or(std::nan(""));
  if (!std::isfinite(covered)) {
    const bool known = progress.rms && std::isfinite(*progress.rms);
    return known ? fmt::format("{}, rms {:.2f} px", views, *progress.rms) : views;
  }
  const std::string text = fmt::format("{}, accurate to {:.2f} px", views, 2 * covered);
  // Elsewhere the board has not been yet.
  constexpr double kMuchWorse = 3;
  if (!std::isfinite(anywhere) || anywhere <= kMuchWorse * covered) return text;
  if (anywhere > kNothingKnown) return text + " where the board was, unknown elsewhere";
  const std::string elsewhere =
      2 * anywhere < 10 ? fmt::format("{:.2f}", 2 * anywhere) : fmt::format("{:.3g}", 2 * anywhere);
  const double wanted = progress.wanted_error_anywhere.value_or(HUGE_VAL);
  const std::string goal =
      anywhere > wanted ? fmt::format("; {:.2f} px is wanted there", 2 * wanted) : std::string();
  return fmt::format("{} where the board was, {} px elsewhere{}", text, elsewhere, goal);
}

}  // namespace

#if CALVIN_HAVE_CAIRO

struct OverlayPainter::State {
  OverlayRaster raster;
};

#else

struct OverlayPainter::State {};

#endif

OverlayPainter::OverlayPainter() = default;
OverlayPainter::~OverlayPainter() = default;

Result<std::span<const OverlayTile>> OverlayPainter::draw(
    [[maybe_unused]] ImageSize frame, [[maybe_unused]] std::span<const Observation> observations,
    [[maybe_unused]] const std::optional<Progress>& progress,
    [[maybe_unused]] const OverlayParts& parts) {
#if CALVIN_HAVE_CAIRO
  try {
    if (!state_) state_ = std::make_unique<State>();
    state_->raster.draw(frame, shapes_of(frame, observations, progress, parts));
    return state_->raster.tiles();
  } catch (const std::exception& error) {
    state_.reset();
    return make_error(ErrorCode::kIo,
                      fmt::format("The overlay cannot be drawn: {}.", error.what()));
  }
#else
  return make_error(
      ErrorCode::kUnsupported,
      "This build draws nothing on the video: it was made without Cairo. Build it with "
      "-Ddraw=enabled.");
#endif
}

Result<std::vector<OverlayTile>> draw_overlay(ImageSize frame,
                                              std::span<const Observation> observations,
                                              const std::optional<Progress>& progress,
                                              const OverlayParts& parts) {
  OverlayPainter painter;
  const auto tiles = painter.draw(frame, observations, progress, parts);
  if (!tiles) return tl::unexpected<Error>(tiles.error());
  std::vector<OverlayTile> whole;
  for (const OverlayTile& tile : *tiles) whole.push_back(whole_tile(tile));
  return whole;
}

std::string overlay_caption(const Progress& progress) {
  const std::string hint = shortened(progress.hint, kLongestHint);
  const std::string figures = figures_of(progress);
  if (figures.empty() || hint.empty()) return figures + hint;
  return fmt::format("{} ({})", hint, figures);
}

}  // namespace calvin
