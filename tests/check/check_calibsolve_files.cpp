// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibsolve: the files that it writes, under whatever names and in whatever places.

#include <fcntl.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "calvin/io/calibration_io.hpp"
#include "solve_fixture.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;
using check::SolveFixture;

static int warnings(SolveFixture& f) {
  return static_cast<int>(f.bus.texts(GST_MESSAGE_WARNING).size());
}

// A file that a container was given alone: it cannot be replaced, only overwritten.
GST_START_TEST(test_a_location_that_is_a_mount_point_is_written) {
  check::TemporaryFolder folder;
  const std::string outside = folder / "outside.json";
  const std::string location = folder / "cam.json";
  std::ofstream(outside) << std::string(100000, 'x');
  std::ofstream(location).close();
  // In a world of this process alone: nothing stays mounted where the test fails.
  if (unshare(CLONE_NEWNS) != 0 || mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
      mount(outside.c_str(), location.c_str(), nullptr, MS_BIND, nullptr) != 0) {
    g_print("skipped: a mount takes the rights of root\n");
    return;
  }
  {
    SolveFixture f("location=" + location);
    f.push_views(10);
    f.eos();
    fail_unless_equals_int(warnings(f), 1);
    fail_unless(f.bus.says(GST_MESSAGE_WARNING, "no calibration"), "what was there is kept");
    fail_unless(f.bus.texts(GST_MESSAGE_ERROR).empty());
  }
  umount(location.c_str());
  const auto read = read_calibration(outside);
  fail_unless(read.has_value(), "%s", read ? "" : read.error().message.c_str());
  fail_unless_equals_int(read->views.size(), 10);
}
GST_END_TEST;

// A pipe with room for all that is written to it, under a name or under its number alone.
struct ReadLater {
  explicit ReadLater(const check::TemporaryFolder& folder, bool by_number) {
    constexpr int kRoom = 1 << 20;
    if (by_number) {
      int ends[2] = {-1, -1};
      fail_unless(pipe2(ends, O_CLOEXEC | O_NONBLOCK) == 0);
      reader = ends[0];
      writer = ends[1];
      name = "/dev/fd/" + std::to_string(writer);
    } else {
      name = folder / "pipe";
      fail_unless(mkfifo(name.c_str(), 0600) == 0);
      reader = open(name.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    }
    fail_unless(fcntl(reader, F_SETPIPE_SZ, kRoom) >= 0);
  }
  ~ReadLater() {
    close(reader);
    if (writer >= 0) close(writer);
  }
  std::string bytes() const {
    std::string all;
    char block[4096];
    for (ssize_t n = 0; (n = read(reader, block, sizeof(block))) > 0;) {
      all.append(block, static_cast<std::size_t>(n));
    }
    return all;
  }

  std::string name;
  int reader = -1;
  int writer = -1;
};

// What has been read from a pipe cannot be replaced by anything better.
GST_START_TEST(test_a_pipe_gets_the_final_result_alone) {
  check::TemporaryFolder folder;
  const ReadLater pipe(folder, __i__ == 1);
  SolveFixture f("location=" + pipe.name + " export=opencv-json:" + folder / "cv.json");
  f.push_views(3);
  for (int i = 0; i < 3000 && f.result("intermediate") == nullptr; ++i) g_usleep(10000);
  for (int n = 3; n < 10; ++n) {
    const auto seen = f.bus.named("calib-result").size();
    g_object_set(f.element, "skew", n % 2 != 0, nullptr);  // solves again
    gst_buffer_unref(f.push(n));
    for (int i = 0; i < 3000 && f.bus.named("calib-result").size() == seen; ++i) g_usleep(10000);
  }
  fail_unless(read_calibration(folder / "cv.json").has_value(), "nothing is tested");
  fail_unless(pipe.bytes().empty());
  f.eos();
  fail_unless(f.bus.texts(GST_MESSAGE_ERROR).empty());
  const auto read = parse_calibration(pipe.bytes());
  fail_unless(read.has_value(), "%s", read ? "" : read.error().message.c_str());
  fail_unless_equals_int(read->views.size(), 10);
}
GST_END_TEST;

// The second format would replace the first one, at every solve.
GST_START_TEST(test_two_names_of_one_file_are_refused) {
  check::TemporaryFolder folder;
  std::filesystem::create_directory(folder / "sub");
  std::filesystem::create_symlink("cam.json", folder / "link.json");
  const std::string before = std::filesystem::current_path();
  std::filesystem::current_path(folder / "sub");
  for (const std::string& other : {folder / "link.json", std::string("../cam.json")}) {
    const auto texts = check::errors_at_start(
        "calibsolve", "export", ("calvin:" + folder / "cam.json" + ",ros:" + other).c_str());
    fail_unless(texts.size() == 1 && texts[0].find("twice") != std::string::npos, "%s",
                other.c_str());
  }
  std::filesystem::current_path(before);
}
GST_END_TEST;

GST_START_TEST(test_links_in_a_circle_are_no_location) {
  check::TemporaryFolder folder;
  const std::string location = folder / "a";
  std::filesystem::create_symlink("b", location);
  std::filesystem::create_symlink("a", folder / "b");
  SolveFixture f("location=" + location);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, location.c_str()));
  f.push_views(10);
  f.eos();
  fail_unless(f.bus.says(GST_MESSAGE_ERROR, location.c_str()));
  fail_unless(std::filesystem::is_symlink(location));
}
GST_END_TEST;

