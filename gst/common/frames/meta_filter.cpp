// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Filters that are passthrough for pixels and attach metas, and filters that change pixels.

#include "common/frames/meta_filter.hpp"

#include <gst/video/video.h>

#include "common/frames/dma_caps.hpp"

namespace calvin::gst {

namespace {

// What downstream does with frames of these caps, asked under the name that they have there.
void ask_about_mapped(GstBaseTransform* trans, GstCaps* mapped, GstQuery* query) {
  g_autoptr(GstQuery) asked = gst_query_new_allocation(mapped, FALSE);
  if (!gst_pad_peer_query(GST_BASE_TRANSFORM_SRC_PAD(trans), asked)) return;
  for (guint i = 0; i < gst_query_get_n_allocation_metas(asked); ++i) {
    const GstStructure* parameters = nullptr;
    const GType api = gst_query_parse_nth_allocation_meta(asked, i, &parameters);
    gst_query_add_allocation_meta(query, api, parameters);
  }
}

// Whether a query about frames in DMA memory was answered, which go on under another name or as
// other frames. They bring their memory along.
bool answer_dma_query(GstBaseTransform* trans, bool passthrough, GstQuery* query) {
  GstCaps* caps = nullptr;
  gst_query_parse_allocation(query, &caps, nullptr);
  if (caps == nullptr) return false;
  g_autoptr(GstCaps) out = gst_pad_get_current_caps(GST_BASE_TRANSFORM_SRC_PAD(trans));
  g_autoptr(GstCaps) mapped = mapped_caps(caps);
  if (gst_caps_is_equal(mapped, caps) || (out != nullptr && gst_caps_is_equal(out, caps))) {
    return false;
  }
  if (passthrough) ask_about_mapped(trans, mapped, query);
  if (!gst_query_find_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr)) {
    gst_query_add_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr);
  }
  return true;
}

// The input itself where it is writable, else a copy that shares its memory.
GstFlowReturn share_input_buffer(GstBaseTransform* /*trans*/, GstBuffer* in, GstBuffer** out) {
  *out = gst_buffer_is_writable(in) ? in : gst_buffer_copy(in);
  return GST_FLOW_OK;
}

// For a class derived directly from GStreamer's: as its parent, without the crop meta that a sink
// may offer. Frames then are as large as their caps. For frames in DMA memory that go on as others
// no pool is proposed.
gboolean propose_uncropped_allocation(GstBaseTransform* trans, GstQuery* decide_query,
                                      GstQuery* query) {
  auto* parent = GST_BASE_TRANSFORM_CLASS(g_type_class_peek_parent(G_OBJECT_GET_CLASS(trans)));
  if (!answer_dma_query(trans, decide_query == nullptr, query) &&
      !parent->propose_allocation(trans, decide_query, query)) {
    return FALSE;
  }
  guint index = 0;
  while (gst_query_find_allocation_meta(query, GST_VIDEO_CROP_META_API_TYPE, &index)) {
    gst_query_remove_nth_allocation_meta(query, index);
  }
  return TRUE;
}

}  // namespace

void install_meta_filter(GstBaseTransformClass* trans_class) {
  trans_class->transform_caps = share_memory_transform_caps;
  trans_class->prepare_output_buffer = share_input_buffer;
  trans_class->propose_allocation = propose_uncropped_allocation;
  trans_class->transform_ip_on_passthrough = TRUE;
  add_raw_video_pads(GST_ELEMENT_CLASS(trans_class));
}

void install_pixel_filter(GstBaseTransformClass* trans_class) {
  trans_class->set_caps = set_mapped_caps;
  trans_class->get_unit_size = mapped_unit_size;
  trans_class->propose_allocation = propose_uncropped_allocation;
  trans_class->transform_ip_on_passthrough = FALSE;
}

void configure_meta_filter(GstBaseTransform* trans) {
  gst_base_transform_set_in_place(trans, TRUE);
  gst_base_transform_set_passthrough(trans, TRUE);
  gst_base_transform_set_qos_enabled(trans, FALSE);
}

void add_raw_video_pads(GstElementClass* element_class) {
  g_autoptr(GstCaps) caps =
      with_dma_caps(gst_caps_from_string(CALVIN_RAW_CAPS(GST_VIDEO_FORMATS_ALL)));
  gst_element_class_add_pad_template(
      element_class, gst_pad_template_new("sink", GST_PAD_SINK, GST_PAD_ALWAYS, caps));
  gst_element_class_add_pad_template(
      element_class, gst_pad_template_new("src", GST_PAD_SRC, GST_PAD_ALWAYS, caps));
}

std::optional<bool> upstream_says_live(GstPad* sink) {
  g_autoptr(GstQuery) query = gst_query_new_latency();
  if (!gst_pad_peer_query(sink, query)) return std::nullopt;
  gboolean live = FALSE;
  gst_query_parse_latency(query, &live, nullptr, nullptr);
  return live != FALSE;
}

// As splitmuxsrc, which does not answer the LATENCY query.
static bool upstream_is_recorded(GstPad* sink) {
  g_autoptr(GstQuery) duration = gst_query_new_duration(GST_FORMAT_TIME);
  if (gst_pad_peer_query(sink, duration)) {
    gint64 length = -1;
    gst_query_parse_duration(duration, nullptr, &length);
    if (length > 0) return true;
  }
  g_autoptr(GstQuery) seeking = gst_query_new_seeking(GST_FORMAT_TIME);
  if (!gst_pad_peer_query(sink, seeking)) return false;
  gboolean seekable = FALSE;
  gst_query_parse_seeking(seeking, nullptr, &seekable, nullptr, nullptr);
  return seekable != FALSE;
}

bool upstream_is_live(GstPad* sink) {
  if (const auto said = upstream_says_live(sink)) return *said;
  return !upstream_is_recorded(sink);
}

}  // namespace calvin::gst
