// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The checks of views before any arithmetic sees them.

#include "calvin/solve/view.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/target/kinds.hpp"
#include "calvin/target/points/id_index.hpp"

namespace calvin {

namespace {

// Corners may lie this far beyond the border, in parts of the image size.
constexpr double kMargin = 0.05;

bool within(Pixel p, ImageSize size) {
  const double du = kMargin * size.width;
  const double dv = kMargin * size.height;
  return p.u >= -0.5 - du && p.u <= size.width - 0.5 + du && p.v >= -0.5 - dv &&
         p.v <= size.height - 0.5 + dv;
}

}  // namespace

Status check_image_size(ImageSize size) {
  if (size.width < 1 || size.height < 1 || size.width > 65536 || size.height > 65536) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("An image of {}x{} px cannot be calibrated; give the size of the "
                                  "frames that the board was seen in.",
                                  size.width, size.height));
  }
  return {};
}

bool is_off_size(const Observation& seen, ImageSize size) noexcept {
  return seen.image_size.width > 0 && seen.image_size != size;
}

Status check_sizes(std::span<const View> views, ImageSize size) {
  const Observation* off = nullptr;
  for (const View& view : views) {
    if (!view.observation.found()) continue;
    if (!is_off_size(view.observation, size)) return {};
    if (off == nullptr) off = &view.observation;
  }
  if (off == nullptr) return {};
  return make_error(
      ErrorCode::kInvalidArgument,
      fmt::format("The views are of images of {}x{} px, and a camera for images of "
                  "{}x{} px is asked for: give the size of the images in which the "
                  "board was seen.",
                  off->image_size.width, off->image_size.height, size.width, size.height));
}

Status check_before_camera(const View& view, ImageSize of_camera) {
  const ImageSize seen = view.observation.image_size;
  if (!is_off_size(view.observation, of_camera)) return check(view, of_camera);
  return make_error(
      ErrorCode::kInvalidArgument,
      fmt::format("The board was seen in an image of {}x{} px, the camera's is {}x{}. "
                  "Scale the camera to the image first.",
                  seen.width, seen.height, of_camera.width, of_camera.height));
}

Status check_has_pose(const Board& board) {
  if (board.as<PointLight>() == nullptr) return {};
  return make_error(
      ErrorCode::kUnsupported,
      fmt::format("The board {} is a light, and one point says nothing of a single camera: a light "
                  "calibrates several cameras together, which see it at the same times. Calibrate "
                  "a single camera with a board such as puzzle:14x9:20mm.",
                  board.text()));
}

Status check(const View& view, ImageSize image_size) {
  if (Status status = check_image_size(image_size); !status) return status;
  if (Status status = view.board.check(); !status) return status;
  const Observation& seen = view.observation;
  const auto refuse = [](std::string message) {
    return make_error(ErrorCode::kInvalidArgument, std::move(message));
  };
  if (seen.ids.size() != seen.uv.size()) {
    return refuse(fmt::format("{} ids and {} corners were given; each corner needs its id.",
                              seen.ids.size(), seen.uv.size()));
  }
  if (!seen.velocity.empty() && seen.velocity.size() != seen.uv.size()) {
    return refuse(fmt::format("{} velocities and {} corners were given; each corner needs its own.",
                              seen.velocity.size(), seen.uv.size()));
  }
  const auto finite = [](Pixel p) { return std::isfinite(p.u) && std::isfinite(p.v); };
  if (!std::all_of(seen.velocity.begin(), seen.velocity.end(), finite)) {
    return refuse("A corner has a velocity that is no number.");
  }
  const IdIndex board_ids(view.board);
  std::vector<bool> known(static_cast<std::size_t>(view.board.point_count()), false);
  for (std::size_t i = 0; i < seen.ids.size(); ++i) {
    const int id = seen.ids[i];
    const auto index = board_ids.of(id);
    if (!index) {
      return refuse(
          fmt::format("The corner id {} is not on the board {}, which has {} corners. "
                      "Is this the board that was seen?",
                      id, view.board.text(), view.board.point_count()));
    }
    if (known[*index]) {
      return refuse(fmt::format("The corner id {} is given twice.", id));
    }
    known[*index] = true;
    if (!within(seen.uv[i], image_size)) {
      return refuse(fmt::format("The corner {} at ({}, {}) is outside the image of {}x{} px.", id,
                                seen.uv[i].u, seen.uv[i].v, image_size.width, image_size.height));
    }
  }
  return {};
}

}  // namespace calvin
