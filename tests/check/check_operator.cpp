// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// An operator before rendered frames: who holds the board about where the ghost of calibrate shows
// it, beside one who does as he likes, each against the true camera. tests/lib/session's
// test_operator does the same with a session alone, and often.

// Ours first: check.h defines the macro `fail`.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calvin/camera/lens_table.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/session/guidance/board_placement.hpp"
#include "calvin/solve/start/plane_pose.hpp"
#include "calvin/synth/render.hpp"
#include "common/metas.hpp"
#include "simulated_hand.hpp"
#include "true_error.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;

namespace {

constexpr ImageSize kSize = {640, 480};
constexpr int kViews = 25;

// What was known after a view.
struct Known {
  double rms = 0;    // px, of the corners
  double error = 0;  // px, the true one
  double error_where_seen = 0;
  double promise = 0;
  double promise_anywhere = 0;
};
using Course = std::map<int, Known>;  // by the number of views

class Operator {
 public:
  // `look`: of the frames; their noise differs from frame to frame.
  Operator(const Camera& truth, const RenderOptions& look, unsigned seed, const char* capture)
      : truth_(truth),
        renderer_(truth_),
        look_(look),
        random_(seed),
        hand_(truth_, random_),
        element_(gst_element_factory_make("calibrate", nullptr)),
        bus_(gst_bus_new()) {
    gst_util_set_object_arg(G_OBJECT(element_), "capture-mode", capture);
    gst_util_set_object_arg(G_OBJECT(element_), "mode", "sync");
    g_object_set(element_, "overlay", FALSE, "model", std::string(truth_.model()).c_str(), nullptr);
    gst_element_set_bus(element_, bus_);
    harness_ = gst_harness_new_with_element(element_, "sink", "src");
    gst_harness_set_src_caps_str(harness_,
                                 "video/x-raw, format=GRAY8, width=640, height=480, "
                                 "framerate=15/1");
  }
  Operator(const Operator&) = delete;
  Operator& operator=(const Operator&) = delete;
  ~Operator() {
    gst_element_set_bus(element_, nullptr);
    gst_harness_teardown(harness_);
    gst_object_unref(element_);
    gst_bus_set_flushing(bus_, TRUE);
    gst_object_unref(bus_);
  }

  // s, from the first frame: when the picture said that nothing more is needed.
  [[nodiscard]] const std::optional<double>& done_at() const noexcept { return done_at_; }

  Course follow() {
    hand_.follow([this] { return wanted(); },
                 [this](const SE3& pose, double now) { return show(pose, now); },
                 [this] { return views_ >= kViews; });
    return course_;
  }

  Course ignore_hints() {
    for (double now = 1; views_ < kViews && now < 200; now += 1) {
      g_signal_emit_by_name(element_, "capture-view");
      show(hand_.anywhere(), now);
    }
    return course_;
  }

 private:
  // Where the ghost is, as one who looks at the picture brings the board there.
  [[nodiscard]] std::optional<SE3> wanted() const {
    const std::vector<Eigen::Vector3d> corners = around();
    if (seen_.ghost.size() != corners.size()) return std::nullopt;
    std::vector<Eigen::Vector3d> rays;
    for (const Pixel& part : seen_.ghost) {
      const auto ray = truth_.unproject({part.u * kSize.width - 0.5, part.v * kSize.height - 0.5});
      rays.push_back(ray ? *ray : Eigen::Vector3d::Zero());
    }
    return pose_from_rays(corners, rays);
  }
  // The points of the board that the ghost is an outline of, around its corners: as many for each
  // edge.
  static std::vector<Eigen::Vector3d> around() {
    constexpr int kOfEdge = 8;
    const BoardArea area = scenes::kBoard.extent();
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 4 * kOfEdge; ++i) {
      const double t = (i % kOfEdge) / static_cast<double>(kOfEdge);
      const int edge = i / kOfEdge;
      const double x = edge == 0 ? t : edge == 1 ? 1 : edge == 2 ? 1 - t : 0;
      const double y = edge == 0 ? 0 : edge == 1 ? t : edge == 2 ? 1 : 1 - t;
      points.emplace_back(area.left + x * area.width(), area.top + y * area.height(), 0);
    }
    return points;
  }

