// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Distances of views, kept up to date view by view.

#include "calvin/session/views/view_spacing.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calvin/geometry/pixels.hpp"
#include "calvin/session/views/corner_motion.hpp"

namespace calvin {

double view_distance(const View& a, const View& b) {
  const Observation& from = a.observation;
  const Observation& to = b.observation;
  if (from.board != to.board) return HUGE_VAL;
  if (from.ids == to.ids) {
    double squares = 0;
    for (std::size_t i = 0; i < to.uv.size(); ++i) {
      const double du = to.uv[i].u - from.uv[i].u;
      const double dv = to.uv[i].v - from.uv[i].v;
      squares += du * du + dv * dv;
    }
    return std::sqrt(squares / static_cast<double>(to.uv.size()));
  }
  const CornerMotion moved = corner_motion(from, to);
  const bool alike = 2 * moved.shared >= std::max(from.ids.size(), to.ids.size());
  return alike ? std::max(moved.all, distance(mean_of(from.uv), mean_of(to.uv))) : HUGE_VAL;
}

double ViewSpacing::distance_below(double relevant, const Spaced& a, const Spaced& b) {
  // Each new view makes a thousand pairs: the corners of few of them need to be looked at.
  const double centers = calvin::distance(a.center, b.center);
  if (centers >= relevant) return centers;
  return view_distance(*a.view, *b.view);
}

void ViewSpacing::find_nearest(Spaced& of) const {
  of.nearest = nullptr;
  of.distance = HUGE_VAL;
  for (const Spaced& other : views_) {
    if (other.view == of.view) continue;
    const double distance = distance_below(of.distance, other, of);
    if (of.nearest != nullptr && distance >= of.distance) continue;
    of.nearest = other.view.get();
    of.distance = distance;
  }
}

void ViewSpacing::add(const std::shared_ptr<const View>& view) {
  Spaced added;
  added.view = view;
  added.distance = HUGE_VAL;
  added.center = mean_of(view->observation.uv);
  // The last frames are mostly the nearest, after which the others need no second look.
  for (auto it = views_.rbegin(); it != views_.rend(); ++it) {
    Spaced& other = *it;
    const double distance = distance_below(std::max(other.distance, added.distance), other, added);
    if (other.nearest == nullptr || distance < other.distance) {
      other.nearest = added.view.get();
      other.distance = distance;
    }
    if (added.nearest == nullptr || distance < added.distance) {
      added.nearest = other.view.get();
      added.distance = distance;
    }
  }
  views_.push_back(std::move(added));
}

void ViewSpacing::remove(std::size_t index) {
  const std::shared_ptr<const View> gone = views_[index].view;
  views_.erase(views_.begin() + static_cast<std::ptrdiff_t>(index));
  for (Spaced& other : views_) {
    if (other.nearest == gone.get()) find_nearest(other);
  }
}

std::size_t ViewSpacing::most_crowded(std::size_t count) const {
  std::size_t crowded = 0;
  for (std::size_t i = 1; i < count; ++i) {
    if (views_[i].distance <= views_[crowded].distance) crowded = i;
  }
  return crowded;
}

}  // namespace calvin
