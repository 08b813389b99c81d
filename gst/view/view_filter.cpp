// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The child of calibview that is a filter: it stands behind calibrig, shows the rig that is solved
// there, and has the times of the frames that come in, of which it looks at nothing else.

#include <string_view>
#include <utility>

#include <gst/base/gstbasetransform.h>
#include <gst/video/video.h>

#include "common/element_class.hpp"
#include "common/messages.hpp"
#include "common/rig_event.hpp"
#include "view/scene_painter.hpp"
#include "view/view_caps.hpp"
#include "view/view_elements.hpp"

GST_DEBUG_CATEGORY_EXTERN(calibview_debug);
#define GST_CAT_DEFAULT calibview_debug

using namespace calvin;

namespace {

struct FilterState {
  std::shared_ptr<gst::ViewState> view;
  gst::ScenePainter painter;  // streaming thread
};

}  // namespace

G_DECLARE_FINAL_TYPE(GstCalibViewFilter, gst_calib_view_filter, GST, CALIB_VIEW_FILTER,
                     GstBaseTransform)

struct _GstCalibViewFilter {
  GstBaseTransform parent;
  FilterState* state;
  GstVideoInfo info;  // of what it makes; object lock
};

G_DEFINE_FINAL_TYPE(GstCalibViewFilter, gst_calib_view_filter, GST_TYPE_BASE_TRANSFORM)

static gboolean gst_calib_view_filter_start(GstBaseTransform* trans) {
  GstCalibViewFilter* self = GST_CALIB_VIEW_FILTER(trans);
  const Status started = self->state->view->start(GST_ELEMENT(self), true);
  if (!started) gst::post_error(GST_ELEMENT(self), started.error());
  return started.has_value();
}

static gboolean gst_calib_view_filter_stop(GstBaseTransform* trans) {
  FilterState& state = *GST_CALIB_VIEW_FILTER(trans)->state;
  state.view->stop();
  state.painter.clear();
  return TRUE;
}

// Of the other side only the rate is known.
static GstCaps* gst_calib_view_filter_transform_caps(GstBaseTransform* trans, GstPadDirection from,
                                                     GstCaps* caps, GstCaps* filter) {
  GstPad* other =
      from == GST_PAD_SINK ? GST_BASE_TRANSFORM_SRC_PAD(trans) : GST_BASE_TRANSFORM_SINK_PAD(trans);
  g_autoptr(GstCaps) any = gst_pad_get_pad_template_caps(other);
  GstCaps* result = gst_caps_new_empty();
  for (guint i = 0; i < gst_caps_get_size(caps); ++i) {
    g_autoptr(GstCaps) one = gst_caps_copy(any);
    const GValue* rate = gst_structure_get_value(gst_caps_get_structure(caps, i), "framerate");
    if (rate != nullptr) gst_caps_set_value(one, "framerate", rate);
    result = gst_caps_merge(result, gst_caps_ref(one));
  }
  if (filter == nullptr) return result;
  GstCaps* wanted = gst_caps_intersect_full(filter, result, GST_CAPS_INTERSECT_FIRST);
  gst_caps_unref(result);
  return wanted;
}

// GstBaseTransform would ask upstream for the size that downstream wants.
static gboolean gst_calib_view_filter_query(GstBaseTransform* trans, GstPadDirection direction,
                                            GstQuery* query) {
  if (direction != GST_PAD_SINK || GST_QUERY_TYPE(query) != GST_QUERY_CAPS) {
    return GST_BASE_TRANSFORM_CLASS(gst_calib_view_filter_parent_class)
        ->query(trans, direction, query);
  }
  GstCaps* filter = nullptr;
  gst_query_parse_caps(query, &filter);
  GstPad* src = GST_BASE_TRANSFORM_SRC_PAD(trans);
  g_autoptr(GstCaps) made = gst_pad_get_pad_template_caps(src);
  g_autoptr(GstCaps) wanted = gst_pad_peer_query_caps(src, made);
  g_autoptr(GstCaps) taken =
      gst_calib_view_filter_transform_caps(trans, GST_PAD_SRC, wanted, filter);
  gst_query_set_caps_result(query, taken);
  return TRUE;
}

// The size of the frames that come in, where downstream has no wish.
static GstCaps* gst_calib_view_filter_fixate_caps(GstBaseTransform* /*trans*/, GstPadDirection from,
                                                  GstCaps* caps, GstCaps* other) {
  if (from != GST_PAD_SINK) return gst_caps_fixate(other);
  int width = 1280;
  int height = 720;
  const GstStructure* s = gst_caps_get_structure(caps, 0);
  (void)gst_structure_get_int(s, "width", &width);
  (void)gst_structure_get_int(s, "height", &height);
  return gst_caps_fixate(gst::fixate_view(other, width, height));
}

static gboolean gst_calib_view_filter_set_caps(GstBaseTransform* trans, GstCaps* /*in*/,
                                               GstCaps* out) {
  GstCalibViewFilter* self = GST_CALIB_VIEW_FILTER(trans);
  GstVideoInfo info;
  if (!gst_video_info_from_caps(&info, out)) return FALSE;
  GST_OBJECT_LOCK(self);
  self->info = info;
  GST_OBJECT_UNLOCK(self);
  GST_INFO_OBJECT(self, "makes %" GST_PTR_FORMAT, static_cast<void*>(out));
  return self->state->painter.set_format(info);
}

