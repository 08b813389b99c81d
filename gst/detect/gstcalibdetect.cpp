// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibdetect: finds boards in the frames that pass and attaches what it found.

/**
 * SECTION:element-calibdetect
 * @title: calibdetect
 *
 * Finds calibration boards and attaches the corners to the buffers as the custom meta
 * `calvin-observation`. Pixels are never touched and, on live pipelines, never waited for.
 *
 * ## Example launch line
 * |[
 * gst-launch-1.0 -m v4l2src ! calibdetect board=checkerboard:9x6:25mm post-messages=true ! fakesink
 * ]|
 */

#include <gst/base/gstbasetransform.h>
#include <gst/video/video.h>

#include "common/field.hpp"
#include "common/frames/dma_caps.hpp"
#include "common/frames/meta_filter.hpp"
#include "common/frames/refused_caps.hpp"
#include "common/messages.hpp"
#include "common/metas.hpp"
#include "common/properties.hpp"
#include "detect/calib_detector.hpp"
#include "elements.hpp"

GST_DEBUG_CATEGORY(calibdetect_debug);
#define GST_CAT_DEFAULT calibdetect_debug

G_DECLARE_FINAL_TYPE(GstCalibDetect, gst_calib_detect, GST, CALIB_DETECT, GstBaseTransform)

using namespace calvin;

struct _GstCalibDetect {
  GstBaseTransform parent;
  gst::CalibDetector* detector;
};

G_DEFINE_FINAL_TYPE_WITH_CODE(GstCalibDetect, gst_calib_detect, GST_TYPE_BASE_TRANSFORM,
                              G_IMPLEMENT_INTERFACE(GST_TYPE_PRESET, nullptr))
GST_ELEMENT_REGISTER_DEFINE_WITH_CODE(calibdetect, "calibdetect", GST_RANK_NONE,
                                      gst_calib_detect_get_type(),
                                      GST_DEBUG_CATEGORY_INIT(calibdetect_debug, "calibdetect", 0,
                                                              "calibration board detector"))

enum {
  PROP_0,
  PROP_BOARD,
  PROP_CAMERA,
  PROP_MODE,
  PROP_MAX_RATE,
  PROP_POST_MESSAGES,
  PROP_RECHECK,
  PROP_STATS,
};

static GType gst_calib_detect_mode_get_type() {
  static const GEnumValue kValues[] = {
      {gst::kModeAuto, "Async when the source is live, sync otherwise", "auto"},
      {gst::kModeSync, "The streaming thread waits: each frame carries its own corners", "sync"},
      {gst::kModeAsync, "Nothing waits: newest frame only, corners ride on a later frame", "async"},
      {0, nullptr, nullptr}};
  static const GType kType = g_enum_register_static("GstCalibDetectMode", kValues);
  return kType;
}

static gst::Field gst_calib_detect_field(gst::DetectorSettings& settings, guint id) {
  switch (id) {
    case PROP_BOARD:
      return settings.board;
    case PROP_CAMERA:
      return settings.camera;
    case PROP_MODE:
      return settings.mode;
    case PROP_MAX_RATE:
      return settings.max_rate;
    case PROP_POST_MESSAGES:
      return settings.post_messages;
    case PROP_RECHECK:
      return settings.recheck;
    default:
      return {};
  }
}

static void gst_calib_detect_set_property(GObject* object, guint id, const GValue* value,
                                          GParamSpec* spec) {
  GST_CALIB_DETECT(object)->detector->change_settings([&](gst::DetectorSettings& settings) {
    if (gst_calib_detect_field(settings, id).set(value)) return;
    G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, spec);
  });
}

static void gst_calib_detect_get_property(GObject* object, guint id, GValue* value,
                                          GParamSpec* spec) {
  gst::CalibDetector& detector = *GST_CALIB_DETECT(object)->detector;
  gst::DetectorSettings settings = detector.settings();
  if (id == PROP_STATS) {
    g_value_take_boxed(value, detector.stats());
  } else if (!gst_calib_detect_field(settings, id).get(value)) {
    G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, spec);
  }
}

