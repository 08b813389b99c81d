// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-calibrate-images --board auto: which board the pictures show. A stream takes a board up
// with the frame in which it is sure; pictures before that one would be lost.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <gst/video/video.h>

#include "calibrate_images_decode.hpp"
#include "calibrate_images_folder.hpp"
#include "calvin/detect/board_identifier.hpp"

namespace calibrate_images {

inline void look(const Sample& sample, calvin::BoardIdentifier& identifier) {
  GstVideoInfo info;
  GstVideoFrame frame;
  if (!gst_video_info_from_caps(&info, gst_sample_get_caps(sample.get())) ||
      !gst_video_frame_map(&frame, &info, gst_sample_get_buffer(sample.get()), GST_MAP_READ)) {
    return;
  }
  identifier.look({static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, 0)),
                   GST_VIDEO_FRAME_WIDTH(&frame), GST_VIDEO_FRAME_HEIGHT(&frame),
                   GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0), 1},
                  {});
  gst_video_frame_unmap(&frame);
}

// The text of the board that is certainly in the pictures; absent where that is no question, and
// where none is certain.
inline std::optional<std::string> board_seen(const std::string& text,
                                             const std::vector<Picture>& pictures) {
  const auto any = calvin::parse_auto_board(text);
  if (!any || !*any) return std::nullopt;
  calvin::BoardIdentifier identifier(**any);
  for (const Picture& picture : pictures) {
    const auto sample = decode(picture.path);
    if (sample) look(*sample, identifier);
    if (const auto certain = identifier.certain()) return certain->text();
  }
  return std::nullopt;
}

}  // namespace calibrate_images
