// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

/**
 * SECTION:element-calibundistort
 * @title: calibundistort
 * @short_description: makes straight lines straight
 *
 * Undistorts video with a calibration: the file or text in #GstCalibUndistort:calibration, or else
 * the `calvin-calibration` event of a `calibsolve` upstream. Without a calibration the frames pass
 * through untouched and are not copied. What it tells its neighbours downstream is the calibration
 * of its own output, a pinhole camera.
 *
 * ## Example launch line
 * |[
 * gst-launch-1.0 v4l2src ! videoconvert ! calibundistort calibration=cam.json ! autovideosink
 * ]|
 */

#include <gst/video/gstvideofilter.h>

#include "common/calibration_event.hpp"
#include "common/element_class.hpp"
#include "common/frames/dma_caps.hpp"
#include "common/frames/frame_part.hpp"
#include "common/frames/mapped_frame.hpp"
#include "common/frames/meta_filter.hpp"
#include "common/frames/refused_caps.hpp"
#include "common/messages.hpp"
#include "common/rig_event.hpp"
#include "elements.hpp"
#include "undistort/frame_mapping.hpp"
#include "undistort/undistort_caps.hpp"
#include "undistort/undistort_properties.hpp"
#include "undistort/undistort_state.hpp"

GST_DEBUG_CATEGORY(calibundistort_debug);
#define GST_CAT_DEFAULT calibundistort_debug

using namespace calvin;
using gst::EventPtr;

struct _GstCalibUndistort {
  GstVideoFilter parent;
  gst::UndistortState* state;
};

#define GST_TYPE_CALIB_UNDISTORT (gst_calib_undistort_get_type())
G_DECLARE_FINAL_TYPE(GstCalibUndistort, gst_calib_undistort, GST, CALIB_UNDISTORT, GstVideoFilter)
G_DEFINE_FINAL_TYPE(GstCalibUndistort, gst_calib_undistort, GST_TYPE_VIDEO_FILTER)
GST_ELEMENT_REGISTER_DEFINE_WITH_CODE(
    calibundistort, "calibundistort", GST_RANK_NONE, GST_TYPE_CALIB_UNDISTORT,
    GST_DEBUG_CATEGORY_INIT(calibundistort_debug, "calibundistort", 0, "undistorts video"))

static gst::UndistortState& gst_calib_undistort_state(GObject* object) {
  return *GST_CALIB_UNDISTORT(object)->state;
}

static void gst_calib_undistort_before_transform(GstBaseTransform* trans, GstBuffer* buffer) {
  GstCalibUndistort* self = GST_CALIB_UNDISTORT(trans);
  gst::UndistortState& s = *self->state;
  if (!s.undistorter.has_frames()) return;
  s.follow_crop(buffer);
  const auto times = gst::frame_times(&trans->segment, buffer);
  if (GST_CLOCK_TIME_IS_VALID(times.stream_time)) {
    gst_object_sync_values(GST_OBJECT(self), times.stream_time);
  }
  s.update();
  s.undistorter.begin();
  GST_LOG_OBJECT(self, "%s: %" GST_PTR_FORMAT, s.undistorter.describe().c_str(),
                 static_cast<void*>(buffer));
}

// GstBaseTransform looks after before_transform whether downstream wants other frames.
static GstFlowReturn gst_calib_undistort_prepare_output_buffer(GstBaseTransform* trans,
                                                               GstBuffer* in, GstBuffer** out) {
  gst::UndistortState& s = *GST_CALIB_UNDISTORT(trans)->state;
  if (s.renegotiated) {
    s.follow_crop(in);
    s.update();
  }
  return GST_BASE_TRANSFORM_CLASS(gst_calib_undistort_parent_class)
      ->prepare_output_buffer(trans, in, out);
}

static GstFlowReturn gst_calib_undistort_transform_frame(GstVideoFilter* filter, GstVideoFrame* in,
                                                         GstVideoFrame* out) {
  const Status done = GST_CALIB_UNDISTORT(filter)->state->undistorter.apply(*in, *out);
  if (done) return GST_FLOW_OK;
  if (done.error().code == ErrorCode::kCancelled) return GST_FLOW_FLUSHING;
  GST_ELEMENT_ERROR(filter, STREAM, FORMAT, ("%s", done.error().message.c_str()), (nullptr));
  return GST_FLOW_ERROR;
}

// GstVideoFilter would send on what the output's memory held before for a frame that cannot be
// read. One such frame does not stop the others.
static GstFlowReturn gst_calib_undistort_transform(GstBaseTransform* trans, GstBuffer* in,
                                                   GstBuffer* out) {
  GstVideoFilter* filter = GST_VIDEO_FILTER(trans);
  gst::UndistortState& s = *GST_CALIB_UNDISTORT(trans)->state;
  const GstVideoInfo whole =
      s.part ? gst::with_size(filter->in_info, s.part->whole) : filter->in_info;
  auto from = gst::MappedFrame::map(whole, in);
  if (!from) {
    GST_WARNING_OBJECT(trans, "drops a frame: %s", from.error().message.c_str());
    if (!std::exchange(s.frame_refused, true)) {
      gst::post_warning(GST_ELEMENT(trans),
                        {from.error().code, from.error().message + " Such frames are left out."});
    }
    return GST_BASE_TRANSFORM_FLOW_DROPPED;
  }
  auto to = gst::MappedFrame::map(filter->out_info, out, GST_MAP_WRITE);
  if (!to) {
    gst::post_error(GST_ELEMENT(trans), to.error());
    return GST_FLOW_ERROR;
  }
  return gst_calib_undistort_transform_frame(filter, &**from, &**to);
}