static GstFlowReturn gst_calib_detect_transform_ip(GstBaseTransform* trans, GstBuffer* buffer) {
  gst::CalibDetector& detector = *GST_CALIB_DETECT(trans)->detector;
  if (!detector.has_format()) {
    gst::post_error(GST_ELEMENT(trans),
                    {ErrorCode::kMalformed,
                     "A frame came before the caps that say what it is: set the caps upstream, "
                     "with caps=... of appsrc or a capsfilter."});
    return GST_FLOW_NOT_NEGOTIATED;
  }
  // Asked once after each CAPS: only then does a live source know that it is one.
  if (!detector.mode_known()) detector.choose_mode(gst::upstream_is_live(trans));
  const auto earlier = detector.take_waiting();
  if (earlier) gst::attach_observations(buffer, *earlier);
  const auto found = detector.look(buffer, gst::frame_times(&trans->segment, buffer));
  if (found) gst::attach_observations(buffer, *found);
  return GST_FLOW_OK;
}

static gboolean gst_calib_detect_set_caps(GstBaseTransform* trans, GstCaps* caps,
                                          GstCaps* /*out_caps*/) {
  GstVideoInfo info;
  if (!gst::video_info_of(info, caps)) return FALSE;
  const Status set = GST_CALIB_DETECT(trans)->detector->set_format(info);
  if (!set) gst::post_error(GST_ELEMENT(trans), set.error());
  return set.has_value();
}

// A result that no buffer took goes ahead of the event that ends its segment of the stream.
static void gst_calib_detect_push_waiting(GstCalibDetect* self) {
  const auto result = self->detector->take_waiting();
  if (!result) return;
  GST_DEBUG_OBJECT(self, "what no frame could take goes ahead as an event");
  gst_pad_push_event(
      GST_BASE_TRANSFORM_SRC_PAD(self),
      gst_event_new_custom(GST_EVENT_CUSTOM_DOWNSTREAM, gst::observations_to_structure(*result)));
}

static gboolean gst_calib_detect_src_event(GstBaseTransform* trans, GstEvent* event) {
  if (GST_EVENT_TYPE(event) == GST_EVENT_CUSTOM_UPSTREAM &&
      gst_event_has_name(event, gst::kWantPatchesName)) {
    GST_INFO_OBJECT(trans, "corners are sent with the pixels around them from now on");
    GST_CALIB_DETECT(trans)->detector->send_patches();
    gst_event_unref(event);
    return TRUE;
  }
  return GST_BASE_TRANSFORM_CLASS(gst_calib_detect_parent_class)->src_event(trans, event);
}

static gboolean gst_calib_detect_sink_event(GstBaseTransform* trans, GstEvent* event) {
  GstCalibDetect* self = GST_CALIB_DETECT(trans);
  gst::CalibDetector& detector = *self->detector;
  switch (GST_EVENT_TYPE(event)) {
    case GST_EVENT_EOS:
      detector.drain();
      gst_calib_detect_push_waiting(self);
      break;
    case GST_EVENT_CAPS:
    case GST_EVENT_SEGMENT:
      gst_calib_detect_push_waiting(self);
      detector.next_segment();
      break;
    case GST_EVENT_FLUSH_START:
      detector.cancel();
      break;
    case GST_EVENT_FLUSH_STOP:
      detector.resume();
      detector.next_segment();
      break;
    default:
      break;
  }
  return GST_BASE_TRANSFORM_CLASS(gst_calib_detect_parent_class)->sink_event(trans, event);
}

static gboolean gst_calib_detect_start(GstBaseTransform* trans) {
  const Status started = GST_CALIB_DETECT(trans)->detector->start();
  if (!started) gst::post_error(GST_ELEMENT(trans), started.error());
  return started.has_value();
}

static gboolean gst_calib_detect_stop(GstBaseTransform* trans) {
  GST_CALIB_DETECT(trans)->detector->stop();
  return TRUE;
}

static GstStateChangeReturn gst_calib_detect_change_state(GstElement* element,
                                                          GstStateChange change) {
  // Before the pads are deactivated: that waits for the streaming thread, which may be waiting.
  if (change == GST_STATE_CHANGE_PAUSED_TO_READY) GST_CALIB_DETECT(element)->detector->cancel();
  return GST_ELEMENT_CLASS(gst_calib_detect_parent_class)->change_state(element, change);
}

static void gst_calib_detect_dispose(GObject* object) {
  // From here on no job begins to post in the name of the element.
  GST_CALIB_DETECT(object)->detector->stop();
  G_OBJECT_CLASS(gst_calib_detect_parent_class)->dispose(object);
}

