// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibdetect before a board that nobody named: with a wrong text it says which one is in view, by
// a text to paste; with `auto` it takes that one.

#include <cmath>
#include <string>

#include "calvin/synth/render.hpp"
#include "calvin/target/marker_dictionary.hpp"
#include "detect_fixture.hpp"
#include "support.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;

namespace {

constexpr ImageSize kSize = {1280, 960};

// A board in the middle of the picture, a little tilted.
GrayImage picture_of(const Board& board) {
  const BoardArea points = board.extent();
  const BoardArea all = board.outline();
  const Eigen::Vector3d middle((points.left + points.right) / 2, (points.top + points.bottom) / 2,
                               0);
  const SE3 turn = {exp_so3({0.2, -0.1, 0.1}), {0, 0, 0}};
  const Eigen::Vector3d away(0, 0, 1.05 * std::hypot(all.width(), all.height()));
  return render_board(default_camera(kSize), board, {turn.rotation, away - turn.rotation * middle},
                      {.noise = 2, .blur = 0.7});
}

struct BoardsFixture {
  explicit BoardsFixture(const std::string& board)
      : element(check::make_element(("calibdetect mode=sync board=" + board).c_str())),
        bus(element),
        h(check::harness_of(element)) {
    gst_harness_set_src_caps(h, check::caps_of("GRAY8", kSize));
  }
  ~BoardsFixture() {
    bus.detach();
    gst_harness_teardown(h);
  }
  GstBuffer* push(const GrayImage& image) {
    return gst_harness_push_and_pull(h, check::frame_of(image, "GRAY8", frames++));
  }
  GstElement* element;
  check::Bus bus;
  GstHarness* h;
  int frames = 0;
};

}  // namespace

