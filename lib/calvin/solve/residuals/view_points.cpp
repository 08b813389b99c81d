// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Copies the corners in use into padded arrays, and shares the printed part between views.

#include "calvin/solve/residuals/view_points.hpp"

#include <algorithm>
#include <utility>

namespace calvin {

ViewPoints::ViewPoints(const PointSet& view, const BoardShape& shape, const ViewPoints* other)
    : padded_((view.used() + kLanes - 1) / kLanes * kLanes),
      modes_(shape.modes),
      moves_(!view.motion.empty()),
      seen_(aligned_array((moves_ ? 6 : 3) * std::max(padded_, kLanes))) {
  std::size_t at = 0;
  for (std::size_t i = 0; i < view.size(); ++i) {
    if (!(view.weight[i] > 0)) continue;
    seen_[at] = view.uv[i].u;
    seen_[padded_ + at] = view.uv[i].v;
    seen_[2 * padded_ + at] = view.weight[i];
    if (moves_) {
      const RowMotion& motion = view.motion[i];
      seen_[3 * padded_ + at] = motion.by_readout.u;
      seen_[4 * padded_ + at] = motion.by_readout.v;
      seen_[5 * padded_ + at] = motion.rate;
    }
    ++at;
  }
  for (std::size_t k = 0; k < (moves_ ? 6 : 3); ++k) {
    double* array = &seen_[k * padded_];
    std::fill(array + at, array + padded_, k == 2 ? 0 : array[0]);
  }
  const bool same = other != nullptr && other->padded_ == padded_ && other->modes_ == modes_ &&
                    other->printed_->shows(view, padded_);
  printed_ = same ? other->printed_ : std::make_shared<Printed>(printed(view, shape));
}

void ViewPoints::place(const std::vector<Eigen::Vector3d>& points) {
  for (std::size_t k = 0; k < 3; ++k) {
    double* array = &printed_->arrays[k * padded_];
    for (std::size_t at = 0; at < count(); ++at) {
      array[at] = points[static_cast<std::size_t>(ids()[at])][static_cast<Eigen::Index>(k)];
    }
    std::fill(array + count(), array + padded_, array[0]);
  }
}

bool ViewPoints::Printed::shows(const PointSet& view, std::size_t padded) const {
  std::size_t at = 0;
  for (std::size_t i = 0; i < view.size(); ++i) {
    if (!(view.weight[i] > 0)) continue;
    const Eigen::Vector3d& p = view.points[i];
    if (at == ids.size() || ids[at] != view.ids[i] || arrays[at] != p.x() ||
        arrays[padded + at] != p.y() || arrays[2 * padded + at] != p.z()) {
      return false;
    }
    ++at;
  }
  return at == ids.size();
}

ViewPoints::Printed ViewPoints::printed(const PointSet& view, const BoardShape& shape) const {
  Printed result;
  result.arrays = aligned_array((3 + 3 * modes_) * std::max(padded_, kLanes));
  const auto put = [&](std::size_t first, std::size_t at, const Eigen::Vector3d& p) {
    for (std::size_t k = 0; k < 3; ++k) {
      result.arrays[(first + k) * padded_ + at] = p[static_cast<Eigen::Index>(k)];
    }
  };
  for (std::size_t i = 0; i < view.size(); ++i) {
    if (!(view.weight[i] > 0)) continue;
    const std::size_t at = result.ids.size();
    put(0, at, view.points[i]);
    const auto id = static_cast<std::size_t>(view.ids[i]);
    for (std::size_t m = 0; m < modes_; ++m) {
      put(3 + 3 * m, at, shape.displacement[id * modes_ + m]);
    }
    result.ids.push_back(view.ids[i]);
  }
  for (std::size_t a = 0; a < 3 + 3 * modes_; ++a) {
    double* array = &result.arrays[a * padded_];
    std::fill(array + result.ids.size(), array + padded_, array[0]);
  }
  return result;
}

}  // namespace calvin
