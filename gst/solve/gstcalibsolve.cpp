// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibsolve: keeps good views of the boards that were found upstream and solves the camera.

/**
 * SECTION:element-calibsolve
 * @title: calibsolve
 *
 * Collects the observations that calibdetect attached, solves the camera on a thread of its own,
 * posts progress and results, writes files and pushes the sticky event `calvin-calibration`.
 *
 * ## Example launch line
 * |[
 * gst-launch-1.0 -m calibtestsrc num-buffers=60 ! calibdetect ! calibsolve location=cam.json !
 * fakesink
 * ]|
 */

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gst/base/gstbasetransform.h>
#include <gst/video/video.h>

#include "common/element_class.hpp"
#include "common/frames/dma_caps.hpp"
#include "common/frames/frame_points.hpp"
#include "common/frames/interpolated_times.hpp"
#include "common/frames/meta_filter.hpp"
#include "common/frames/refused_caps.hpp"
#include "common/messages.hpp"
#include "common/metas.hpp"
#include "elements.hpp"
#include "solve/calib_solver.hpp"
#include "solve/solve_events.hpp"
#include "solve/solver_properties.hpp"

GST_DEBUG_CATEGORY(calibsolve_debug);
#define GST_CAT_DEFAULT calibsolve_debug

G_DECLARE_FINAL_TYPE(GstCalibSolve, gst_calib_solve, GST, CALIB_SOLVE, GstBaseTransform)

namespace {

using namespace calvin;

struct State : gst::CalibSolver {
  using CalibSolver::CalibSolver;

  // Streaming thread.
  bool mode_known = false;
  bool patches_asked = false;
  gst::FramePoints points;
};

}  // namespace

struct _GstCalibSolve {
  GstBaseTransform parent;
  State* state;
};

G_DEFINE_FINAL_TYPE(GstCalibSolve, gst_calib_solve, GST_TYPE_BASE_TRANSFORM)
GST_ELEMENT_REGISTER_DEFINE_WITH_CODE(calibsolve, "calibsolve", GST_RANK_NONE,
                                      gst_calib_solve_get_type(),
                                      GST_DEBUG_CATEGORY_INIT(calibsolve_debug, "calibsolve", 0,
                                                              "camera calibration solver"))

enum {
  SIGNAL_CAPTURE_VIEW,
  SIGNAL_SOLVE,
  SIGNAL_RESET,
  SIGNAL_REMOVE_VIEW,
  SIGNAL_ADD_POINT,
  SIGNAL_REMOVE_POINT,
  LAST_SIGNAL
};
static guint gst_calib_solve_signals[LAST_SIGNAL];

static State& gst_calib_solve_state(GObject* object) { return *GST_CALIB_SOLVE(object)->state; }

// ---- Action signals: any thread -----------------------------------------------------------------

static void gst_calib_solve_capture_view(GstCalibSolve* self) { self->state->capture_view(); }

static void gst_calib_solve_solve(GstCalibSolve* self) { self->state->solve_now(); }

static void gst_calib_solve_reset(GstCalibSolve* self) { self->state->reset(); }

static gboolean gst_calib_solve_remove_view(GstCalibSolve* self, guint index) {
  return self->state->remove_view(index);
}

static void gst_calib_solve_add_point(GstCalibSolve* self, double u, double v, double x, double y,
                                      double z) {
  self->state->add_point({{u, v}, Eigen::Vector3d(x, y, z), {}});
}

static gboolean gst_calib_solve_remove_point(GstCalibSolve* self, guint index) {
  return self->state->remove_point(index);
}

// ---- Streaming ----------------------------------------------------------------------------------

static void gst_calib_solve_push_calibration(GstCalibSolve* self) {
  if (const auto event = self->state->take_event()) {
    GST_INFO_OBJECT(self, "the calibration of %s goes downstream", event->camera.c_str());
    gst_pad_push_event(GST_BASE_TRANSFORM_SRC_PAD(self), gst::new_calibration_event(*event));
  }
}

// An observation tells the frame that it was made on, which a later one may carry.
static bool gst_calib_solve_offer(GstCalibSolve* self, const std::vector<Observation>& observations,
                                  GstClockTime duration) {
  const GstSegment* segment = &GST_BASE_TRANSFORM(self)->segment;
  bool captured = false;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const Observation& o = observations[i];
    captured |= self->state->offer(o, gst::frame_times(segment, o.timestamp, duration), i);
  }
  return captured;
}