// Names of files are bytes; what is shown of them is UTF-8. GStreamer says of other text "please
// file a bug", which ends a test.
GST_START_TEST(test_names_need_not_be_utf8) {
  check::TemporaryFolder folder;
  const std::string location = folder / "caf\xe9.json";
  SolveFixture f;
  g_object_set(f.element, "location", location.c_str(), "camera", "c\xe9line", nullptr);
  f.push_views(10);
  f.eos();
  fail_unless(f.bus.texts(GST_MESSAGE_ERROR).empty());
  const auto read = read_calibration(location);
  fail_unless(read.has_value());
  fail_unless_equals_string(read->camera.c_str(), "c\xef\xbf\xbdline");
  const GstStructure* r = f.result("final");
  const std::string shown = folder / "caf\xef\xbf\xbd.json";
  fail_unless_equals_string(gst_structure_get_string(r, "location"), shown.c_str());
  fail_unless_equals_string(gst_structure_get_string(r, "camera"), "c\xef\xbf\xbdline");
}
GST_END_TEST;

GST_START_TEST(test_what_is_said_of_names_is_utf8) {
  SolveFixture f;
  g_object_set(f.element, "location", "/nowhere/caf\xe9.json", nullptr);
  gst_buffer_unref(f.push(0));
  for (int i = 0; i < 3000 && warnings(f) == 0; ++i) g_usleep(10000);
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, "/nowhere/caf\xef\xbf\xbd.json"));
}
GST_END_TEST;

// The picture names the file of a session that is done. A result waits for the disk a second at the
// most, so that the file of a busy one is named on a later frame.
GST_START_TEST(test_the_hint_names_a_file_in_utf8) {
  check::TemporaryFolder folder;
  SolveFixture f("max-views=5");
  const std::string location = folder / "caf\xe9.json";
  g_object_set(f.element, "location", location.c_str(), nullptr);
  f.push_views(5);
  for (int i = 0; i < 3000 && f.result("final") == nullptr; ++i) g_usleep(10000);
  fail_unless(f.result("final") != nullptr);
  std::string hint;
  for (int i = 0; i < 3000 && hint.find("caf\xef\xbf\xbd.json") == std::string::npos; ++i) {
    g_autoptr(GstBuffer) out = f.push(6 + i);
    const auto guidance = gst::read_guidance(out);
    fail_unless(guidance.has_value() && guidance->done);
    hint = guidance->hint;
    g_usleep(10000);
  }
  fail_unless(hint.find("caf\xef\xbf\xbd.json") != std::string::npos, "%s", hint.c_str());
}
GST_END_TEST;

