// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How calibundistort negotiates: the same frames, or else frames of another size.

#include "undistort/undistort_caps.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "common/frames/dma_caps.hpp"
#include "common/frames/meta_filter.hpp"

namespace calvin::gst {

namespace {

constexpr int kLargest = 65536;  // as for a calibration

int rounded_ratio(int value, int numerator, int denominator) {
  return static_cast<int>(gst_util_uint64_scale_int_round(static_cast<guint64>(value), numerator,
                                                          std::max(denominator, 1)));
}

// Fixates the size in `to`; `size` where it can be had.
void fixate_size(GstStructure* to, ImageSize size) {
  g_autoptr(GstStructure) offered = gst_structure_copy(to);
  gst_structure_fixate_field_nearest_int(to, "width", size.width);
  int width = size.width;
  gst_structure_get_int(to, "width", &width);
  const int wanted = rounded_ratio(width, size.height, size.width);
  gst_structure_fixate_field_nearest_int(to, "height", wanted);
  int height = wanted;
  gst_structure_get_int(to, "height", &height);
  if (height == wanted) return;
  gst_structure_set_value(to, "width", gst_structure_get_value(offered, "width"));
  gst_structure_fixate_field_nearest_int(to, "width",
                                         rounded_ratio(height, size.width, size.height));
}

bool can_be(const GstStructure* offered, const char* field, int value) {
  g_auto(GValue) wanted = G_VALUE_INIT;
  g_value_init(&wanted, G_TYPE_INT);
  g_value_set_int(&wanted, value);
  const GValue* has = gst_structure_get_value(offered, field);
  return has == nullptr || gst_value_intersect(nullptr, has, &wanted) != FALSE;
}

// The first structure that has frames of that size, or else the first one: what cuts or turns
// pictures downstream offers the size that it would make of the size before the size itself.
GstCaps* preferred(GstCaps* offered, ImageSize size) {
  for (guint i = 0; i < gst_caps_get_size(offered); ++i) {
    const GstStructure* one = gst_caps_get_structure(offered, i);
    if (!can_be(one, "width", size.width) || !can_be(one, "height", size.height)) continue;
    GstCaps* with_size = gst_caps_copy_nth(offered, i);
    gst_caps_unref(offered);
    return with_size;
  }
  return gst_caps_truncate(offered);
}

// Says in `to` what colours and siting the frames of `in` have.
void keep_meaning(GstStructure* to, const FrameFormat& in) {
  if (!gst_structure_has_field(to, "colorimetry")) {
    g_autofree gchar* colours = gst_video_colorimetry_to_string(&in.info.colorimetry);
    if (colours != nullptr) {
      gst_structure_set(to, "colorimetry", G_TYPE_STRING, colours, nullptr);
    }
  }
  if (!gst_structure_has_field(to, "chroma-site")) {
    g_autofree gchar* site = gst_video_chroma_site_to_string(in.site);
    if (site != nullptr) gst_structure_set(to, "chroma-site", G_TYPE_STRING, site, nullptr);
  }
}

}  // namespace

GstCaps* undistort_transform_caps(GstBaseTransform* /*trans*/, GstPadDirection direction,
                                  GstCaps* caps, GstCaps* filter) {
  g_autoptr(GstCaps) mapped = mapped_caps(caps);
  GstCaps* others = gst_caps_copy(mapped);
  for (guint i = 0; i < gst_caps_get_size(mapped); ++i) {
    // The fields of an interlaced frame pass as they are or not at all.
    if (!gst_caps_features_is_equal(gst_caps_get_features(mapped, i),
                                    GST_CAPS_FEATURES_MEMORY_SYSTEM_MEMORY)) {
      continue;
    }
    GstStructure* any = gst_structure_copy(gst_caps_get_structure(mapped, i));
    gst_structure_set(any, "width", GST_TYPE_INT_RANGE, 1, kLargest, "height", GST_TYPE_INT_RANGE,
                      1, kLargest, nullptr);
    gst_structure_remove_field(any, "chroma-site");
    others = gst_caps_merge_structure(others, any);
  }
  // The frames that come out lie in system memory, those that come in in either.
  if (direction == GST_PAD_SRC) others = with_dma_caps(others);
  if (filter != nullptr) {
    GstCaps* both = gst_caps_intersect_full(filter, others, GST_CAPS_INTERSECT_FIRST);
    gst_caps_unref(others);
    others = both;
  }
  return others;
}

GstCaps* undistort_fixate_caps(GstBaseTransform* /*trans*/, GstPadDirection direction,
                               GstCaps* caps, GstCaps* othercaps) {
  GstVideoInfo in;
  if (video_info_of(in, caps)) {
    const FrameFormat format(in, caps);
    othercaps = gst_caps_make_writable(preferred(othercaps, format.size()));
    fixate_size(gst_caps_get_structure(othercaps, 0), format.size());
    othercaps = gst_caps_fixate(othercaps);
    GstVideoInfo out;
    if (direction == GST_PAD_SINK && GST_VIDEO_INFO_IS_YUV(&in) &&
        gst_video_info_from_caps(&out, othercaps) &&
        (!gst_video_colorimetry_is_equal(&in.colorimetry, &out.colorimetry) ||
         FrameFormat(out, othercaps).site != format.site)) {
      keep_meaning(gst_caps_get_structure(othercaps, 0), format);
    }
    return othercaps;
  }
  return gst_caps_fixate(othercaps);
}

Status check_move(const FrameFormat& in, const FrameFormat& out) {
  if (in.same_places(out)) return {};
  if (GST_VIDEO_INFO_IS_INTERLACED(&in.info)) {
    return make_error(ErrorCode::kUnsupported,
                      "Interlaced video cannot be scaled: insert deinterlace before this element.");
  }
  if (!has_extent(in.size()) || !has_extent(out.size())) {
    return make_error(
        ErrorCode::kUnsupported,
        fmt::format(
            "Frames of {}x{} px cannot be made into frames of {}x{}: both need at least two "
            "columns and two rows. Insert videoscale where the smaller ones are.",
            in.size().width, in.size().height, out.size().width, out.size().height));
  }
  return {};
}

void add_undistort_pads(GstElementClass* element_class) {
  // Alternating fields are taken only to say that they need deinterlace.
  g_autoptr(GstCaps) caps = gst_caps_from_string(
      CALVIN_RAW_CAPS(CALVIN_PLANE_FORMATS) "; " GST_VIDEO_CAPS_MAKE_WITH_FEATURES(
          GST_CAPS_FEATURE_FORMAT_INTERLACED, CALVIN_PLANE_FORMATS) ", interlace-mode = "
                                                                    "alternate");
  g_autoptr(GstCaps) both = with_dma_caps(gst_caps_copy(caps));
  gst_element_class_add_pad_template(
      element_class, gst_pad_template_new("sink", GST_PAD_SINK, GST_PAD_ALWAYS, both));
  gst_element_class_add_pad_template(
      element_class, gst_pad_template_new("src", GST_PAD_SRC, GST_PAD_ALWAYS, caps));
}

}  // namespace calvin::gst
