// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Frames in DMA memory, as caps of system memory and back.

#include "common/frames/dma_caps.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace calvin::gst {

namespace {

#if GST_CHECK_VERSION(1, 24, 0)

constexpr char kDmaMemory[] = "memory:DMABuf";  // of libgstallocators, for this word alone
constexpr char kDmaFormat[] = "DMA_DRM";
constexpr guint64 kLinear = 0;  // DRM_FORMAT_MOD_LINEAR

// What the kernel calls a format of GStreamer's; empty where it has no word for it.
std::string name_in_dma(const char* format) {
  const guint32 code = gst_video_dma_drm_fourcc_from_format(gst_video_format_from_string(format));
  if (code == 0) return {};
  g_autofree char* name = gst_video_dma_drm_fourcc_to_string(code, kLinear);
  return name;
}

// And back; empty where the frames are tiled, too.
std::string name_when_mapped(const char* dma_name) {
  guint64 modifier = kLinear;
  const guint32 code = gst_video_dma_drm_fourcc_from_string(dma_name, &modifier);
  if (code == 0 || modifier != kLinear) return {};
  const GstVideoFormat format = gst_video_dma_drm_fourcc_to_format(code);
  return format == GST_VIDEO_FORMAT_UNKNOWN ? "" : gst_video_format_to_string(format);
}

// Those of a field, one or a list of them, that have a name of the other kind.
std::vector<std::string> renamed(const GValue* names, std::string (*rename)(const char*)) {
  std::vector<std::string> found;
  const auto add = [&](const GValue* name) {
    if (!G_VALUE_HOLDS_STRING(name)) return;
    std::string other = rename(g_value_get_string(name));
    if (!other.empty()) found.push_back(std::move(other));
  };
  if (names == nullptr) return found;
  if (!GST_VALUE_HOLDS_LIST(names)) add(names);
  for (guint i = 0; GST_VALUE_HOLDS_LIST(names) && i < gst_value_list_get_size(names); ++i) {
    add(gst_value_list_get_value(names, i));
  }
  return found;
}

void set_names(GstStructure* s, const char* field, const std::vector<std::string>& names) {
  if (names.size() == 1) {
    gst_structure_set(s, field, G_TYPE_STRING, names.front().c_str(), nullptr);
    return;
  }
  GValue list = G_VALUE_INIT;
  g_value_init(&list, GST_TYPE_LIST);
  for (const std::string& name : names) {
    GValue item = G_VALUE_INIT;
    g_value_init(&item, G_TYPE_STRING);
    g_value_set_string(&item, name.c_str());
    gst_value_list_append_and_take_value(&list, &item);
  }
  gst_structure_take_value(s, field, &list);
}

bool is_dma(const GstStructure* s, const GstCapsFeatures* features) {
  const char* format = gst_structure_get_string(s, "format");
  return features != nullptr && gst_caps_features_get_size(features) == 1 &&
         gst_caps_features_contains(features, kDmaMemory) && g_strcmp0(format, kDmaFormat) == 0;
}

// Absent where all that it has is tiled.
GstStructure* mapped_structure(const GstStructure* dma) {
  const auto names = renamed(gst_structure_get_value(dma, "drm-format"), name_when_mapped);
  if (names.empty()) return nullptr;
  GstStructure* mapped = gst_structure_copy(dma);
  gst_structure_remove_field(mapped, "drm-format");
  set_names(mapped, "format", names);
  return mapped;
}

// Absent where the kernel has a name for none of its formats.
GstStructure* dma_structure(const GstStructure* mapped) {
  const auto names = renamed(gst_structure_get_value(mapped, "format"), name_in_dma);
  if (names.empty()) return nullptr;
  GstStructure* dma = gst_structure_copy(mapped);
  gst_structure_set(dma, "format", G_TYPE_STRING, kDmaFormat, nullptr);
  set_names(dma, "drm-format", names);
  return dma;
}

#endif

// Whether the rows are as long as GStreamer says, which counts their bytes in an int.
bool rows_hold(const GstVideoInfo& info) {
  for (guint p = 0; p < GST_VIDEO_INFO_N_PLANES(&info); ++p) {
    if (GST_VIDEO_INFO_PLANE_STRIDE(&info, p) <= 0) return false;
  }
  const GstVideoFormatInfo* f = info.finfo;
  // Tiles have no rows, and a palette has a row of colours, not of pixels.
  if (GST_VIDEO_FORMAT_INFO_IS_TILED(f) || GST_VIDEO_FORMAT_INFO_HAS_PALETTE(f)) return true;
  for (guint c = 0; c < GST_VIDEO_FORMAT_INFO_N_COMPONENTS(f); ++c) {
    const std::int64_t columns = GST_VIDEO_INFO_COMP_WIDTH(&info, c);
    if (columns * GST_VIDEO_FORMAT_INFO_PSTRIDE(f, c) > GST_VIDEO_INFO_COMP_STRIDE(&info, c)) {
      return false;
    }
  }
  return true;
}

// Takes both, or keeps the one.
GstCaps* filtered(GstCaps* caps, GstCaps* filter) {
  if (filter == nullptr) return caps;
  GstCaps* both = gst_caps_intersect_full(filter, caps, GST_CAPS_INTERSECT_FIRST);
  gst_caps_unref(caps);
  return both;
}

}  // namespace

