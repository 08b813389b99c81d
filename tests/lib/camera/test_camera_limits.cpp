// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How far each lens sees, where lenses of different models are the same one, and what is published
// of them.
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "calvin/camera/camera.hpp"
#include "calvin/camera/lens_table.hpp"
#include "calvin/camera/models.hpp"
#include "calvin/camera/monotone.hpp"
#include "lens_samples.hpp"

namespace calvin {
namespace {

Eigen::Vector3d ray(double angle, double direction) {
  return {std::sin(angle) * std::cos(direction), std::sin(angle) * std::sin(direction),
          std::cos(angle)};
}

TEST(PerspectiveModel, IsNotValidBehindTheCamera) {
  const auto camera = Camera::make("brown5", {640, 480}, {520, 518, 325, 236, -.3, .1, 0, 0, 0});
  ASSERT_TRUE(camera.has_value());
  EXPECT_FALSE(camera->project({0.1, 0.1, -1}).has_value());
  EXPECT_FALSE(camera->project({1, 0, 0}).has_value());
  EXPECT_FALSE(camera->project({0, 0, 0}).has_value());
}

TEST(PerspectiveModel, IsNotValidWhereTheDistortionFoldsBack) {
  // x (1 - 0.3 x^2) has its maximum at x = 1/sqrt(0.9).
  const auto camera = Camera::make("brown4", {640, 480}, {500, 500, 320, 240, -0.3, 0, 0, 0});
  ASSERT_TRUE(camera.has_value());
  const double fold = 1 / std::sqrt(0.9);
  const double rim = fold * (1 - 0.3 * fold * fold);
  EXPECT_TRUE(camera->project({fold * 0.999, 0, 1}).has_value());
  EXPECT_FALSE(camera->project({fold * 1.001, 0, 1}).has_value());
  EXPECT_TRUE(camera->unproject({320 + 500 * rim * 0.999, 240}).has_value());
  EXPECT_FALSE(camera->unproject({320 + 500 * rim * 1.001, 240}).has_value());
}

TEST(FisheyeModel, SeesPast90DegreesAndSaysWhereItEnds) {
  const auto camera = Camera::make("fisheye", {640, 480}, {200, 200, 320, 240, 0, 0, 0, 0});
  ASSERT_TRUE(camera.has_value());
  const auto pixel = camera->project(ray(1.9, 0));
  ASSERT_TRUE(pixel.has_value());
  EXPECT_NEAR(pixel->u, 320 + 200 * 1.9, 1e-9);
  EXPECT_LT(camera->unproject(*pixel)->z(), -0.3);
  EXPECT_FALSE(camera->project({0, 0, -1}).has_value());
  EXPECT_FALSE(camera->unproject({320 + 200 * 3.2, 240}).has_value());
}

// How far from the axis a lens sees on its way along x: up to where the formula has no value or the
// picture stops growing, found by walking there.
template <typename M>
double walked_limit(const std::vector<double>& p) {
  constexpr double kStep = 1e-4;
  double last = 0;
  for (double angle = kStep; angle < 3.1415; angle += kStep) {
    double uv[2];
    if (!M::project(p.data(), 0, ray(angle, 0), uv, nullptr, nullptr)) return angle;
    if (!(uv[0] > last) || !std::isfinite(uv[0])) return angle;
    last = uv[0];
  }
  return 3.1415;
}

TEST(Limit, IsWhereThePictureStopsGrowing) {
  std::vector<std::pair<std::string_view, std::vector<double>>> lenses = {
      {"pinhole", {}},
      {"brown5", {-0.3, 0, 0, 0, 0}},
      {"brown5", {0.1, -0.2, 0, 0, 0.01}},
      {"rational8", {0.2, 0, 0, 0, 0, 0.5, 0, 0}},      // grows for ever
      {"rational8", {-0.2, 0.01, 0, 0, 0, 0.5, 0, 0}},  // the numerator folds
      {"rational8", {0.1, 0, 0, 0, 0, -0.25, 0, 0}},    // a pole at r = 2
      {"rational8", {0, 0, 0, 0, 0, 0, 0, 0.02}},       // the denominator folds
      {"fisheye", {0, -0.05, 0, 0}},
      {"fisheye", {0, 0, 0, 0}},
      {"ucm", {-0.3}},
      {"ucm", {0}},
      {"ucm", {0.3}},
      {"ucm", {0.5}},
      {"ucm", {0.8}},
      {"ucm", {1}},
      {"ucm", {1.5}},
      {"eucm", {0.4, 3}},
      {"eucm", {0.7, 0.5}},
      {"eucm", {0.7, 2}},
      {"doublesphere", {0, 0}},
      {"doublesphere", {0.3, 0.4}},
      {"doublesphere", {0.5, 0.8}},
      {"doublesphere", {-0.27, 0.57}},
      {"doublesphere", {-0.9, 0.7}},
      {"doublesphere", {1, 0.6}},
      {"doublesphere", {1.5, 0.3}},
      {"doublesphere", {1.5, -0.5}},
      {"doublesphere", {3, 0.9}},
      {"fov", {0}},
      {"fov", {0.04}},
      {"fov", {-0.3}},
      {"fov", {3}},
  };
  for (const LensTraits& lens : all_lenses()) {
    if (lens.perspective) continue;  // tangential terms move the rim
    for (const auto& d : samples::lens(lens.model).coefficients) lenses.emplace_back(lens.model, d);
  }
  for (const auto& [model, d] : lenses) {
    SCOPED_TRACE(std::string(model) + ::testing::PrintToString(d));
    std::vector<double> p = {1, 1, 0, 0};
    p.insert(p.end(), d.begin(), d.end());
    double walked = 0;
    visit_model(model, [&, &d = p]<typename M>() { walked = walked_limit<M>(d); });
    const auto camera = Camera::make(model, {2, 2}, p);
    ASSERT_TRUE(camera) << camera.error().message;
    EXPECT_TRUE(camera->project(ray(walked - 4e-4, 0.3)));
    EXPECT_TRUE(walked > 3.14 || !camera->project(ray(walked + 4e-4, 0.3)));
    for (double angle = 0; angle < walked - 4e-4; angle += 0.01) {
      const Eigen::Vector3d expected = ray(angle, 0.3);
      const auto pixel = camera->project(expected);
      ASSERT_TRUE(pixel) << angle;
      const auto back = camera->unproject(*pixel);
      ASSERT_TRUE(back) << angle;
      EXPECT_LT((*back - expected).norm(), 1e-6) << angle;
    }
  }
}

// Poles of a rational lens, folds and steep rims at random places.
TEST(Limit, HasOneRayForEachPixelBeforeIt) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coefficient(-1, 1);
  std::size_t count = 0;
  const auto judge = [&](std::string_view model, const std::vector<double>& d) {
    SCOPED_TRACE(std::string(model) + ::testing::PrintToString(d));
    std::vector<double> p = {300, 300, 319.5, 239.5};
    p.insert(p.end(), d.begin(), d.end());
    const auto camera = Camera::make(model, {640, 480}, p);
    if (!camera) return;
    for (double angle = 0.02; angle < 3; angle += 0.02) {
      const auto pixel = camera->project(ray(angle, 0.6));
      if (!pixel || std::hypot(pixel->u, pixel->v) > 1e5) return;
      ++count;
      const auto back = camera->unproject(*pixel);
      ASSERT_TRUE(back) << angle;
      const auto again = camera->project(*back);
      ASSERT_TRUE(again) << angle;
      ASSERT_NEAR(again->u, pixel->u, 1e-6) << angle;
      ASSERT_NEAR(again->v, pixel->v, 1e-6) << angle;
    }
  };
  for (int i = 0; i < 2000; ++i) {
    std::vector<double> d(8);
    for (double& value : d) value = coefficient(random);
    judge("fisheye", {d[0], d[1], d[2], d[3] / 3});
    judge("rational8", {d[0], d[1], 0, 0, d[2], d[3], d[4], d[5]});
  }
  judge("rational8", {0, 0, 0, 0, 0, -0.53, 0, 0});
  judge("fisheye", {0.0731125, -0.288286, 0.364733, -0.050153});
  EXPECT_GT(count, 50000U);
}

TEST(Limit, OfNoLensIsRefused) {
  for (const auto& [model, d] : std::vector<std::pair<std::string_view, std::vector<double>>>{
           {"eucm", {0.5, 0}},
           {"eucm", {0.5, -1}},
           {"doublesphere", {-1, 0.5}},
           {"fov", {3.2}},
           {"tilted14", {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0}}}) {
    std::vector<double> p = {500, 500, 320, 240};
    p.insert(p.end(), d.begin(), d.end());
    const auto camera = Camera::make(model, {640, 480}, p);
    ASSERT_FALSE(camera) << model;
    EXPECT_EQ(camera.error().code, ErrorCode::kInvalidArgument);
    EXPECT_NE(camera.error().message.find(model), std::string::npos);
  }
}

// One lens in the words of another model.
TEST(WideModels, AgreeWhereTheyMeet) {
  const auto make = [](std::string_view model, std::vector<double> d) {
    d.insert(d.begin(), {200, 201, 320, 240});
    return Camera::make(model, {640, 480}, d).value();
  };
  const std::vector<std::pair<Camera, Camera>> pairs = {
      {make("ucm", {0.6}), make("eucm", {0.6, 1})},
      {make("ucm", {0.6}), make("doublesphere", {0, 0.6})},
      {make("ucm", {0}), make("pinhole", {})},
      {make("fov", {0}), make("pinhole", {})},
      {make("fov", {1e-6}), make("pinhole", {})},
      {make("fov", {-0.9}), make("fov", {0.9})},
      // With alpha = 0 xi is Mei's.
      {make("doublesphere", {0.7, 0}),
       Camera::make("ucm", {640, 480}, {200 / 1.7, 201 / 1.7, 320, 240, 0.7 / 1.7}).value()},
  };
  for (const auto& [a, b] : pairs) {
    for (double angle = 0; angle < 1.5; angle += 0.1) {
      const Pixel p = a.project(ray(angle, angle)).value();
      const Pixel q = b.project(ray(angle, angle)).value();
      EXPECT_NEAR(p.u, q.u, 1e-9 * std::abs(p.u)) << angle;
      EXPECT_NEAR(p.v, q.v, 1e-9 * std::abs(p.v)) << angle;
    }
  }
  // Stereographic: 2 tan(theta / 2).
  EXPECT_NEAR(make("ucm", {0.5}).project(ray(2, 0)).value().u, 320 + 400 * std::tan(1.0), 1e-9);
}

// Where 2 tan(w / 2) r_u = tan(w / 2) the picture is as far from the axis as the object.
TEST(FovModel, KeepsHalfAFocalLengthWhateverW) {
  for (double w = 0; w < 3; w += 0.01) {
    const auto camera = Camera::make("fov", {640, 480}, {200, 200, 320, 240, w});
    EXPECT_NEAR(camera->project({0.5, 0, 1}).value().u, 420, 1e-9) << w;
  }
}

// The narrow lens of TUM's benchmark for monocular odometry: camera.txt, whose numbers count from
// the picture's edge and in widths and heights of it, and the field of view that goes with it. J.
// Engel, V. Usenko, D. Cremers, A Photometrically Calibrated Benchmark For Monocular Visual
// Odometry, arXiv:1607.02555: 98 x 79 degrees.
TEST(FovModel, SeesAsMuchAsIsPublished) {
  const Camera camera = Camera::make("fov", {1280, 1024},
                                     {1280 * 0.535719308086809, 1024 * 0.669566858850269,
                                      1280 * 0.493248545285398 - 0.5,
                                      1024 * 0.500408664348414 - 0.5, 0.897966326944875})
                            .value();
  const auto angle = [&camera](Pixel a, Pixel b) {
    return std::acos(camera.unproject(a)->dot(*camera.unproject(b))) * 180 / std::numbers::pi;
  };
  EXPECT_NEAR(angle({-0.5, camera.cy()}, {1279.5, camera.cy()}), 98, 0.5);
  EXPECT_NEAR(angle({camera.cx(), -0.5}, {camera.cx(), 1023.5}), 79, 0.5);
}

// The formula alone, as the solver asks it, which has no Camera::make() before it.
TEST(FovModel, HasNoValueFromPiOn) {
  const auto is_lens = [](double w) {
    const std::vector<double> p = {200, 200, 320, 240, w};
    double uv[2];
    bool valid = false;
    visit_model("fov", [&]<typename M>() {
      valid = M::project(p.data(), 0, {0.1, 0.2, 1}, uv, nullptr, nullptr);
    });
    return valid;
  };
  for (const double w : {0.0, 1e-6, 1.0, 3.1, 3.14}) {
    EXPECT_TRUE(is_lens(w)) << w;
    EXPECT_TRUE(is_lens(-w)) << w;
  }
  for (const double w : {std::numbers::pi, 3.2, 4.0, 7.0}) {
    EXPECT_FALSE(is_lens(w)) << w;
    EXPECT_FALSE(is_lens(-w)) << w;
  }
}

TEST(Lenses, BendNothingWhereTheyAreNeutral) {
  for (const LensTraits& lens : all_lenses()) {
    std::vector<double> p = {200, 201, 320, 240};
    p.insert(p.end(), lens.neutral.begin(), lens.neutral.end());
    const auto camera = Camera::make(lens.model, {640, 480}, p);
    ASSERT_TRUE(camera) << camera.error().message;
    for (double angle = 0.1; angle < 1.4; angle += 0.1) {
      const Pixel at = camera->project(ray(angle, angle)).value();
      const double off = std::hypot((at.u - 320) / 200, (at.v - 240) / 201);
      EXPECT_NEAR(off, lens.model == "fisheye" ? angle : std::tan(angle), 1e-12) << lens.model;
    }
  }
}

TEST(Lenses, AreGivenInTheOrderOfTheirCoefficients) {
  const auto brown =
      lenses_where([](const LensTraits& lens) { return lens.opencv == OpenCvForm::kBrown; });
  std::vector<std::size_t> counts;
  for (const LensTraits* lens : brown) counts.push_back(lens->coefficients.size());
  EXPECT_EQ(counts, (std::vector<std::size_t>{0, 4, 5, 8, 12, 14}));
  EXPECT_TRUE(lenses_where([](const LensTraits&) { return false; }).empty());
}

TEST(Monotone, SaysWhereTheImageFoldsBack) {
  const auto check = [](std::string_view model, const std::vector<double>& p) {
    return check_monotone(Camera::make(model, {640, 480}, p).value());
  };
  EXPECT_TRUE(check("pinhole", {500, 500, 320, 240}));
  EXPECT_TRUE(check("brown5", {500, 500, 320, 240, -0.28, 0.1, 1e-3, 1e-3, -0.01}));
  EXPECT_TRUE(check("fisheye", {180, 180, 320, 240, 0, 0, 0, 0}));
  // x (1 - 0.3 x^2) ends at 0.7027, with f = 500 after 351.4 px: the first pixel of the border that
  // is farther off is (63, 0), at 351.6. The corners are 400 px off.
  EXPECT_TRUE(check("brown4", {575, 575, 320, 240, -0.3, 0, 0, 0}));
  const auto folded = check("brown4", {500, 500, 320, 240, -0.3, 0, 0, 0});
  ASSERT_FALSE(folded);
  EXPECT_EQ(folded.error().code, ErrorCode::kDegenerate);
  EXPECT_NE(folded.error().message.find("from 352 px off the centre on, as at (63, 0)"),
            std::string::npos)
      << folded.error().message;
  EXPECT_NE(folded.error().message.find("the corners are 400 px off"), std::string::npos)
      << folded.error().message;
  // r / (1 + 0.5 r^2) ends at 0.7071.
  EXPECT_TRUE(check("rational8", {575, 575, 320, 240, 0, 0, 0, 0, 0, 0.5, 0, 0}));
  EXPECT_FALSE(check("rational8", {550, 550, 320, 240, 0, 0, 0, 0, 0, 0.5, 0, 0}));
  // A round picture of 190 px in the middle.
  EXPECT_FALSE(check("fisheye", {100, 100, 320, 240, 0, -0.02, 0, 0}));
  EXPECT_FALSE(check("ucm", {100, 100, 320, 240, 0.7}));
}

}  // namespace
}  // namespace calvin
