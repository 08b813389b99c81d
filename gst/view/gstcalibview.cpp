// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibview: shows where the cameras of a rig stand.

/**
 * SECTION:element-calibview
 * @title: calibview
 *
 * A source of video that shows the cameras of a rig in space: where they stand, what they look at,
 * and how well that is known. The view goes slowly around the rig; a mouse in the window of the
 * sink turns it, and its wheel comes closer.
 *
 * ## Example launch line
 * |[
 * gst-launch-1.0 calibview rig=rig.json ! videoconvert ! autovideosink
 * ]|
 */

#include <algorithm>
#include <cstdint>
#include <optional>

#include <gst/base/gstpushsrc.h>
#include <gst/video/navigation.h>
#include <gst/video/video.h>

#include "common/element_class.hpp"
#include "common/frames/frame_planes.hpp"
#include "common/messages.hpp"
#include "elements.hpp"
#include "view/view_state.hpp"

GST_DEBUG_CATEGORY(calibview_debug);
#define GST_CAT_DEFAULT calibview_debug

G_DECLARE_FINAL_TYPE(GstCalibView, gst_calib_view, GST, CALIB_VIEW, GstPushSrc)

using namespace calvin;

// BGRx where downstream has no wish: what is drawn needs no conversion then.
static constexpr char kCaps[] =
    "video/x-raw, format = (string) " CALVIN_PLANE_FORMATS
    ", "
    "width = (int) [ 16, 8192 ], height = (int) [ 16, 8192 ], "
    "framerate = (fraction) [ 1, 240 ], pixel-aspect-ratio = (fraction) 1/1, "
    "interlace-mode = (string) progressive";

struct _GstCalibView {
  GstPushSrc parent;
  gst::ViewState* state;
  GstVideoInfo info;  // object lock to write, and to read off the streaming thread
  // Streaming thread.
  GstVideoInfo drawn;            // BGRx of the size of `info`
  GstVideoConverter* converter;  // from that; nullptr where that is what is wanted
  GstBuffer* canvas;             // likewise
  guint64 frame;                 // the next one since the format
  GstClockTime begin;            // its format's first time
  // Object lock: where a button is held, px.
  gboolean is_held;
  double mouse_x;
  double mouse_y;
};

G_DEFINE_FINAL_TYPE(GstCalibView, gst_calib_view, GST_TYPE_PUSH_SRC)
GST_ELEMENT_REGISTER_DEFINE_WITH_CODE(calibview, "calibview", GST_RANK_NONE,
                                      gst_calib_view_get_type(),
                                      GST_DEBUG_CATEGORY_INIT(calibview_debug, "calibview", 0,
                                                              "view of a rig of cameras"))

static gst::ViewState& gst_calib_view_state(GObject* object) {
  return *GST_CALIB_VIEW(object)->state;
}

static GstVideoInfo gst_calib_view_info(GstCalibView* self) {
  GST_OBJECT_LOCK(self);
  const GstVideoInfo info = self->info;
  GST_OBJECT_UNLOCK(self);
  return info;
}

static GstClockTime gst_calib_view_time(const GstCalibView* self, guint64 frame) {
  return self->begin + gst_util_uint64_scale(frame * GST_SECOND,
                                             static_cast<guint64>(self->info.fps_d),
                                             static_cast<guint64>(self->info.fps_n));
}

static void gst_calib_view_drop_converter(GstCalibView* self) {
  if (self->converter != nullptr) gst_video_converter_free(self->converter);
  self->converter = nullptr;
  gst_clear_buffer(&self->canvas);
}

static gboolean gst_calib_view_start(GstBaseSrc* src) {
  GstCalibView* self = GST_CALIB_VIEW(src);
  GST_OBJECT_LOCK(self);
  gst_video_info_init(&self->info);
  self->is_held = FALSE;
  GST_OBJECT_UNLOCK(self);
  self->frame = 0;
  self->begin = 0;
  const Status started = self->state->start();
  if (!started) gst::post_error(GST_ELEMENT(self), started.error());
  return started.has_value();
}