#if GST_CHECK_VERSION(1, 24, 0)

GstCaps* mapped_caps(const GstCaps* caps) {
  if (gst_caps_is_any(caps)) return gst_caps_new_any();
  GstCaps* mapped = gst_caps_new_empty();
  for (guint i = 0; i < gst_caps_get_size(caps); ++i) {
    const GstStructure* s = gst_caps_get_structure(caps, i);
    GstCapsFeatures* features = gst_caps_get_features(caps, i);
    if (!is_dma(s, features)) {
      gst_caps_append_structure_full(mapped, gst_structure_copy(s),
                                     gst_caps_features_copy(features));
    } else if (GstStructure* other = mapped_structure(s); other != nullptr) {
      mapped = gst_caps_merge_structure(mapped, other);
    }
  }
  return mapped;
}

GstCaps* with_dma_caps(GstCaps* caps) {
  caps = gst_caps_make_writable(caps);
  const guint size = gst_caps_get_size(caps);
  for (guint i = 0; i < size; ++i) {
    if (!gst_caps_features_is_equal(gst_caps_get_features(caps, i),
                                    GST_CAPS_FEATURES_MEMORY_SYSTEM_MEMORY)) {
      continue;
    }
    GstStructure* dma = dma_structure(gst_caps_get_structure(caps, i));
    if (dma == nullptr) continue;
    gst_caps_append_structure_full(caps, dma, gst_caps_features_new(kDmaMemory, nullptr));
  }
  return caps;
}

#else

GstCaps* mapped_caps(const GstCaps* caps) { return gst_caps_copy(caps); }

GstCaps* with_dma_caps(GstCaps* caps) { return caps; }

#endif

bool video_info_of(GstVideoInfo& info, const GstCaps* caps) {
  g_autoptr(GstCaps) mapped = mapped_caps(caps);
  return gst_caps_is_fixed(mapped) && gst_video_info_from_caps(&info, mapped) != FALSE &&
         rows_hold(info);
}

GstCaps* share_memory_transform_caps(GstBaseTransform* /*trans*/, GstPadDirection direction,
                                     GstCaps* caps, GstCaps* filter) {
  GstCaps* others = gst_caps_copy(caps);
  others =
      direction == GST_PAD_SINK ? gst_caps_merge(others, mapped_caps(caps)) : with_dma_caps(others);
  return filtered(others, filter);
}

GstCaps* map_memory_transform_caps(GstBaseTransform* /*trans*/, GstPadDirection direction,
                                   GstCaps* caps, GstCaps* filter) {
  GstCaps* others =
      direction == GST_PAD_SINK ? mapped_caps(caps) : with_dma_caps(gst_caps_copy(caps));
  return filtered(others, filter);
}

gboolean set_mapped_caps(GstBaseTransform* trans, GstCaps* in, GstCaps* out) {
  GstVideoInfo info;
  if (!video_info_of(info, in)) return FALSE;
  g_autoptr(GstCaps) mapped = mapped_caps(in);
  auto* parent = GST_BASE_TRANSFORM_CLASS(g_type_class_peek_parent(G_OBJECT_GET_CLASS(trans)));
  return parent->set_caps(trans, mapped, out);
}

gboolean mapped_unit_size(GstBaseTransform* /*trans*/, GstCaps* caps, gsize* size) {
  GstVideoInfo info;
  if (!video_info_of(info, caps)) return FALSE;
  *size = GST_VIDEO_INFO_SIZE(&info);
  return TRUE;
}

}  // namespace calvin::gst
