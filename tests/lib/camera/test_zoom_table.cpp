// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Zoom tables: what is none, and the calibration between their settings against lenses whose truth
// is known everywhere: 12 settings each, calibrated from noisy corners.
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/camera/setting_mixture.hpp"
#include "calvin/camera/setting_weights.hpp"
#include "calvin/camera/zoom_interpolation.hpp"
#include "calvin/camera/zoom_table.hpp"
#include "calvin/solve/difference.hpp"
#include "simulated_zoom.hpp"

namespace calvin {
namespace {

using scenes::Random;
using scenes::ZoomLens;

Calibration plain(double zoom, double f = 500) {
  Calibration calibration = Camera::make("brown5", {640, 480}, {f, f, 320, 240, -0.1, 0, 0, 0, 0})
                                .value()
                                .to_calibration();
  calibration.zoom = zoom;
  return calibration;
}

// ---- What is no table ---------------------------------------------------------------------------

std::string refusal(std::vector<Calibration> calibrations) {
  const auto table = make_zoom_table(std::move(calibrations));
  return table ? "" : table.error().message;
}

TEST(ZoomTable, PutsSettingsInOrder) {
  std::vector<Calibration> all = {plain(300), plain(100), plain(100), plain(200)};
  const double focuses[] = {5, 9, -2, 5};
  for (std::size_t i = 0; i < all.size(); ++i) all[i].focus = focuses[i];
  all[1].camera = "box";
  const auto table = make_zoom_table(all);
  ASSERT_TRUE(table.has_value()) << table.error().message;
  const double zooms[] = {100, 100, 200, 300};
  const double sorted[] = {-2, 9, 5, 5};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(table->settings[i].calibration.zoom, zooms[i]);
    EXPECT_EQ(table->settings[i].calibration.focus, sorted[i]);
    EXPECT_EQ(table->settings[i].calibration.camera, "box");
  }
  EXPECT_EQ(table->camera, "box");
  EXPECT_EQ(groups_of(*table).size(), 3U);
  EXPECT_TRUE(depends_on_focus(*table));
}

TEST(ZoomTable, RefusesWhatIsNotOfOneCamera) {
  EXPECT_NE(refusal({plain(1)}).find("two settings"), std::string::npos);
  Calibration other = plain(2);
  other.zoom.reset();
  EXPECT_NE(refusal({plain(1), other}).find("ZOOM=FILE"), std::string::npos);
  EXPECT_NE(refusal({plain(1), plain(2), plain(1)}).find("zoom 1 twice"), std::string::npos);
  EXPECT_NE(refusal({plain(0), plain(9e8), plain(0.5)}).find("twice"), std::string::npos);
  other = plain(2);
  other.focus = 3;
  EXPECT_NE(refusal({plain(1), other}).find("give the focus of all"), std::string::npos);
  other = plain(2);
  other.image_size = {1280, 960};
  EXPECT_NE(refusal({plain(1), other}).find("1280x960 px"), std::string::npos);
  other =
      Camera::make("brown4", {640, 480}, {500, 500, 320, 240, 0, 0, 0, 0}).value().to_calibration();
  other.zoom = 2;
  EXPECT_NE(refusal({plain(1), other}).find("calibrate all settings with one"), std::string::npos);
  other = plain(2);
  other.sensor_crop = Rectangle{0, 0, 320, 240};
  EXPECT_NE(refusal({plain(1), other}).find("sensor_crop"), std::string::npos);
  Calibration left = plain(1);
  left.camera = "left";
  other = plain(2);
  other.camera = "right";
  EXPECT_NE(refusal({left, other}).find("--camera"), std::string::npos);
  other = left = plain(1);
  other.zoom = 2;
  left.device = CaptureDevice{"/dev/video0", "Box", "", {}};
  other.device = CaptureDevice{"/dev/video0", "Dome", "", {}};
  EXPECT_NE(refusal({left, other}).find("'Dome'"), std::string::npos);
  other.device->name = "Box";
  EXPECT_EQ(refusal({left, other}), "");
  other.zoom = std::nan("");
  EXPECT_NE(refusal({left, other}).find("1e9"), std::string::npos);
}

// ---- Between the settings -----------------------------------------------------------------------

ZoomTable truth_at(const ZoomLens& lens, int settings) {
  std::vector<Calibration> all;
  for (const double zoom : lens.settings(settings)) {
    all.push_back(lens.at(zoom).to_calibration());
    all.back().zoom = zoom;
  }
  return make_zoom_table(std::move(all)).value();
}

ZoomTable calibrated_at(const ZoomLens& lens, int settings, Random& random) {
  return scenes::calibrated_table(lens, settings, 40, 0.05, random);
}

double worst_px(const ZoomLens& lens, const Camera& camera, double zoom) {
  const auto apart = difference(lens.at(zoom), camera);
  EXPECT_TRUE(apart.has_value());
  return apart ? apart->image.max : 1e3;
}

Camera between(const ZoomTable& table, double zoom) {
  const auto found = interpolate(table, {zoom, std::nullopt});
  EXPECT_TRUE(found.has_value());
  EXPECT_EQ(found->remark, "");
  return Camera::make(found->calibration).value();
}

// The largest of all over the quarters of every gap.
double worst_px(const ZoomLens& lens, const ZoomTable& table,
                const std::function<Camera(double)>& camera_at) {
  double worst = 0;
  for (std::size_t i = 0; i + 1 < table.settings.size(); ++i) {
    const double a = *table.settings[i].calibration.zoom;
    const double b = *table.settings[i + 1].calibration.zoom;
    for (const double t : {0.25, 0.5, 0.75}) {
      const double zoom = a + t * (b - a);
      worst = std::max(worst, worst_px(lens, camera_at(zoom), zoom));
    }
  }
  return worst;
}

class EveryLens : public ::testing::TestWithParam<ZoomLens> {};
INSTANTIATE_TEST_SUITE_P(Zoom, EveryLens, ::testing::ValuesIn(scenes::kZoomLenses),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(EveryLens, IsWithinHalfAPixelBetweenTwelveSettings) {
  Random random(7);
  const ZoomLens& lens = GetParam();
  const int rounds = scenes::full_count() ? 20 : 1;
  double worst = 0;
  for (int round = 0; round < rounds; ++round) {
    const ZoomTable table = calibrated_at(lens, 12, random);
    worst = std::max(worst, worst_px(lens, table, [&](double z) { return between(table, z); }));
  }
  RecordProperty("worst_px", std::to_string(worst));
  EXPECT_LT(worst, 0.5);
}

// Without noise: what the curve itself lacks.
TEST_P(EveryLens, IsSmooth) {
  const ZoomLens& lens = GetParam();
  for (const auto& [count, most] : {std::pair(12, 0.06), std::pair(8, 0.3), std::pair(5, 2.0)}) {
    const ZoomTable table = truth_at(lens, count);
    const double worst = worst_px(lens, table, [&](double z) { return between(table, z); });
    RecordProperty("worst_px_of_" + std::to_string(count), std::to_string(worst));
    EXPECT_LT(worst, most) << count << " settings";
  }
}

// What straight lines between the settings lack, all else being the same.
Camera straight_between(const ZoomTable& table, double zoom) {
  const ZoomLaw law = zoom_law(table);
  Calibration mixed = mix_settings(
      table, law, setting_weights(table, law, ZoomCurve::kStraight, {zoom, std::nullopt}));
  mixed.model = table.settings.front().calibration.model;
  mixed.image_size = table.settings.front().calibration.image_size;
  return Camera::make(mixed).value();
}

TEST_P(EveryLens, IsNearerThanStraightLines) {
  const ZoomLens& lens = GetParam();
  const ZoomTable table = truth_at(lens, 12);
  const double smooth = worst_px(lens, table, [&](double z) { return between(table, z); });
  const double straight =
      worst_px(lens, table, [&](double z) { return straight_between(table, z); });
  RecordProperty("worst_px_of_straight", std::to_string(straight));
  EXPECT_LT(2 * smooth, straight);
}

// The focal length of each follows the law of its control.
TEST(ZoomLaw, IsFoundFromTheSettings) {
  const ZoomLaw laws[] = {ZoomLaw::kFocalLength, ZoomLaw::kLogarithm, ZoomLaw::kPower,
                          ZoomLaw::kLogarithm};
  for (std::size_t i = 0; i < scenes::kZoomLenses.size(); ++i) {
    const ZoomLens& lens = scenes::kZoomLenses[i];
    Random random(i);
    EXPECT_EQ(zoom_law(truth_at(lens, 7)), laws[i]) << lens;
    EXPECT_EQ(zoom_law(calibrated_at(lens, 9, random)), laws[i]) << lens;
  }
  EXPECT_EQ(zoom_law(truth_at(scenes::kZoomLenses[0], 2)), ZoomLaw::kLogarithm);
}

TEST_P(EveryLens, IsItselfAtItsSettings) {
  const ZoomTable table = truth_at(GetParam(), 5);
  for (const ZoomSetting& setting : table.settings) {
    const auto found = interpolate(table, {setting.calibration.zoom, std::nullopt});
    ASSERT_TRUE(found.has_value());
    for (const Parameter& p : setting.calibration.parameters) {
      EXPECT_NEAR(found->calibration.find(p.name)->value, p.value, 1e-9 * std::abs(p.value));
    }
  }
}

// Few settings far from each other: a focal length may not turn back between them.
TEST_P(EveryLens, ZoomsOneWay) {
  for (const int count : {2, 3, 4, 7}) {
    const ZoomTable table = truth_at(GetParam(), count);
    double before = 0;
    for (int k = 0; k <= 300; ++k) {
      const ZoomLens& lens = GetParam();
      const double f = between(table, lens.first + k / 300.0 * (lens.last - lens.first)).fx();
      EXPECT_GT(f, before);
      before = f;
    }
  }
}

// e^T C^-1 e over the parameters, between the settings: 1 on average for each of them. The noise is
// such that what the curve lacks is small beside it.
TEST_P(EveryLens, KnowsItsOwnErrors) {
  const ZoomLens& lens = GetParam();
  Random random(11);
  double sum = 0;
  int count = 0;
  const int rounds = scenes::full_count() ? 20 : 3;
  for (int round = 0; round < rounds; ++round) {
    const ZoomTable table = scenes::calibrated_table(lens, 12, 25, 0.3, random);
    for (std::size_t i = 0; i + 1 < table.settings.size(); i += 2) {
      const double zoom =
          (*table.settings[i].calibration.zoom + *table.settings[i + 1].calibration.zoom) / 2;
      const auto found = interpolate(table, {zoom, std::nullopt});
      ASSERT_TRUE(found.has_value());
      sum += scenes::normalised_error(found->calibration, lens.at(zoom));
      ++count;
    }
  }
  EXPECT_GT(sum / count, 0.7);
  EXPECT_LT(sum / count, 1.4);
}

// What one focal length is off by does to all of the mixture, against differences.
TEST(ZoomTable, CarriesTheErrorOfAFocalLengthOn) {
  constexpr double kSigma = 0.01;  // px
  const ZoomLens& lens = scenes::kZoomLenses[2];
  ZoomTable table = truth_at(lens, 7);
  Calibration& own = table.settings[3].calibration;
  own.parameters[0].sigma = kSigma;
  own.covariance = {kSigma * kSigma};
  const double zoom = 0.3 * *own.zoom + 0.7 * *table.settings[4].calibration.zoom;
  const auto value = [&](double change, const std::string& name) {
    ZoomTable other = table;
    other.settings[3].calibration.parameters[0].value += change;
    return interpolate(other, {zoom, std::nullopt})->calibration.find(name)->value;
  };
  const Calibration found = interpolate(table, {zoom, std::nullopt})->calibration;
  std::vector<double> off;
  for (const Parameter& p : found.parameters) {
    const double change = (value(kSigma, p.name) - value(-kSigma, p.name)) / 2;
    EXPECT_EQ(p.sigma.has_value(), change != 0) << p.name;
    if (p.sigma) off.push_back(change);
  }
  ASSERT_EQ(off.size(), 6U) << "fx, k1, k2, p1, p2, k3";
  ASSERT_EQ(found.covariance.size(), off.size() * off.size());
  for (std::size_t r = 0; r < off.size(); ++r) {
    for (std::size_t c = 0; c < off.size(); ++c) {
      const double expected = off[r] * off[c];
      EXPECT_NEAR(found.covariance[r * off.size() + c], expected, 1e-4 * std::abs(expected));
    }
  }
}

// ---- Focus --------------------------------------------------------------------------------------

// A lens that breathes: its focal length and its distortion go with the focus, too.
Camera breathing(double zoom, double focus) {
  const double f = 500 * std::pow(4, zoom) * (1 + 0.06 * focus * (1 + 0.3 * zoom));
  const double q = std::pow(400 / f, 2);
  return Camera::make("brown4", {640, 480},
                      {f, f, 320 + 3 * zoom, 240 + focus,
                       (-0.1 + 0.15 * zoom + 0.02 * focus * focus) / q, 0.01 / q / q, 0, 0})
      .value();
}

TEST(ZoomTable, FollowsTheFocusToo) {
  std::vector<Calibration> all;
  for (const double zoom : {0.0, 0.2, 0.4, 0.6, 0.8, 1.0}) {
    // The near end of the focus is another one at each zoom.
    for (const double focus : {0.0, 0.3, 0.6, 0.9 + 0.1 * zoom}) {
      all.push_back(breathing(zoom, focus).to_calibration());
      all.back().zoom = zoom;
      all.back().focus = focus;
    }
  }
  const ZoomTable table = make_zoom_table(all).value();
  for (const double zoom : {0.0, 0.1, 0.33, 0.71, 1.0}) {
    for (const double focus : {0.0, 0.15, 0.4, 0.85}) {
      const auto found = interpolate(table, {zoom, focus});
      ASSERT_TRUE(found.has_value());
      const auto apart =
          difference(breathing(zoom, focus), Camera::make(found->calibration).value());
      EXPECT_LT(apart->image.max, 0.2) << zoom << ", " << focus;
      EXPECT_EQ(found->calibration.focus, focus);
    }
  }
  // Between zoom 0.4 and 0.6 the settings go to 0.94 and 0.96.
  const auto near_end = interpolate(table, {0.5, 0.95});
  ASSERT_TRUE(near_end.has_value());
  EXPECT_NE(near_end->remark.find("focus of the lens stands at 0.95"), std::string::npos);
  EXPECT_NEAR(*near_end->calibration.focus, 0.94, 1e-12);
  EXPECT_EQ(interpolate(table, {0.6, 0.95})->remark, "");
  const auto unknown = interpolate(table, {0.5, std::nullopt});
  ASSERT_FALSE(unknown.has_value());
  EXPECT_NE(unknown.error().message.find("where the focus stands"), std::string::npos);
}

// One focus for each zoom, as of a lens that was focused anew: then it says nothing.
TEST(ZoomTable, NeedsNoFocusWhereItTellsNothing) {
  std::vector<Calibration> all = {plain(0, 500), plain(1, 800), plain(2, 1100)};
  for (Calibration& c : all) c.focus = 10 * *c.zoom;
  const ZoomTable table = make_zoom_table(all).value();
  const auto without = interpolate(table, {0.5, std::nullopt});
  ASSERT_TRUE(without.has_value());
  EXPECT_FALSE(without->calibration.focus.has_value());
  const auto with = interpolate(table, {0.5, 7});
  ASSERT_TRUE(with.has_value());
  EXPECT_EQ(with->calibration.find("fx")->value, without->calibration.find("fx")->value);
}

// ---- Beyond the table ---------------------------------------------------------------------------

TEST(ZoomTable, EndsWhereItsSettingsEndAndSaysSo) {
  const ZoomTable table = make_zoom_table({plain(100, 500), plain(200, 800)}).value();
  const auto beyond = interpolate(table, {250, std::nullopt});
  ASSERT_TRUE(beyond.has_value());
  EXPECT_NEAR(beyond->calibration.find("fx")->value, 800, 1e-9);
  EXPECT_EQ(beyond->calibration.zoom, 200);
  EXPECT_NE(beyond->remark.find("stands at 250, and the zoom table knows 100 to 200"),
            std::string::npos);
  EXPECT_EQ(interpolate(table, {100, 5})->remark, "");
  for (const auto& zoom : {std::optional<double>(), std::optional(std::nan(""))}) {
    const auto unknown = interpolate(table, {zoom, std::nullopt});
    ASSERT_FALSE(unknown.has_value());
    EXPECT_NE(unknown.error().message.find("zoom 100 to 200"), std::string::npos);
  }
}

// A smooth curve through these leaves what the model allows; the straight line does not.
TEST(ZoomTable, StaysWithinTheModel) {
  std::vector<Calibration> all;
  const double betas[] = {4, 0.0005, 0.0004, 0.0003, 5};
  for (int i = 0; i < 5; ++i) {
    all.push_back(
        Camera::make("eucm", {640, 480}, {300.0 + 60 * i, 300.0 + 60 * i, 320, 240, 0.5, betas[i]})
            .value()
            .to_calibration());
    all.back().zoom = i;
  }
  const ZoomTable table = make_zoom_table(all).value();
  for (double zoom = 0; zoom <= 4; zoom += 0.05) {
    const auto found = interpolate(table, {zoom, std::nullopt});
    ASSERT_TRUE(found.has_value()) << zoom;
    EXPECT_GT(found->calibration.find("beta")->value, 0) << zoom;
  }
}

}  // namespace
}  // namespace calvin