static gboolean gst_calib_view_stop(GstBaseSrc* src) {
  GST_CALIB_VIEW(src)->state->stop();
  gst_calib_view_drop_converter(GST_CALIB_VIEW(src));
  return TRUE;
}

// As it is drawn where that may be, and not in grey where colours may be: a converter before an
// encoder of both lists what the encoder takes first.
static GstCaps* gst_calib_view_prefer_colours(GstCaps* caps) {
  for (const char* format : {"BGRx", "RGBx", "RGBA", "RGB"}) {
    g_autoptr(GstCaps) wish =
        gst_caps_new_simple("video/x-raw", "format", G_TYPE_STRING, format, nullptr);
    GstCaps* both = gst_caps_intersect_full(caps, wish, GST_CAPS_INTERSECT_FIRST);
    if (!gst_caps_is_empty(both)) {
      gst_caps_unref(caps);
      return both;
    }
    gst_caps_unref(both);
  }
  return caps;
}

static GstCaps* gst_calib_view_fixate(GstBaseSrc* src, GstCaps* caps) {
  caps = gst_calib_view_prefer_colours(caps);
  caps = gst_caps_make_writable(gst_caps_truncate(caps));
  GstStructure* s = gst_caps_get_structure(caps, 0);
  gst_structure_fixate_field_string(s, "format", "BGRx");
  gst_structure_fixate_field_nearest_int(s, "width", 1280);
  gst_structure_fixate_field_nearest_int(s, "height", 720);
  gst_structure_fixate_field_nearest_fraction(s, "framerate", 25, 1);
  return GST_BASE_SRC_CLASS(gst_calib_view_parent_class)->fixate(src, caps);
}

static gboolean gst_calib_view_set_caps(GstBaseSrc* src, GstCaps* caps) {
  GstCalibView* self = GST_CALIB_VIEW(src);
  GstVideoInfo info;
  if (!gst_video_info_from_caps(&info, caps)) return FALSE;
  // Time goes on where the frames of the rate before ended.
  if (GST_VIDEO_INFO_FPS_N(&self->info) > 0) self->begin = gst_calib_view_time(self, self->frame);
  self->frame = 0;
  GST_OBJECT_LOCK(self);
  self->info = info;
  GST_OBJECT_UNLOCK(self);
  gst_calib_view_drop_converter(self);
  gst_video_info_set_format(&self->drawn, GST_VIDEO_FORMAT_BGRx,
                            static_cast<guint>(GST_VIDEO_INFO_WIDTH(&info)),
                            static_cast<guint>(GST_VIDEO_INFO_HEIGHT(&info)));
  // A converter wants both sides to be of one rate.
  GST_VIDEO_INFO_FPS_N(&self->drawn) = GST_VIDEO_INFO_FPS_N(&info);
  GST_VIDEO_INFO_FPS_D(&self->drawn) = GST_VIDEO_INFO_FPS_D(&info);
  if (GST_VIDEO_INFO_FORMAT(&info) != GST_VIDEO_FORMAT_BGRx) {
    self->converter = gst_video_converter_new(&self->drawn, &info, nullptr);
    if (self->converter == nullptr) return FALSE;
    self->canvas = gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&self->drawn), nullptr);
  }
  gst_base_src_set_blocksize(src, static_cast<guint>(GST_VIDEO_INFO_SIZE(&info)));
  GST_INFO_OBJECT(self, "makes %" GST_PTR_FORMAT, static_cast<void*>(caps));
  return TRUE;
}

// Draws BGRx.
static Status gst_calib_view_draw(GstCalibView* self, GstClockTime time, GstBuffer* buffer) {
  GstVideoFrame frame;
  if (!gst_video_frame_map(&frame, &self->drawn, buffer, GST_MAP_READWRITE)) {
    return make_error(ErrorCode::kIo, "The frame's memory cannot be written.");
  }
  Status drawn =
      self->state->draw(time, {GST_VIDEO_FRAME_WIDTH(&frame), GST_VIDEO_FRAME_HEIGHT(&frame)},
                        static_cast<std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, 0)),
                        GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0));
  gst_video_frame_unmap(&frame);
  return drawn;
}

