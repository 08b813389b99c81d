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

#include <mutex>

#include <gst/video/gstvideofilter.h>

#include "calibration_event.hpp"
#include "calibration_input.hpp"
#include "dma_caps.hpp"
#include "elements.hpp"
#include "frame_check.hpp"
#include "frame_mapping.hpp"
#include "frame_part.hpp"
#include "messages.hpp"
#include "meta_filter.hpp"
#include "orientation_tags.hpp"
#include "output_event.hpp"
#include "properties.hpp"
#include "refused_caps.hpp"
#include "undistort_caps.hpp"
#include "undistort_properties.hpp"

GST_DEBUG_CATEGORY_STATIC(calibundistort_debug);
#define GST_CAT_DEFAULT calibundistort_debug

using namespace calvin;
using gst::EventPtr;
using gst::FrameWarp;

namespace {

GParamSpec* output_calibration_spec;

struct State {
  std::mutex lock;
  // Under the lock.
  gst::UndistortSettings settings;
  bool calibration_changed = false;
  std::string output_calibration;
  EventPtr arrived_event;                    // a calibration event, not yet looked at
  std::shared_ptr<const Undistorter> shown;  // how the last frame was moved

  FrameWarp warp;

  // Streaming thread, or before it starts.
  gst::CalibrationInput input;
  gst::OrientationTags tags;
  gst::FrameFormat in;  // as the caps say
  gst::FrameFormat out;
  std::optional<FramePart> part;  // of the last buffer
  bool distort = false;           // the frames that come out have the lens in them
  std::optional<std::pair<gst::FrameFormat, std::optional<FramePart>>> fitted;  // `input` is
  std::optional<bool> live;    // unknown: not asked since the last caps
  bool renegotiated = false;   // since the last update()
  bool frame_refused = false;  // and the user was told so
  gst::OutputEvent output;
};

}  // namespace

struct _GstCalibUndistort {
  GstVideoFilter parent;
  State* state;
};

#define GST_TYPE_CALIB_UNDISTORT (gst_calib_undistort_get_type())
G_DECLARE_FINAL_TYPE(GstCalibUndistort, gst_calib_undistort, GST, CALIB_UNDISTORT, GstVideoFilter)
G_DEFINE_FINAL_TYPE(GstCalibUndistort, gst_calib_undistort, GST_TYPE_VIDEO_FILTER)
GST_ELEMENT_REGISTER_DEFINE_WITH_CODE(
    calibundistort, "calibundistort", GST_RANK_NONE, GST_TYPE_CALIB_UNDISTORT,
    GST_DEBUG_CATEGORY_INIT(calibundistort_debug, "calibundistort", 0, "undistorts video"))

// The settings as they are now. What has changed goes to the input; that of an event is returned.
static gst::UndistortSettings take_settings(State& s, EventPtr& event) {
  const std::lock_guard guard(s.lock);
  if (std::exchange(s.calibration_changed, false)) s.input.set_text(s.settings.calibration);
  event = std::move(s.arrived_event);
  return s.settings;
}

static void set_output_calibration(GstCalibUndistort* self, const std::string& json) {
  {
    const std::lock_guard guard(self->state->lock);
    if (json == std::exchange(self->state->output_calibration, json)) return;
  }
  g_object_notify_by_pspec(G_OBJECT(self), output_calibration_spec);
}

// Tells downstream, and whoever listens to `output-calibration`, what the frames from now on are.
static void announce(GstCalibUndistort* self) {
  State& s = *self->state;
  EventPtr event = s.output.next(s.warp, s.input);
  if (!event) return;
  GST_DEBUG_OBJECT(self, "announces %" GST_PTR_FORMAT, static_cast<void*>(event.get()));
  const auto calibration = gst::parse_calibration_event(event.get());
  gst_pad_push_event(GST_BASE_TRANSFORM_SRC_PAD(self), event.release());
  set_output_calibration(self, calibration ? calibration->json : "");
}

// The calibration is that of the frames with the lens in them.
static void fit_input(State& s) {
  std::pair wanted(s.distort ? s.out : s.in, s.distort ? std::nullopt : s.part);
  auto& [frames, part] = wanted;
  if (part) frames.info = gst::with_size(frames.info, part->size);
  if (s.fitted == wanted) return;
  s.input.set_frames(frames.info, part);
  s.fitted = std::move(wanted);
}