static gboolean gst_calib_undistort_transform_meta(GstBaseTransform* trans, GstBuffer* out,
                                                   GstMeta* meta, GstBuffer* in) {
  const auto& current = GST_CALIB_UNDISTORT(trans)->state->undistorter.current();
  if (current) {
    const gst::MetaFate fate = gst::map_meta(*current, in, meta, out);
    if (fate != gst::MetaFate::kOthers) return fate == gst::MetaFate::kCopy;
  }
  return GST_BASE_TRANSFORM_CLASS(gst_calib_undistort_parent_class)
      ->transform_meta(trans, out, meta, in);
}

static gboolean gst_calib_undistort_set_info(GstVideoFilter* filter, GstCaps* in_caps,
                                             GstVideoInfo* in_info, GstCaps* out_caps,
                                             GstVideoInfo* out_info) {
  gst::UndistortState& s = *GST_CALIB_UNDISTORT(filter)->state;
  const gst::FrameFormat in(*in_info, in_caps);
  const gst::FrameFormat out(*out_info, out_caps);
  if (s.undistorter.has_frames() && s.in == in && s.out == out) return TRUE;
  if (const Status moves = gst::check_move(in, out); !moves) {
    gst::post_error(GST_ELEMENT(filter), moves.error());
    return FALSE;
  }
  GST_INFO_OBJECT(filter, "%" GST_PTR_FORMAT " become %" GST_PTR_FORMAT,
                  static_cast<void*>(in_caps), static_cast<void*>(out_caps));
  s.in = in;
  s.out = out;
  s.part.reset();  // until the next buffer says more
  s.frame_refused = false;
  s.undistorter.set_frames(in, out);
  s.live.reset();
  s.renegotiated = true;
  return TRUE;
}

static gboolean gst_calib_undistort_sink_event(GstBaseTransform* trans, GstEvent* event) {
  GstCalibUndistort* self = GST_CALIB_UNDISTORT(trans);
  gst::UndistortState& s = *self->state;
  if (gst::CalibrationInput::is_calibration(event)) {
    GST_DEBUG_OBJECT(self, "got %" GST_PTR_FORMAT, static_cast<void*>(event));
    // It goes on as it is, or as the calibration of the output. The peer's event is not serialized:
    // it waits for the next frame, as any does before the first caps.
    const bool now =
        GST_EVENT_TYPE(event) == GST_EVENT_CUSTOM_DOWNSTREAM_STICKY && s.undistorter.has_frames();
    s.keep_event(EventPtr(event));
    if (now) s.update();
    return TRUE;
  }
  if (gst::parse_rig_event(event)) s.keep_rig_event(EventPtr(gst_event_ref(event)));
  if (s.tags.take(event)) s.input.set_upright(s.tags.upright());
  return GST_BASE_TRANSFORM_CLASS(gst_calib_undistort_parent_class)->sink_event(trans, event);
}

static gboolean gst_calib_undistort_src_event(GstBaseTransform* trans, GstEvent* event) {
  gst::UndistortState& s = *GST_CALIB_UNDISTORT(trans)->state;
  // The peer's event goes both ways: cameracalibrate may stand behind this element.
  if (gst::CalibrationInput::is_calibration(event)) {
    s.keep_event(EventPtr(gst_event_ref(event)));
  }
  if (GST_EVENT_TYPE(event) == GST_EVENT_NAVIGATION) {
    if (const auto shown = s.shown()) event = gst::map_navigation(*shown, event);
  }
  return GST_BASE_TRANSFORM_CLASS(gst_calib_undistort_parent_class)->src_event(trans, event);
}

static void gst_calib_undistort_init(GstCalibUndistort* self) {
  self->state = new gst::UndistortState(GST_BASE_TRANSFORM(self));
  gst_base_transform_set_passthrough(GST_BASE_TRANSFORM(self), TRUE);
  gst::explain_refused_caps(GST_ELEMENT(self));
}

static void gst_calib_undistort_class_init(GstCalibUndistortClass* klass) {
  auto* object_class = G_OBJECT_CLASS(klass);
  gst::install_finalize<gst_calib_undistort_state>(object_class);
  gst::install_properties<gst_calib_undistort_state, gst::kUndistortProperties>(object_class);
  auto* trans_class = GST_BASE_TRANSFORM_CLASS(klass);
  gst::install_start_and_stop<gst_calib_undistort_state>(trans_class);
  gst::install_pixel_filter(trans_class);
  trans_class->sink_event = gst_calib_undistort_sink_event;
  trans_class->src_event = gst_calib_undistort_src_event;
  trans_class->transform_caps = gst::undistort_transform_caps;
  trans_class->fixate_caps = gst::undistort_fixate_caps;
  trans_class->before_transform = gst_calib_undistort_before_transform;
  trans_class->prepare_output_buffer = gst_calib_undistort_prepare_output_buffer;
  trans_class->transform = gst_calib_undistort_transform;
  trans_class->transform_meta = gst_calib_undistort_transform_meta;
  GST_VIDEO_FILTER_CLASS(klass)->set_info = gst_calib_undistort_set_info;
  GST_VIDEO_FILTER_CLASS(klass)->transform_frame = gst_calib_undistort_transform_frame;
  gst::add_undistort_pads(GST_ELEMENT_CLASS(klass));
  gst_element_class_set_static_metadata(
      GST_ELEMENT_CLASS(klass), "Camera undistortion", "Filter/Effect/Video",
      "Makes straight lines straight with the calibration of the camera", "The gst-calvin authors");
}
