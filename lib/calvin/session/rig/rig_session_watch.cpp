// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cameras that move while a session of several runs: what they see is kept apart, until they are
// asked to be inserted again.

#include <algorithm>
#include <iterator>
#include <utility>

#include "calvin/session/rig/rig_session.hpp"

namespace calvin {

std::vector<RigCameraViews> views_of(const WatchJob& job) {
  RigJob same;
  same.cameras = job.cameras;
  return views_of(same);
}

std::vector<std::string> RigSession::moved_cameras() const {
  std::vector<std::string> names;
  for (const Camera& camera : cameras_) {
    if (camera.movement) names.push_back(camera.name);
  }
  return names;
}

std::optional<WatchJob> RigSession::take_watch() {
  constexpr std::uint64_t kInterval = 100'000'000;  // ns: instants that follow sooner tell no more
  if (!watched_ || !is_watched()) return std::nullopt;
  auto views = recent_instants_.take(settings_.options.tolerance, kInterval);
  WatchJob job{watched_, moved_cameras(), {}, settings_.options.tolerance, generation_};
  for (std::size_t c = 0; c < views.size(); ++c) {
    if (views[c].empty() || !cameras_[c].fitted) continue;
    job.cameras.push_back({cameras_[c].name, cameras_[c].fitted, std::move(views[c])});
  }
  if (job.cameras.size() < 2) return std::nullopt;
  return job;
}

bool RigSession::moved(const WatchJob& job, const MovedCamera& moved) {
  if (job.generation != generation_) return false;
  ++movements_;
  bool any = false;
  for (Camera& camera : cameras_) {
    const bool is_one = std::ranges::find(moved.cameras, camera.name) != moved.cameras.end();
    if (camera.name.empty() || !is_one || camera.movement) continue;
    camera.movement = Movement{moved.since, movements_, to_text(moved)};
    const auto later = std::ranges::stable_partition(camera.kept, [&](const SharedView& view) {
      return view->observation.timestamp < moved.since;
    });
    camera.apart.assign(std::make_move_iterator(later.begin()),
                        std::make_move_iterator(later.end()));
    camera.kept.erase(later.begin(), later.end());
    any = true;
  }
  if (any) ++revision_;
  return any;
}

bool RigSession::reinsert(const std::string& name) {
  const auto own = std::ranges::find_if(
      cameras_, [&](const Camera& camera) { return !name.empty() && camera.name == name; });
  if (own == cameras_.end()) return false;
  const auto movement = std::exchange(own->movement, std::nullopt);
  own->kept = std::exchange(own->apart, {});
  own->recent.clear();
  // It was this one: the other, of which it was said with it, has stayed where it was.
  for (Camera& other : cameras_) {
    if (!movement || !other.movement || other.movement->number != movement->number) continue;
    other.kept.insert(other.kept.end(), other.apart.begin(), other.apart.end());
    other.apart.clear();
    other.movement.reset();
  }
  // What is being solved or looked at now has the camera where it stood, and so has the last rig.
  ++generation_;
  ++revision_;
  is_due_ = true;
  watched_.reset();
  recent_instants_.clear();
  return true;
}

}  // namespace calvin
