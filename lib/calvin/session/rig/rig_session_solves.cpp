// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// When the cameras of a session are solved, which of them, and what is missing.

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "calvin/camera/frame_fit.hpp"
#include "calvin/core/text.hpp"
#include "calvin/rig/joint/board_scale.hpp"
#include "calvin/rig/result/rig_frame.hpp"
#include "calvin/session/rig/rig_session.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin {

namespace {

constexpr std::uint64_t kFewest = 6;  // views between two solves, at the least

// `before`: it has seen something where it stood then.
std::string has_seen_nothing(const std::string& camera, bool is_light, bool before) {
  if (before) {
    return fmt::format("Where the camera '{}' stands now is not known: {}.", camera,
                       is_light ? "move the light where it and two others see it at a time"
                                : "show a board to it and to another camera at a time");
  }
  return fmt::format("The camera '{}' has seen no {}.", camera,
                     is_light ? "light: put calibdetect board=dot before it, and move the light "
                                "where it and two others see it at a time"
                              : "board: put calibdetect before it, and show it the board");
}

std::string has_seen_another(const std::string& camera, const std::string& seen,
                             const std::vector<Board>& wanted) {
  std::vector<std::string> texts;
  for (const Board& board : wanted) texts.push_back(board.text());
  return fmt::format(
      "The camera '{}' has seen {}, and board= says {}: set board= to the board that is shown, or "
      "show the other one.",
      camera, seen, join(texts, ";"));
}

// Cameras that have seen something at one time.
std::vector<CameraPair> pairs_of(const std::vector<Instant>& instants) {
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> common;
  for (const Instant& instant : instants) {
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

// Two cameras do not tell their focal lengths by a light.
std::size_t fewest_cameras(const RigJob& job) {
  const bool all_known = std::ranges::all_of(
      job.cameras, [](const RigJob::Camera& camera) { return camera.calibration != nullptr; });
  return all_known ? 2 : 3;
}

}  // namespace

std::vector<RigCameraViews> views_of(const RigJob& job) {
  std::vector<RigCameraViews> all;
  for (const RigJob::Camera& camera : job.cameras) {
    RigCameraViews& one = all.emplace_back();
    one.calibration = *camera.calibration;
    one.views.reserve(camera.views.size());
    for (const SharedView& view : camera.views) one.views.push_back(*view);
  }
  return all;
}

void RigSession::fit_intrinsics(Camera& camera) {
  camera.fitted.reset();
  if (!camera.size || !camera.intrinsics) return;
  Calibration calibration = *camera.intrinsics;
  if (calibration.image_size != *camera.size) {
    const auto fit = fit_to_frame(calibration, *camera.size);
    if (!fit) return;
    calibration = fit->camera.to_calibration();
  }
  calibration.camera = camera.name;
  camera.fitted = std::make_shared<const Calibration>(std::move(calibration));
}

std::optional<RigJob> RigSession::take_solve(bool final) {
  constexpr double kMore = 0.2;  // of the views at the last solve
  const std::uint64_t more = revision_ - asked_revision_;
  const auto enough =
      std::max(kFewest, static_cast<std::uint64_t>(kMore * static_cast<double>(asked_revision_)));
  if (final ? is_solved() : !is_due_ && more < enough) return std::nullopt;
  RigJob job;
  job.options = settings_.options;
  job.options.is_partial = true;
  job.final = final;
  job.generation = generation_;
  for (const Camera& camera : cameras_) {
    if (camera.name.empty()) continue;
    if (const auto lack = lack_of(camera)) {
      job.left_out.push_back({camera.name, lack->message});
    } else {
      job.cameras.push_back({camera.name, camera.fitted, camera.views()});
    }
    if (camera.movement) job.remarks.push_back(camera.movement->text);
  }
  std::vector<std::string> names;
  for (const RigJob::Camera& camera : job.cameras) names.push_back(camera.name);
  if (!job.left_out.empty()) {
    for (std::string& remark : rig::drop_unknown(job.options.baselines, names)) {
      job.remarks.push_back(std::move(remark));
    }
  }
  // One that has nothing to be solved by, that was removed, or that never came.
  if (job.options.world && !rig::check_world(*job.options.world, names)) {
    job.remarks.push_back(rig::drop_world(job.options.world));
  }
  if (sees_light()) job.light = settings_.light;
  const PointLight* light = light_ ? light_->as<PointLight>() : nullptr;
  if (job.light && light != nullptr && light->is_wand()) job.light->wand = light->places;
  if (job.cameras.size() < fewest_cameras(job)) return std::nullopt;
  asked_revision_ = revision_;
  is_due_ = false;
  return job;
}

void RigSession::solved(const RigJob& job, std::shared_ptr<const WatchedRig> watched) {
  if (!is_current(job)) return;
  watched_ = std::move(watched);
  if (job.final) solved_revision_ = asked_revision_;
}

std::vector<Instant> RigSession::instants() const {
  std::vector<ViewTimes> times;
  for (const Camera& camera : cameras_) {
    ViewTimes& of = times.emplace_back();
    for (const SharedView& view : camera.views()) of.push_back(view->observation.timestamp);
  }
  return pair_instants(times, settings_.options.tolerance).instants;
}

RigProgress RigSession::progress() const {
  RigProgress progress;
  for (const Camera& camera : cameras_) {
    if (!camera.kept.empty() || camera.chosen) progress.cameras.push_back(camera.name);
  }
  const std::vector<Instant> all = instants();
  progress.instants = static_cast<int>(all.size());
  const std::vector<CameraPair> pairs = pairs_of(all);
  for (const CameraPair& pair : pairs) {
    progress.links.push_back(
        {cameras_[pair.a].name, cameras_[pair.b].name, static_cast<int>(pair.views)});
  }
  if (const auto weakest = weakest_pair(pairs)) {
    progress.weakest = progress.links[*weakest].a + " " + progress.links[*weakest].b;
  }
  return progress;
}

std::optional<Error> RigSession::lack_of(const Camera& camera) const {
  if (camera.kept.empty() && !camera.chosen) {
    if (camera.points.count() > 0) {
      return Error{ErrorCode::kDegenerate,
                   fmt::format("The manual points of the camera '{}' are not enough. {}",
                               camera.name, camera.points.hint())};
    }
    if (!camera.has_seen && !camera.seen_other.empty()) {
      return Error{ErrorCode::kInvalidArgument,
                   has_seen_another(camera.name, camera.seen_other, settings_.boards)};
    }
    return Error{ErrorCode::kDegenerate,
                 has_seen_nothing(camera.name, sees_light(), camera.has_seen)};
  }
  if (!camera.intrinsics) {
    if (sees_light()) return std::nullopt;
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("The intrinsics of the camera '{}' are not known: set intrinsics=FILE "
                             "of its pad, or put calibrate before it.",
                             camera.name)};
  }
  if (!camera.fitted) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("The intrinsics of the camera '{}' are of pictures of another aspect "
                             "than it has now: calibrate it at this size.",
                             camera.name)};
  }
  return std::nullopt;
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
    if (auto lack = lack_of(camera)) return *std::move(lack);
  }
  const bool all_known =
      std::ranges::all_of(cameras_, [](const Camera& c) { return c.name.empty() || c.fitted; });
  if (sees_light() && there < 3 && !all_known) {
    return {ErrorCode::kInvalidArgument,
            "Two cameras do not tell their focal lengths by a light: link a third one that sees it "
            "too, or set intrinsics=FILE of both pads."};
  }
  return {ErrorCode::kDegenerate, "There is nothing new to solve."};
}

}  // namespace calvin
