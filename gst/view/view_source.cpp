// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The child of calibview that is a source of video.

#include <cstdint>
#include <utility>

#include <gst/base/gstpushsrc.h>
#include <gst/video/video.h>

#include "common/element_class.hpp"
#include "common/messages.hpp"
#include "view/scene_painter.hpp"
#include "view/view_caps.hpp"
#include "view/view_elements.hpp"

GST_DEBUG_CATEGORY_EXTERN(calibview_debug);
#define GST_CAT_DEFAULT calibview_debug

using namespace calvin;

namespace {

struct SourceState {
  std::shared_ptr<gst::ViewState> view;
  // Streaming thread.
  gst::ScenePainter painter;
  guint64 frame = 0;       // the next one since the format
  GstClockTime begin = 0;  // its format's first time
};

}  // namespace

G_DECLARE_FINAL_TYPE(GstCalibViewSource, gst_calib_view_source, GST, CALIB_VIEW_SOURCE, GstPushSrc)

struct _GstCalibViewSource {
  GstPushSrc parent;
  SourceState* state;
  GstVideoInfo info;  // object lock to write, and to read off the streaming thread
};

G_DEFINE_FINAL_TYPE(GstCalibViewSource, gst_calib_view_source, GST_TYPE_PUSH_SRC)

static GstVideoInfo gst_calib_view_source_info(GstCalibViewSource* self) {
  GST_OBJECT_LOCK(self);
  const GstVideoInfo info = self->info;
  GST_OBJECT_UNLOCK(self);
  return info;
}

static GstClockTime gst_calib_view_source_time(const GstCalibViewSource* self, guint64 frame) {
  return self->state->begin + gst_util_uint64_scale(frame * GST_SECOND,
                                                    static_cast<guint64>(self->info.fps_d),
                                                    static_cast<guint64>(self->info.fps_n));
}

static gboolean gst_calib_view_source_start(GstBaseSrc* src) {
  GstCalibViewSource* self = GST_CALIB_VIEW_SOURCE(src);
  GST_OBJECT_LOCK(self);
  gst_video_info_init(&self->info);
  GST_OBJECT_UNLOCK(self);
  self->state->frame = 0;
  self->state->begin = 0;
  const Status started = self->state->view->start(GST_ELEMENT(self), false);
  if (!started) gst::post_error(GST_ELEMENT(self), started.error());
  return started.has_value();
}

static gboolean gst_calib_view_source_stop(GstBaseSrc* src) {
  SourceState& state = *GST_CALIB_VIEW_SOURCE(src)->state;
  state.view->stop();
  state.painter.clear();
  return TRUE;
}

static GstCaps* gst_calib_view_source_fixate(GstBaseSrc* src, GstCaps* caps) {
  return GST_BASE_SRC_CLASS(gst_calib_view_source_parent_class)
      ->fixate(src, gst::fixate_view(caps, 1280, 720));
}

static gboolean gst_calib_view_source_set_caps(GstBaseSrc* src, GstCaps* caps) {
  GstCalibViewSource* self = GST_CALIB_VIEW_SOURCE(src);
  GstVideoInfo info;
  if (!gst_video_info_from_caps(&info, caps)) return FALSE;
  // Time goes on where the frames of the rate before ended.
  SourceState& state = *self->state;
  if (GST_VIDEO_INFO_FPS_N(&self->info) > 0) {
    state.begin = gst_calib_view_source_time(self, state.frame);
  }
  state.frame = 0;
  GST_OBJECT_LOCK(self);
  self->info = info;
  GST_OBJECT_UNLOCK(self);
  if (!state.painter.set_format(info)) return FALSE;
  gst_base_src_set_blocksize(src, static_cast<guint>(GST_VIDEO_INFO_SIZE(&info)));
  GST_INFO_OBJECT(self, "makes %" GST_PTR_FORMAT, static_cast<void*>(caps));
  return TRUE;
}

static GstFlowReturn gst_calib_view_source_fill(GstPushSrc* push, GstBuffer* buffer) {
  GstCalibViewSource* self = GST_CALIB_VIEW_SOURCE(push);
  SourceState& state = *self->state;
  const GstClockTime time = gst_calib_view_source_time(self, state.frame);
  if (const Status drawn = state.painter.paint(*state.view, time, buffer); !drawn) {
    gst::post_error(GST_ELEMENT(self), drawn.error());
    return GST_FLOW_ERROR;
  }
  GST_BUFFER_PTS(buffer) = time;
  GST_BUFFER_DTS(buffer) = GST_CLOCK_TIME_NONE;
  GST_BUFFER_DURATION(buffer) = gst_calib_view_source_time(self, state.frame + 1) - time;
  ++state.frame;
  return GST_FLOW_OK;
}