// What is in view, and a board that somebody looks for in its place. The first ten need no table of
// markers.
static const struct {
  const char* shown;
  const char* wanted;
  const char* said;  // of what is in view
} kWrong[] = {
    {"checkerboard:9x6:25mm", "checkerboard:10x7:25mm", "a 9x6 board"},
    {"checkerboard:9x6:25mm", "checkerboard:6x5:25mm", "a 9x6 board"},
    {"checkerboard:9x6:25mm", "puzzle:9x6:20mm", "a 9x6 board"},
    {"checkerboard:8x5:25mm", "circles:8x5:30mm", "checkerboard:8x5:30mm"},
    {"puzzle:9x6:25mm:250,411", "puzzle:9x6:25mm", "puzzle:9x6:25mm:250,411"},
    {"puzzle:10x8:25mm", "circles:7x5:25mm", "puzzle:10x8:25mm"},
    {"circles:7x5:25mm", "circles:8x6:25mm", "circles:7x5:25mm"},
    {"acircles:4x11:25mm", "circles:7x5:30mm", "acircles:4x11:"},
    {"circles:7x5:25mm", "checkerboard:7x5:25mm", "circles:7x5:25mm"},
    {"circles:8x6:25mm:inverted", "circles:8x6:25mm", "circles:8x6:25mm:inverted"},
    {"puzzle:14x9:25mm", "charuco:5x7:40mm:20mm:DICT_6X6_250", "puzzle:14x9:40mm"},
    {"charuco:8x6:25mm:20mm:DICT_5X5_50", "charuco:8x6:25mm:20mm:DICT_4X4_50",
     "charuco:8x6:25mm:20mm:DICT_5X5_50"},
    {"charuco:7x8:25mm:20mm:DICT_6X6_50:legacy", "charuco:7x8:25mm:20mm:DICT_6X6_250",
     "charuco:7x8:25mm:20mm:DICT_6X6_250:legacy"},
    {"charuco:7x8:25mm:20mm:DICT_6X6_50", "charuco:7x8:25mm:20mm:DICT_6X6_50:legacy",
     "charuco:7x8:25mm:20mm:DICT_6X6_50"},
    {"charuco:6x9:25mm:15mm:DICT_4X4_50:inverted", "charuco:6x9:25mm:15mm:DICT_4X4_50",
     "charuco:6x9:25mm:15mm:DICT_4X4_50:inverted"},
    {"charuco:5x7:25mm:20mm:DICT_4X4_50", "charuco:7x5:25mm:20mm:DICT_4X4_50",
     "charuco:5x7:25mm:20mm:DICT_4X4_50"},
    {"charuco:5x7:25mm:20mm:DICT_4X4_50", "checkerboard:9x6:25mm", "charuco:5x7:"},
    {"charuco:9x7:25mm:20mm:DICT_4X4_50", "puzzle:14x9:25mm", "charuco:9x7:25mm:20mm:DICT_4X4_50"},
    {"aprilgrid:6x6:25mm:0.3", "aprilgrid:5x5:25mm:0.3", "aprilgrid:6x6:25mm:0.3"},
    {"aprilgrid:4x3:25mm:0.3:first=12", "aprilgrid:4x3:25mm:0.3",
     "aprilgrid:4x3:25mm:0.3:first=12"},
    {"aprilgrid:5x4:25mm:0.3:tag25h9", "aprilgrid:5x4:25mm:0.3", "tag25h9"},
    {"aprilgrid:6x6:25mm:0.3", "circles:7x5:25mm", "aprilgrid:6x6:25mm:0.3"},
    {"aprilgrid:4x4:25mm:0.2", "aprilgrid:5x5:25mm:0.3", "aprilgrid:4x4:25mm:0.2"},
    {"aruco:5x4:25mm:5mm:DICT_4X4_50:first=3", "aruco:5x4:25mm:5mm:DICT_5X5_50:first=3",
     "aruco:5x4:25mm:5mm:DICT_4X4_50:first=3"},
    {"aruco:5x4:25mm:5mm:DICT_6X6_50", "aruco:6x4:25mm:5mm:DICT_7X7_250",
     "aruco:5x4:25mm:5mm:DICT_6X6_50"},
    {"apriltag:tag36h11:4x3:25mm:10mm:first=5", "charuco:5x7:25mm:20mm:DICT_4X4_50",
     "apriltag:tag36h11:4x3:25mm:10mm:first=5"},
    {"apriltag:tagStandard41h12:4x3:25mm:20mm:first=12", "apriltag:tagStandard41h12:4x3:25mm:20mm",
     "apriltag:tagStandard41h12:4x3:25mm:20mm:first=12"},
    {"checkerboard:9x6:25mm", "checkerboard:9x6:25mm:circles", "checkerboard:9x6:25mm,"},
    {"checkerboard:9x6:25mm:circles=1.1+2.1+1.2", "checkerboard:9x6:25mm:circles",
     "circles=1.1+2.1+1.2"},
};

static bool is_known(const char* board) {
  if (strncmp(board, "apriltag:tagStandard", 20) == 0) return has_april_tag_3();
  return has_opencv_dictionaries() ||
         (strncmp(board, "charuco", 7) != 0 && strncmp(board, "april", 5) != 0 &&
          strncmp(board, "aruco", 5) != 0);
}

GST_START_TEST(test_a_wrong_text_is_answered_by_the_right_one) {
  const auto& [shown, wanted, said] = kWrong[__i__];
  if (!is_known(shown) || !is_known(wanted)) return;
  BoardsFixture f(wanted);
  const GrayImage image = picture_of(parse_board(shown).value());
  std::string hint;
  for (int n = 0; n < 45; ++n) {
    g_autoptr(GstBuffer) out = f.push(image);
    fail_if(gst::read_observations(out)[0].found(), "%s is no %s", shown, wanted);
    hint = gst::read_hint(out).words;
  }
  fail_unless(hint.starts_with("This is ") && hint.find(said) != std::string::npos, "%s: '%s'",
              shown, hint.c_str());
  // First its size may be said, then which board it is.
  fail_unless(f.bus.named("calib-detection").size() <= 2);
}
GST_END_TEST;