// Asks upstream for the patches that corners are refined in: once, as soon as they are to be.
static void gst_calib_solve_want_patches(GstCalibSolve* self) {
  if (self->state->patches_asked || !self->state->refines_with_camera()) return;
  self->state->patches_asked = true;
  GST_INFO_OBJECT(self, "asks upstream for the pixels around the corners");
  gst_pad_push_event(GST_BASE_TRANSFORM_SINK_PAD(self),
                     gst_event_new_custom(GST_EVENT_CUSTOM_UPSTREAM,
                                          gst_structure_new_empty(gst::kWantPatchesName)));
}

// A point that was chosen waits for a frame, in which the corner next to it is looked for, and so
// do those of the others that are expected by then: in small parts of the picture, each in less
// than a millisecond.
static void gst_calib_solve_take_points(GstCalibSolve* self, GstBuffer* buffer) {
  if (!self->state->wants_points()) return;
  const gst::FrameLook frame = self->state->points.look(buffer);
  self->state->take_points(gst::frame_times(&GST_BASE_TRANSFORM(self)->segment, buffer),
                           [&frame](Pixel at, double reach) { return frame.point_at(at, reach); });
}

static GstFlowReturn gst_calib_solve_transform_ip(GstBaseTransform* trans, GstBuffer* buffer) {
  GstCalibSolve* self = GST_CALIB_SOLVE(trans);
  gst::CalibSolver& solver = *self->state;
  solver.frame_came();
  // Asked once after each CAPS: only then does a live source know that it is one.
  if (!std::exchange(self->state->mode_known, true)) {
    solver.set_live(gst::upstream_is_live(GST_BASE_TRANSFORM_SINK_PAD(trans)));
  }
  solver.update();
  gst_calib_solve_want_patches(self);
  std::optional<Error> problem;
  const auto observations = gst::read_observations(buffer, &problem);
  if (problem) solver.complain(*problem);
  // A detector that skips frames has said nothing of this one.
  if (gst_buffer_get_custom_meta(buffer, gst::kObservationName) != nullptr) {
    const auto [words, wrong_board] = gst::read_hint(buffer);
    solver.hear_detector(words, wrong_board);
  }
  const bool captured = gst_calib_solve_offer(self, observations, GST_BUFFER_DURATION(buffer));
  gst_calib_solve_take_points(self, buffer);
  gst_calib_solve_push_calibration(self);
  Progress progress = solver.progress();
  progress.captured = captured;
  gst::attach_guidance(buffer, progress);
  return GST_FLOW_OK;
}

static gboolean gst_calib_solve_set_caps(GstBaseTransform* trans, GstCaps* caps,
                                         GstCaps* /*out_caps*/) {
  GstCalibSolve* self = GST_CALIB_SOLVE(trans);
  GstVideoInfo info;
  if (!gst::video_info_of(info, caps)) return FALSE;
  self->state->mode_known = self->state->patches_asked = false;
  self->state->points.set_format(info);
  self->state->set_size({GST_VIDEO_INFO_WIDTH(&info), GST_VIDEO_INFO_HEIGHT(&info)});
  self->state->set_frame_duration(gst::frame_duration(info));
  if (gst::upstream_says_live(GST_BASE_TRANSFORM_SINK_PAD(trans)).value_or(false))
    self->state->watch_stream(true);
  gst_calib_solve_want_patches(self);
  return TRUE;
}

static gboolean gst_calib_solve_sink_event(GstBaseTransform* trans, GstEvent* event) {
  GstCalibSolve* self = GST_CALIB_SOLVE(trans);
  gst::CalibSolver& solver = *self->state;
  switch (GST_EVENT_TYPE(event)) {
    case GST_EVENT_EOS:
      solver.finish();
      gst_calib_solve_push_calibration(self);
      break;
    case GST_EVENT_GAP:
      solver.frame_came();
      break;
    case GST_EVENT_CUSTOM_DOWNSTREAM:
      // An observation that no buffer could take.
      if (gst_event_has_name(event, gst::kObservationName)) {
        std::optional<Error> problem;
        const auto observations =
            gst::observations_from_structure(gst_event_get_structure(event), &problem);
        if (problem) solver.complain(*problem);
        gst_calib_solve_offer(self, observations, GST_CLOCK_TIME_NONE);
      }
      break;
    case GST_EVENT_FLUSH_START:
      solver.cancel();
      break;
    case GST_EVENT_FLUSH_STOP:
      solver.resume();
      break;
    default:
      break;
  }
  return GST_BASE_TRANSFORM_CLASS(gst_calib_solve_parent_class)->sink_event(trans, event);
}

// Any thread: whoever sends the event.
static gboolean gst_calib_solve_src_event(GstBaseTransform* trans, GstEvent* event) {
  gst::CalibSolver& solver = *GST_CALIB_SOLVE(trans)->state;
  const auto command = gst::solve_command(event);
  const bool is_ours = command && command->is_ours;
  if (command) {
    GST_INFO_OBJECT(trans, "obeys %" GST_PTR_FORMAT, static_cast<void*>(event));
    solver.run_command(*command);
  }
  if (!is_ours)
    return GST_BASE_TRANSFORM_CLASS(gst_calib_solve_parent_class)->src_event(trans, event);
  gst_event_unref(event);
  return TRUE;
}