static void gst_calib_detect_finalize(GObject* object) {
  delete GST_CALIB_DETECT(object)->detector;
  G_OBJECT_CLASS(gst_calib_detect_parent_class)->finalize(object);
}

static void gst_calib_detect_init(GstCalibDetect* self) {
  self->detector = new gst::CalibDetector(GST_ELEMENT(self));
  gst::configure_meta_filter(GST_BASE_TRANSFORM(self));
  gst::explain_refused_caps(GST_ELEMENT(self));
}

static void gst_calib_detect_install_properties(GObjectClass* object_class) {
  g_object_class_install_property(
      object_class, PROP_BOARD,
      g_param_spec_string("board", "Board",
                          "The board to find, KIND:COLSxROWS:SIZE with inner corners and the side "
                          "of a square, or FILE.json#NAME; several separated by ;",
                          kDefaultBoard.data(), gst::kMutablePlaying));
  g_object_class_install_property(
      object_class, PROP_CAMERA,
      g_param_spec_string("camera", "Camera", "Name of the camera in metas, messages and files",
                          "cam0", gst::kMutablePlaying));
  g_object_class_install_property(
      object_class, PROP_MODE,
      g_param_spec_enum("mode", "Mode",
                        "Whether frames wait for the detector; decided anew at each format",
                        gst_calib_detect_mode_get_type(), gst::kModeAuto, gst::kMutablePlaying));
  g_object_class_install_property(
      object_class, PROP_MAX_RATE,
      g_param_spec_double("max-rate", "Maximum Rate",
                          "Frames per second of running time to look at, at the most (0 = all)", 0,
                          1000, 0, gst::kMutablePlaying));
  g_object_class_install_property(
      object_class, PROP_POST_MESSAGES,
      g_param_spec_boolean("post-messages", "Post Messages",
                           "Post a calib-detection message for every board and frame looked at",
                           FALSE, gst::kMutablePlaying));
  g_object_class_install_property(
      object_class, PROP_RECHECK,
      g_param_spec_string(
          "recheck", "Recheck",
          "A calibration (a file, or whatever calibundistort takes) that each board "
          "found is held against: posts calib-check with the misfit, how far the "
          "camera has moved from it, and the pose of the board",
          nullptr, gst::kMutablePlaying));
  g_object_class_install_property(
      object_class, PROP_STATS,
      g_param_spec_boxed(
          "stats", "Statistics",
          "Counts of frames since start: frames, detections, skipped (by max-rate, or as "
          "the worker was busy)",
          GST_TYPE_STRUCTURE, gst::kReadOnly));
  gst_type_mark_as_plugin_api(gst_calib_detect_mode_get_type(), static_cast<GstPluginAPIFlags>(0));
}

static void gst_calib_detect_class_init(GstCalibDetectClass* klass) {
  auto* object_class = G_OBJECT_CLASS(klass);
  auto* element_class = GST_ELEMENT_CLASS(klass);
  auto* trans_class = GST_BASE_TRANSFORM_CLASS(klass);
  object_class->set_property = gst_calib_detect_set_property;
  object_class->get_property = gst_calib_detect_get_property;
  object_class->dispose = gst_calib_detect_dispose;
  object_class->finalize = gst_calib_detect_finalize;
  element_class->change_state = gst_calib_detect_change_state;
  trans_class->start = gst_calib_detect_start;
  trans_class->stop = gst_calib_detect_stop;
  trans_class->transform_caps = gst::share_memory_transform_caps;
  trans_class->set_caps = gst_calib_detect_set_caps;
  trans_class->sink_event = gst_calib_detect_sink_event;
  trans_class->src_event = gst_calib_detect_src_event;
  trans_class->prepare_output_buffer = gst::share_input_buffer;
  trans_class->propose_allocation = gst::propose_uncropped_allocation;
  trans_class->transform_ip = gst_calib_detect_transform_ip;
  trans_class->transform_ip_on_passthrough = TRUE;
  gst_calib_detect_install_properties(object_class);
  gst::add_raw_video_pads(element_class);
  gst_element_class_set_static_metadata(
      element_class, "Calibration board detector", "Filter/Analyzer/Video",
      "Finds calibration boards and attaches their corners to the frames",
      "The gst-calvin authors");
}