// The board that is looked for comes into view: nothing more is said of the other one.
GST_START_TEST(test_the_answer_ends_where_the_board_is_found) {
  BoardsFixture f("puzzle:10x8:25mm");
  const GrayImage other = picture_of(parse_board("circles:7x5:25mm").value());
  for (int n = 0; n < 45; ++n) gst_buffer_unref(f.push(other));
  g_autoptr(GstBuffer) found = f.push(picture_of(parse_board("puzzle:10x8:25mm").value()));
  fail_unless(gst::read_observations(found)[0].found());
  fail_unless(gst::read_hint(found).words.empty());
  g_autoptr(GstBuffer) again = f.push(other);
  fail_unless(gst::read_hint(again).words.empty());
}
GST_END_TEST;

static const char* const kAuto[] = {
    "checkerboard:9x6:30mm",  "checkerboard:9x6:30mm:circles",
    "puzzle:9x6:30mm:120,7",  "circles:7x5:30mm",
    "acircles:4x11:30mm",     "charuco:7x8:30mm:24mm:DICT_6X6_50:legacy",
    "aprilgrid:6x6:30mm:0.3", "aruco:5x4:30mm:6mm:DICT_6X6_50"};

GST_START_TEST(test_auto_takes_what_is_in_view) {
  const char* board = kAuto[__i__];
  if (!is_known(board)) return;
  BoardsFixture f("auto:30mm");
  const GrayImage image = picture_of(parse_board(board).value());
  for (int n = 0; n < 3; ++n) {
    g_autoptr(GstBuffer) out = f.push(image);
    const auto seen = gst::read_observations(out);
    fail_unless_equals_int(seen.size(), 1);
    // A code says which board it is; what has none is looked at twice.
    fail_unless(seen[0].found() || n == 0);
    fail_unless_equals_string(seen[0].board.c_str(), seen[0].found() ? board : "auto");
  }
  fail_unless_equals_int(f.bus.texts(GST_MESSAGE_INFO).size(), 1);
  fail_unless(f.bus.texts(GST_MESSAGE_INFO)[0].find(board) != std::string::npos);
}
GST_END_TEST;

// Another board that is held up in place of the first one is taken, too.
GST_START_TEST(test_auto_takes_the_next_board) {
  BoardsFixture f("auto");
  const GrayImage first = picture_of(parse_board("puzzle:9x6:25mm").value());
  const GrayImage next = picture_of(parse_board("circles:7x5:25mm").value());
  for (int n = 0; n < 3; ++n) gst_buffer_unref(f.push(first));
  for (int n = 0; n < 45; ++n) gst_buffer_unref(f.push(next));
  g_autoptr(GstBuffer) out = f.push(next);
  const auto seen = gst::read_observations(out);
  fail_unless_equals_string(seen[0].board.c_str(), "circles:7x5:25mm");
  fail_unless(seen[0].found());
}
GST_END_TEST;

// Of any size and from anywhere, but no board of another kind.
GST_START_TEST(test_auto_of_puzzles_takes_no_other_kind) {
  BoardsFixture f("puzzle:auto:30mm");
  const GrayImage circles = picture_of(parse_board("circles:7x5:30mm").value());
  for (int n = 0; n < 3; ++n) {
    g_autoptr(GstBuffer) out = f.push(circles);
    const auto seen = gst::read_observations(out);
    fail_unless_equals_string(seen[0].board.c_str(), "puzzle:auto");
    fail_if(seen[0].found());
    const std::string hint = gst::read_hint(out).words;
    fail_unless(n < 2 || hint.find("circles:7x5") != std::string::npos);
  }
  for (const char* board : {"puzzle:9x6:30mm:120,7", "puzzle:11x8:30mm:499,300"}) {
    const GrayImage image = picture_of(parse_board(board).value());
    for (int n = 0; n < 45; ++n) gst_buffer_unref(f.push(image));
    g_autoptr(GstBuffer) out = f.push(image);
    const auto seen = gst::read_observations(out);
    fail_unless_equals_string(seen[0].board.c_str(), board);
    fail_unless(seen[0].found());
  }
}
GST_END_TEST;

