// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Words that lie on the picture itself, of any colour: in the panel, beside points. None in a build
// without Pango.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "calvin/draw/overlay.hpp"

namespace calvin::gst {

class Labels {
 public:
  // One around all words, as those of a panel, or one for each of those that are far apart.
  enum class Tiles { kOne, kEach };
  explicit Labels(Tiles tiles);
  ~Labels();

  // Whether this build can draw any.
  [[nodiscard]] static bool can_draw() noexcept;

  // Tiles over the picture, some perhaps without pixels; good until the next call. Words that are
  // those of the last call cost nothing. One thread at a time.
  std::span<const OverlayTile> draw(std::vector<OverlayWords> words, ImageSize frame);

 private:
  Tiles kind_;
  std::unique_ptr<class TextPainter> painter_;
  std::vector<OverlayWords> words_;  // no two alike
  ImageSize frame_;
  std::vector<OverlayTile> tiles_;
};

}  // namespace calvin::gst