static gboolean gst_calib_view_filter_transform_size(GstBaseTransform* trans, GstPadDirection from,
                                                     GstCaps* /*caps*/, gsize size, GstCaps* other,
                                                     gsize* other_size) {
  GstVideoInfo info;
  if (from != GST_PAD_SINK) {
    *other_size = size;
    return TRUE;
  }
  if (!gst_video_info_from_caps(&info, other)) {
    GST_ERROR_OBJECT(trans, "no video: %" GST_PTR_FORMAT, static_cast<void*>(other));
    return FALSE;
  }
  *other_size = GST_VIDEO_INFO_SIZE(&info);
  return TRUE;
}

// What is known of the frame is not true of the picture that takes its place.
static gboolean gst_calib_view_filter_transform_meta(GstBaseTransform* /*trans*/,
                                                     GstBuffer* /*out*/, GstMeta* /*meta*/,
                                                     GstBuffer* /*in*/) {
  return FALSE;
}

static GstFlowReturn gst_calib_view_filter_transform(GstBaseTransform* trans, GstBuffer* in,
                                                     GstBuffer* out) {
  GstCalibViewFilter* self = GST_CALIB_VIEW_FILTER(trans);
  GstClockTime time =
      gst_segment_to_running_time(&trans->segment, GST_FORMAT_TIME, GST_BUFFER_PTS(in));
  if (!GST_CLOCK_TIME_IS_VALID(time)) time = 0;
  FilterState& state = *self->state;
  if (const Status drawn = state.painter.paint(*state.view, time, out); !drawn) {
    gst::post_error(GST_ELEMENT(self), drawn.error());
    return GST_FLOW_ERROR;
  }
  return GST_FLOW_OK;
}

// What events say of the camera of the frames, as how it was held and what it was calibrated to, is
// not true of the picture either.
static bool gst_calib_view_filter_is_of_input(GstEvent* event) {
  if (GST_EVENT_TYPE(event) == GST_EVENT_TAG) return true;
  const GstStructure* s = gst_event_get_structure(event);
  return s != nullptr && std::string_view(gst_structure_get_name(s)).starts_with("calvin-");
}

static gboolean gst_calib_view_filter_sink_event(GstBaseTransform* trans, GstEvent* event) {
  GstCalibViewFilter* self = GST_CALIB_VIEW_FILTER(trans);
  if (const auto json = gst::parse_rig_event(event)) {
    if (const Status shown = self->state->view->show(*json); !shown) {
      gst::post_warning(GST_ELEMENT(self), shown.error());
    }
  } else if (gst_calib_view_filter_is_of_input(event)) {
    gst_event_unref(event);
    return TRUE;
  }
  return GST_BASE_TRANSFORM_CLASS(gst_calib_view_filter_parent_class)->sink_event(trans, event);
}

// The mouse is over this picture, and not over that of the camera.
static gboolean gst_calib_view_filter_src_event(GstBaseTransform* trans, GstEvent* event) {
  if (GST_EVENT_TYPE(event) != GST_EVENT_NAVIGATION) {
    return GST_BASE_TRANSFORM_CLASS(gst_calib_view_filter_parent_class)->src_event(trans, event);
  }
  GstCalibViewFilter* self = GST_CALIB_VIEW_FILTER(trans);
  GST_OBJECT_LOCK(self);
  const int height = GST_VIDEO_INFO_HEIGHT(&self->info);
  GST_OBJECT_UNLOCK(self);
  self->state->view->navigate(event, height);
  gst_event_unref(event);
  return TRUE;
}

static FilterState& gst_calib_view_filter_state(GObject* object) {
  return *GST_CALIB_VIEW_FILTER(object)->state;
}

static void gst_calib_view_filter_init(GstCalibViewFilter* self) {
  self->state = new FilterState;
  gst_video_info_init(&self->info);
}

static void gst_calib_view_filter_class_init(GstCalibViewFilterClass* klass) {
  auto* element_class = GST_ELEMENT_CLASS(klass);
  auto* trans_class = GST_BASE_TRANSFORM_CLASS(klass);
  gst::install_finalize<gst_calib_view_filter_state>(G_OBJECT_CLASS(klass));
  trans_class->start = gst_calib_view_filter_start;
  trans_class->stop = gst_calib_view_filter_stop;
  trans_class->transform_caps = gst_calib_view_filter_transform_caps;
  trans_class->fixate_caps = gst_calib_view_filter_fixate_caps;
  trans_class->set_caps = gst_calib_view_filter_set_caps;
  trans_class->query = gst_calib_view_filter_query;
  trans_class->transform_size = gst_calib_view_filter_transform_size;
  trans_class->transform_meta = gst_calib_view_filter_transform_meta;
  trans_class->transform = gst_calib_view_filter_transform;
  trans_class->sink_event = gst_calib_view_filter_sink_event;
  trans_class->src_event = gst_calib_view_filter_src_event;
  g_autoptr(GstCaps) in = gst_caps_from_string(gst::kViewInputCaps);
  g_autoptr(GstCaps) out = gst_caps_from_string(gst::kAnyViewCaps);
  gst_element_class_add_pad_template(
      element_class, gst_pad_template_new("sink", GST_PAD_SINK, GST_PAD_ALWAYS, in));
  gst_element_class_add_pad_template(element_class,
                                     gst_pad_template_new("src", GST_PAD_SRC, GST_PAD_ALWAYS, out));
  gst_element_class_set_static_metadata(element_class, "View of a rig of cameras", "Filter/Video",
                                        "Makes pictures of the rig that is solved upstream",
                                        "The gst-calvin authors");
}

GstElement* gst::new_view_filter(std::shared_ptr<ViewState> state) {
  auto* self = GST_CALIB_VIEW_FILTER(
      g_object_new(gst_calib_view_filter_get_type(), "name", "filter", nullptr));
  self->state->view = std::move(state);
  return GST_ELEMENT(self);
}
