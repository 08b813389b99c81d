// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The tag image-orientation: how the frames of a stream have to be turned to stand upright.

#include "undistort/orientation_tags.hpp"

#include <gst/video/video.h>

namespace calvin::gst {

namespace {

std::optional<Orientation> orientation_of(GstTagList* tags) {
  GstVideoOrientationMethod method = GST_VIDEO_ORIENTATION_IDENTITY;
  if (!gst_video_orientation_from_tag(tags, &method)) return std::nullopt;
  switch (method) {
    case GST_VIDEO_ORIENTATION_90R:
      return Orientation{true, true, false};
    case GST_VIDEO_ORIENTATION_180:
      return Orientation{false, true, true};
    case GST_VIDEO_ORIENTATION_90L:
      return Orientation{true, false, true};
    case GST_VIDEO_ORIENTATION_HORIZ:
      return Orientation{false, true, false};
    case GST_VIDEO_ORIENTATION_VERT:
      return Orientation{false, false, true};
    case GST_VIDEO_ORIENTATION_UL_LR:
      return Orientation{true, false, false};
    case GST_VIDEO_ORIENTATION_UR_LL:
      return Orientation{true, true, true};
    default:
      return Orientation{};
  }
}

}  // namespace

bool OrientationTags::take(GstEvent* event) {
  if (GST_EVENT_TYPE(event) == GST_EVENT_STREAM_START) {
    stream_.reset();
    return true;
  }
  if (GST_EVENT_TYPE(event) != GST_EVENT_TAG) return false;
  GstTagList* tags = nullptr;
  gst_event_parse_tag(event, &tags);
  const auto said = orientation_of(tags);
  if (said) (gst_tag_list_get_scope(tags) == GST_TAG_SCOPE_STREAM ? stream_ : global_) = said;
  return true;
}

}  // namespace calvin::gst
