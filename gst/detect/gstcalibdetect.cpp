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

#include "common/element_class.hpp"
#include "common/frames/dma_caps.hpp"
#include "common/frames/meta_filter.hpp"
#include "common/frames/refused_caps.hpp"
#include "common/messages.hpp"
#include "common/metas.hpp"
#include "detect/calib_detector.hpp"
#include "detect/detector_properties.hpp"
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

static gst::CalibDetector& gst_calib_detect_detector(GObject* object) {
  return *GST_CALIB_DETECT(object)->detector;
}

static void gst_calib_detect_attach(GstBuffer* buffer, const gst::FrameFindings& found) {
  gst::attach_observations(buffer, found.observations);
  gst::attach_hint(buffer, found.hint);
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
  if (!detector.mode_known())
    detector.choose_mode(gst::upstream_is_live(GST_BASE_TRANSFORM_SINK_PAD(trans)));
  const auto earlier = detector.take_waiting();
  if (earlier) gst_calib_detect_attach(buffer, *earlier);
  const auto found = detector.look(buffer, detector.times_of(trans->segment, buffer));
  if (found) gst_calib_detect_attach(buffer, *found);
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
  gst_pad_push_event(GST_BASE_TRANSFORM_SRC_PAD(self),
                     gst_event_new_custom(GST_EVENT_CUSTOM_DOWNSTREAM,
                                          gst::observations_to_structure(result->observations)));
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
      gst_calib_detect_push_waiting(self);
      detector.next_format();
      break;
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

static void gst_calib_detect_init(GstCalibDetect* self) {
  self->detector = new gst::CalibDetector(GST_ELEMENT(self));
  gst::configure_meta_filter(GST_BASE_TRANSFORM(self));
  gst::explain_refused_caps(GST_ELEMENT(self));
}

static void gst_calib_detect_class_init(GstCalibDetectClass* klass) {
  auto* object_class = G_OBJECT_CLASS(klass);
  gst::install_finalize<gst_calib_detect_detector>(object_class);
  gst::install_dispose<gst_calib_detect_detector>(object_class);
  gst::install_properties<gst_calib_detect_detector, gst::kDetectorProperties>(object_class);
  auto* trans_class = GST_BASE_TRANSFORM_CLASS(klass);
  gst::install_start_and_stop<gst_calib_detect_detector>(trans_class);
  gst::install_meta_filter(trans_class);
  trans_class->set_caps = gst_calib_detect_set_caps;
  trans_class->sink_event = gst_calib_detect_sink_event;
  trans_class->src_event = gst_calib_detect_src_event;
  trans_class->transform_ip = gst_calib_detect_transform_ip;
  gst_element_class_set_static_metadata(
      GST_ELEMENT_CLASS(klass), "Calibration board detector", "Filter/Analyzer/Video",
      "Finds calibration boards and attaches their corners to the frames",
      "The gst-calvin authors");
}
