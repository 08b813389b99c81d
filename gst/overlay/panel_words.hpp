// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The words in the panel. None in a build without Pango.
#pragma once

#include <memory>
#include <vector>

#include "calvin/draw/overlay.hpp"

namespace calvin::gst {

class PanelWords {
 public:
  PanelWords();
  ~PanelWords();

  // Whether this build can draw any.
  [[nodiscard]] static bool can_draw() noexcept;

  // A tile over the panel, nullptr where there is none; good until the next call. Words that are
  // those of the last call cost nothing. One thread at a time.
  const OverlayTile* draw(std::vector<OverlayWords> words, ImageSize frame);

 private:
  std::unique_ptr<class TextPainter> painter_;
  std::vector<OverlayWords> words_;
  ImageSize frame_;
  OverlayTile tile_;
};

}  // namespace calvin::gst