GST_START_TEST(test_auto_says_nothing_of_an_empty_room) {
  BoardsFixture f("auto");
  const GrayImage grey(kSize.width, kSize.height, 120);
  for (int n = 0; n < 3; ++n) {
    g_autoptr(GstBuffer) out = f.push(grey);
    fail_unless_equals_int(gst::read_observations(out).size(), 1);
    fail_if(gst::read_observations(out)[0].found());
    fail_unless(gst::read_hint(out).words.empty());
  }
  fail_unless(f.bus.texts(GST_MESSAGE_INFO).empty());
}
GST_END_TEST;

GST_START_TEST(test_auto_of_no_length_is_an_error_that_shows_a_right_one) {
  const auto texts = check::errors_at_start("calibdetect", "board", "auto:wide");
  fail_unless_equals_int(texts.size(), 1);
  fail_unless(texts[0].find("auto:25mm") != std::string::npos);
}
GST_END_TEST;

// A camera that looks at a room with lamps, in which lights are moved.
namespace {

struct LightFixture : BoardsFixture {
  LightFixture() : BoardsFixture("dot") {}

  static Eigen::Vector3d at(int frame) { return {0.04 * frame - 0.4, 0.1, 1.5}; }
  // The next frame, with the light and, if there are to be two, another one in the mirror.
  GstBuffer* push_light(int frame, bool twice = false) {
    const Camera camera = default_camera(kSize);
    const RenderOptions options = {
        .noise = 2, .blur = 0.7, .seed = static_cast<std::uint64_t>(frame), .lamps = 3};
    const Board light = parse_board("dot").value();
    GrayImage image =
        render_board(camera, light, {Eigen::Matrix3d::Identity(), at(frame)}, options);
    if (twice) {
      const Eigen::Vector3d mirrored(at(frame).x(), -at(frame).y(), at(frame).z());
      const GrayImage other =
          render_board(camera, light, {Eigen::Matrix3d::Identity(), mirrored}, options);
      for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        image.pixels[i] = std::max(image.pixels[i], other.pixels[i]);
      }
    }
    return push(image);
  }
};

}  // namespace

GST_START_TEST(test_a_light_is_one_point_with_a_sigma) {
  LightFixture f;
  for (int n = 0; n < 20; ++n) {
    g_autoptr(GstBuffer) out = f.push_light(n);
    const auto seen = gst::read_observations(out);
    fail_unless_equals_int(seen.size(), 1);
    fail_unless_equals_string(seen[0].board.c_str(), "dot");
    fail_unless(seen[0].found() == (n > 0), "the first frame is what is there without it");
    if (!seen[0].found()) continue;
    fail_unless_equals_int(seen[0].ids.size(), 1);
    fail_unless_equals_int(seen[0].ids[0], 0);
    const Pixel truth = default_camera(kSize).project(LightFixture::at(n)).value();
    const double sigma = seen[0].sigma[0];
    fail_unless(sigma > 0 && sigma < 0.1, "%g", sigma);
    fail_unless(std::hypot(seen[0].uv[0].u - truth.u, seen[0].uv[0].v - truth.v) < 6 * sigma);
    fail_unless(gst::read_hint(out).words.empty());
  }
}
GST_END_TEST;

// A dark room is right for a light; and of what is held up beside it nothing is said.
GST_START_TEST(test_the_dark_and_other_boards_are_no_news_to_who_looks_for_a_light) {
  BoardsFixture f("dot");
  const GrayImage board = picture_of(parse_board("checkerboard:9x6:25mm").value());
  for (int n = 0; n < 80; ++n) {
    g_autoptr(GstBuffer) out = f.push(n < 30 ? GrayImage(kSize.width, kSize.height, 3) : board);
    fail_if(gst::read_observations(out)[0].found());
    fail_unless(gst::read_hint(out).words.empty(), "%s", gst::read_hint(out).words.c_str());
  }
  fail_unless(f.bus.named("calib-detection").empty());
}
GST_END_TEST;

