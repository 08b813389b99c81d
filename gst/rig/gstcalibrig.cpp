// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibrig: where several cameras stand, from the boards that were found in front of each.

/**
 * SECTION:element-calibrig
 * @title: calibrig
 *
 * Passes the frames of several cameras, each from a sink pad to the source pad of the same number,
 * and solves where the cameras stand by the boards that calibdetect has found upstream: pictures of
 * one time belong together. Never holds a frame back.
 *
 * ## Example launch line
 * |[
 * gst-launch-1.0 -m calibrig name=rig location=rig.json sink_0::intrinsics=left.json
 * sink_1::intrinsics=right.json v4l2src device=/dev/video0 ! calibdetect ! rig.sink_0 v4l2src
 * device=/dev/video2 ! calibdetect ! rig.sink_1
 * ]|
 */

#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include <gst/gst.h>

#include "common/calibration_event.hpp"
#include "common/element_class.hpp"
#include "common/frames/dma_caps.hpp"
#include "common/frames/meta_filter.hpp"
#include "common/messages.hpp"
#include "common/metas.hpp"
#include "common/rig_event.hpp"
#include "elements.hpp"
#include "rig/rig_end.hpp"
#include "rig/rig_events.hpp"
#include "rig/rig_messages.hpp"
#include "rig/rig_pad.hpp"
#include "rig/rig_solver.hpp"

GST_DEBUG_CATEGORY(calibrig_debug);
#define GST_CAT_DEFAULT calibrig_debug

G_DECLARE_FINAL_TYPE(GstCalibRig, gst_calib_rig, GST, CALIB_RIG, GstElement)

using namespace calvin;

static constexpr guint kMostCameras = 4096;

struct _GstCalibRig {
  GstElement parent;
  gst::RigSolver* solver;
  guint next_camera;  // object lock
  gst::RigEnd end;    // likewise
};

G_DEFINE_FINAL_TYPE_WITH_CODE(GstCalibRig, gst_calib_rig, GST_TYPE_ELEMENT,
                              G_IMPLEMENT_INTERFACE(GST_TYPE_CHILD_PROXY,
                                                    gst::sink_pads_as_children))
GST_ELEMENT_REGISTER_DEFINE_WITH_CODE(calibrig, "calibrig", GST_RANK_NONE, gst_calib_rig_get_type(),
                                      GST_DEBUG_CATEGORY_INIT(calibrig_debug, "calibrig", 0,
                                                              "places of several cameras"))

static GstStaticPadTemplate gst_calib_rig_sink_template = GST_STATIC_PAD_TEMPLATE(
    "sink_%u", GST_PAD_SINK, GST_PAD_REQUEST, GST_STATIC_CAPS("video/x-raw(ANY)"));
static GstStaticPadTemplate gst_calib_rig_src_template = GST_STATIC_PAD_TEMPLATE(
    "src_%u", GST_PAD_SRC, GST_PAD_SOMETIMES, GST_STATIC_CAPS("video/x-raw(ANY)"));

static gst::RigSolver& gst_calib_rig_solver(GObject* object) {
  return *GST_CALIB_RIG(object)->solver;
}

// ---- Streaming ----------------------------------------------------------------------------------

// A rig that is new goes ahead of the next frame.
static void gst_calib_rig_push_rig(GstCalibRig* self, GstPad* pad) {
  if (const auto json = self->solver->take_rig(gst::stream_of(pad).rig_number)) {
    gst_pad_push_event(gst::source_of(pad), gst::new_rig_event(*json));
  }
}

// How much later a frame was taken by the clock that its reference timestamp is of, than by its
// own; 0 where it has none.
static GstClockTimeDiff gst_calib_rig_clock_offset(GstBuffer* buffer, GstClockTime running_time) {
  const GstReferenceTimestampMeta* meta = gst_buffer_get_reference_timestamp_meta(buffer, nullptr);
  if (meta == nullptr || !GST_CLOCK_TIME_IS_VALID(running_time)) return 0;
  return GST_CLOCK_DIFF(running_time, meta->timestamp);
}

