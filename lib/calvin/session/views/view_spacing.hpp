// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which of many views tells least beside the others.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "calvin/solve/view.hpp"

namespace calvin {

// How far each of some views is from the one that is most like it: where nearly the same was seen
// twice, the second view tells little but the noise of its corners. Views are numbered in the order
// in which they were added; one that is removed moves those after it up.
//
// Adding and removing take a time that grows with the number of views; none waits for a solve.
class ViewSpacing {
 public:
  void add(const std::shared_ptr<const View>& view);
  void remove(std::size_t index);
  void clear() { views_.clear(); }

  // Of the first `count` views, at least one, that which is nearest to another one; of two that are
  // equally near the later.
  [[nodiscard]] std::size_t most_crowded(std::size_t count) const;

 private:
  struct Spaced {
    std::shared_ptr<const View> view;
    const View* nearest = nullptr;
    double distance = 0;  // px, to the nearest
    Pixel center;         // of the corners
  };

  // Not the distance itself where it is at least `relevant`: any number that is.
  [[nodiscard]] static double distance_below(double relevant, const Spaced& a, const Spaced& b);
  void find_nearest(Spaced& of) const;

  std::vector<Spaced> views_;
};

// RMS distance of the corners that two views of a board share, px, or that of the centres of what
// they show, if that is more; infinite where they share less than half of those of either.
[[nodiscard]] double view_distance(const View& a, const View& b);

}  // namespace calvin
