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
#include "calvin/io/calibration_io.hpp"
#include "elements.hpp"
#include "frame_check.hpp"
#include "frame_planes.hpp"
#include "messages.hpp"
#include "meta_filter.hpp"
#include "metas.hpp"
#include "properties.hpp"
#include "refused_caps.hpp"
#include "undistorter_builder.hpp"

GST_DEBUG_CATEGORY_STATIC(calibundistort_debug);
#define GST_CAT_DEFAULT calibundistort_debug

using namespace calvin;
using gst::EventPtr;
using gst::UndistorterBuilder;

namespace {

enum Property { kCalibration = 1, kEnabled, kAlpha, kOutputCalibration, kProperties };
GParamSpec* properties[kProperties];

struct Settings {
  std::string calibration;
  bool enabled = true;
  double alpha = 0;
};

struct State {
  std::mutex lock;
  // Under the lock.
  Settings settings;
  bool calibration_changed = false;
  std::string output_calibration;
  EventPtr arrived_event;  // a calibration event, not yet looked at

  UndistorterBuilder builder;

  // Streaming thread, or before it starts.
  gst::CalibrationInput input;
  GstVideoInfo info{};
  std::vector<gst::FramePlane> planes;
  bool live = false;
  bool streaming = false;  // a frame of this format has passed
  std::optional<UndistorterBuilder::Key> requested;
  std::shared_ptr<const Undistorter> active;
  EventPtr output_event;  // the calibration of what `active` gives
  EventPtr sent_event;    // what downstream knows
};

EventPtr event_of(const Camera& camera, const std::string& name) {
  Calibration calibration = camera.to_calibration();
  calibration.camera = name;
  return EventPtr(gst::new_calibration_event({name, print_calibration(calibration).value_or("")}));
}

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
static Settings take_settings(State& s, EventPtr& event) {
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
  g_object_notify_by_pspec(G_OBJECT(self), properties[kOutputCalibration]);
}

// Makes what was built the one in use, unless the calibration has changed meanwhile.
static void adopt(GstCalibUndistort* self, const UndistorterBuilder::Built& built) {
  State& s = *self->state;
  if (built.key.camera != s.input.serial()) return;
  if (!built.undistorter) {
    if (built.undistorter.error().code != ErrorCode::kCancelled) {
      gst::post_warning(GST_ELEMENT(self), built.undistorter.error());
    }
    return;
  }
  s.active = *built.undistorter;
  s.output_event = event_of(s.active->output(), s.input.name());
  GST_INFO_OBJECT(self, "undistorting, alpha %f", built.key.alpha);
}

// Sees to it that the undistorter for the camera and `alpha` is in use, or will be soon: what runs
// live goes on as it is until a worker is done, everything else waits for it.
static void ensure_undistorter(GstCalibUndistort* self, double alpha) {
  State& s = *self->state;
  if (const auto built = s.builder.take()) adopt(self, *built);
  const UndistorterBuilder::Key key = {s.input.serial(), alpha};
  if (s.requested == key) return;
  s.requested = key;
  UndistorterBuilder::Request request = {key, *s.input.camera(), {}};
  for (const gst::FramePlane& plane : s.planes) request.planes.push_back(plane.layout);
  if (s.live && s.streaming) {
    s.builder.offer(std::move(request));
  } else {
    adopt(self, s.builder.build(request));
  }
}

// Tells downstream, and whoever listens to `output-calibration`, what the frames from now on are.
static void announce(GstCalibUndistort* self, bool undistorting) {
  State& s = *self->state;
  EventPtr event;
  if (undistorting) {
    event.reset(gst_event_ref(s.output_event.get()));
  } else if (s.input.event() != nullptr) {
    event.reset(gst_event_ref(s.input.event()));
  } else if (s.sent_event && s.sent_event == s.output_event) {
    event = s.input.camera() ? event_of(*s.input.camera(), s.input.name())
                             : EventPtr(gst::new_calibration_event({}));
  }
  if (!event || event == s.sent_event) return;
  gst_pad_push_event(GST_BASE_TRANSFORM_SRC_PAD(self), gst_event_ref(event.get()));
  const auto calibration = gst::parse_calibration_event(event.get());
  s.sent_event = std::move(event);
  set_output_calibration(self, calibration ? calibration->json : "");
}

// Brings everything up to date with the properties, the file and the events. Between two frames.
static void update(GstCalibUndistort* self) {
  State& s = *self->state;
  EventPtr event;
  const Settings settings = take_settings(s, event);
  if (event) {
    const Status taken = s.input.take_event(event.get());
    if (!taken) gst::post_warning(GST_ELEMENT(self), taken.error());
  }
  for (const Error& error : s.input.update(gst::CalibrationSetting::Clock::now())) {
    gst::post_warning(GST_ELEMENT(self), error);
  }
  if (!s.input.camera()) {
    s.active.reset();
    s.requested.reset();
  } else if (settings.enabled) {
    ensure_undistorter(self, settings.alpha);
  }
  const bool undistorting = settings.enabled && s.active;
  GstBaseTransform* trans = GST_BASE_TRANSFORM(self);
  if (undistorting == gst_base_transform_is_passthrough(trans)) {
    gst_base_transform_set_passthrough(trans, !undistorting);
    // Upstream got downstream's buffers while the frames passed through.
    gst_base_transform_reconfigure_sink(trans);
    gst_base_transform_reconfigure_src(trans);
  }
  announce(self, undistorting);
}

static void gst_calib_undistort_before_transform(GstBaseTransform* trans, GstBuffer* buffer) {
  GstCalibUndistort* self = GST_CALIB_UNDISTORT(trans);
  State& s = *self->state;
  if (s.planes.empty()) return;
  const auto times = gst::frame_times(&trans->segment, buffer);
  if (GST_CLOCK_TIME_IS_VALID(times.stream_time)) {
    gst_object_sync_values(GST_OBJECT(self), times.stream_time);
  }
  if (!s.streaming) s.live = gst::upstream_is_live(trans);
  update(self);
  s.streaming = true;
}

static GstFlowReturn gst_calib_undistort_transform_frame(GstVideoFilter* filter, GstVideoFrame* in,
                                                         GstVideoFrame* out) {
  GstCalibUndistort* self = GST_CALIB_UNDISTORT(filter);
  State& s = *self->state;
  for (std::size_t i = 0; i < s.planes.size(); ++i) {
    const auto source = gst::memory_of(*in, s.planes[i]);
    s.active->apply(i, {source.data, source.stride}, gst::memory_of(*out, s.planes[i]));
  }
  return GST_FLOW_OK;
}

// GstVideoFilter would send on what the output's memory held before for a frame that cannot be
// read.
static GstFlowReturn gst_calib_undistort_transform(GstBaseTransform* trans, GstBuffer* in,
                                                   GstBuffer* out) {
  GstVideoFilter* filter = GST_VIDEO_FILTER(trans);
  for (const auto& [info, buffer] : {std::pair(filter->in_info, in), {filter->out_info, out}}) {
    if (const Status checked = gst::check_frame(info, buffer); !checked) {
      gst::post_error(GST_ELEMENT(trans), checked.error());
      return GST_FLOW_ERROR;
    }
  }
  return GST_BASE_TRANSFORM_CLASS(gst_calib_undistort_parent_class)->transform(trans, in, out);
}

static gboolean gst_calib_undistort_transform_meta(GstBaseTransform* trans, GstBuffer* out,
                                                   GstMeta* meta, GstBuffer* in) {
  State& s = *GST_CALIB_UNDISTORT(trans)->state;
  if (gst_meta_info_is_custom(meta->info) &&
      gst_custom_meta_has_name(reinterpret_cast<GstCustomMeta*>(meta), gst::kObservationName)) {
    std::vector<Observation> mapped;
    for (const Observation& o : gst::read_observations(in))
      mapped.push_back(s.active->to_output(o));
    gst::attach_observations(out, mapped);
    return FALSE;
  }
  // It tells of the session and has no place in the picture.
  if (gst_meta_info_is_custom(meta->info) &&
      gst_custom_meta_has_name(reinterpret_cast<GstCustomMeta*>(meta), gst::kGuidanceName)) {
    return TRUE;
  }
  return GST_BASE_TRANSFORM_CLASS(gst_calib_undistort_parent_class)
      ->transform_meta(trans, out, meta, in);
}

static gboolean gst_calib_undistort_set_info(GstVideoFilter* filter, GstCaps* /*in_caps*/,
                                             GstVideoInfo* in, GstCaps* /*out_caps*/,
                                             GstVideoInfo* /*out*/) {
  State& s = *GST_CALIB_UNDISTORT(filter)->state;
  if (!s.planes.empty() && gst_video_info_is_equal(&s.info, in)) return TRUE;
  s.info = *in;
  s.planes = gst::planes_of(*in);
  s.input.set_frames(*in);
  s.streaming = false;
  s.requested.reset();
  s.active.reset();
  return TRUE;
}

static gboolean gst_calib_undistort_sink_event(GstBaseTransform* trans, GstEvent* event) {
  GstCalibUndistort* self = GST_CALIB_UNDISTORT(trans);
  State& s = *self->state;
  if (gst::CalibrationInput::is_calibration(event)) {
    // It goes on as it is, or as the calibration of the output. The peer's event is not serialized:
    // it waits for the next frame, as any does before the first caps.
    const bool now =
        GST_EVENT_TYPE(event) == GST_EVENT_CUSTOM_DOWNSTREAM_STICKY && !s.planes.empty();
    {
      const std::lock_guard guard(s.lock);
      s.arrived_event.reset(event);
    }
    if (now) update(self);
    return TRUE;
  }
  return GST_BASE_TRANSFORM_CLASS(gst_calib_undistort_parent_class)->sink_event(trans, event);
}

// The peer's event goes both ways: cameracalibrate may stand behind this element.
static gboolean gst_calib_undistort_src_event(GstBaseTransform* trans, GstEvent* event) {
  if (gst::CalibrationInput::is_calibration(event)) {
    State& s = *GST_CALIB_UNDISTORT(trans)->state;
    const std::lock_guard guard(s.lock);
    s.arrived_event.reset(gst_event_ref(event));
  }
  return GST_BASE_TRANSFORM_CLASS(gst_calib_undistort_parent_class)->src_event(trans, event);
}

static gboolean gst_calib_undistort_start(GstBaseTransform* trans) {
  GstCalibUndistort* self = GST_CALIB_UNDISTORT(trans);
  State& s = *self->state;
  s.planes.clear();
  s.sent_event.reset();
  s.requested.reset();
  s.active.reset();
  EventPtr stale;
  take_settings(s, stale);
  s.input.reset();
  set_output_calibration(self, "");
  gst_base_transform_set_passthrough(trans, TRUE);
  for (const Error& error : s.input.update(gst::CalibrationSetting::Clock::now())) {
    if (error.code != ErrorCode::kNotFound) {
      gst::post_error(GST_ELEMENT(self), error);
      return FALSE;
    }
    gst::post_warning(GST_ELEMENT(self), error);
  }
  s.builder.start();
  return TRUE;
}

static gboolean gst_calib_undistort_stop(GstBaseTransform* trans) {
  State& s = *GST_CALIB_UNDISTORT(trans)->state;
  s.builder.stop();
  s.active.reset();
  return TRUE;
}

static GstStateChangeReturn gst_calib_undistort_change_state(GstElement* element,
                                                             GstStateChange change) {
  // A build on the streaming thread would hold the state change up.
  if (change == GST_STATE_CHANGE_PAUSED_TO_READY) {
    GST_CALIB_UNDISTORT(element)->state->builder.cancel();
  }
  return GST_ELEMENT_CLASS(gst_calib_undistort_parent_class)->change_state(element, change);
}

static void gst_calib_undistort_set_property(GObject* object, guint id, const GValue* value,
                                             GParamSpec* pspec) {
  State& s = *GST_CALIB_UNDISTORT(object)->state;
  const std::lock_guard guard(s.lock);
  switch (id) {
    case kCalibration:
      s.settings.calibration = gst::string_of(value);
      s.calibration_changed = true;
      break;
    case kEnabled:
      s.settings.enabled = g_value_get_boolean(value);
      break;
    case kAlpha:
      s.settings.alpha = g_value_get_double(value);
      break;
    default:
      G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, pspec);
  }
}

