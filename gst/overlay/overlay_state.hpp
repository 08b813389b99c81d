// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What caliboverlay is set to, and what it knows of its stream.
#pragma once

#include <atomic>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <gst/gst.h>

#include "calvin/core/observation.hpp"
#include "calvin/draw/overlay.hpp"
#include "calvin/session/progress.hpp"
#include "common/frames/frame_part.hpp"
#include "common/properties.hpp"
#include "common/shared_settings.hpp"
#include "overlay/caption.hpp"
#include "overlay/labels.hpp"
#include "overlay/overlay_blend.hpp"

namespace calvin::gst {

struct OverlaySettings {
  bool mirror = false;
  bool ghost = true;
  bool coverage = true;
  bool caption = true;
};

// A live detector skips frames: what it last saw stays for this long, or the marks would flicker.
inline constexpr GstClockTime kHold = 250 * GST_MSECOND;

// Something of an earlier buffer that is still shown.
template <typename T>
struct Held {
  T value{};
  GstClockTime since = GST_CLOCK_TIME_NONE;

  void take(T next, GstClockTime now) {
    value = std::move(next);
    since = now;
  }
  // Forgets it when its time is over, or when time jumped.
  void expire(GstClockTime now) {
    const bool known = GST_CLOCK_TIME_IS_VALID(now) && GST_CLOCK_TIME_IS_VALID(since);
    if (!known || now < since || now - since > kHold) *this = {};
  }
};

// Touched by the streaming thread only, and by start and stop when there is none; the settings by
// any.
struct OverlayState : SharedSettings<OverlaySettings> {
  Held<std::vector<Observation>> observations;
  Held<std::optional<Progress>> progress;
  Held<bool> captured;
  OverlayPainter painter;
  TileBlender blender;
  std::span<const OverlayTile> tiles;  // of the buffer at hand
  Caption caption;
  Caption::Place words_at = Caption::Place::kBottom;
  Labels panel_words{Labels::Tiles::kOne};
  Labels point_numbers{Labels::Tiles::kEach};
  PanelSide panel = PanelSide::kLeft;
  // The tiles of words for the buffer at hand.
  const OverlayTile* words = nullptr;
  std::span<const OverlayTile> words_in_panel;
  std::span<const OverlayTile> numbers;  // of points
  std::optional<FramePart> part;         // of the buffer's picture that is the frame
  bool mirror = false;                   // the buffer at hand
  bool blending_failed = false;
  std::atomic<int> width = 0;  // px, of the frames
  bool frame_refused = false;  // and that was reported

  void forget() {
    observations = {};
    progress = {};
    captured = {};
    tiles = {};
    words = nullptr;
    words_in_panel = numbers = {};
  }
};

extern const Properties<OverlayState> kOverlayProperties;

}  // namespace calvin::gst
