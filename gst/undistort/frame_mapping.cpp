// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What moves with the pixels of a frame: metas on their way down, pointer events on their way up.

#include "undistort/frame_mapping.hpp"

#include <cmath>

#include <gst/video/video.h>

#include "common/metas.hpp"

namespace calvin::gst {

namespace {

bool is_custom(const GstMeta* meta, const char* name) {
  return gst_meta_info_is_custom(meta->info) &&
         gst_custom_meta_has_name(reinterpret_cast<GstCustomMeta*>(const_cast<GstMeta*>(meta)),
                                  name);
}

gpointer copy_parameter(gconstpointer structure, gpointer /*data*/) {
  return gst_structure_copy(static_cast<const GstStructure*>(structure));
}

void map_region(const Undistorter& undistorter, const GstVideoRegionOfInterestMeta& region,
                GstBuffer* out) {
  const auto box = undistorter.to_output(
      Rectangle{static_cast<double>(region.x), static_cast<double>(region.y),
                static_cast<double>(region.w), static_cast<double>(region.h)});
  if (!box) return;
  const auto left = static_cast<guint>(std::lround(box->x));
  const auto top = static_cast<guint>(std::lround(box->y));
  const auto right = static_cast<guint>(std::lround(box->x + box->width));
  const auto bottom = static_cast<guint>(std::lround(box->y + box->height));
  if (right <= left || bottom <= top) return;
  GstVideoRegionOfInterestMeta* mapped = gst_buffer_add_video_region_of_interest_meta_id(
      out, region.roi_type, left, top, right - left, bottom - top);
  if (mapped == nullptr) return;
  mapped->id = region.id;
  mapped->parent_id = region.parent_id;
  mapped->params = g_list_copy_deep(region.params, copy_parameter, nullptr);
}

}  // namespace

MetaFate map_meta(const Undistorter& undistorter, GstBuffer* in, GstMeta* meta, GstBuffer* out) {
  if (is_custom(meta, kObservationName)) {
    std::vector<Observation> mapped;
    for (const Observation& o : read_observations(in)) mapped.push_back(undistorter.to_output(o));
    attach_observations(out, mapped);
    return MetaFate::kDone;
  }
  if (meta->info->api == GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE) {
    map_region(undistorter, *reinterpret_cast<GstVideoRegionOfInterestMeta*>(meta), out);
    return MetaFate::kDone;
  }
  // It tells of the session.
  if (is_custom(meta, kGuidanceName)) return MetaFate::kCopy;
  return MetaFate::kOthers;
}

GstEvent* map_navigation(const Undistorter& undistorter, GstEvent* event) {
  double x = 0;
  double y = 0;
  if (!gst_navigation_event_get_coordinates(event, &x, &y)) return event;
  const Pixel place = undistorter.nearest_source({x - 0.5, y - 0.5});
  event = gst_event_make_writable(event);
  gst_navigation_event_set_coordinates(event, place.u + 0.5, place.v + 0.5);
  return event;
}

}  // namespace calvin::gst