static void gst_calib_undistort_get_property(GObject* object, guint id, GValue* value,
                                             GParamSpec* pspec) {
  State& s = *GST_CALIB_UNDISTORT(object)->state;
  const std::lock_guard guard(s.lock);
  switch (id) {
    case kCalibration:
      gst::set_string(value, s.settings.calibration);
      break;
    case kEnabled:
      g_value_set_boolean(value, s.settings.enabled);
      break;
    case kAlpha:
      g_value_set_double(value, s.settings.alpha);
      break;
    case kOutputCalibration:
      gst::set_string(value, s.output_calibration);
      break;
    default:
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

static void install_properties(GObjectClass* object_class) {
  properties[kCalibration] = g_param_spec_string(
      "calibration", "Calibration",
      "The calibration: a file (native JSON, OpenCV, ROS), which may appear later and is read "
      "again when it is replaced; or JSON text; or the settings of cameraundistort; or a list such "
      "as fx=500,fy=500,cx=319.5,cy=239.5,k1=-0.2,width=640,height=480. Empty: the calibration "
      "event of an element upstream",
      nullptr, gst::kMutablePlaying);
  properties[kEnabled] = g_param_spec_boolean("enabled", "Enabled",
                                              "Undistort; off: the frames pass through untouched",
                                              TRUE, gst::kMutablePlaying);
  properties[kAlpha] = g_param_spec_double(
      "alpha", "Alpha",
      "What the output shows. 0: the largest view without an invalid pixel; 1: every valid pixel "
      "of the input, at most 150 degrees; between: moves linearly from one to the other",
      0, 1, 0, static_cast<GParamFlags>(gst::kMutablePlaying | GST_PARAM_CONTROLLABLE));
  properties[kOutputCalibration] =
      g_param_spec_string("output-calibration", "Output Calibration",
                          "The calibration of the output as native JSON: a pinhole camera while it "
                          "is undistorted, what came from upstream while it passes through",
                          nullptr, gst::kReadOnly);
  g_object_class_install_properties(object_class, kProperties, properties);
}

static void add_pads(GstElementClass* element_class) {
  g_autoptr(GstCaps) caps =
      gst_caps_from_string(GST_VIDEO_CAPS_MAKE("{ GRAY8, I420, NV12, YUY2, BGRx }"));
  gst_element_class_add_pad_template(
      element_class, gst_pad_template_new("sink", GST_PAD_SINK, GST_PAD_ALWAYS, caps));
  gst_element_class_add_pad_template(
      element_class, gst_pad_template_new("src", GST_PAD_SRC, GST_PAD_ALWAYS, caps));
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
  trans_class->propose_allocation = gst::propose_uncropped_allocation;
  trans_class->before_transform = gst_calib_undistort_before_transform;
  trans_class->transform = gst_calib_undistort_transform;
  trans_class->transform_meta = gst_calib_undistort_transform_meta;
  trans_class->transform_ip_on_passthrough = FALSE;
  filter_class->set_info = gst_calib_undistort_set_info;
  filter_class->transform_frame = gst_calib_undistort_transform_frame;
  install_properties(object_class);
  add_pads(element_class);
  gst_element_class_set_static_metadata(
      element_class, "Camera undistortion", "Filter/Effect/Video",
      "Makes straight lines straight with the calibration of the camera", "The gst-calvin authors");
}
