// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// When a view of a guided session tells enough to be kept. Internal.
#pragma once

#include <cstdint>
#include <optional>

#include "calvin/core/observation.hpp"
#include "calvin/solve/view.hpp"

namespace calvin {

// Whether a view tells enough to be kept where the board is held still, where it moves, and where
// it has moved for so long that nobody is about to hold it still.
struct ViewWorth {
  bool still = true;
  bool moving = true;
  bool restless = true;
  // Where no more are kept: which of those that are it may take the place of.
  const View* in_place_of = nullptr;
};

// How a view compares with the one that is asked for.
struct NearView {
  double share = 0;     // ViewGuide::share()
  double distance = 0;  // ViewGuide::distance(), px
};

// Follows how near a board comes to the views that are asked for. Who brings it there is waited
// for; who does not, or cannot, gives views of any place: they tell less, but something.
class GuidedCapture {
 public:
  // Something was kept at that time, or a solve has ended: nothing was waited.
  void restart(std::uint64_t now);
  // Another view is asked for, for want of one that somebody gets to: what was waited counts.
  void change_target(std::uint64_t now);

  // Of a view that was seen at that time (ns); absent where nothing is asked for. Where nobody
  // knows the times (kNoTimestamp) there is nothing to wait for.
  [[nodiscard]] ViewWorth worth(const std::optional<NearView>& view, std::uint64_t now);
  // Whether somebody brings the board to where it is asked for, by the newest views.
  [[nodiscard]] bool follows() const noexcept { return follows_; }

 private:
  void follow(double distance, std::uint64_t now);

  std::uint64_t since_ = kNoTimestamp;   // restart()
  std::uint64_t nearer_ = kNoTimestamp;  // when the board last came nearer
  double near_ = 0;                      // px, the distance then
  std::optional<double> first_;          // px, the distance after restart()
  double nearest_ = 0;                   // px, the least one
  bool follows_ = true;                  // whether the board is brought to where it is asked for
};

}  // namespace calvin
