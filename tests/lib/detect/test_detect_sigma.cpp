// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the detector says of its errors, beside the errors: for pictures of many kinds, each by
// itself, and for the better and the worse corners of each.
#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <numbers>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/camera/image_transform.hpp"
#include "calvin/detect/detector.hpp"
#include "calvin/synth/render.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::kBoard;
using scenes::Random;
using scenes::uniform;

constexpr ImageSize kPicture = {640, 480};

// A picture without noise, as numbers; what happens to it before noise and rounding.
using Grey = std::vector<double>;
using Light = void (*)(Grey&);

struct Kind {
  const char* name;
  double least_tilt = 0;  // degrees, from the line of sight
  double most_tilt = 30;
  RenderOptions options = {.noise = 3, .blur = 0.8};
  Light light = nullptr;
  double grain = 0;  // px, 1 sigma of what noise has in common with its neighbours
  const char* model = "brown5";
  double least = 0.15;  // of the width of the picture
  double most = 0.6;
  bool upright =
      false;  // its rows along those of the picture, tilted about a diagonal of its squares
  double bias = 0.0003;  // px, in common: a sixth of what an edge is rendered to

  friend std::ostream& operator<<(std::ostream& out, const Kind& kind) { return out << kind.name; }
};

double& at(Grey& grey, int x, int y) {
  return grey[static_cast<std::size_t>(y) * kPicture.width + static_cast<std::size_t>(x)];
}

// A lamp to the left: a third of the light is left on the right, and the lower rows have less too.
void gradient(Grey& grey) {
  for (int y = 0; y < kPicture.height; ++y) {
    for (int x = 0; x < kPicture.width; ++x) {
      at(grey, x, y) *= (1 - 0.66 * x / kPicture.width) * (1 - 0.2 * y / kPicture.height);
    }
  }
}

// A lamp close by: a quarter less light every hundred pixels.
void lamp(Grey& grey) {
  for (int y = 0; y < kPicture.height; ++y) {
    for (int x = 0; x < kPicture.width; ++x) at(grey, x, y) *= std::exp(-x / 350.0);
  }
}

// A bright middle.
void vignette(Grey& grey) {
  for (int y = 0; y < kPicture.height; ++y) {
    for (int x = 0; x < kPicture.width; ++x) {
      const double r2 = std::pow((x - 320.0) / 400, 2) + std::pow((y - 240.0) / 400, 2);
      at(grey, x, y) *= std::pow(1 + r2, -2);
    }
  }
}

std::vector<double> gaussian(double sigma, double sigmas) {
  const int reach = static_cast<int>(sigmas * sigma) + 1;
  std::vector<double> weights;
  for (int d = -reach; d <= reach; ++d) weights.push_back(std::exp(-0.5 * d * d / sigma / sigma));
  return weights;
}

// Rows are blurred along u by `left` px at the left border to `right` px at the right one.
void blur_along(Grey& grey, double left, double right) {
  Grey row(static_cast<std::size_t>(kPicture.width));
  std::vector<std::vector<double>> kernels;
  for (int x = 0; x < kPicture.width; ++x) {
    kernels.push_back(gaussian(left + (right - left) * x / kPicture.width, 4));
    const double sum = std::accumulate(kernels.back().begin(), kernels.back().end(), 0.0);
    for (double& w : kernels.back()) w /= sum;
  }
  for (int y = 0; y < kPicture.height; ++y) {
    for (int x = 0; x < kPicture.width; ++x) row[static_cast<std::size_t>(x)] = at(grey, x, y);
    for (int x = 0; x < kPicture.width; ++x) {
      const auto& kernel = kernels[static_cast<std::size_t>(x)];
      int from = x - static_cast<int>(kernel.size() / 2);
      double sum = 0;
      for (const double w : kernel) {
        sum += w * row[static_cast<std::size_t>(std::clamp(from++, 0, kPicture.width - 1))];
      }
      at(grey, x, y) = sum;
    }
  }
}
// An edge of which the blur grows by g px in a px is g sigma / 2 off for who takes it for even.
constexpr double kLeastBlur = 0.3;
constexpr double kMostBlur = 2.5;
constexpr double kBiasOfBlur = (kMostBlur - kLeastBlur) / kPicture.width * 1.6 / 2;
constexpr double kSmear = 2.5;
void smear(Grey& grey) { blur_along(grey, kSmear, kSmear); }
void uneven_blur(Grey& grey) { blur_along(grey, kLeastBlur, kMostBlur); }

