// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a person who holds a board wants to see on the video: the corners that were found, how far
// the calibration is, and what to show next.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/core/result.hpp"
#include "calvin/draw/overlay_layout.hpp"
#include "calvin/draw/overlay_tile.hpp"
#include "calvin/session/progress.hpp"

namespace calvin {

// What is left out on request, and where the panel is.
struct OverlayParts {
  bool ghost = true;
  bool coverage = true;  // the panel: bars, chips and map
  bool words = true;     // whether somebody adds the words of the panel
  PanelSide panel = PanelSide::kLeft;
};

// Marks for every found observation (rows joined in the order of the ids, red to violet; control
// point 0 is a disc, or a circle where the labelling is ambiguous) and, where there is `progress`,
// one bar each for coverage, x, y, size and tilt, a value outside 0..1 taken as the nearer end, a
// chip for each group of parameters that turns green as they are known, the map of what was
// covered, a cross at each manual point, the ghost, which fills with what the present view tells,
// and a border for `captured` and, a thinner one, for `done`; the words of overlay_panel_words()
// and the numbers of overlay_point_numbers() are not. No tile where there is nothing to draw.
// Corners are scaled to the frame from the image_size of their observation. The first 64
// observations are drawn, and the first 2000 corners of them. kUnsupported where the library was
// built without Cairo, whatever the arguments.
[[nodiscard]] Result<std::vector<OverlayTile>> draw_overlay(
    ImageSize frame, std::span<const Observation> observations,
    const std::optional<Progress>& progress, const OverlayParts& parts = {});

// draw_overlay() for the frames of a video: what is as it was in the last frame is not drawn again,
// and tiles have spans. One thread at a time.
class OverlayPainter {
 public:
  OverlayPainter();
  OverlayPainter(const OverlayPainter&) = delete;
  OverlayPainter& operator=(const OverlayPainter&) = delete;
  ~OverlayPainter();

  // Good until the next call.
  [[nodiscard]] Result<std::span<const OverlayTile>> draw(ImageSize frame,
                                                          std::span<const Observation> observations,
                                                          const std::optional<Progress>& progress,
                                                          const OverlayParts& parts = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// What to do first: "Tilt the board more. (12 views, accurate to 0.36 px)"; empty where there is
// nothing to say. "Accurate to" is two sigma of the expected error; without it the rms is told. A
// hint is cut behind 500 bytes.
[[nodiscard]] std::string overlay_caption(const Progress& progress);

}  // namespace calvin