static bool is_final(const GstStructure* result) {
  return g_strcmp0(gst_structure_get_string(result, "state"), "final") == 0;
}

// What a disk does not take at one moment it may take at another.
GST_START_TEST(test_a_final_result_that_could_not_be_written_is_tried_again_at_the_end) {
  check::TemporaryFolder folder;
  const std::string location = folder / "later/cam.json";
  SolveFixture f("max-views=10 location=" + location);
  f.push_views(10);
  for (int i = 0; i < 3000 && f.result("final") == nullptr; ++i) g_usleep(10000);
  fail_unless(f.result("final") != nullptr);
  fail_if(gst_structure_has_field(f.result("final"), "location"), "there is no such file");
  std::filesystem::create_directory(folder / "later");
  f.eos();
  fail_unless(f.bus.texts(GST_MESSAGE_ERROR).empty());
  fail_unless_equals_int(warnings(f), 1);  // the one at the start
  const auto results = f.bus.named("calib-result");
  fail_unless_equals_int(std::count_if(results.begin(), results.end(), is_final), 1);
  const auto read = read_calibration(location);
  fail_unless(read.has_value(), "%s", read ? "" : read.error().message.c_str());
  fail_unless_equals_int(read->views.size(), 10);
}
GST_END_TEST;

// Of the results on the way the best one, though the next is worse.
GST_START_TEST(test_a_result_that_could_not_be_written_is_tried_again_with_the_next) {
  check::TemporaryFolder folder;
  const std::string location = folder / "later/cam.json";
  SolveFixture f("min-views=10 location=" + location);
  const auto wait_for_results = [&](std::size_t count) {
    for (int i = 0; i < 3000 && f.bus.named("calib-result").size() < count; ++i) g_usleep(10000);
    fail_unless_equals_int(f.bus.named("calib-result").size(), count);
    return check::get(f.bus.named("calib-result").back(), "expected-error");
  };
  f.push_views(10);
  const double best = wait_for_results(1);
  std::filesystem::create_directory(folder / "later");
  for (int n = 10; n < 13; ++n) gst_buffer_unref(f.push(n, 1.005));  // as after a change of zoom
  fail_unless(wait_for_results(2) > best, "nothing is tested");
  const auto read = read_calibration(location);
  fail_unless(read.has_value(), "%s", read ? "" : read.error().message.c_str());
  fail_unless_equals_int(read->views.size(), 10);
}
GST_END_TEST;

static const struct {
  const char* model;
  const char* format;
} kNotHeld[] = {{"ucm", "opencv-yaml"},
                {"eucm", "opencv-xml"},
                {"doublesphere", "ros"},
                {"doublesphere", "opencv-json"},
                {"tilted14", "ros"}};

GST_START_TEST(test_a_lens_that_a_format_does_not_hold_is_an_error_at_the_start) {
  const auto& [model, format] = kNotHeld[__i__];
  GstElement* element = gst_element_factory_make("calibsolve", nullptr);
  g_object_set(element, "model", model, "export", (std::string(format) + ":/tmp/a").c_str(),
               nullptr);
  const auto texts = check::errors_at_start(element);
  fail_unless_equals_int(texts.size(), 1);
  fail_unless(texts[0].find(std::string("format ") + format) != std::string::npos, "%s",
              texts[0].c_str());
  fail_unless(texts[0].find(std::string("like ") + model) != std::string::npos);
  // The other programs' names have no place there.
  for (const char* other : {"ros", "ROS", "OpenCV", "opencv-yaml"}) {
    fail_if(texts[0].find(other) != std::string::npos && other != std::string(format), "%s",
            texts[0].c_str());
  }
}
GST_END_TEST;

