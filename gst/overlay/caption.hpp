// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// One line of text at the bottom of the frame. Nothing is drawn in a build without Pango.
#pragma once

#include <memory>
#include <string>

#include "calvin/draw/overlay.hpp"

namespace calvin::gst {

class Caption {
 public:
  Caption();
  ~Caption();

  // The text's tile, nullptr where there is none; good until the next call. Text and size of the
  // frame that are those of the last call cost nothing. One thread at a time.
  const OverlayTile* draw(const std::string& text, ImageSize frame);

 private:
  struct Renderer;

  std::unique_ptr<Renderer> renderer_;
  std::string text_;
  ImageSize frame_;
  OverlayTile tile_;
};

}  // namespace calvin::gst