// Brings everything up to date with the properties, the file and the events. Between two frames.
static void update(GstCalibUndistort* self) {
  State& s = *self->state;
  GstBaseTransform* trans = GST_BASE_TRANSFORM(self);
  s.renegotiated = false;
  EventPtr event;
  const gst::UndistortSettings settings = take_settings(s, event);
  if (event) {
    const Status taken = s.input.take_event(event.get());
    if (!taken) gst::post_warning(GST_ELEMENT(self), taken.error());
  }
  if (!s.live) s.live = gst::upstream_is_live(trans);
  s.distort = settings.view.distort();
  const int serial = s.input.serial();
  const auto before = s.warp.current();
  fit_input(s);
  auto errors = s.input.update(gst::CalibrationReader::Clock::now());
  const gst::ViewSettings& view = settings.view;
  const auto more = s.warp.update(s.input, {settings.enabled, view.view(), view.distort(), *s.live,
                                            view.sampling(), view.threads});
  errors.insert(errors.end(), more.begin(), more.end());
  for (const Error& error : errors) gst::post_warning(GST_ELEMENT(self), error);
  if (serial != s.input.serial()) {
    GST_INFO_OBJECT(self, "%s calibration", s.input.camera() ? "takes a" : "has no");
  }
  if (before != s.warp.current()) GST_DEBUG_OBJECT(self, "%s", s.warp.describe().c_str());
  {
    const std::lock_guard guard(s.lock);
    s.shown = s.warp.current();
  }
  const bool passthrough = !s.warp.current() && !s.warp.must_move();
  if (passthrough != (gst_base_transform_is_passthrough(trans) != FALSE)) {
    gst_base_transform_set_passthrough(trans, passthrough);
    // Upstream got downstream's buffers while the frames passed through.
    gst_base_transform_reconfigure_sink(trans);
    gst_base_transform_reconfigure_src(trans);
  }
  announce(self);
}

// The frame may be another part of the buffer's picture from now on.
static void follow_crop(GstCalibUndistort* self, GstBuffer* buffer) {
  State& s = *self->state;
  const auto part = gst::part_of(buffer, s.in.info);
  if (part == std::exchange(s.part, part)) return;
  GST_DEBUG_OBJECT(self, "the frame is %s of the picture in memory", part ? "a part" : "all");
  gst::FrameFormat in = s.in;
  if (part) in.info = gst::with_size(s.in.info, part->size);
  s.warp.set_frames(in, s.out, part);
}

static void gst_calib_undistort_before_transform(GstBaseTransform* trans, GstBuffer* buffer) {
  GstCalibUndistort* self = GST_CALIB_UNDISTORT(trans);
  State& s = *self->state;
  if (!s.warp.has_frames()) return;
  follow_crop(self, buffer);
  const auto times = gst::frame_times(&trans->segment, buffer);
  if (GST_CLOCK_TIME_IS_VALID(times.stream_time)) {
    gst_object_sync_values(GST_OBJECT(self), times.stream_time);
  }
  update(self);
  s.warp.begin();
  GST_LOG_OBJECT(self, "%s: %" GST_PTR_FORMAT, s.warp.describe().c_str(),
                 static_cast<void*>(buffer));
}

// GstBaseTransform looks after before_transform whether downstream wants other frames.
static GstFlowReturn gst_calib_undistort_prepare_output_buffer(GstBaseTransform* trans,
                                                               GstBuffer* in, GstBuffer** out) {
  GstCalibUndistort* self = GST_CALIB_UNDISTORT(trans);
  if (self->state->renegotiated) {
    follow_crop(self, in);
    update(self);
  }
  return GST_BASE_TRANSFORM_CLASS(gst_calib_undistort_parent_class)
      ->prepare_output_buffer(trans, in, out);
}

static GstFlowReturn gst_calib_undistort_transform_frame(GstVideoFilter* filter, GstVideoFrame* in,
                                                         GstVideoFrame* out) {
  const Status done = GST_CALIB_UNDISTORT(filter)->state->warp.apply(*in, *out);
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
  State& s = *GST_CALIB_UNDISTORT(trans)->state;
  const GstVideoInfo whole =
      s.part ? gst::with_size(filter->in_info, s.part->whole) : filter->in_info;
  if (const Status readable = gst::check_frame(whole, in); !readable) {
    GST_WARNING_OBJECT(trans, "drops a frame: %s", readable.error().message.c_str());
    if (!std::exchange(s.frame_refused, true)) {
      gst::post_warning(
          GST_ELEMENT(trans),
          {readable.error().code, readable.error().message + " Such frames are left out."});
    }
    return GST_BASE_TRANSFORM_FLOW_DROPPED;
  }
  if (const Status writable = gst::check_frame(filter->out_info, out); !writable) {
    gst::post_error(GST_ELEMENT(trans), writable.error());
    return GST_FLOW_ERROR;
  }
  return GST_BASE_TRANSFORM_CLASS(gst_calib_undistort_parent_class)->transform(trans, in, out);
}