// The noise: of variance 1, alike over `grain` px.
Grey noise_of(double grain, Random& random) {
  std::normal_distribution<double> normal(0, 1);
  Grey noise(static_cast<std::size_t>(kPicture.width) * kPicture.height);
  for (double& n : noise) n = normal(random);
  if (!(grain > 0)) return noise;
  std::vector<double> weights = gaussian(grain, 3);
  const double squares = std::inner_product(weights.begin(), weights.end(), weights.begin(), 0.0);
  for (double& w : weights) w /= std::sqrt(squares);
  const int reach = static_cast<int>(weights.size() / 2);
  for (const bool along : {true, false}) {
    Grey next(noise.size());
    for (int y = 0; y < kPicture.height; ++y) {
      for (int x = 0; x < kPicture.width; ++x) {
        for (int d = -reach; d <= reach; ++d) {
          const int u = (x + (along ? d : 0) + kPicture.width) % kPicture.width;
          const int v = (y + (along ? 0 : d) + kPicture.height) % kPicture.height;
          at(next, x, y) += weights[static_cast<std::size_t>(d + reach)] * at(noise, u, v);
        }
      }
    }
    noise = std::move(next);
  }
  return noise;
}

// A lens blurs before pixels take their means: the picture is rendered of pixels half as wide,
// which are blurred, and then of four each.
constexpr int kFine = 2;

Camera fine_camera(const Camera& camera) {
  std::vector<double> p = camera.parameters();
  for (const std::size_t i : {0U, 1U}) p[i] *= kFine;
  for (const std::size_t i : {2U, 3U}) p[i] = scaled_coordinate(p[i], static_cast<double>(kFine));
  return Camera::make(camera.model(), {kFine * kPicture.width, kFine * kPicture.height}, p).value();
}

Grey means_of(const ImageView& fine) {
  Grey grey(static_cast<std::size_t>(kPicture.width) * kPicture.height);
  for (int y = 0; y < fine.height; ++y) {
    for (int x = 0; x < fine.width; ++x) {
      at(grey, x / kFine, y / kFine) += fine.at(x, y) / static_cast<double>(kFine * kFine);
    }
  }
  return grey;
}

// `renderer` is of fine_camera().
GrayImage picture(const BoardRenderer& renderer, const SE3& pose, const Kind& kind,
                  Random& random) {
  RenderOptions clean = kind.options;
  clean.noise = 0;
  clean.blur *= kFine;
  const double exposure = clean.exposure;
  clean.exposure = 1;
  Grey grey = means_of(renderer.render(kBoard, pose, clean).view());
  if (kind.light) kind.light(grey);
  const Grey noise = noise_of(kind.grain, random);
  GrayImage image(kPicture.width, kPicture.height);
  for (std::size_t i = 0; i < grey.size(); ++i) {
    const double g = exposure * grey[i] + kind.options.noise * noise[i];
    image.pixels[i] = static_cast<std::uint8_t>(std::lround(std::clamp(g, 0.0, 255.0)));
  }
  return image;
}

// Ways in which corners may all be off alike.
constexpr std::size_t kWays = 6;
using Ways = std::array<Eigen::Vector2d, kWays>;
constexpr std::array<const char*, kWays> kWayNames = {
    "along u",          "along v",        "from the picture's middle",
    "from the board's", "along its rows", "along its columns"};

struct Error {
  Eigen::Vector2d off;  // px
  Ways ways;
  double sigma = 0;
  double rank = 0;    // of its sigma in its view, 0..1
  bool even = false;  // its column and its row together
};

Camera camera_of(const Kind& kind) {
  if (std::string(kind.model) == "fisheye") {
    return Camera::make("fisheye", kPicture, {210, 210.5, 322, 238, -0.02, 0.005, -0.003, 5e-4})
        .value();
  }
  return default_camera(kPicture);
}