  // Whether a view was taken. What is asked for is solved before the next frame.
  bool show(const SE3& pose, double now) {
    RenderOptions options = look_;
    options.seed = static_cast<std::uint64_t>(now * 1000);
    const GrayImage image = renderer_.render(scenes::kBoard, pose, options);
    GstBuffer* in = gst_buffer_new_memdup(image.pixels.data(), image.pixels.size());
    GST_BUFFER_PTS(in) = static_cast<GstClockTime>(now * GST_SECOND);
    GST_BUFFER_DURATION(in) = static_cast<GstClockTime>(hand_.kFrame * GST_SECOND);
    g_autoptr(GstBuffer) out = gst_harness_push_and_pull(harness_, in);
    if (auto progress = gst::read_guidance(out)) seen_ = *std::move(progress);
    if (!seen_.captured) return false;
    views_ = seen_.views;
    if (seen_.done && !done_at_) done_at_ = now;
    if (views_ >= kFewest) take_result();
    return true;
  }
  void take_result() {
    constexpr int kPatience = 30000;  // ms, of a machine that is busy
    bool is_there = false;
    for (int waited = 0; !is_there && waited < kPatience; waited += 5) {
      g_usleep(5000);
      while (GstMessage* message = gst_bus_pop(bus_)) {
        is_there |= gst_message_has_name(message, "calib-result") != FALSE;
        gst_message_unref(message);
      }
    }
    fail_unless(is_there, "no result after %d views", views_);
    g_usleep(20000);  // until the next frame: the guide is made after the result
    g_autofree char* json = nullptr;
    g_object_get(element_, "calibration", &json, nullptr);
    const auto found = parse_calibration(json);
    fail_unless(found.has_value());
    course_[views_] = {found->rms.value_or(NAN), scenes::worst_error(*found, truth_, {}),
                       scenes::worst_error(*found, truth_, found->covered),
                       2 * found->expected_error.value_or(HUGE_VAL),
                       2 * found->expected_error_anywhere.value_or(HUGE_VAL)};
  }

  static constexpr int kFewest = 3;  // views that are solved

  Camera truth_;
  BoardRenderer renderer_;
  RenderOptions look_;
  scenes::Random random_;
  scenes::SimulatedHand hand_;
  GstElement* element_;
  GstBus* bus_;
  GstHarness* harness_ = nullptr;
  Progress seen_;
  int views_ = 0;
  std::optional<double> done_at_;
  Course course_;
};

// A lens that is built shows everything up to 90 degrees from its axis, or ends with its picture.
Camera lens_of(const char* model, unsigned seed) {
  scenes::Random random(2000 + seed);
  for (;;) {
    Camera camera = scenes::random_camera(model, random, kSize);
    const bool is_whole = find_lens(model)->perspective || camera.project({1, 0, 0}).has_value();
    if (is_whole) return camera;
  }
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values.at(values.size() / 2);
}

struct Cell {
  const char* model;
  RenderOptions look;
  const char* corners;  // how exact they are in such frames
};
// The most blur is less than the 2 px above which a picture is refused.
const RenderOptions kCoarse = {.noise = 30, .blur = 1.8};
const RenderOptions kFine = {.noise = 12, .blur = 1};
const Cell kCells[] = {{"brown5", kCoarse, ".1 px"},  {"brown4", kCoarse, ".1 px"},
                       {"fisheye", kCoarse, ".1 px"}, {"brown5", kFine, ".03 px"},
                       {"brown4", kFine, ".03 px"},   {"fisheye", kFine, ".03 px"}};

}  // namespace

GST_START_TEST(test_who_follows_the_ghost_is_more_exact) {
  const auto& cell = kCells[__i__];
  const unsigned seeds = scenes::full_count() ? 5 : 1;
  std::map<int, std::vector<double>> with;
  std::map<int, std::vector<double>> without;
  int kept = 0;
  int promises = 0;
  for (unsigned seed = 0; seed < seeds; ++seed) {
    const Camera truth = lens_of(cell.model, seed);
    Operator who_follows(truth, cell.look, seed, "auto");
    const Course followed = who_follows.follow();
    const Course ignored = Operator(truth, cell.look, seed, "manual").ignore_hints();
    for (const int views : {10, 15, kViews}) {
      fail_unless(followed.contains(views), "%s: stuck before %d views", cell.model, views);
      const Known& known = followed.at(views);
      with[views].push_back(known.error);
      without[views].push_back(ignored.at(views).error);
      kept += known.error_where_seen <= known.promise ? 1 : 0;
      kept += known.error <= known.promise_anywhere ? 1 : 0;
      promises += 2;
    }
    g_print("%s, corners to %s: done after %.0f s, rms %.3f px\n", cell.model, cell.corners,
            who_follows.done_at().value_or(NAN), followed.at(kViews).rms);
  }
  double ratio = 1;
  for (const auto& [views, errors] : with) {
    g_print("%s, corners to %s, %d views: %.3f px with the ghost, %.3f px without\n", cell.model,
            cell.corners, views, median(errors), median(without[views]));
    ratio *= std::cbrt(median(errors) / median(without[views]));
  }
  g_print("%s, corners to %s: %.2f of the error\n", cell.model, cell.corners, ratio);
  // One session is no statistics, and of five the three numbers of views together are a little.
  fail_unless(ratio < (scenes::full_count() ? 0.65 : 1));
  g_print("promises kept: %d of %d\n", kept, promises);
  fail_unless(kept >= (scenes::full_count() ? 0.7 : 0) * promises);
}
GST_END_TEST;

static Suite* operator_suite() {
  Suite* suite = suite_create("operator");
  TCase* tc = tcase_create("general");
  tcase_set_timeout(tc, 0);
  tcase_add_loop_test(tc, test_who_follows_the_ghost_is_more_exact, 0,
                      scenes::full_count() ? static_cast<int>(G_N_ELEMENTS(kCells)) : 1);
  suite_add_tcase(suite, tc);
  return suite;
}

GST_CHECK_MAIN(operator)