static void gst_calib_rig_offer(GstCalibRig* self, GstPad* pad,
                                const std::vector<Observation>& observations,
                                GstClockTimeDiff offset) {
  const GstSegment* segment = &gst::stream_of(pad).segment;
  for (const Observation& seen : observations) {
    if (!seen.found()) continue;
    const FrameTimes times = gst::frame_times(segment, seen.timestamp, GST_CLOCK_TIME_NONE);
    if (!GST_CLOCK_TIME_IS_VALID(times.running_time)) continue;
    self->solver->offer(gst::camera_of(pad), seen, times,
                        times.running_time + static_cast<GstClockTime>(offset));
  }
}

// Points that were chosen in this camera's picture wait for a frame of it.
static void gst_calib_rig_take_points(GstCalibRig* self, GstPad* pad, GstBuffer* buffer,
                                      GstClockTime shared_clock) {
  const std::size_t camera = gst::camera_of(pad);
  if (!self->solver->has_waiting_points(camera)) return;
  const gst::RigPadStream& stream = gst::stream_of(pad);
  const gst::FrameLook frame = stream.points.look(buffer);
  self->solver->take_waiting_points(
      camera, gst::frame_times(&stream.segment, buffer), shared_clock,
      [&frame](Pixel at, double reach) { return frame.point_at(at, reach); });
}

static GstFlowReturn gst_calib_rig_chain(GstPad* pad, GstObject* parent, GstBuffer* buffer) {
  GstCalibRig* self = GST_CALIB_RIG(parent);
  const gst::RigPadStream& stream = gst::stream_of(pad);
  const auto observations = gst::read_observations(buffer);
  const GstClockTime running_time =
      gst_segment_to_running_time(&stream.segment, GST_FORMAT_TIME, GST_BUFFER_PTS(buffer));
  const GstClockTimeDiff offset = gst_calib_rig_clock_offset(buffer, running_time);
  gst_calib_rig_offer(self, pad, observations, offset);
  gst_calib_rig_take_points(self, pad, buffer, running_time + static_cast<GstClockTime>(offset));
  GstPad* source = gst::source_of(pad);
  // Cameras of which nobody wants the frames are calibrated all the same.
  if (!gst_pad_is_linked(source)) {
    gst_buffer_unref(buffer);
    return GST_FLOW_OK;
  }
  gst_calib_rig_push_rig(self, pad);
  return gst_pad_push(source, buffer);
}

// Where nobody is linked behind it, the pipeline ends with the session.
static void gst_calib_rig_post_eos(GstCalibRig* self) {
  if (!GST_OBJECT_FLAG_IS_SET(self, GST_ELEMENT_FLAG_SINK)) return;
  GstMessage* message = gst_message_new_eos(GST_OBJECT(self));
  GST_OBJECT_LOCK(self);
  const guint32 seqnum = self->end.seqnum;
  GST_OBJECT_UNLOCK(self);
  gst_message_set_seqnum(message, seqnum);
  gst_element_post_message(GST_ELEMENT(self), message);
}

// A camera whose pad came while the others run: its settings are there by its first frame.
static void gst_calib_rig_introduce(GstCalibRig* self, GstPad* pad) {
  if (gst::stream_of(pad).is_known) return;
  self->solver->add_camera_later(gst::camera_of(pad), gst::take_settings(pad));
}

static void gst_calib_rig_set_format(GstCalibRig* self, GstPad* pad, GstEvent* event) {
  GstCaps* caps = nullptr;
  gst_event_parse_caps(event, &caps);
  GstVideoInfo info;
  if (!gst::video_info_of(info, caps)) return;
  gst::stream_of(pad).points.set_format(info);
  if (gst::upstream_says_live(pad).value_or(false)) self->solver->give_way();
  self->solver->set_size(gst::camera_of(pad),
                         {GST_VIDEO_INFO_WIDTH(&info), GST_VIDEO_INFO_HEIGHT(&info)});
}