static Status gst_calib_view_convert(GstCalibView* self, GstBuffer* to) {
  GstVideoFrame from_frame;
  GstVideoFrame to_frame;
  if (!gst_video_frame_map(&from_frame, &self->drawn, self->canvas, GST_MAP_READ)) {
    return make_error(ErrorCode::kIo, "The drawing cannot be read.");
  }
  const bool mapped = gst_video_frame_map(&to_frame, &self->info, to, GST_MAP_WRITE) != FALSE;
  if (mapped) {
    gst_video_converter_frame(self->converter, &from_frame, &to_frame);
    gst_video_frame_unmap(&to_frame);
  }
  gst_video_frame_unmap(&from_frame);
  if (!mapped) return make_error(ErrorCode::kIo, "The frame's memory cannot be written.");
  return {};
}

static GstFlowReturn gst_calib_view_fill(GstPushSrc* push, GstBuffer* buffer) {
  GstCalibView* self = GST_CALIB_VIEW(push);
  const GstClockTime time = gst_calib_view_time(self, self->frame);
  const bool is_direct = self->converter == nullptr;
  Status drawn = gst_calib_view_draw(self, time, is_direct ? buffer : self->canvas);
  if (drawn && !is_direct) drawn = gst_calib_view_convert(self, buffer);
  if (!drawn) {
    gst::post_error(GST_ELEMENT(self), drawn.error());
    return GST_FLOW_ERROR;
  }
  GST_BUFFER_PTS(buffer) = time;
  GST_BUFFER_DTS(buffer) = GST_CLOCK_TIME_NONE;
  GST_BUFFER_DURATION(buffer) = gst_calib_view_time(self, self->frame + 1) - time;
  ++self->frame;
  return GST_FLOW_OK;
}

static void gst_calib_view_get_times(GstBaseSrc* src, GstBuffer* buffer, GstClockTime* start,
                                     GstClockTime* end) {
  *start = *end = GST_CLOCK_TIME_NONE;
  if (!gst_base_src_is_live(src) || !GST_BUFFER_PTS_IS_VALID(buffer)) return;
  *start = GST_BUFFER_PTS(buffer);
  *end = *start + GST_BUFFER_DURATION(buffer);
}

static gboolean gst_calib_view_query(GstBaseSrc* src, GstQuery* query) {
  const GstVideoInfo info = gst_calib_view_info(GST_CALIB_VIEW(src));
  if (GST_QUERY_TYPE(query) != GST_QUERY_LATENCY || GST_VIDEO_INFO_FPS_N(&info) <= 0) {
    return GST_BASE_SRC_CLASS(gst_calib_view_parent_class)->query(src, query);
  }
  gst_query_set_latency(
      query, gst_base_src_is_live(src),
      gst_util_uint64_scale(GST_SECOND, static_cast<guint64>(GST_VIDEO_INFO_FPS_D(&info)),
                            static_cast<guint64>(GST_VIDEO_INFO_FPS_N(&info))),
      GST_CLOCK_TIME_NONE);
  return TRUE;
}

// ---- The mouse: any thread ----------------------------------------------------------------------

// How far it went with a button held since it was asked last, px; absent where none is.
static std::optional<Pixel> gst_calib_view_dragged(GstCalibView* self, double x, double y) {
  std::optional<Pixel> way;
  GST_OBJECT_LOCK(self);
  if (self->is_held) way = Pixel{x - self->mouse_x, y - self->mouse_y};
  self->mouse_x = x;
  self->mouse_y = y;
  GST_OBJECT_UNLOCK(self);
  return way;
}

