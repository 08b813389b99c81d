// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A few words at the bottom of the frame or, beside the panel, at its top. Nothing is drawn in a
// build without Pango.
#pragma once

#include <memory>
#include <string>

#include "calvin/draw/overlay.hpp"

namespace calvin::gst {

class Caption {
 public:
  Caption();
  ~Caption();

  enum class Place { kBottom, kTop };

  struct Words {
    std::string text;
    ImageSize frame;
    OverlaySpan room;   // at the top; at the bottom there is the whole frame
    bool done = false;  // on green

    [[nodiscard]] bool operator==(const Words&) const = default;
  };

  // The words' tile, nullptr where there is none; good until the next call for that place. Words
  // that are those of the last call for it cost nothing. One thread at a time.
  const OverlayTile* draw(const Words& words, Place place);

 private:
  struct Drawn {
    Words words;
    OverlayTile tile;
  };

  std::unique_ptr<class TextPainter> painter_;
  Drawn bottom_;
  Drawn top_;
};

}  // namespace calvin::gst
