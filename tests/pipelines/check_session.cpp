// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whole pipelines against ground truth: is the calibration as right as it says, and does
// calibundistort straighten what it should?

#include <map>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/solve/difference.hpp"
#include "calvin/target/board.hpp"
#include "common/calibration_event.hpp"
#include "common/metas.hpp"

#include <glib/gstdio.h>
#include <gst/check/gstcheck.h>

using namespace calvin;

static const char kFisheye[] =
    "fx=205,fy=206,cx=322,cy=238,k1=-0.02,k2=0.005,k3=-0.003,k4=0.0005,width=640,height=480,"
    "model=fisheye";

static bool full() { return g_getenv("CALVIN_FULL") != nullptr; }

// Runs a pipeline to its end; the JSON of its final result, empty where there was none. `misfit` is
// the fault that it names, empty for none.
static std::string run(GstElement* pipeline, std::string* misfit = nullptr) {
  std::string json;
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  fail_if(gst_element_set_state(pipeline, GST_STATE_PLAYING) == GST_STATE_CHANGE_FAILURE);
  for (bool done = false; !done;) {
    g_autoptr(GstMessage) message = gst_bus_timed_pop(bus, 120 * GST_SECOND);
    fail_unless(message != nullptr, "the pipeline hangs");
    fail_if(GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR);
    done = GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS;
    const GstStructure* s = gst_message_get_structure(message);
    if (s != nullptr && gst_structure_has_name(s, "calib-result")) {
      const char* text = gst_structure_get_string(s, "json");
      if (text != nullptr) json = text;
      const char* cause = gst_structure_get_string(s, "misfit");
      if (misfit != nullptr) *misfit = cause != nullptr ? cause : "";
    }
  }
  gst_bus_set_flushing(bus, TRUE);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  return json;
}

// e^T C^-1 e / n of one session, with its fx sigma.
struct Score {
  double normalised = 0;
  double sigma_fx = 0;
  double apart = 0;  // px, the largest over the image, the rotation taken out
  std::string misfit;
};

static Score session(int seed, int frames, const char* model, const char* camera) {
  g_autofree char* text = g_strdup_printf(
      "calibtestsrc seed=%d num-buffers=%d %s%s name=src ! "
      "calibrate model=%s overlay=false mode=sync ! fakesink sync=false",
      seed, frames, camera[0] != '\0' ? "calibration=" : "", camera, model);
  g_autoptr(GstElement) pipeline = gst_parse_launch(text, nullptr);
  fail_unless(pipeline != nullptr);
  // The truth rides on every buffer.
  std::string truth_json;
  g_autoptr(GstElement) source = gst_bin_get_by_name(GST_BIN(pipeline), "src");
  g_autoptr(GstPad) pad = gst_element_get_static_pad(source, "src");
  gst_pad_add_probe(
      pad, GST_PAD_PROBE_TYPE_BUFFER,
      [](GstPad*, GstPadProbeInfo* info, gpointer data) {
        *static_cast<std::string*>(data) =
            gst::read_ground_truth(GST_PAD_PROBE_INFO_BUFFER(info))->calibration;
        return GST_PAD_PROBE_REMOVE;
      },
      &truth_json, nullptr);
  std::string misfit;
  const auto found = parse_calibration(run(pipeline, &misfit));
  const auto truth = parse_calibration(truth_json);
  fail_unless(found.has_value() && truth.has_value(), "seed %d", seed);

  const auto n = static_cast<Eigen::Index>(found->parameters.size());
  fail_unless_equals_int(found->covariance.size(), n * n);
  const Eigen::Map<const Eigen::MatrixXd> covariance(found->covariance.data(), n, n);
  Eigen::VectorXd e(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Parameter& p = found->parameters[static_cast<std::size_t>(i)];
    e[i] = p.value - truth->find(p.name)->value;
  }
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation = scale.asDiagonal() * covariance * scale.asDiagonal();
  const Eigen::VectorXd scaled = scale.asDiagonal() * e;
  return {scaled.dot(correlation.ldlt().solve(scaled)) / static_cast<double>(n),
          *found->find("fx")->sigma,
          difference(Camera::make(*found).value(), Camera::make(*truth).value()).value().image.max,
          misfit};
}

static void assert_honest(const char* model, const char* camera) {
  const int frames = full() ? 300 : 30;
  double mean = 0;
  double worst = 0;
  double apart = 0;
  int flagged = 0;
  for (int seed = 1; seed <= 20; ++seed) {
    const Score score = session(seed, frames, model, camera);
    flagged += score.misfit.empty() ? 0 : 1;
    mean += score.normalised / 20;
    worst = std::max(worst, score.sigma_fx);
    apart += score.apart / 20;
  }
  g_print(
      "%s, 20 seeds of %d frames: e^T C^-1 e / n = %.3f, fx sigma at most %.4f px, %.4f px apart\n",
      model, frames, mean, worst, apart);
  fail_unless(mean > 0.4 && mean < 2.5, "mean e^T C^-1 e / n is %f, the cameras are %f px apart",
              mean, apart);
  fail_unless(worst < 1, "fx sigma %f", worst);
  // Nothing is amiss in any of them. Of one in twenty it may be said, and twice is bad luck.
  fail_unless(flagged <= 2, "%d of 20 perfect sessions are blamed for a misfit", flagged);
}

GST_START_TEST(test_brown5_sigmas_tell_the_truth) { assert_honest("brown5", ""); }
GST_END_TEST;

GST_START_TEST(test_fisheye_sigmas_tell_the_truth) { assert_honest("fisheye", kFisheye); }
GST_END_TEST;

