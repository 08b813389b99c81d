// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Takes the grey levels of a border and of what is around it, each as a plane over the quad.

#include "calvin/detect/tags/tag_cells.hpp"

#include <Eigen/Cholesky>

namespace calvin::detect {

void GreyPlane::fit() {
  // Of places all around the middle each sum tells one number.
  constexpr double kNone = 1e-9;
  if (std::max({std::abs(x_), std::abs(y_), std::abs(xy_)}) < kNone) {
    levels_ = {right_[0] / count_, right_[1] / xx_, right_[2] / yy_};
    return;
  }
  Eigen::Matrix3d products;
  products << count_, x_, y_, x_, xx_, xy_, y_, xy_, yy_;
  levels_ = products.ldlt().solve(right_);
}

bool TagCells::are_plain() const {
  constexpr double kMost =
      0.25;  // of the contrast: twice that is no light bit when it is sharpened
  if (!is_inside_) return false;
  double dark = 0;
  double light = 0;
  for (const double along : {0.25 * side_, 0.75 * side_}) {
    for (const auto& [depth, sum] : {std::pair{0.5, &dark}, {-around_, &light}}) {
      const double far = side_ - depth;
      *sum += (grey_in(along, depth) + grey_in(far, along) + grey_in(along, far) +
               grey_in(depth, along)) /
              8;
    }
  }
  const double least = dark + kMost * (light - dark);
  for (int row = border_; row < side_ - border_; ++row) {
    for (int col = border_; col < side_ - border_; ++col) {
      const double grey = grey_in(col + 0.5, row + 0.5);
      if (inverted_ ? grey <= least : grey >= least) return false;
    }
  }
  return true;
}

void TagCells::take_levels() {
  Samples border;
  Samples outside;
  for (int row = 0; row < side_; ++row) {
    for (int col = 0; col < side_; ++col) {
      if (!is_border(col, row)) continue;
      const double grey = mean_at(col + 0.5, row + 0.5);
      border_greys_[index(col, row)] = grey;
      border.add(col + 0.5, row + 0.5, grey);
    }
  }
  for (int i = 0; i < side_; ++i) {
    const double along = i + 0.5;
    const double far = side_ + around_;
    for (const auto& [x, y] :
         {std::pair{along, -around_}, {far, along}, {along, far}, {-around_, along}}) {
      outside.add(x, y, grey_in(x, y));
    }
  }
  border_seen_ = border.count;
  around_seen_ = outside.count;
  if (2 * border_seen_ < side_ || 2 * around_seen_ < side_) return;
  for (const Sample& s : border.seen()) dark_.add(s.x - middle_, s.y - middle_, s.grey);
  for (const Sample& s : outside.seen()) light_.add(s.x - middle_, s.y - middle_, s.grey);
  dark_.fit();
  light_.fit();
  contrast_ = (light_.at(0, 0) - dark_.at(0, 0)) * (inverted_ ? -1 : 1);
  const auto is_light = [&](const Sample& s) { return lightness(s.x, s.y, s.grey) > 0.5; };
  border_wrong_ = static_cast<int>(std::ranges::count_if(border.seen(), is_light));
  around_wrong_ = around_seen_ - static_cast<int>(std::ranges::count_if(outside.seen(), is_light));
}

}  // namespace calvin::detect
