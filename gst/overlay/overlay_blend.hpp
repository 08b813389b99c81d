// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The library's overlay tiles onto a mapped frame of any raw format.
#pragma once

#include <optional>

#include <gst/video/video.h>

#include "calvin/draw/overlay.hpp"
#include "calvin/draw/raster/tile_stamp.hpp"
#include "common/frames/frame_part.hpp"

namespace calvin::gst {

// How the samples of a format with 8 bits each and without alpha lie in memory; absent for others.
[[nodiscard]] std::optional<PixelLayout> layout_of(const GstVideoInfo& info);

// Blends itself where there is a layout, else by libgstvideo. One thread at a time.
class TileBlender {
 public:
  // A frame mapped for reading and writing, until the next one; tiles belong on `part` of it, if
  // there is one.
  void begin_frame(GstVideoFrame* frame, const std::optional<FramePart>& part = {});
  // False where libgstvideo cannot blend onto the format.
  bool blend(const OverlayTile& tile);

 private:
  GstVideoFrame* frame_ = nullptr;
  int left_ = 0;
  int top_ = 0;
  bool has_layout_ = false;
  FramePlanes planes_;
  TileStamps stamps_;
};

}  // namespace calvin::gst