static void gst_calib_view_hold(GstCalibView* self, bool is_held, double x, double y) {
  GST_OBJECT_LOCK(self);
  self->is_held = is_held;
  self->mouse_x = x;
  self->mouse_y = y;
  GST_OBJECT_UNLOCK(self);
}

static void gst_calib_view_navigate(GstCalibView* self, GstEvent* event) {
  const GstVideoInfo info = gst_calib_view_info(self);
  const int height = std::max(1, GST_VIDEO_INFO_HEIGHT(&info));
  double x = 0;
  double y = 0;
  int button = 0;
  switch (gst_navigation_event_get_type(event)) {
    case GST_NAVIGATION_EVENT_MOUSE_BUTTON_PRESS:
      gst_navigation_event_parse_mouse_button_event(event, &button, &x, &y);
      if (button == 1) gst_calib_view_hold(self, true, x, y);
      if (button == 4 || button == 5) self->state->zoom_by(button == 4 ? 1 : -1);
      break;
    case GST_NAVIGATION_EVENT_MOUSE_BUTTON_RELEASE:
      gst_navigation_event_parse_mouse_button_event(event, &button, &x, &y);
      if (button == 1) gst_calib_view_hold(self, false, x, y);
      break;
    case GST_NAVIGATION_EVENT_MOUSE_MOVE:
      gst_navigation_event_parse_mouse_move_event(event, &x, &y);
      if (const auto way = gst_calib_view_dragged(self, x, y)) {
        self->state->drag_by(way->u / height, way->v / height);
      }
      break;
    case GST_NAVIGATION_EVENT_MOUSE_SCROLL: {
      double across = 0;
      double up = 0;
      gst_navigation_event_parse_mouse_scroll_event(event, &x, &y, &across, &up);
      if (up != 0) self->state->zoom_by(up > 0 ? 1 : -1);
      break;
    }
    default:
      break;
  }
}

static gboolean gst_calib_view_event(GstBaseSrc* src, GstEvent* event) {
  if (GST_EVENT_TYPE(event) == GST_EVENT_NAVIGATION) {
    gst_calib_view_navigate(GST_CALIB_VIEW(src), event);
    return TRUE;
  }
  return GST_BASE_SRC_CLASS(gst_calib_view_parent_class)->event(src, event);
}

// ---- Class --------------------------------------------------------------------------------------

static void gst_calib_view_init(GstCalibView* self) {
  self->state = new gst::ViewState(GST_BASE_SRC(self));
  gst_video_info_init(&self->info);
  gst_base_src_set_format(GST_BASE_SRC(self), GST_FORMAT_TIME);
}

static void gst_calib_view_class_init(GstCalibViewClass* klass) {
  auto* object_class = G_OBJECT_CLASS(klass);
  auto* element_class = GST_ELEMENT_CLASS(klass);
  auto* base_class = GST_BASE_SRC_CLASS(klass);
  gst::install_finalize<gst_calib_view_state>(object_class);
  gst::install_dispose<gst_calib_view_state>(object_class);
  gst::install_properties<gst_calib_view_state, gst::kViewProperties>(object_class);
  base_class->start = gst_calib_view_start;
  base_class->stop = gst_calib_view_stop;
  base_class->fixate = gst_calib_view_fixate;
  base_class->set_caps = gst_calib_view_set_caps;
  base_class->get_times = gst_calib_view_get_times;
  base_class->query = gst_calib_view_query;
  base_class->event = gst_calib_view_event;
  GST_PUSH_SRC_CLASS(klass)->fill = gst_calib_view_fill;
  g_autoptr(GstCaps) caps = gst_caps_from_string(kCaps);
  gst_element_class_add_pad_template(
      element_class, gst_pad_template_new("src", GST_PAD_SRC, GST_PAD_ALWAYS, caps));
  gst_element_class_set_static_metadata(
      element_class, "View of a rig of cameras", "Source/Video",
      "Shows where the cameras of a rig stand, and what they look at", "The gst-calvin authors");
}