// The board's middle anywhere, so that all of it is seen.
SE3 pose_of(const Kind& kind, const Camera& camera, Random& random) {
  const Eigen::Vector3d middle = kBoard.points().back() / 2;
  for (;;) {
    const auto ray = camera.unproject({uniform(random, 60, 580), uniform(random, 60, 420)});
    if (!ray) continue;
    const double tilt = uniform(random, kind.least_tilt, kind.most_tilt) * std::numbers::pi / 180;
    const double side =
        kind.upright ? std::numbers::pi / 4 : uniform(random, 0, 2 * std::numbers::pi);
    const double extent = uniform(random, kind.least, kind.most) * kPicture.width;
    const Eigen::Matrix3d turn = rotation_between(Eigen::Vector3d::UnitZ(), *ray) *
                                 exp_so3({tilt * std::cos(side), tilt * std::sin(side), 0}) *
                                 exp_so3({0, 0, kind.upright ? 0.0 : uniform(random, -3, 3)});
    const SE3 pose = {turn, *ray * (camera.fx() * 0.2 / extent) - turn * middle};
    if (true_observation(camera, kBoard, pose).ids.size() == 54) return pose;
  }
}

Ways ways_at(const Observation& truth, std::size_t id) {
  const auto way = [](Pixel from, Pixel to) {
    return Eigen::Vector2d(to.u - from.u, to.v - from.v).normalized();
  };
  const std::size_t row = 9 * (id / 9);
  const Pixel middle = {(truth.uv[22].u + truth.uv[31].u) / 2,
                        (truth.uv[22].v + truth.uv[31].v) / 2};
  return {Eigen::Vector2d(1, 0),
          Eigen::Vector2d(0, 1),
          way({319.5, 239.5}, truth.uv[id]),
          way(middle, truth.uv[id]),
          way(truth.uv[row], truth.uv[row + 8]),
          way(truth.uv[id % 9], truth.uv[45 + id % 9])};
}

class Sigma : public ::testing::TestWithParam<Kind> {
 protected:
  void SetUp() override {
    const Kind& kind = GetParam();
    Random random(61);
    const Camera camera = camera_of(kind);
    const BoardRenderer renderer(fine_camera(camera));
    const auto detector = std::move(*make_detector(kBoard));
    const int views = Sigma::views();
    for (int i = 0; i < views; ++i) {
      const SE3 pose = pose_of(kind, camera, random);
      const Observation truth = true_observation(camera, kBoard, pose);
      const GrayImage image = picture(renderer, pose, kind, random);
      const Observation seen = detector->detect(image.view()).observation;
      blur_ += seen.blur / views;
      found_ += seen.found() ? 1.0 / views : 0;
      std::vector<double> sigmas = seen.sigma;
      std::sort(sigmas.begin(), sigmas.end());
      for (std::size_t k = 0; k < seen.ids.size(); ++k) {
        const auto id = static_cast<std::size_t>(seen.ids[k]);
        const auto rank = std::lower_bound(sigmas.begin(), sigmas.end(), seen.sigma[k]);
        errors_.push_back(
            {{seen.uv[k].u - truth.uv[id].u, seen.uv[k].v - truth.uv[id].v},
             ways_at(truth, id),
             seen.sigma[k],
             static_cast<double>(rank - sigmas.begin()) / static_cast<double>(sigmas.size()),
             (id % 9 + id / 9) % 2 == 0});
      }
    }
  }
  // The mean of e^T S^-1 e / 2 of the corners whose sigma has such a rank, and what it may be off:
  // besides the corners each view has a scatter, told by 66 numbers.
  struct Mean {
    double value = 0;
    double spread = 0;
  };
  [[nodiscard]] Mean chi_squared(double from, double to) const {
    double sum = 0;
    int count = 0;
    for (const Error& e : errors_) {
      if (e.rank < from || e.rank >= to) continue;
      sum += e.off.squaredNorm() / (2 * e.sigma * e.sigma);
      ++count;
    }
    return {sum / count, std::sqrt(1.0 / count + 2.0 / 66 / views())};
  }
  [[nodiscard]] static int views() { return scenes::full_count() ? 150 : 28; }

  double found_ = 0;
  double blur_ = 0;  // px, the mean of what it says
  std::vector<Error> errors_;
};