GST_START_TEST(test_several_lights_are_refused_and_said_to_be) {
  LightFixture f;
  gst_buffer_unref(f.push_light(40));  // out of the picture
  int said = 0;
  for (int n = 0; n < 10; ++n) {
    g_autoptr(GstBuffer) out = f.push_light(n, true);
    fail_if(gst::read_observations(out)[0].found());
    said += gst::read_hint(out).words.starts_with("Several lights are in view") ? 1 : 0;
  }
  fail_unless_equals_int(said, 10);
  fail_unless_equals_int(f.bus.named("calib-detection").size(), 1);
}
GST_END_TEST;

// Without asking, and once: the size seen stays the same.
GST_START_TEST(test_another_board_is_said_without_asking) {
  check::DetectFixture f("calibdetect mode=sync board=checkerboard:10x7:25mm");
  for (int n = 0; n < 4; ++n) {
    g_autoptr(GstBuffer) out =
        gst_harness_push_and_pull(f.h, check::frame_of(f.scene.picture(3), "GRAY8", n));
    fail_if(gst::read_observations(out)[0].found());
    const auto [hint, wrong_board] = gst::read_hint(out);
    fail_unless(wrong_board);
    fail_unless_equals_string(hint.c_str(), "This is a 9x6 board, I look for 10x7");
  }
  const auto messages = f.bus.named("calib-detection");
  fail_unless_equals_int(messages.size(), 1);
  fail_unless_equals_string(gst_structure_get_string(messages[0], "reason"), "wrong-board");
  fail_unless_equals_string(gst_structure_get_string(messages[0], "seen"), "9x6");
  fail_unless_equals_string(gst_structure_get_string(messages[0], "hint"),
                            "This is a 9x6 board, I look for 10x7");
}
GST_END_TEST;

// The board that is looked for comes into view and goes: the other one is said anew.
GST_START_TEST(test_another_board_is_said_again_after_the_right_one) {
  check::DetectFixture f("calibdetect mode=sync");
  const Board other = parse_board("checkerboard:8x5:25mm").value();
  const GrayImage wrong = render_board(f.scene.camera, other, f.scene.pose(3));
  for (int n = 0; n < 6; ++n) {
    const GrayImage image = n / 2 == 1 ? f.scene.picture(3) : wrong;
    g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, check::frame_of(image, "GRAY8", n));
    fail_unless(gst::read_hint(out).words.empty() == (n / 2 == 1));
  }
  const auto messages = f.bus.named("calib-detection");
  fail_unless_equals_int(messages.size(), 2);
  for (const GstStructure* s : messages) {
    fail_unless_equals_string(gst_structure_get_string(s, "seen"), "8x5");
  }
}
GST_END_TEST;

static Suite* calibdetect_boards_suite(void) {
  Suite* s = suite_create("calibdetect_boards");
  TCase* tc = tcase_create("general");
  suite_add_tcase(s, tc);
  tcase_set_timeout(tc, 120);
  tcase_add_loop_test(tc, test_a_wrong_text_is_answered_by_the_right_one, 0, G_N_ELEMENTS(kWrong));
  tcase_add_test(tc, test_the_answer_ends_where_the_board_is_found);
  tcase_add_test(tc, test_another_board_is_said_without_asking);
  tcase_add_test(tc, test_another_board_is_said_again_after_the_right_one);
  tcase_add_loop_test(tc, test_auto_takes_what_is_in_view, 0, G_N_ELEMENTS(kAuto));
  tcase_add_test(tc, test_auto_takes_the_next_board);
  tcase_add_test(tc, test_auto_of_puzzles_takes_no_other_kind);
  tcase_add_test(tc, test_auto_says_nothing_of_an_empty_room);
  tcase_add_test(tc, test_auto_of_no_length_is_an_error_that_shows_a_right_one);
  tcase_add_test(tc, test_a_light_is_one_point_with_a_sigma);
  tcase_add_test(tc, test_the_dark_and_other_boards_are_no_news_to_who_looks_for_a_light);
  tcase_add_test(tc, test_several_lights_are_refused_and_said_to_be);
  return s;
}

GST_CHECK_MAIN(calibdetect_boards);
