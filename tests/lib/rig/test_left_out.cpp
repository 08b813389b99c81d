// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// with_left_out(): what it says of a table against what the table is really off by.
#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/camera/zoom_interpolation.hpp"
#include "calvin/rig/zoom/left_out.hpp"
#include "calvin/solve/difference.hpp"
#include "simulated_zoom.hpp"

namespace calvin {
namespace {

using scenes::Random;
using scenes::ZoomLens;

class EveryLens : public ::testing::TestWithParam<ZoomLens> {};
INSTANTIATE_TEST_SUITE_P(LeftOut, EveryLens, ::testing::ValuesIn(scenes::kZoomLenses),
                         [](const auto& test) { return std::string(test.param.name); });

// Of few settings, so that the curve is what is off, and of exact ones. The gaps at both ends,
// which no setting tells of, may be a little worse than the others.
TEST_P(EveryLens, SaysWhatTheTableIsOffByAtMost) {
  const ZoomLens& lens = GetParam();
  for (const int count : {4, 6, 12}) {
    std::vector<Calibration> all;
    for (const double zoom : lens.settings(count)) {
      all.push_back(lens.at(zoom).to_calibration());
      all.back().zoom = zoom;
    }
    const ZoomTable table = with_left_out(make_zoom_table(all).value());
    EXPECT_FALSE(table.settings.back().left_out.has_value());
    double worst = 0;
    for (std::size_t i = 0; i + 1 < all.size(); ++i) {
      EXPECT_EQ(table.settings[i].left_out.has_value(), i > 0);
      const double zoom = (*all[i].zoom + *all[i + 1].zoom) / 2;
      const auto found = interpolate(table, {zoom, std::nullopt});
      const auto apart = difference(lens.at(zoom), Camera::make(found->calibration).value());
      worst = std::max(worst, apart->image.max);
    }
    ASSERT_TRUE(largest_left_out(table).has_value());
    EXPECT_GT(1.2 * *largest_left_out(table), worst) << count << " settings";
  }
}

// A setting that was calibrated at another place of the lens than it says stands out.
TEST(LeftOut, FindsASettingThatIsWrong) {
  const ZoomLens& lens = scenes::kZoomLenses.front();
  Random random(5);
  std::vector<Calibration> all;
  for (const double zoom : lens.settings(8)) {
    all.push_back(scenes::calibrated(lens, zoom, 12, 0.1, random));
  }
  EXPECT_LT(largest_left_out(with_left_out(make_zoom_table(all).value())), 3);
  const double right = *all[4].zoom;
  all[4] = scenes::calibrated(lens, right + 12, 12, 0.1, random);
  all[4].zoom = right;
  const ZoomTable table = with_left_out(make_zoom_table(all).value());
  EXPECT_GT(largest_left_out(table), 5);
  EXPECT_EQ(largest_left_out(table), table.settings[4].left_out);
}

TEST(LeftOut, TellsNothingOfTwoSettings) {
  const ZoomLens& lens = scenes::kZoomLenses.front();
  std::vector<Calibration> all;
  for (const double zoom : lens.settings(2)) {
    all.push_back(lens.at(zoom).to_calibration());
    all.back().zoom = zoom;
  }
  EXPECT_FALSE(largest_left_out(with_left_out(make_zoom_table(all).value())).has_value());
  // Three settings of the focus at one zoom: the middle one has both sides.
  for (Calibration& c : all) c.focus = 0;
  for (const double focus : {1.0, 2.0}) {
    all.push_back(all.front());
    all.back().focus = focus;
  }
  const ZoomTable table = with_left_out(make_zoom_table(all).value());
  EXPECT_FALSE(table.settings[0].left_out.has_value());
  ASSERT_TRUE(table.settings[1].left_out.has_value());
  EXPECT_LT(*table.settings[1].left_out, 1e-6);
  EXPECT_FALSE(table.settings[3].left_out.has_value());
}

}  // namespace
}  // namespace calvin