static void gst_calib_solve_init(GstCalibSolve* self) {
  self->state = new State(GST_ELEMENT(self));
  gst::configure_meta_filter(GST_BASE_TRANSFORM(self));
  gst::explain_refused_caps(GST_ELEMENT(self));
}

// ---- Class --------------------------------------------------------------------------------------

static void gst_calib_solve_install_signals(GType type) {
  constexpr auto kAction = static_cast<GSignalFlags>(G_SIGNAL_RUN_LAST | G_SIGNAL_ACTION);
  const auto action = [type](const char* name, void (*handler)(GstCalibSolve*)) {
    return g_signal_new_class_handler(name, type, kAction, G_CALLBACK(handler), nullptr, nullptr,
                                      nullptr, G_TYPE_NONE, 0);
  };
  guint* signals = gst_calib_solve_signals;
  /**
   * GstCalibSolve::capture-view:
   *
   * Keeps the next view of the board, whatever the capture mode.
   */
  signals[SIGNAL_CAPTURE_VIEW] = action("capture-view", gst_calib_solve_capture_view);
  /**
   * GstCalibSolve::solve:
   *
   * Solves all views now and posts the result as a final one; capturing goes on.
   */
  signals[SIGNAL_SOLVE] = action("solve", gst_calib_solve_solve);
  /**
   * GstCalibSolve::reset:
   *
   * Forgets all views and the calibration; files stay as they are. Returns at once; afterwards
   * nothing of the session before is begun to be posted.
   */
  signals[SIGNAL_RESET] = action("reset", gst_calib_solve_reset);
  /**
   * GstCalibSolve::remove-view:
   * @index: of the view, from 0
   *
   * Forgets one view and solves again, also into the files. Returns: whether there was such a view.
   */
  signals[SIGNAL_REMOVE_VIEW] = g_signal_new_class_handler(
      "remove-view", type, kAction, G_CALLBACK(gst_calib_solve_remove_view), nullptr, nullptr,
      nullptr, G_TYPE_BOOLEAN, 1, G_TYPE_UINT);
  /**
   * GstCalibSolve::add-point:
   * @u: of the pixel, from the centre of the top-left one
   * @v: likewise
   * @x: of its place in the world, m
   * @y: likewise
   * @z: likewise
   *
   * A manual control point. The corner next to the pixel in the next frame is taken for it, where
   * there is one; the message `calib-point` says what came of it.
   */
  signals[SIGNAL_ADD_POINT] = g_signal_new_class_handler(
      "add-point", type, kAction, G_CALLBACK(gst_calib_solve_add_point), nullptr, nullptr, nullptr,
      G_TYPE_NONE, 5, G_TYPE_DOUBLE, G_TYPE_DOUBLE, G_TYPE_DOUBLE, G_TYPE_DOUBLE, G_TYPE_DOUBLE);
  /**
   * GstCalibSolve::remove-point:
   * @index: of the point, from 0, in the order in which they were chosen
   *
   * Takes a manual point out. Returns: whether there was such a point.
   */
  signals[SIGNAL_REMOVE_POINT] = g_signal_new_class_handler(
      "remove-point", type, kAction, G_CALLBACK(gst_calib_solve_remove_point), nullptr, nullptr,
      nullptr, G_TYPE_BOOLEAN, 1, G_TYPE_UINT);
}

static void gst_calib_solve_class_init(GstCalibSolveClass* klass) {
  auto* object_class = G_OBJECT_CLASS(klass);
  gst::install_finalize<gst_calib_solve_state>(object_class);
  gst::install_dispose<gst_calib_solve_state>(object_class);
  gst::install_properties<gst_calib_solve_state, gst::kSolverProperties>(object_class);
  gst_calib_solve_install_signals(G_TYPE_FROM_CLASS(klass));
  auto* trans_class = GST_BASE_TRANSFORM_CLASS(klass);
  gst::install_start_and_stop<gst_calib_solve_state>(trans_class);
  gst::install_meta_filter(trans_class);
  trans_class->set_caps = gst_calib_solve_set_caps;
  trans_class->sink_event = gst_calib_solve_sink_event;
  trans_class->src_event = gst_calib_solve_src_event;
  trans_class->transform_ip = gst_calib_solve_transform_ip;
  gst_element_class_set_static_metadata(
      GST_ELEMENT_CLASS(klass), "Camera calibration solver", "Filter/Analyzer/Video",
      "Solves the camera from the boards that were found upstream", "The gst-calvin authors");
}