INSTANTIATE_TEST_SUITE_P(
    Pictures, Sigma,
    ::testing::Values(
        Kind{.name = "Plain"}, Kind{.name = "Steep", .least_tilt = 50, .most_tilt = 65},
        // Errors along u and v go together here: their variances are more than what is left of one
        // beside the other.
        Kind{.name = "Rhombic", .least_tilt = 62, .most_tilt = 70, .upright = true},
        Kind{.name = "Small", .least = 0.15, .most = 0.2},
        Kind{.name = "Noisy", .options = {.noise = 12, .blur = 0.8}},
        Kind{.name = "Clean", .options = {.noise = 0, .blur = 0.8}, .least = 0.4, .most = 0.8},
        Kind{.name = "Sharp", .options = {.noise = 3, .blur = 0.3}},
        Kind{.name = "Blurred", .options = {.noise = 3, .blur = 2.5}, .least = 0.4},
        Kind{.name = "OverExposed", .options = {.noise = 3, .blur = 0.8, .exposure = 1.6}},
        Kind{.name = "Gradient",
             .options = {.noise = 1, .blur = 0.8},
             .light = gradient,
             .bias = 0.0005},
        Kind{.name = "GradientOnSteep",
             .least_tilt = 45,
             .most_tilt = 60,
             .light = gradient,
             .bias = 0.001},
        Kind{.name = "Lamp",
             .options = {.noise = 0.3, .blur = 0.8},
             .light = lamp,
             .least = 0.4,
             .upright = true,
             .bias = 0.0005},
        Kind{.name = "Vignette", .light = vignette, .bias = 0.001},
        Kind{.name = "UnevenBlur", .light = uneven_blur, .least = 0.4, .bias = kBiasOfBlur},
        Kind{.name = "Smear", .most_tilt = 10, .light = smear, .least = 0.4, .upright = true},
        Kind{.name = "Grain", .grain = 1.2}, Kind{.name = "Fisheye", .model = "fisheye"},
        Kind{.name = "FisheyeSteep", .least_tilt = 45, .most_tilt = 60, .model = "fisheye"},
        // The lens bends the board more than a surface through its corners follows.
        Kind{.name = "FisheyeLarge",
             .most_tilt = 45,
             .options = {.noise = 12, .blur = 1},
             .model = "fisheye",
             .least = 0.4,
             .most = 0.8}),
    [](const auto& test) { return std::string(test.param.name); });

// Of all corners, and of those whose squares are coloured one way or the other.
void expect_no_bias(const std::vector<Error>& errors, double bias) {
  for (std::size_t w = 0; w < kWays; ++w) {
    for (const std::string which : {"all", "even", "odd"}) {
      double sum = 0;
      double weights = 0;
      for (const Error& e : errors) {
        if (which == "even" ? !e.even : which == "odd" && e.even) continue;
        sum += e.off.dot(e.ways[w]) / (e.sigma * e.sigma);
        weights += 1 / (e.sigma * e.sigma);
      }
      EXPECT_NEAR(sum / weights, 0, bias + 4 / std::sqrt(weights)) << kWayNames[w] << ", " << which;
    }
  }
}

TEST_P(Sigma, IsThatOfTheErrors) {
  expect_no_bias(errors_, GetParam().bias);
  EXPECT_GE(found_, 0.95);
  const Mean all = chi_squared(0, 1);
  EXPECT_NEAR(all.value, 1, 0.15 + 3 * all.spread);
  // Those that seem the best are so by luck too.
  for (const auto& [from, to] : {std::pair{0.0, 0.25}, {0.25, 0.75}, {0.75, 1.0}}) {
    const Mean part = chi_squared(from, to);
    std::cout << "  " << part.value << " +- " << part.spread;
    EXPECT_NEAR(part.value, 1, 0.3 + 3 * part.spread) << from;
  }
  std::cout << ", all " << all.value << " +- " << all.spread << '\n';
  // Of the edges: that of the picture and a pixel's own, which is no Gaussian where there is little
  // else, and the smear of those that it is across.
  const double smeared = GetParam().name == std::string("Smear") ? kSmear : 0;
  const double blur = std::hypot(GetParam().options.blur, smeared, 1 / std::sqrt(12.0));
  if (blur > 0.6 && GetParam().light != uneven_blur) {
    EXPECT_NEAR(blur_ / blur, 1, 0.05);
  }
  // What corners near each other have in common never averages out.
  for (const Error& e : errors_) ASSERT_GT(e.sigma, 0.0003);
}

}  // namespace
}  // namespace calvin