static gboolean gst_calib_undistort_transform_meta(GstBaseTransform* trans, GstBuffer* out,
                                                   GstMeta* meta, GstBuffer* in) {
  const auto& current = GST_CALIB_UNDISTORT(trans)->state->warp.current();
  if (current) {
    const gst::MetaFate fate = gst::map_meta(*current, in, meta, out);
    if (fate != gst::MetaFate::kOthers) return fate == gst::MetaFate::kCopy;
  }
  return GST_BASE_TRANSFORM_CLASS(gst_calib_undistort_parent_class)
      ->transform_meta(trans, out, meta, in);
}

// GstVideoFilter knows no frames in DMA memory.
static gboolean gst_calib_undistort_set_caps(GstBaseTransform* trans, GstCaps* in, GstCaps* out) {
  GstVideoInfo info;
  if (!gst::video_info_of(info, in)) return FALSE;
  g_autoptr(GstCaps) mapped = gst::mapped_caps(in);
  return GST_BASE_TRANSFORM_CLASS(gst_calib_undistort_parent_class)->set_caps(trans, mapped, out);
}

static gboolean gst_calib_undistort_set_info(GstVideoFilter* filter, GstCaps* in_caps,
                                             GstVideoInfo* in_info, GstCaps* out_caps,
                                             GstVideoInfo* out_info) {
  State& s = *GST_CALIB_UNDISTORT(filter)->state;
  const gst::FrameFormat in(*in_info, in_caps);
  const gst::FrameFormat out(*out_info, out_caps);
  if (s.warp.has_frames() && s.in == in && s.out == out) return TRUE;
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
  s.warp.set_frames(in, out);
  s.live.reset();
  s.renegotiated = true;
  return TRUE;
}

static gboolean gst_calib_undistort_sink_event(GstBaseTransform* trans, GstEvent* event) {
  GstCalibUndistort* self = GST_CALIB_UNDISTORT(trans);
  State& s = *self->state;
  if (gst::CalibrationInput::is_calibration(event)) {
    GST_DEBUG_OBJECT(self, "got %" GST_PTR_FORMAT, static_cast<void*>(event));
    // It goes on as it is, or as the calibration of the output. The peer's event is not serialized:
    // it waits for the next frame, as any does before the first caps.
    const bool now =
        GST_EVENT_TYPE(event) == GST_EVENT_CUSTOM_DOWNSTREAM_STICKY && s.warp.has_frames();
    {
      const std::lock_guard guard(s.lock);
      s.arrived_event.reset(event);
    }
    if (now) update(self);
    return TRUE;
  }
  if (s.tags.take(event)) s.input.set_upright(s.tags.upright());
  return GST_BASE_TRANSFORM_CLASS(gst_calib_undistort_parent_class)->sink_event(trans, event);
}

static gboolean gst_calib_undistort_src_event(GstBaseTransform* trans, GstEvent* event) {
  State& s = *GST_CALIB_UNDISTORT(trans)->state;
  // The peer's event goes both ways: cameracalibrate may stand behind this element.
  if (gst::CalibrationInput::is_calibration(event)) {
    const std::lock_guard guard(s.lock);
    s.arrived_event.reset(gst_event_ref(event));
  }
  if (GST_EVENT_TYPE(event) == GST_EVENT_NAVIGATION) {
    std::shared_ptr<const Undistorter> shown;
    {
      const std::lock_guard guard(s.lock);
      shown = s.shown;
    }
    if (shown) event = gst::map_navigation(*shown, event);
  }
  return GST_BASE_TRANSFORM_CLASS(gst_calib_undistort_parent_class)->src_event(trans, event);
}

static gboolean gst_calib_undistort_start(GstBaseTransform* trans) {
  GstCalibUndistort* self = GST_CALIB_UNDISTORT(trans);
  State& s = *self->state;
  s.output.reset();
  s.tags.reset();
  EventPtr stale;
  take_settings(s, stale);
  s.fitted.reset();
  set_output_calibration(self, "");
  gst_base_transform_set_passthrough(trans, TRUE);
  for (const Error& error : s.input.start()) {
    if (error.code != ErrorCode::kNotFound) {
      gst::post_error(GST_ELEMENT(self), error);
      s.input.stop();
      return FALSE;
    }
    gst::post_warning(GST_ELEMENT(self), error);
  }
  const Status started = s.warp.start();
  if (!started) gst::post_error(GST_ELEMENT(self), started.error());
  return started.has_value();
}