static gboolean gst_calib_rig_sink_event(GstPad* pad, GstObject* parent, GstEvent* event) {
  GstCalibRig* self = GST_CALIB_RIG(parent);
  gst::RigPadStream& stream = gst::stream_of(pad);
  switch (GST_EVENT_TYPE(event)) {
    case GST_EVENT_CAPS:
      gst_calib_rig_introduce(self, pad);
      gst_calib_rig_set_format(self, pad, event);
      break;
    case GST_EVENT_SEGMENT:
      gst_event_copy_segment(event, &stream.segment);
      gst::camera_runs(GST_ELEMENT(self), self->end, pad);
      break;
    case GST_EVENT_FLUSH_START:
      // The thread of this pad may be waiting for the last solve.
      self->solver->cancel();
      break;
    case GST_EVENT_FLUSH_STOP:
      self->solver->resume();
      gst_segment_init(&stream.segment, GST_FORMAT_TIME);
      gst::camera_runs(GST_ELEMENT(self), self->end, pad);
      break;
    case GST_EVENT_EOS:
      self->solver->take_waiting_points(gst::camera_of(pad), {}, GST_CLOCK_TIME_NONE,
                                        [](Pixel, double) { return std::nullopt; });
      if (gst::camera_ends(GST_ELEMENT(self), self->end, pad, event)) {
        self->solver->finish();
        gst_calib_rig_post_eos(self);
      }
      gst_calib_rig_push_rig(self, pad);
      break;
    case GST_EVENT_CUSTOM_DOWNSTREAM:
      // An observation that no buffer could take.
      if (gst_event_has_name(event, gst::kObservationName)) {
        gst_calib_rig_offer(self, pad,
                            gst::observations_from_structure(gst_event_get_structure(event)), 0);
      }
      break;
    case GST_EVENT_CUSTOM_DOWNSTREAM_STICKY:
      if (const auto calibration = gst::parse_calibration_event(event)) {
        if (!stream.has_own_intrinsics) {
          self->solver->set_intrinsics(gst::camera_of(pad), calibration->json);
        }
      }
      break;
    default:
      break;
  }
  GstPad* source = gst::source_of(pad);
  // Events that nobody takes are kept by the source pad for whoever is linked later.
  const gboolean pushed = gst_pad_push_event(source, event);
  return pushed || !gst_pad_is_linked(source);
}

static gboolean gst_calib_rig_src_event(GstPad* pad, GstObject* parent, GstEvent* event) {
  GstPad* sink = gst::sink_of(pad);
  const auto command = gst::rig_command(event);
  if (sink != nullptr && command) gst::run_command(*GST_CALIB_RIG(parent)->solver, *command, sink);
  if (sink != nullptr && !(command && command->is_ours)) return gst_pad_push_event(sink, event);
  gst_event_unref(event);
  return sink != nullptr;
}

// ---- Pads ---------------------------------------------------------------------------------------

// The number that a name asks for, or the next one that is free.
static guint gst_calib_rig_number(GstCalibRig* self, const char* name) {
  guint number = 0;
  const bool is_asked = name != nullptr && std::sscanf(name, "sink_%u", &number) == 1;
  GST_OBJECT_LOCK(self);
  if (!is_asked) number = self->next_camera;
  if (number < kMostCameras) self->next_camera = std::max(self->next_camera, number + 1);
  GST_OBJECT_UNLOCK(self);
  return number;
}

