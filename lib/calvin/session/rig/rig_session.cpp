// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Keeps views by the places of boards and by the clock.

#include "calvin/session/rig/rig_session.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "calvin/camera/frame_fit.hpp"
#include "calvin/core/text.hpp"

namespace calvin {

namespace {

constexpr std::uint64_t kMoment = 1'000'000'000;  // ns: views of which the time may yet be wanted
constexpr double kNewPlace = 0.02;                // of the width of the picture
constexpr std::size_t kMostViews = 600;           // of a camera; then every other time is forgotten
constexpr std::uint64_t kFewest = 6;              // views between two solves, at the least
constexpr std::size_t kStill = 10;                // views of a board that lies still

std::uint64_t between(std::uint64_t a, std::uint64_t b) { return a > b ? a - b : b - a; }

// The mean distance of the corners that two observations share, px; absent where there are none.
// Ids ascend.
std::optional<double> moved(const Observation& a, const Observation& b) {
  if (a.board != b.board) return std::nullopt;
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0, j = 0; i < a.ids.size() && j < b.ids.size();) {
    if (a.ids[i] == b.ids[j]) {
      sum += std::hypot(a.uv[i].u - b.uv[j].u, a.uv[i].v - b.uv[j].v);
      ++count;
    }
    const bool next_a = a.ids[i] <= b.ids[j];
    const bool next_b = b.ids[j] <= a.ids[i];
    i += next_a ? 1 : 0;
    j += next_b ? 1 : 0;
  }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

// How fast each corner moves by the observation before, px/s; empty where one was not seen in it.
std::vector<Pixel> velocities(const Observation& before, const Observation& now) {
  const double seconds = 1e-9 * static_cast<double>(now.timestamp - before.timestamp);
  std::vector<Pixel> all;
  std::size_t i = 0;
  for (std::size_t j = 0; j < now.ids.size(); ++j) {
    while (i < before.ids.size() && before.ids[i] < now.ids[j]) ++i;
    if (i == before.ids.size() || before.ids[i] != now.ids[j]) return {};
    all.push_back(
        {(now.uv[j].u - before.uv[i].u) / seconds, (now.uv[j].v - before.uv[i].v) / seconds});
  }
  return all;
}

}  // namespace

void RigSession::start(RigSessionSettings settings) {
  settings_ = std::move(settings);
  cameras_.clear();
  wanted_.clear();
  ++generation_;
  revision_ = asked_revision_ = solved_revision_ = 0;
}

RigSession::Camera& RigSession::at(std::size_t camera) {
  if (camera >= cameras_.size()) cameras_.resize(camera + 1);
  return cameras_[camera];
}

void RigSession::set_name(std::size_t camera, std::string name) {
  at(camera).name = std::move(name);
}

void RigSession::remove(std::size_t camera) {
  at(camera) = {};
  ++revision_;
}

void RigSession::set_intrinsics(std::size_t camera, const Calibration& calibration) {
  at(camera).intrinsics = calibration;
  ++revision_;
}

Result<View> RigSession::to_view(const Observation& observation) {
  auto known = std::ranges::find_if(
      boards_, [&](const Board& board) { return board.text() == observation.board; });
  if (known == boards_.end()) {
    auto board = parse_board(observation.board);
    if (!board) return tl::unexpected<Error>(board.error());
    boards_.push_back(*std::move(board));
    known = boards_.end() - 1;
  }
  View view{observation, *known};
  view.observation.patches.reset();
  if (!std::ranges::is_sorted(observation.ids)) {
    return make_error(ErrorCode::kInvalidArgument,
                      "The ids of an observation do not ascend, as those of calibdetect do.");
  }
  if (const Status good = check(view, observation.image_size); !good) {
    return tl::unexpected<Error>(good.error());
  }
  return view;
}

// By the view before, of a camera that sees the board without a break.
void RigSession::set_velocity(Camera& camera, View& view) const {
  constexpr std::uint64_t kBreak = 200'000'000;  // ns
  Observation& now = view.observation;
  now.velocity.clear();
  if (camera.last && camera.last->board == now.board && camera.last->timestamp < now.timestamp &&
      now.timestamp - camera.last->timestamp < kBreak) {
    now.velocity = velocities(*camera.last, now);
    // That is the velocity of a moment ago: how it has changed since before goes on.
    const bool goes_on =
        camera.last->velocity.size() == now.velocity.size() && camera.last->ids == now.ids;
    std::vector<Pixel> behind = now.velocity;
    for (std::size_t i = 0; goes_on && i < now.velocity.size(); ++i) {
      const Pixel& before = camera.behind[i];
      now.velocity[i].u += 0.5 * (behind[i].u - before.u);
      now.velocity[i].v += 0.5 * (behind[i].v - before.v);
    }
    camera.behind = std::move(behind);
  }
  camera.last = now;
}

bool RigSession::is_new(const Camera& camera, const View& view) const {
  const Observation& now = view.observation;
  if (settings_.options.mode == RigMode::kFloor && camera.kept.size() < kStill) return true;
  return std::ranges::none_of(camera.kept, [&](const View& kept) {
    const auto distance = moved(kept.observation, now);
    return distance && *distance < kNewPlace * now.image_size.width;
  });
}

void RigSession::keep(Camera& camera, View view) {
  const auto same = [&](const View& kept) {
    return kept.observation.timestamp == view.observation.timestamp &&
           kept.observation.board == view.observation.board &&
           kept.observation.uv.front().u == view.observation.uv.front().u;
  };
  if (std::ranges::any_of(camera.kept, same)) return;
  camera.kept.push_back(std::move(view));
  ++revision_;
}

void RigSession::keep_recent_at(std::uint64_t timestamp) {
  for (Camera& camera : cameras_) {
    for (const View& view : camera.recent) {
      if (between(view.observation.timestamp, timestamp) <= settings_.options.tolerance) {
        keep(camera, view);
      }
    }
  }
}

Result<bool> RigSession::offer(std::size_t camera, Observation observation) {
  if (!observation.found() || observation.timestamp == kNoTimestamp) return false;
  if (!settings_.board.empty() && observation.board != settings_.board) return false;
  auto view = to_view(observation);
  if (!view) return tl::unexpected<Error>(view.error());
  Camera& own = at(camera);
  // Pictures of another size are those of another camera, whose views begin anew.
  const bool is_other =
      !own.kept.empty() && own.kept.front().observation.image_size != view->observation.image_size;
  if (is_other) {
    own.kept.clear();
    own.recent.clear();
    own.last.reset();
  }
  set_velocity(own, *view);
  const std::uint64_t now = view->observation.timestamp;
  const bool fresh = is_new(own, *view);
  const bool wanted = std::ranges::any_of(
      wanted_, [&](std::uint64_t at) { return between(at, now) <= settings_.options.tolerance; });
  if (fresh || wanted) {
    keep(own, *view);
    if (fresh) wanted_.push_back(now);
    if (fresh) keep_recent_at(now);
    if (own.kept.size() > kMostViews) thin_out();
    return true;
  }
  own.recent.push_back(*std::move(view));
  while (!own.recent.empty() && between(own.recent.front().observation.timestamp, now) > kMoment) {
    own.recent.pop_front();
  }
  return false;
}

// Forgets what was seen at every other time, so that any stream takes the same memory.
void RigSession::thin_out() {
  std::ranges::sort(wanted_);
  std::vector<std::uint64_t> left;
  for (std::size_t i = 0; i < wanted_.size(); i += 2) left.push_back(wanted_[i]);
  wanted_ = std::move(left);
  for (Camera& camera : cameras_) {
    std::erase_if(camera.kept, [&](const View& view) {
      return std::ranges::none_of(wanted_, [&](std::uint64_t at) {
        return between(at, view.observation.timestamp) <= settings_.options.tolerance;
      });
    });
  }
}

// The intrinsics for the pictures that the camera has.
std::optional<Calibration> RigSession::fitted(const Camera& camera) const {
  if (camera.name.empty() || !camera.intrinsics || camera.kept.empty()) return std::nullopt;
  const ImageSize size = camera.kept.front().observation.image_size;
  Calibration calibration = *camera.intrinsics;
  if (calibration.image_size != size) {
    const auto fit = fit_to_frame(calibration, size);
    if (!fit) return std::nullopt;
    calibration = fit->camera.to_calibration();
  }
  calibration.camera = camera.name;
  return calibration;
}

std::vector<RigCameraViews> RigSession::views() const {
  std::vector<RigCameraViews> all;
  for (const Camera& camera : cameras_) {
    if (auto calibration = fitted(camera)) all.push_back({*std::move(calibration), camera.kept});
  }
  return all;
}

std::optional<RigJob> RigSession::take_solve(bool final) {
  constexpr double kMore = 0.2;  // of the views at the last solve
  const std::uint64_t more = revision_ - asked_revision_;
  const auto enough =
      std::max(kFewest, static_cast<std::uint64_t>(kMore * static_cast<double>(asked_revision_)));
  if (final ? is_solved() : more < enough) return std::nullopt;
  RigJob job{views(), settings_.options, final, generation_};
  const auto there =
      std::ranges::count_if(cameras_, [](const Camera& c) { return !c.name.empty(); });
  const bool all_there =
      job.cameras.size() == static_cast<std::size_t>(there) && job.cameras.size() >= 2;
  if (!all_there) return std::nullopt;
  asked_revision_ = revision_;
  return job;
}

void RigSession::solved(const RigJob& job, bool well) {
  if (is_current(job) && well && job.final) solved_revision_ = asked_revision_;
}

// By the times of the views alone: this is asked for on streaming threads.
std::vector<CameraPair> RigSession::pairs() const {
  std::vector<ViewTimes> times;
  for (const Camera& camera : cameras_) {
    ViewTimes& of = times.emplace_back();
    for (const View& view : camera.kept) of.push_back(view.observation.timestamp);
  }
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> common;
  for (const Instant& instant : pair_instants(times, settings_.options.tolerance).instants) {
    for (std::size_t i = 0; i < instant.views.size(); ++i) {
      for (std::size_t j = i + 1; j < instant.views.size(); ++j) {
        const std::size_t a = instant.views[i].camera;
        const std::size_t b = instant.views[j].camera;
        if (a != b) ++common[{a, b}];
      }
    }
  }
  std::vector<CameraPair> all;
  for (const auto& [pair, views] : common) all.push_back({pair.first, pair.second, views});
  return all;
}

RigProgress RigSession::progress() const {
  RigProgress progress;
  for (const Camera& camera : cameras_) {
    if (!camera.kept.empty()) progress.cameras.push_back(camera.name);
  }
  const std::vector<CameraPair> all = pairs();
  for (const CameraPair& pair : all) {
    progress.links.push_back(
        {cameras_[pair.a].name, cameras_[pair.b].name, static_cast<int>(pair.views)});
  }
  if (const auto weakest = weakest_pair(all)) {
    progress.weakest = progress.links[*weakest].a + " " + progress.links[*weakest].b;
  }
  return progress;
}

Error RigSession::lack() const {
  const auto there =
      std::ranges::count_if(cameras_, [](const Camera& c) { return !c.name.empty(); });
  if (there < 2) {
    return {ErrorCode::kInvalidArgument,
            "A rig has two cameras or more: link each to a pad of its own, sink_0, sink_1 and so "
            "on."};
  }
  for (const Camera& camera : cameras_) {
    if (camera.name.empty()) continue;
    if (camera.kept.empty()) {
      return {ErrorCode::kDegenerate,
              fmt::format("The camera '{}' has seen no board: put calibdetect before it, and show "
                          "it the board.",
                          camera.name)};
    }
    if (!camera.intrinsics) {
      return {ErrorCode::kInvalidArgument,
              fmt::format("The intrinsics of the camera '{}' are not known: set intrinsics=FILE "
                          "of its pad, or put calibrate before it.",
                          camera.name)};
    }
    if (!fitted(camera)) {
      return {ErrorCode::kInvalidArgument,
              fmt::format("The intrinsics of the camera '{}' are of pictures of another aspect "
                          "than it has now: calibrate it at this size.",
                          camera.name)};
    }
  }
  return {ErrorCode::kDegenerate, "There is nothing new to solve."};
}

}  // namespace calvin