static void gst_calib_view_source_get_times(GstBaseSrc* src, GstBuffer* buffer, GstClockTime* start,
                                            GstClockTime* end) {
  *start = *end = GST_CLOCK_TIME_NONE;
  if (!gst_base_src_is_live(src) || !GST_BUFFER_PTS_IS_VALID(buffer)) return;
  *start = GST_BUFFER_PTS(buffer);
  *end = *start + GST_BUFFER_DURATION(buffer);
}

static gboolean gst_calib_view_source_query(GstBaseSrc* src, GstQuery* query) {
  const GstVideoInfo info = gst_calib_view_source_info(GST_CALIB_VIEW_SOURCE(src));
  if (GST_QUERY_TYPE(query) != GST_QUERY_LATENCY || GST_VIDEO_INFO_FPS_N(&info) <= 0) {
    return GST_BASE_SRC_CLASS(gst_calib_view_source_parent_class)->query(src, query);
  }
  gst_query_set_latency(
      query, gst_base_src_is_live(src),
      gst_util_uint64_scale(GST_SECOND, static_cast<guint64>(GST_VIDEO_INFO_FPS_D(&info)),
                            static_cast<guint64>(GST_VIDEO_INFO_FPS_N(&info))),
      GST_CLOCK_TIME_NONE);
  return TRUE;
}

static gboolean gst_calib_view_source_event(GstBaseSrc* src, GstEvent* event) {
  if (GST_EVENT_TYPE(event) != GST_EVENT_NAVIGATION) {
    return GST_BASE_SRC_CLASS(gst_calib_view_source_parent_class)->event(src, event);
  }
  GstCalibViewSource* self = GST_CALIB_VIEW_SOURCE(src);
  const GstVideoInfo info = gst_calib_view_source_info(self);
  self->state->view->navigate(event, GST_VIDEO_INFO_HEIGHT(&info));
  return TRUE;
}

// Whether it is live has to be known before it starts.
static GstStateChangeReturn gst_calib_view_source_change_state(GstElement* element,
                                                               GstStateChange change) {
  if (change == GST_STATE_CHANGE_READY_TO_PAUSED) {
    const gst::ViewSettings settings = GST_CALIB_VIEW_SOURCE(element)->state->view->settings();
    gst_base_src_set_live(GST_BASE_SRC(element), settings.is_live);
    g_object_set(element, "num-buffers", settings.num_buffers, nullptr);
  }
  return GST_ELEMENT_CLASS(gst_calib_view_source_parent_class)->change_state(element, change);
}

static SourceState& gst_calib_view_source_state(GObject* object) {
  return *GST_CALIB_VIEW_SOURCE(object)->state;
}

static void gst_calib_view_source_init(GstCalibViewSource* self) {
  self->state = new SourceState;
  gst_video_info_init(&self->info);
  gst_base_src_set_format(GST_BASE_SRC(self), GST_FORMAT_TIME);
}

static void gst_calib_view_source_class_init(GstCalibViewSourceClass* klass) {
  auto* element_class = GST_ELEMENT_CLASS(klass);
  auto* base_class = GST_BASE_SRC_CLASS(klass);
  gst::install_finalize<gst_calib_view_source_state>(G_OBJECT_CLASS(klass));
  element_class->change_state = gst_calib_view_source_change_state;
  base_class->start = gst_calib_view_source_start;
  base_class->stop = gst_calib_view_source_stop;
  base_class->fixate = gst_calib_view_source_fixate;
  base_class->set_caps = gst_calib_view_source_set_caps;
  base_class->get_times = gst_calib_view_source_get_times;
  base_class->query = gst_calib_view_source_query;
  base_class->event = gst_calib_view_source_event;
  GST_PUSH_SRC_CLASS(klass)->fill = gst_calib_view_source_fill;
  g_autoptr(GstCaps) caps = gst_caps_from_string(gst::kMadeViewCaps);
  gst_element_class_add_pad_template(
      element_class, gst_pad_template_new("src", GST_PAD_SRC, GST_PAD_ALWAYS, caps));
  gst_element_class_set_static_metadata(element_class, "View of a rig of cameras", "Source/Video",
                                        "Makes pictures of a rig", "The gst-calvin authors");
}

GstElement* gst::new_view_source(std::shared_ptr<ViewState> state) {
  auto* self = GST_CALIB_VIEW_SOURCE(
      g_object_new(gst_calib_view_source_get_type(), "name", "source", nullptr));
  self->state->view = std::move(state);
  return GST_ELEMENT(self);
}
