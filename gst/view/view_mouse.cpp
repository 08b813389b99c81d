// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the mouse does in the window of the sink: a sink sends it upstream as navigation events.

#include <algorithm>
#include <cmath>

#include <gst/video/navigation.h>

#include "view/view_state.hpp"

namespace calvin::gst {

void ViewState::press(int button, double x, double y) {
  if (button == 4 || button == 5) zoom_by(button == 4 ? 1 : -1);
  if (button != 1) return;
  const std::lock_guard guard(lock_);
  held_ = Pixel{x, y};
}

void ViewState::release(int button) {
  const std::lock_guard guard(lock_);
  if (button == 1) held_.reset();
}

void ViewState::move_to(double x, double y, int height) {
  constexpr double kTurn = 3;  // rad, for the height of the picture
  const std::lock_guard guard(lock_);
  if (!held_) return;
  const double right = (x - held_->u) / height;
  const double down = (y - held_->v) / height;
  held_ = Pixel{x, y};
  if (!std::isfinite(right) || !std::isfinite(down)) return;
  viewpoint_.azimuth -= kTurn * right;
  viewpoint_.elevation = std::clamp(viewpoint_.elevation + kTurn * down, -1.5, 1.5);
}

void ViewState::zoom_by(double steps) {
  constexpr double kStep = 1.1;
  const std::lock_guard guard(lock_);
  viewpoint_.zoom = std::clamp(viewpoint_.zoom * std::pow(kStep, steps), 0.2, 8.0);
}

void ViewState::navigate(GstEvent* event, int height) {
  double x = 0;
  double y = 0;
  int button = 0;
  switch (gst_navigation_event_get_type(event)) {
    case GST_NAVIGATION_EVENT_MOUSE_BUTTON_PRESS:
      gst_navigation_event_parse_mouse_button_event(event, &button, &x, &y);
      press(button, x, y);
      break;
    case GST_NAVIGATION_EVENT_MOUSE_BUTTON_RELEASE:
      gst_navigation_event_parse_mouse_button_event(event, &button, &x, &y);
      release(button);
      break;
    case GST_NAVIGATION_EVENT_MOUSE_MOVE:
      gst_navigation_event_parse_mouse_move_event(event, &x, &y);
      move_to(x, y, std::max(1, height));
      break;
    case GST_NAVIGATION_EVENT_MOUSE_SCROLL: {
      double across = 0;
      double up = 0;
      gst_navigation_event_parse_mouse_scroll_event(event, &x, &y, &across, &up);
      if (up != 0) zoom_by(up > 0 ? 1 : -1);
      break;
    }
    default:
      break;
  }
}

}  // namespace calvin::gst