// ---- Undistortion -------------------------------------------------------------------------------

// The corners found in the undistorted picture, against the true pose seen by the camera that the
// element announces.
struct Straightness {
  std::map<GstClockTime, std::vector<gst::TrueBoard>> truth;
  GstPad* output = nullptr;  // src pad of calibundistort
  double squares = 0;
  int points = 0;
  int frames = 0;
};

static GstPadProbeReturn remember_truth(GstPad*, GstPadProbeInfo* info, gpointer data) {
  GstBuffer* buffer = GST_PAD_PROBE_INFO_BUFFER(info);
  static_cast<Straightness*>(data)->truth[GST_BUFFER_PTS(buffer)] =
      gst::read_ground_truth(buffer)->boards;
  return GST_PAD_PROBE_OK;
}

static GstPadProbeReturn compare_corners(GstPad*, GstPadProbeInfo* info, gpointer data) {
  auto* s = static_cast<Straightness*>(data);
  GstBuffer* buffer = GST_PAD_PROBE_INFO_BUFFER(info);
  g_autoptr(GstEvent) sticky =
      gst_pad_get_sticky_event(s->output, GST_EVENT_CUSTOM_DOWNSTREAM_STICKY, 0);
  if (sticky == nullptr) return GST_PAD_PROBE_OK;  // not calibrated yet
  const auto announced = gst::parse_calibration_event(sticky);
  const auto calibration = parse_calibration(announced->json);
  fail_unless(calibration.has_value());
  fail_unless_equals_string(calibration->model.c_str(), "pinhole");
  const auto camera = Camera::make(*calibration);
  const SE3 camera_from_board = to_se3(s->truth.at(GST_BUFFER_PTS(buffer)).at(0).camera_from_board);
  for (const Observation& o : gst::read_observations(buffer)) {
    const auto points = parse_board(o.board)->points();
    for (std::size_t i = 0; i < o.ids.size(); ++i) {
      const auto p =
          camera->project(camera_from_board * points[static_cast<std::size_t>(o.ids[i])]);
      fail_unless(p.has_value());
      s->squares += std::pow(p->u - o.uv[i].u, 2) + std::pow(p->v - o.uv[i].v, 2);
      ++s->points;
    }
    s->frames += o.found() ? 1 : 0;
  }
  return GST_PAD_PROBE_OK;
}

static void assert_straight(const std::string& launch, int wanted_frames) {
  g_autoptr(GstElement) pipeline = gst_parse_launch(launch.c_str(), nullptr);
  fail_unless(pipeline != nullptr);
  Straightness s;
  const auto pad_of = [&](const char* name) {
    g_autoptr(GstElement) element = gst_bin_get_by_name(GST_BIN(pipeline), name);
    return gst_element_get_static_pad(element, "src");
  };
  g_autoptr(GstPad) source = pad_of("src");
  g_autoptr(GstPad) last = pad_of("look");
  s.output = pad_of("undistort");
  gst_pad_add_probe(source, GST_PAD_PROBE_TYPE_BUFFER, remember_truth, &s, nullptr);
  gst_pad_add_probe(last, GST_PAD_PROBE_TYPE_BUFFER, compare_corners, &s, nullptr);
  run(pipeline);
  gst_object_unref(s.output);
  const double rms = std::sqrt(s.squares / std::max(1, s.points));
  g_print("%d frames, RMS %.4f px from the announced camera\n", s.frames, rms);
  fail_unless(s.frames >= wanted_frames, "the board was found in %d frames only", s.frames);
  fail_unless(rms < 0.1, "RMS %f", rms);
}

GST_START_TEST(test_a_file_straightens_the_board) {
  g_autofree char* folder = g_dir_make_tmp("calvin-XXXXXX", nullptr);
  g_autofree char* file = g_build_filename(folder, "cam.json", nullptr);
  g_autofree char* text = g_strdup_printf(
      "calibtestsrc num-buffers=40 ! calibrate location=%s ! fakesink sync=false", file);
  g_autoptr(GstElement) pipeline = gst_parse_launch(text, nullptr);
  fail_if(run(pipeline).empty());
  for (const char* alpha : {"0", "1"}) {
    assert_straight(std::string("calibtestsrc name=src seed=9 num-buffers=40 ! "
                                "calibundistort name=undistort calibration=") +
                        file + " alpha=" + alpha +
                        " ! calibdetect name=look mode=sync ! fakesink sync=false",
                    20);
  }
  g_remove(file);
  g_rmdir(folder);
}
GST_END_TEST;

GST_START_TEST(test_the_event_straightens_the_board) {
  for (const char* format : {"GRAY8", "I420", "NV12", "YUY2", "BGRx"}) {
    assert_straight(std::string("calibtestsrc name=src num-buffers=60 ! video/x-raw,format=") +
                        format +
                        " ! calibrate overlay=false min-views=15 ! "
                        "calibundistort name=undistort ! calibdetect name=look mode=sync ! "
                        "fakesink sync=false",
                    10);
  }
}
GST_END_TEST;

static Suite* session_suite() {
  Suite* suite = suite_create("session");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_set_timeout(tc, full() ? 1800 : 300);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_test(tc, test_brown5_sigmas_tell_the_truth);
  tcase_add_test(tc, test_fisheye_sigmas_tell_the_truth);
  tcase_add_test(tc, test_a_file_straightens_the_board);
  tcase_add_test(tc, test_the_event_straightens_the_board);
  return suite;
}

GST_CHECK_MAIN(session)
