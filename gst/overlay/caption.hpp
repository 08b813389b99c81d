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

  // The text's tile, nullptr where there is none; good until the next call for that place. Text and
  // size of the frame that are those of the last call for it cost nothing. One thread at a time.
  const OverlayTile* draw(const std::string& text, ImageSize frame, Place place = Place::kBottom);

 private:
  struct Renderer;

  struct Drawn {
    std::string text;
    ImageSize frame;
    OverlayTile tile;
  };

  std::unique_ptr<Renderer> renderer_;
  Drawn bottom_;
  Drawn top_;
};

}  // namespace calvin::gst
