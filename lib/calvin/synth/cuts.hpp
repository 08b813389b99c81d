// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The cuts between the cells along one axis, and in which cell a coordinate lies. Internal.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace calvin::synth {

class Cuts {
 public:
  explicit Cuts(std::vector<double> ascending) : at_(std::move(ascending)) {
    if (at_.empty()) at_.push_back(0);
    const double length = at_.back() - at_.front();
    double least = length;
    for (std::size_t i = 1; i < at_.size(); ++i) least = std::min(least, at_[i] - at_[i - 1]);
    // Cells of one size each get a step of the raster, which is all there is to find then.
    const double most = kStepsPerCell * static_cast<double>(at_.size());
    const double steps = length > 0 ? std::clamp(std::round(length / least), 1.0, most) : 1;
    steps_per_metre_ = length > 0 ? steps / length : 0;
    for (int k = 0; k <= static_cast<int>(steps); ++k) {
      const double start = at_.front() + k * (length / steps);
      const auto next = std::upper_bound(at_.begin(), at_.end() - 1, start);
      first_.push_back(std::max(static_cast<int>(next - at_.begin()) - 1, 0));
    }
  }

  [[nodiscard]] int count() const noexcept { return static_cast<int>(at_.size()) - 1; }

  // -1 before the first cell and for what is no number, count() after the last one.
  [[nodiscard]] int cell_of(double x) const noexcept {
    if (!(x >= at_.front())) return -1;
    if (x >= at_.back()) return count();
    int cell = first_[static_cast<std::size_t>((x - at_.front()) * steps_per_metre_)];
    while (x >= at_[static_cast<std::size_t>(cell) + 1]) ++cell;
    return cell;
  }
  // Where a cell ends, from -1 to count() - 1.
  [[nodiscard]] double end_of(int cell) const noexcept {
    return at_[static_cast<std::size_t>(cell + 1)];
  }

 private:
  static constexpr double kStepsPerCell = 16;  // at most

  std::vector<double> at_;
  double steps_per_metre_ = 0;
  std::vector<int> first_;  // the cell in which a step of a fine raster starts
};

}  // namespace calvin::synth
