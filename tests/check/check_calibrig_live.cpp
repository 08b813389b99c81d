// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Four live cameras at 30 frames a second through calibdetect and calibrig: every frame that a
// camera delivers comes out, while boards are looked for and the rig is solved; and by a light that
// is carried before them lenses and places come out as they are.

#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include "calvin/io/rig_io.hpp"
#include "live_studio.hpp"
#include "places_file.hpp"

using namespace calvin;

using check::Arrivals;
using check::is_full;
using check::LiveStudio;

namespace {

double worst_focal(const Rig& rig, const std::vector<Calibration>& truth) {
  double worst = 0;
  for (std::size_t c = 0; c < truth.size(); ++c) {
    const Parameter& found = rig.cameras[c].calibration.parameters.front();
    const double error = std::abs(found.value - truth[c].parameters.front().value);
    if (found.sigma) worst = std::max(worst, error / *found.sigma);
  }
  return worst;
}

}  // namespace

GST_START_TEST(test_no_frame_is_lost) {
  const int count = is_full() ? 30 * 60 : 30 * 5;
  check::LiveSettings settings;
  settings.cameras.size = {1280, 720};
  settings.cameras.seconds = is_full() ? 2.5 : 1.5;
  settings.cameras.is_synchronous = true;
  settings.cameras.jitter = settings.cameras.drift = settings.cameras.lost = 0;
  LiveStudio studio(settings);
  studio.run(count);
  studio.end();
  for (const Arrivals& arrivals : studio.arrivals) {
    std::cout << arrivals.count << " of " << count << " frames, at the latest "
              << arrivals.longest / GST_MSECOND << " ms after they were taken, " << arrivals.gaps
              << " gaps\n";
  }
  for (const Arrivals& arrivals : studio.arrivals) {
    fail_unless_equals_int(arrivals.count, count);
    fail_unless_equals_int(arrivals.gaps, 0);
  }
  const auto rig = read_rig(studio.folder / "rig.json");
  fail_unless(rig.has_value() && rig->cameras.size() == studio.frames.size());
  const emulated::Error error = emulated::error_of(*rig, studio.cameras.after);
  std::cout << "e^T C^-1 e / 18 = " << error.square << ", largest " << error.largest << " sigmas\n";
  // The same pictures come again, with the same noise.
  fail_unless(error.largest < 8, "%f", error.largest);
}
GST_END_TEST;

// Four live cameras, each with a clock of its own and frames that it loses: the light is found in
// their pictures, these are paired by time, and the end waits for the solve. Without intrinsics,
// and with them.
GST_START_TEST(test_live_cameras_around_a_light) {
  check::LiveSettings settings;
  settings.cameras.has_light = true;
  settings.cameras.seconds = is_full() ? 30 : 7;
  settings.detector = "calibdetect board=dot";
  settings.has_intrinsics = __i__ > 0;
  LiveStudio studio(settings);
  const std::string places =
      check::write_places(studio.folder, studio.cameras.calibrations, studio.cameras.before);
  g_autoptr(GstElement) element = studio.child("rig");
  g_object_set(element, "places", places.c_str(), nullptr);
  studio.play();
  studio.end();
  const auto rig = read_rig(studio.folder / "rig.json");
  fail_unless(rig.has_value() && rig->cameras.size() == studio.frames.size());
  fail_unless_equals_string(rig->world.c_str(), kPlacesWorld);
  const emulated::Error error = emulated::error_of(*rig, studio.cameras.before);
  const double focal = worst_focal(*rig, studio.cameras.calibrations);
  std::cout << "e^T C^-1 e / 24 = " << error.square << ", largest " << error.largest
            << " sigmas, focal lengths " << focal << ", rms " << rig->rms.value() << " px\n";
  // In which frames the light is found, and so the error, is another one in each run.
  fail_unless(error.square < 4, "%f", error.square);
  fail_unless(error.largest < 6, "%f", error.largest);
  fail_unless(focal < 6, "%f", focal);
  fail_unless(rig->rms.value() < 0.5, "%f px", rig->rms.value());
}
GST_END_TEST;

static Suite* calibrig_live_suite(void) {
  Suite* s = suite_create("calibrig_live");
  TCase* tc = tcase_create("general");
  suite_add_tcase(s, tc);
  tcase_set_timeout(tc, 280);
  tcase_add_test(tc, test_no_frame_is_lost);
  tcase_add_loop_test(tc, test_live_cameras_around_a_light, 0, 2);
  return s;
}

GST_CHECK_MAIN(calibrig_live);
