// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// One test for every camera model: Jacobians against numeric ones, round trips, other pictures.
#include <random>

#include <gtest/gtest.h>

#include "calvin/camera/camera.hpp"
#include "calvin/camera/models.hpp"
#include "lens_samples.hpp"

namespace calvin {
namespace {

template <typename Lens>
const std::vector<std::vector<double>>& coefficients() {
  return samples::lens(Lens::kName).coefficients;
}

Eigen::Vector3d ray(double angle, double direction) {
  return {std::sin(angle) * std::cos(direction), std::sin(angle) * std::sin(direction),
          std::cos(angle)};
}

template <typename Lens>
class CameraModel : public ::testing::Test {
 protected:
  static constexpr ImageSize kSize = {640, 480};

  static std::vector<double> parameters(const std::vector<double>& lens) {
    std::vector<double> all = {520, 518, 325, 236};
    all.insert(all.end(), lens.begin(), lens.end());
    return all;
  }
};

template <typename Tuple>
struct TypesOf;
template <typename... Lens>
struct TypesOf<std::tuple<Lens...>> {
  using Types = ::testing::Types<Lens...>;
};
TYPED_TEST_SUITE(CameraModel, TypesOf<AllLenses>::Types);

TYPED_TEST(CameraModel, JacobiansEqualNumericOnes) {
  using M = Model<TypeParam>;
  constexpr double kSkew = 0.7;
  for (const auto& lens : coefficients<TypeParam>()) {
    std::vector<double> p = this->parameters(lens);
    for (double angle = 0; angle < samples::lens(TypeParam::kName).widest; angle += 0.0973) {
      Eigen::Vector3d point = 1.7 * ray(angle, 9 * angle);
      double uv[2];
      double jp[6];
      double jq[2 * M::kCount];
      ASSERT_TRUE(M::project(p.data(), kSkew, point, uv, jp, jq));
      const auto numeric = [&](double& x, int row) {
        const double keep = x;
        const double h = 1e-6 * std::max(1.0, std::abs(keep));
        double plus[2];
        double minus[2];
        x = keep + h;
        EXPECT_TRUE(M::project(p.data(), kSkew, point, plus, nullptr, nullptr));
        x = keep - h;
        EXPECT_TRUE(M::project(p.data(), kSkew, point, minus, nullptr, nullptr));
        x = keep;
        return (plus[row] - minus[row]) / (2 * h);
      };
      for (int row = 0; row < 2; ++row) {
        for (int i = 0; i < 3; ++i) {
          const double expected = numeric(point[i], row);
          EXPECT_NEAR(jp[3 * row + i], expected, 1e-5 * (1 + std::abs(expected)))
              << "d/dpoint " << i << " at " << angle;
        }
        for (int i = 0; i < M::kCount; ++i) {
          const double expected = numeric(p[static_cast<std::size_t>(i)], row);
          EXPECT_NEAR(jq[M::kCount * row + i], expected, 1e-5 * (1 + std::abs(expected)))
              << "d/d" << M::names()[static_cast<std::size_t>(i)] << " at " << angle;
        }
      }
    }
  }
}

TYPED_TEST(CameraModel, ProjectAndUnprojectInvertEachOther) {
  for (const auto& lens : coefficients<TypeParam>()) {
    const auto camera = Camera::make(TypeParam::kName, this->kSize, this->parameters(lens), 0.3);
    ASSERT_TRUE(camera.has_value()) << camera.error().message;
    int valid = 0;
    for (double angle = 0; angle < samples::lens(TypeParam::kName).widest; angle += 0.0173) {
      for (double direction = 0; direction < 6.28; direction += 0.37) {
        const Eigen::Vector3d expected = ray(angle, direction);
        const auto pixel = camera->project(3.3 * expected);
        if (!pixel) continue;
        const auto found = camera->unproject(*pixel);
        ASSERT_TRUE(found.has_value()) << "angle " << angle << " direction " << direction;
        EXPECT_LT((*found - expected).norm(), 1e-10) << "angle " << angle;
        ++valid;
      }
    }
    EXPECT_GT(valid, 300);
    for (int v = 0; v < 480; v += 13) {
      for (int u = 0; u < 640; u += 17) {
        const Pixel expected = {static_cast<double>(u), static_cast<double>(v)};
        const auto direction = camera->unproject(expected);
        if (!direction) continue;
        EXPECT_NEAR(direction->norm(), 1, 1e-12);
        const auto pixel = camera->project(*direction);
        ASSERT_TRUE(pixel.has_value()) << u << ", " << v;
        EXPECT_NEAR(pixel->u, expected.u, 1e-10 * 640);
        EXPECT_NEAR(pixel->v, expected.v, 1e-10 * 640);
      }
    }
  }
}

TYPED_TEST(CameraModel, ScalingAndCroppingFollowThePixelConvention) {
  for (const auto& lens : coefficients<TypeParam>()) {
    const auto camera = Camera::make(TypeParam::kName, this->kSize, this->parameters(lens), 20);
    ASSERT_TRUE(camera.has_value());
    const Eigen::Vector3d point(0.2, -0.15, 1);
    const auto at = camera->project(point);
    const auto half = camera->scaled({320, 240}).project(point);
    const auto narrow = camera->scaled({160, 960}).project(point);
    const auto part = camera->cropped(100, 50, {300, 300}).project(point);
    ASSERT_TRUE(at && half && narrow && part);
    EXPECT_NEAR(half->u, (at->u + 0.5) / 2 - 0.5, 1e-9);
    EXPECT_NEAR(half->v, (at->v + 0.5) / 2 - 0.5, 1e-9);
    EXPECT_NEAR(narrow->u, (at->u + 0.5) / 4 - 0.5, 1e-9);
    EXPECT_NEAR(narrow->v, (at->v + 0.5) * 2 - 0.5, 1e-9);
    EXPECT_NEAR(part->u, at->u - 100, 1e-9);
    EXPECT_NEAR(part->v, at->v - 50, 1e-9);
  }
}

// A turned picture shows a turned world: the ray (x, y, z) appears as (y, x, z) and so on.
TYPED_TEST(CameraModel, TurningFollowsThePicture) {
  for (const auto& lens : coefficients<TypeParam>()) {
    for (int i = 0; i < 8; ++i) {
      const Orientation o = {(i & 1) != 0, (i & 2) != 0, (i & 4) != 0};
      // Rows and columns of a skew cannot change places.
      const auto camera =
          Camera::make(TypeParam::kName, this->kSize, this->parameters(lens), o.transpose ? 0 : 20);
      ASSERT_TRUE(camera.has_value());
      const auto skewed =
          Camera::make(TypeParam::kName, this->kSize, this->parameters(lens), 20)->turned(o);
      EXPECT_EQ(skewed.has_value(), !o.transpose);
      const auto result = camera->turned(o);
      // Tilts about two axes do not commute.
      if (TypeParam::kName == "tilted14" && o.transpose && lens[12] != 0 && lens[13] != 0) {
        ASSERT_FALSE(result);
        EXPECT_EQ(result.error().code, ErrorCode::kUnsupported);
        continue;
      }
      const Camera& turned = result.value();
      EXPECT_EQ(turned.image_size(), o.transpose ? (ImageSize{480, 640}) : (ImageSize{640, 480}));
      const Eigen::Vector3d point(0.2, -0.15, 1);
      const Pixel at = camera->project(point).value();
      Pixel expected = o.transpose ? Pixel{at.v, at.u} : at;
      Eigen::Vector3d seen = o.transpose ? Eigen::Vector3d(point[1], point[0], 1) : point;
      if (o.flip_x) expected.u = turned.image_size().width - 1 - expected.u, seen[0] = -seen[0];
      if (o.flip_y) expected.v = turned.image_size().height - 1 - expected.v, seen[1] = -seen[1];
      const Pixel found = turned.project(seen).value();
      EXPECT_NEAR(found.u, expected.u, 1e-9) << i;
      EXPECT_NEAR(found.v, expected.v, 1e-9) << i;
      const auto back = turned.turned(o.inverse()).value().parameters();
      for (std::size_t k = 0; k < back.size(); ++k) {
        EXPECT_NEAR(back[k], camera->parameters()[k], 1e-12 * 640) << i;
      }
    }
  }
}

TYPED_TEST(CameraModel, RefusesBrokenParameters) {
  auto p = this->parameters(coefficients<TypeParam>().front());
  const auto refused = [&](std::size_t i, double value) {
    auto broken = p;
    broken[i] = value;
    const auto camera = Camera::make(TypeParam::kName, this->kSize, broken);
    return !camera.has_value() && camera.error().code == ErrorCode::kInvalidArgument &&
           !camera.error().message.empty();
  };
  EXPECT_TRUE(refused(0, -520));
  EXPECT_TRUE(refused(1, 0));
  for (std::size_t i = 0; i < p.size(); ++i) {
    EXPECT_TRUE(refused(i, std::numeric_limits<double>::quiet_NaN()));
    EXPECT_TRUE(refused(i, std::numeric_limits<double>::infinity()));
  }
  for (const double skew : {1e300, -1e13, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_FALSE(Camera::make(TypeParam::kName, this->kSize, p, skew).has_value()) << skew;
  }
  EXPECT_FALSE(Camera::make(TypeParam::kName, {0, 480}, p).has_value());
  p.push_back(0);
  EXPECT_FALSE(Camera::make(TypeParam::kName, this->kSize, p).has_value());
}

TEST(CameraFromCalibration, NamesWhatIsWrong) {
  Calibration c;
  c.image_size = {640, 480};
  c.model = "brown4";
  c.parameters = {{"fx", 500, {}}, {"fy", 500, {}}, {"cx", 320, {}}, {"cy", 240, {}},
                  {"k1", 0, {}},   {"k2", 0, {}},   {"p1", 0, {}},   {"p2", 0, {}}};
  EXPECT_TRUE(Camera::make(c).has_value());
  Calibration sizeless = c;
  sizeless.image_size = {};
  EXPECT_EQ(Camera::make(sizeless).error().code, ErrorCode::kInvalidArgument);
  EXPECT_NE(Camera::make(sizeless).error().message.find("set image_size"), std::string::npos);
  Calibration missing = c;
  missing.parameters.pop_back();
  EXPECT_NE(Camera::make(missing).error().message.find("'p2'"), std::string::npos);
  Calibration extra = c;
  extra.parameters.push_back({"k9", 0, {}});
  EXPECT_NE(Camera::make(extra).error().message.find("'k9'"), std::string::npos);
  Calibration unknown = c;
  unknown.model = "brown99";
  EXPECT_NE(Camera::make(unknown).error().message.find("brown5"), std::string::npos);
}

}  // namespace
}  // namespace calvin
