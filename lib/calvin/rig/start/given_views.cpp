// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Names, numbers, timestamps and boards of what is given.

#include "calvin/rig/start/given_views.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"
#include "calvin/geometry/covariance.hpp"

namespace calvin::rig {

namespace {

// A covariance of another size is not used, and not looked at.
Status check_covariance(const Calibration& calibration) {
  const auto size = static_cast<std::size_t>(std::ranges::count_if(
      calibration.parameters, [](const Parameter& p) { return p.sigma.has_value(); }));
  if (calibration.covariance.size() != size * size) return {};
  const auto why = no_covariance(calibration.covariance, size);
  if (!why) return {};
  return make_error(ErrorCode::kInvalidArgument,
                    fmt::format("The calibration of '{}': its covariance {}. Calibrate again, or "
                                "leave the covariance out.",
                                calibration.camera, *why));
}

std::vector<Board> boards_in(const std::vector<View>& views) {
  std::vector<Board> boards;
  for (const View& view : views) {
    if (view.observation.found() && std::ranges::find(boards, view.board) == boards.end()) {
      boards.push_back(view.board);
    }
  }
  return boards;
}

std::string texts_of(const std::vector<Board>& boards) {
  constexpr std::size_t kMost = 200;  // bytes
  std::vector<std::string> texts;
  for (const Board& board : boards) texts.push_back(board.text());
  return shortened(join(texts, "; "), kMost);
}

std::optional<Error> without_times(const RigCameraViews& camera) {
  const auto& views = camera.views;
  const auto is_found = [](const View& view) { return view.observation.found(); };
  const auto is_timed = [&](const View& view) {
    return is_found(view) && view.observation.timestamp != kNoTimestamp;
  };
  if (std::ranges::none_of(views, is_found) || std::ranges::any_of(views, is_timed)) return {};
  return Error{ErrorCode::kInvalidArgument,
               fmt::format("No view of '{}' has a timestamp, by which views of several cameras "
                           "belong together: give views their timestamps, of a clock that all "
                           "cameras share.",
                           camera.calibration.camera)};
}

std::optional<Error> without_common_board(const std::vector<RigCameraViews>& seen,
                                          std::size_t camera) {
  const std::vector<Board> own = boards_in(seen[camera].views);
  std::vector<Board> others;
  for (std::size_t c = 0; c < seen.size(); ++c) {
    if (c == camera) continue;
    for (const Board& board : boards_in(seen[c].views)) {
      if (std::ranges::find(own, board) != own.end()) return {};
      if (std::ranges::find(others, board) == others.end()) others.push_back(board);
    }
  }
  if (own.empty() || others.empty()) return {};
  return Error{ErrorCode::kDegenerate,
               fmt::format("The views of '{}' are of the board {}, those of the other cameras of "
                           "{}: show one board to both, and name it alike.",
                           seen[camera].calibration.camera, texts_of(own), texts_of(others))};
}

std::vector<std::uint64_t> times_of(const RigCameraViews& camera) {
  std::vector<std::uint64_t> times;
  for (const View& view : camera.views) {
    const Observation& o = view.observation;
    if (o.found() && o.timestamp != kNoTimestamp) times.push_back(o.timestamp);
  }
  std::ranges::sort(times);
  return times;
}

// Cameras that take pictures at the same rate, each when it likes.
std::optional<Error> without_common_time(const std::vector<RigCameraViews>& seen,
                                         std::size_t camera, std::uint64_t tolerance) {
  constexpr std::uint64_t kNear = 100'000'000;  // ns: farther apart, they show other places
  constexpr double kMillisecond = 1e6;          // ns
  const std::vector<std::uint64_t> own = times_of(seen[camera]);
  std::uint64_t least = kNoTimestamp;
  std::size_t nearest = camera;
  for (std::size_t c = 0; c < seen.size(); ++c) {
    if (c == camera) continue;
    for (const std::uint64_t time : times_of(seen[c])) {
      const auto after = std::ranges::lower_bound(own, time);
      const std::uint64_t ahead = after != own.end() ? *after - time : kNoTimestamp;
      const std::uint64_t behind = after != own.begin() ? time - *std::prev(after) : kNoTimestamp;
      if (std::min(ahead, behind) >= least) continue;
      least = std::min(ahead, behind);
      nearest = c;
    }
  }
  if (least <= tolerance || least > kNear) return {};
  return Error{
      ErrorCode::kDegenerate,
      fmt::format("The pictures of '{}' are {:.3g} ms or more from those of '{}', and those "
                  "of one time are {:.3g} ms apart at the most: raise that (tolerance) to "
                  "the time between two pictures of a camera.",
                  seen[camera].calibration.camera, static_cast<double>(least) / kMillisecond,
                  seen[nearest].calibration.camera, static_cast<double>(tolerance) / kMillisecond)};
}

}  // namespace

Result<std::vector<Camera>> checked_cameras(const std::vector<RigCameraViews>& seen) {
  std::vector<Camera> cameras;
  std::set<std::string> names;
  for (const RigCameraViews& one : seen) {
    const std::string& name = one.calibration.camera;
    if (!names.insert(name).second || name.empty()) {
      return make_error(ErrorCode::kInvalidArgument,
                        fmt::format("Two cameras of the rig are called '{}', or have no name: give "
                                    "each its own, by which it is told from the others.",
                                    name));
    }
    auto camera = Camera::make(one.calibration);
    if (!camera) {
      return make_error(camera.error().code,
                        fmt::format("The calibration of '{}': {}", name, camera.error().message));
    }
    if (const Status good = check_covariance(one.calibration); !good) {
      return tl::unexpected<Error>(good.error());
    }
    cameras.push_back(*std::move(camera));
  }
  return cameras;
}

std::optional<Error> why_apart(const std::vector<RigCameraViews>& seen, std::size_t camera,
                               bool fixed_boards, std::uint64_t tolerance) {
  if (auto error = without_times(seen[camera])) return error;
  if (fixed_boards) return {};
  if (auto error = without_common_board(seen, camera)) return error;
  return without_common_time(seen, camera, tolerance);
}

}  // namespace calvin::rig