static gboolean gst_calib_undistort_stop(GstBaseTransform* trans) {
  State& s = *GST_CALIB_UNDISTORT(trans)->state;
  s.input.stop();
  s.warp.stop();
  s.output.reset();
  const std::lock_guard guard(s.lock);
  s.shown.reset();
  return TRUE;
}

static GstStateChangeReturn gst_calib_undistort_change_state(GstElement* element,
                                                             GstStateChange change) {
  // A build on the streaming thread would hold the state change up.
  if (change == GST_STATE_CHANGE_PAUSED_TO_READY) {
    GST_CALIB_UNDISTORT(element)->state->warp.cancel();
  }
  return GST_ELEMENT_CLASS(gst_calib_undistort_parent_class)->change_state(element, change);
}

static void gst_calib_undistort_set_property(GObject* object, guint id, const GValue* value,
                                             GParamSpec* pspec) {
  State& s = *GST_CALIB_UNDISTORT(object)->state;
  {
    const std::lock_guard guard(s.lock);
    s.calibration_changed |= gst::tells_calibration(id);
    if (!gst::undistort_field(s.settings, id).set(value)) {
      G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, pspec);
    }
  }
  if (const char* other = gst::other_name(id)) g_object_notify(object, other);
}

static void gst_calib_undistort_get_property(GObject* object, guint id, GValue* value,
                                             GParamSpec* pspec) {
  State& s = *GST_CALIB_UNDISTORT(object)->state;
  const std::lock_guard guard(s.lock);
  if (id == gst::kUndistortOutputCalibration) {
    gst::set_string(value, s.output_calibration);
  } else if (!gst::undistort_field(s.settings, id).get(value)) {
    G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, pspec);
  }
}

static void gst_calib_undistort_finalize(GObject* object) {
  delete GST_CALIB_UNDISTORT(object)->state;
  G_OBJECT_CLASS(gst_calib_undistort_parent_class)->finalize(object);
}

static void gst_calib_undistort_init(GstCalibUndistort* self) {
  self->state = new State;
  gst_base_transform_set_passthrough(GST_BASE_TRANSFORM(self), TRUE);
  gst::explain_refused_caps(GST_ELEMENT(self));
}

static void gst_calib_undistort_class_init(GstCalibUndistortClass* klass) {
  auto* object_class = G_OBJECT_CLASS(klass);
  auto* element_class = GST_ELEMENT_CLASS(klass);
  auto* trans_class = GST_BASE_TRANSFORM_CLASS(klass);
  auto* filter_class = GST_VIDEO_FILTER_CLASS(klass);
  object_class->set_property = gst_calib_undistort_set_property;
  object_class->get_property = gst_calib_undistort_get_property;
  object_class->finalize = gst_calib_undistort_finalize;
  element_class->change_state = gst_calib_undistort_change_state;
  trans_class->start = gst_calib_undistort_start;
  trans_class->stop = gst_calib_undistort_stop;
  trans_class->sink_event = gst_calib_undistort_sink_event;
  trans_class->src_event = gst_calib_undistort_src_event;
  trans_class->transform_caps = gst::undistort_transform_caps;
  trans_class->fixate_caps = gst::undistort_fixate_caps;
  trans_class->set_caps = gst_calib_undistort_set_caps;
  trans_class->get_unit_size = gst::mapped_unit_size;
  trans_class->propose_allocation = gst::propose_uncropped_allocation;
  trans_class->before_transform = gst_calib_undistort_before_transform;
  trans_class->prepare_output_buffer = gst_calib_undistort_prepare_output_buffer;
  trans_class->transform = gst_calib_undistort_transform;
  trans_class->transform_meta = gst_calib_undistort_transform_meta;
  trans_class->transform_ip_on_passthrough = FALSE;
  filter_class->set_info = gst_calib_undistort_set_info;
  filter_class->transform_frame = gst_calib_undistort_transform_frame;
  gst::install_undistort_properties(object_class);
  output_calibration_spec = g_object_class_find_property(object_class, "output-calibration");
  gst::add_undistort_pads(element_class);
  gst_element_class_set_static_metadata(
      element_class, "Camera undistortion", "Filter/Effect/Video",
      "Makes straight lines straight with the calibration of the camera", "The gst-calvin authors");
}
