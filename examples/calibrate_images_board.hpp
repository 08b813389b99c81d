// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which board the pictures show: for calvin-calibrate-images --board auto, since a stream takes a
// board up with the frame in which it is sure and pictures before that one would be lost; and where
// none of them shows the board that was asked for.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <gst/video/video.h>

#include "calibrate_images_decode.hpp"
#include "calibrate_images_folder.hpp"
#include "calvin/detect/board_identifier.hpp"
#include "calvin/io/board_names.hpp"

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

// "This is charuco:..., I look for ...", where none of the pictures shows one of the boards of a
// text; empty where nobody knows what they show.
inline std::string other_board(const std::string& text, const std::vector<Picture>& pictures) {
  constexpr std::size_t kMost = 8;  // of them are looked at
  auto boards = calvin::parse_boards(text);
  if (!boards) return "";
  calvin::BoardIdentifier identifier(*std::move(boards));
  for (std::size_t i = 0; i < std::min(kMost, pictures.size()); ++i) {
    const auto sample = decode(pictures[i].path);
    if (sample) look(*sample, identifier);
    if (std::string hint = identifier.hint(); !hint.empty()) return hint;
  }
  return "";
}

}  // namespace calibrate_images