static GstPad* gst_calib_rig_request_new_pad(GstElement* element, GstPadTemplate* templ,
                                             const char* name, const GstCaps* /*caps*/) {
  GstCalibRig* self = GST_CALIB_RIG(element);
  const guint number = gst_calib_rig_number(self, name);
  if (number >= kMostCameras) {
    GST_ERROR_OBJECT(self, "no rig has a camera %u", number);
    return nullptr;
  }
  g_autofree char* sink_name = g_strdup_printf("sink_%u", number);
  g_autofree char* src_name = g_strdup_printf("src_%u", number);
  GstPad* source = gst_pad_new_from_static_template(&gst_calib_rig_src_template, src_name);
  GstPad* sink = gst::new_rig_pad(templ, sink_name, number, source);
  gst_pad_set_chain_function(sink, gst_calib_rig_chain);
  gst_pad_set_event_function(sink, gst_calib_rig_sink_event);
  gst_pad_set_event_function(source, gst_calib_rig_src_event);
  const bool runs =
      GST_STATE(element) > GST_STATE_READY || GST_STATE_TARGET(element) > GST_STATE_READY;
  if (runs) {
    gst_pad_set_active(source, TRUE);
    gst_pad_set_active(sink, TRUE);
  }
  gst_element_add_pad(element, source);
  if (!gst_element_add_pad(element, sink)) {
    gst_element_remove_pad(element, source);
    return nullptr;
  }
  gst_child_proxy_child_added(GST_CHILD_PROXY(self), G_OBJECT(sink), sink_name);
  return sink;
}

static void gst_calib_rig_release_pad(GstElement* element, GstPad* pad) {
  GstPad* source = gst::source_of(pad);
  gst_child_proxy_child_removed(GST_CHILD_PROXY(element), G_OBJECT(pad), GST_PAD_NAME(pad));
  gst_pad_set_active(pad, FALSE);
  gst_pad_set_active(source, FALSE);
  GST_CALIB_RIG(element)->solver->remove_camera(gst::camera_of(pad));
  // Somebody may keep the source pad longer than this one.
  gst_pad_set_element_private(source, nullptr);
  gst_element_remove_pad(element, source);
  gst_element_remove_pad(element, pad);
  GstCalibRig* self = GST_CALIB_RIG(element);
  const bool is_over = gst::camera_goes(element, self->end);
  if (!is_over || GST_STATE(element) <= GST_STATE_READY) return;
  // Whoever releases a pad does not wait for the last solve.
  self->solver->finish_later([self] { gst_calib_rig_post_eos(self); });
}

// ---- Element ------------------------------------------------------------------------------------

static bool gst_calib_rig_start(GstCalibRig* self) {
  const std::vector<GstPad*> pads = gst::sink_pads_of(GST_ELEMENT(self));
  Status started = self->solver->start(gst::names_of(pads));
  for (GstPad* pad : pads) {
    gst::camera_runs(GST_ELEMENT(self), self->end, pad);
    gst_segment_init(&gst::stream_of(pad).segment, GST_FORMAT_TIME);
    gst::stream_of(pad).is_known = false;
    // One that nobody is linked to is no camera, but may be one that comes later.
    if (started && gst_pad_is_linked(pad)) {
      started = self->solver->add_camera(gst::camera_of(pad), gst::take_settings(pad));
    } else if (started) {
      started = gst::RigSolver::check_camera(gst::settings_of(pad));
    }
    gst_object_unref(pad);
  }
  if (!started) gst::post_error(GST_ELEMENT(self), started.error());
  return started.has_value();
}

static GstStateChangeReturn gst_calib_rig_change_state(GstElement* element, GstStateChange change) {
  GstCalibRig* self = GST_CALIB_RIG(element);
  if (change == GST_STATE_CHANGE_READY_TO_PAUSED) {
    self->solver->resume();
    if (gst::is_last(element)) {
      GST_OBJECT_FLAG_SET(self, GST_ELEMENT_FLAG_SINK);
    } else {
      GST_OBJECT_FLAG_UNSET(self, GST_ELEMENT_FLAG_SINK);
    }
    if (!gst_calib_rig_start(self)) return GST_STATE_CHANGE_FAILURE;
  }
  // Before the pads are deactivated: that waits for streaming threads, of which one may be waiting
  // for the last solve.
  if (change == GST_STATE_CHANGE_PAUSED_TO_READY) self->solver->cancel();
  const auto result = GST_ELEMENT_CLASS(gst_calib_rig_parent_class)->change_state(element, change);
  if (change == GST_STATE_CHANGE_PAUSED_TO_READY) self->solver->stop();
  return result;
}

