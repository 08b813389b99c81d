// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/solve/view_points.hpp"

#include <algorithm>

namespace calvin {

ViewPoints::ViewPoints(const PointSet& view, const BoardShape& shape)
    : count_(view.used()),
      padded_((count_ + kLanes - 1) / kLanes * kLanes),
      modes_(shape.modes),
      data_(aligned_array((6 + 3 * modes_) * std::max(padded_, kLanes))) {
  const auto put = [this](std::size_t array, std::size_t at, double value) {
    data_[array * padded_ + at] = value;
  };
  std::size_t at = 0;
  for (std::size_t i = 0; i < view.size(); ++i) {
    if (!(view.weight[i] > 0)) continue;
    for (std::size_t k = 0; k < 3; ++k) put(k, at, view.points[i][static_cast<Eigen::Index>(k)]);
    put(3, at, view.uv[i].u);
    put(4, at, view.uv[i].v);
    put(5, at, view.weight[i]);
    for (std::size_t m = 0; m < modes_; ++m) {
      const auto id = static_cast<std::size_t>(view.ids[i]);
      const Eigen::Vector3d& d = shape.displacement[id * modes_ + m];
      for (std::size_t k = 0; k < 3; ++k) {
        put(6 + 3 * m + k, at, d[static_cast<Eigen::Index>(k)]);
      }
    }
    ++at;
  }
  for (; at < padded_; ++at) {
    for (std::size_t a = 0; a < 6 + 3 * modes_; ++a) put(a, at, data_[a * padded_]);
    put(5, at, 0);
  }
}

}  // namespace calvin