GST_START_TEST(test_such_a_lens_is_refused_while_frames_flow) {
  check::TemporaryFolder folder;
  SolveFixture f("export=opencv-json:" + folder / "cv.json");
  f.push_views(10);
  g_object_set(f.element, "model", "doublesphere", nullptr);
  gst_buffer_unref(f.push(10));
  fail_unless(
      f.bus.says(GST_MESSAGE_WARNING, "format opencv-json has no camera model like doublesphere"));
  f.eos();
  fail_unless_equals_int(warnings(f), 1);
  fail_unless(f.bus.texts(GST_MESSAGE_ERROR).empty());
  fail_unless_equals_string(read_calibration(folder / "cv.json")->model.c_str(), "brown5");
}
GST_END_TEST;

// Nobody knows before the first result which lens it will be.
GST_START_TEST(test_model_auto_says_it_at_the_first_result) {
  check::TemporaryFolder folder;
  check::Scene wide;
  wide.camera =
      Camera::make("doublesphere", wide.size, {190, 190, 319.5, 239.5, -0.2, 0.6}).value();
  wide.motion = Motion(MotionKind::kRandom, wide.camera, wide.board, 1);
  SolveFixture f("model=auto min-views=8 export=opencv-yaml:" + folder / "cam.yaml", wide);
  f.push_views(8);
  for (int i = 0; i < 3000 && f.result("intermediate") == nullptr; ++i) g_usleep(10000);
  fail_unless(f.result("intermediate") != nullptr);
  const GstStructure* first = f.bus.named("calib-result").front();
  const std::string model = gst_structure_get_string(first, "model");
  fail_if(can_hold("opencv-yaml", model).has_value(), "%s tests nothing", model.c_str());
  const std::string said = "The file format opencv-yaml has no camera model like " + model;
  fail_unless(f.bus.says(GST_MESSAGE_WARNING, said.c_str()));
}
GST_END_TEST;

// A file that fails keeps no other one from being written.
GST_START_TEST(test_a_file_that_fails_is_the_only_one) {
  check::TemporaryFolder folder;
  {
    SolveFixture f("export=ros:" + folder / "gone/a.yaml" + ",opencv-json:" + folder / "b.json");
    f.push_views(10);
    f.eos();
    fail_unless(f.bus.says(GST_MESSAGE_ERROR, "a.yaml"));
  }
  const auto read = read_calibration(folder / "b.json");
  fail_unless(read.has_value(), "%s", read ? "" : read.error().message.c_str());
}
GST_END_TEST;

static Suite* calibsolve_files_suite() {
  Suite* suite = suite_create("calibsolve_files");
  TCase* tc = tcase_create("general");
  tcase_set_timeout(tc, 60);
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_test(tc, test_a_location_that_is_a_mount_point_is_written);
  tcase_add_loop_test(tc, test_a_pipe_gets_the_final_result_alone, 0, 2);
  tcase_add_test(tc, test_two_names_of_one_file_are_refused);
  tcase_add_test(tc, test_links_in_a_circle_are_no_location);
  tcase_add_test(tc, test_a_file_that_fails_is_the_only_one);
  tcase_add_test(tc, test_names_need_not_be_utf8);
  tcase_add_test(tc, test_what_is_said_of_names_is_utf8);
  tcase_add_test(tc, test_the_hint_names_a_file_in_utf8);
  tcase_add_test(tc, test_a_final_result_that_could_not_be_written_is_tried_again_at_the_end);
  tcase_add_test(tc, test_a_result_that_could_not_be_written_is_tried_again_with_the_next);
  tcase_add_loop_test(tc, test_a_lens_that_a_format_does_not_hold_is_an_error_at_the_start, 0,
                      static_cast<int>(std::size(kNotHeld)));
  tcase_add_test(tc, test_such_a_lens_is_refused_while_frames_flow);
  tcase_add_test(tc, test_model_auto_says_it_at_the_first_result);
  return suite;
}

GST_CHECK_MAIN(calibsolve_files)