static gboolean gst_calib_rig_reinsert(GstCalibRig* self, const char* camera) {
  return self->solver->reinsert(camera != nullptr ? camera : "");
}

static gboolean gst_calib_rig_add_point(GstCalibRig* self, const char* camera, double u, double v,
                                        double x, double y, double z) {
  return self->solver->add_point(camera != nullptr ? camera : "",
                                 {{u, v}, Eigen::Vector3d(x, y, z), {}});
}

static gboolean gst_calib_rig_remove_point(GstCalibRig* self, const char* camera, guint index) {
  return self->solver->remove_point(camera != nullptr ? camera : "", index);
}

static void gst_calib_rig_init(GstCalibRig* self) {
  self->solver = new gst::RigSolver(GST_ELEMENT(self));
}

static void gst_calib_rig_install_signals(GType type) {
  constexpr auto kAction = static_cast<GSignalFlags>(G_SIGNAL_RUN_LAST | G_SIGNAL_ACTION);
  /**
   * GstCalibRig::reinsert:
   * @camera: its name
   *
   * A camera that has moved stays where it stands now: its place is solved anew by what it has seen
   * since then, and those of the others are not. Returns: whether there is such a camera.
   */
  g_signal_new_class_handler("reinsert", type, kAction, G_CALLBACK(gst_calib_rig_reinsert), nullptr,
                             nullptr, nullptr, G_TYPE_BOOLEAN, 1, G_TYPE_STRING);
  /**
   * GstCalibRig::add-point:
   * @camera: its name
   * @u: of the pixel, from the centre of the top-left one
   * @v: likewise
   * @x: of its place in the world, m
   * @y: likewise
   * @z: likewise
   *
   * A manual control point; see #GstCalibSolve::add-point. Returns: whether there is such a camera.
   */
  g_signal_new_class_handler("add-point", type, kAction, G_CALLBACK(gst_calib_rig_add_point),
                             nullptr, nullptr, nullptr, G_TYPE_BOOLEAN, 6, G_TYPE_STRING,
                             G_TYPE_DOUBLE, G_TYPE_DOUBLE, G_TYPE_DOUBLE, G_TYPE_DOUBLE,
                             G_TYPE_DOUBLE);
  /**
   * GstCalibRig::remove-point:
   * @camera: its name
   * @index: of the point, from 0, in the order in which they were chosen
   *
   * Takes a manual point out. Returns: whether there was such a point.
   */
  g_signal_new_class_handler("remove-point", type, kAction, G_CALLBACK(gst_calib_rig_remove_point),
                             nullptr, nullptr, nullptr, G_TYPE_BOOLEAN, 2, G_TYPE_STRING,
                             G_TYPE_UINT);
}

static void gst_calib_rig_class_init(GstCalibRigClass* klass) {
  auto* object_class = G_OBJECT_CLASS(klass);
  gst::install_finalize<gst_calib_rig_solver>(object_class);
  gst::install_dispose<gst_calib_rig_solver>(object_class);
  gst::install_properties<gst_calib_rig_solver, gst::kRigProperties>(object_class);
  gst_calib_rig_install_signals(G_TYPE_FROM_CLASS(klass));
  auto* element_class = GST_ELEMENT_CLASS(klass);
  element_class->request_new_pad = gst_calib_rig_request_new_pad;
  element_class->release_pad = gst_calib_rig_release_pad;
  element_class->change_state = gst_calib_rig_change_state;
  gst_element_class_add_static_pad_template_with_gtype(element_class, &gst_calib_rig_sink_template,
                                                       gst_calib_rig_pad_get_type());
  gst_element_class_add_static_pad_template(element_class, &gst_calib_rig_src_template);
  gst_element_class_set_static_metadata(
      element_class, "Places of several cameras", "Filter/Analyzer/Video",
      "Solves where cameras stand to each other from the boards that were found upstream",
      "The gst-calvin authors");
}
