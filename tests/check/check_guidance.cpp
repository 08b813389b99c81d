// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The guidance meta that calibsolve attaches.

#include <algorithm>
#include <array>

#include "solve_fixture.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;
using check::SolveFixture;

// The same view of the board from the left border of the picture to the right one, or from the
// upper one to the lower one: the bar of that direction grows, and no other.
GST_START_TEST(test_each_bar_is_of_its_own_direction) {
  SolveFixture f;
  const bool down = __i__ == 1;
  Observation o = f.seen(0);
  const auto value = [&](Pixel& p) -> double& { return down ? p.v : p.u; };
  const auto less = [&](Pixel a, Pixel b) { return value(a) < value(b); };
  const auto [low, high] = std::minmax_element(o.uv.begin(), o.uv.end(), less);
  const double room = (down ? 479 : 639) - (value(*high) - value(*low));
  const double first = value(*low);
  std::array<double, 2> along{};
  std::array<double, 2> across{};
  for (int n = 0; n < 2; ++n) {
    Observation moved = o;
    for (Pixel& p : moved.uv) value(p) += n * room - first;
    g_autoptr(GstBuffer) out = f.push_observation(moved, n);
    const auto shown = gst::read_guidance(out);
    along[static_cast<std::size_t>(n)] = down ? shown->y : shown->x;
    across[static_cast<std::size_t>(n)] = down ? shown->x : shown->y;
  }
  fail_unless(along[1] > along[0] + 0.3, "%f %f", along[0], along[1]);
  fail_unless_equals_float(across[1], across[0]);
}
GST_END_TEST;

static Suite* guidance_suite() {
  Suite* suite = suite_create("guidance");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_loop_test(tc, test_each_bar_is_of_its_own_direction, 0, 2);
  return suite;
}

GST_CHECK_MAIN(guidance)
