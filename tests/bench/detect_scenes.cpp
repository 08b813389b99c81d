// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Chooses cameras and poses of boards from a seed and renders them with blur, noise and clutter.

#include "detect_scenes.hpp"

#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "calvin/geometry/se3.hpp"
#include "calvin/synth/random.hpp"
#include "calvin/synth/render.hpp"
#include "scene_drawing.hpp"

namespace bench {

namespace {

using calvin::Board;
using calvin::Camera;
using calvin::Grid;
using calvin::ImageSize;
using calvin::SE3;
using calvin::synth::Uniform;

constexpr double kPi = std::numbers::pi;

Camera camera_of(const SceneClass& kind, ImageSize size, Uniform& random) {
  if (!kind.fisheye) return calvin::default_camera(size, random(50, 80) * kPi / 180);
  // 185 degrees across the shorter side and more.
  const double f = size.width * random(0.24, 0.34);
  return Camera::make("fisheye", size,
                      {f, f, size.width * random(0.49, 0.51), size.height * random(0.49, 0.51),
                       random(-0.02, 0.02), random(-0.005, 0.005), 0, 0})
      .value();
}

// Of the smallest square in view, px.
double least_square(const calvin::Observation& truth, const Grid& board) {
  double least = 1e9;
  for (std::size_t i = 0; i < truth.ids.size(); ++i) {
    for (std::size_t k = i + 1; k < truth.ids.size(); ++k) {
      const int step = truth.ids[k] - truth.ids[i];
      if (step != board.cols && (step != 1 || truth.ids[k] % board.cols == 0)) continue;
      least =
          std::min(least, std::hypot(truth.uv[k].u - truth.uv[i].u, truth.uv[k].v - truth.uv[i].v));
    }
  }
  return least;
}

bool outer_squares_in_view(const Camera& camera, const Grid& board, const SE3& pose) {
  const calvin::BoardArea area = board.outline();
  for (const double x : {area.left, area.right}) {
    for (const double y : {area.top, area.bottom}) {
      const auto at = camera.project(pose * Eigen::Vector3d(x, y, 0));
      if (!at || at->u < 0 || at->v < 0 || at->u > camera.image_size().width - 1 ||
          at->v > camera.image_size().height - 1) {
        return false;
      }
    }
  }
  return true;
}

SE3 pose_of(const SceneClass& kind, const Camera& camera, const Board& of, Uniform& random) {
  const Grid board = of.grid().value();
  const ImageSize size = camera.image_size();
  const calvin::BoardArea area = board.extent();
  const Eigen::Vector3d middle(area.width() / 2, area.height() / 2, 0);
  for (;;) {
    const auto ray = camera.unproject({random(0, size.width - 1), random(0, size.height - 1)});
    if (!ray) continue;
    double squares = random(kind.fill_from, kind.fill_to) *
                     std::min(size.width / (board.cols + 1.0), size.height / (board.rows + 1.0));
    if (kind.square_to > 0) squares = random(kind.square_from, kind.square_to);
    const double distance = camera.fx() * board.mean_step() / squares;
    const double tilt = random(0, kind.tilt);
    const double side = random(0, 2 * kPi);
    const Eigen::Matrix3d rotation =
        calvin::rotation_between(Eigen::Vector3d::UnitZ(), *ray) *
        calvin::exp_so3({tilt * std::cos(side), tilt * std::sin(side), 0}) *
        calvin::exp_so3({0, 0, random(0, 2 * kPi)});
    SE3 pose = {rotation, *ray * distance - rotation * middle};
    const auto truth = calvin::true_observation(camera, of, pose);
    if (truth.ids.size() < 12 || least_square(truth, board) < 8 * board.gap_share()) continue;
    const double seen = static_cast<double>(truth.ids.size()) / board.count();
    if (kind.cut ? (seen > 0.95 || seen < 0.45) : !outer_squares_in_view(camera, board, pose)) {
      continue;
    }
    return pose;
  }
}

// Where the board is in each row: its place is that of the middle one.
calvin::PoseOfRow motion_of(const SceneClass& kind, const Camera& camera, const SE3& pose,
                            Uniform& random) {
  if (!(kind.rolling > 0)) return [pose](double /*v*/) { return pose; };
  const double px = kind.rolling * random(0.3, 1);
  const double angle = random(0, 2 * kPi);
  const Eigen::Vector3d way = px * pose.translation.norm() / camera.fx() *
                              Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
  const double rows = camera.image_size().height - 1;
  return [pose, way, rows](double v) {
    return SE3{pose.rotation, pose.translation + (v / rows - 0.5) * way};
  };
}

cv::Mat to_mat(const calvin::GrayImage& image) {
  return cv::Mat(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.pixels.data()))
      .clone();
}

// Draws fingers into the image from the board's rim, or a card; takes the corners that they cover,
// or nearly, out of the truth.
void cover(cv::Mat& image, Scene& scene, bool card, Uniform& random) {
  calvin::Observation& truth = scene.truth;
  cv::Point2d middle(0, 0);
  for (const auto& p : truth.uv)
    middle += cv::Point2d(p.u, p.v) / static_cast<double>(truth.uv.size());
  cv::Mat mask = cv::Mat::zeros(image.size(), CV_8UC1);
  const int fingers = whole(random, 1, 3);
  for (int i = 0; i < fingers; ++i) {
    const auto& near =
        truth.uv[static_cast<std::size_t>(whole(random, 0, static_cast<int>(truth.uv.size()) - 1))];
    const cv::Point2d tip(near.u, near.v);
    if (card) {
      lay_card(mask, tip, middle, random);
      break;
    }
    cv::Point2d out = tip - middle;
    out *= 1 / std::max(cv::norm(out), 1.0);
    const int thick = whole(random, image.cols / 60, image.cols / 25);
    cv::line(mask, tip, tip + out * static_cast<double>(image.cols), 255, thick, cv::LINE_AA);
  }
  const double grey = random(70, 190);
  image.setTo(grey, mask > 127);
  calvin::Observation seen = truth;
  seen.ids.clear();
  seen.uv.clear();
  seen.sigma.clear();
  cv::Mat distance;
  cv::distanceTransform(255 - (mask > 0), distance, cv::DIST_L2, 5);
  for (std::size_t i = 0; i < truth.ids.size(); ++i) {
    if (distance.at<float>(static_cast<int>(std::lround(truth.uv[i].v)),
                           static_cast<int>(std::lround(truth.uv[i].u))) < 4) {
      scene.covered.push_back(truth.uv[i]);
      continue;
    }
    seen.ids.push_back(truth.ids[i]);
    seen.uv.push_back(truth.uv[i]);
    seen.sigma.push_back(0);
  }
  truth = seen;
}

// The same view with `fine` times as many pixels a px, and `border` px more on each side.
Camera enlarged(const Camera& camera, int border, int fine) {
  std::vector<double> p = camera.parameters();
  p[0] *= fine;
  p[1] *= fine;
  for (const std::size_t i : {2U, 3U}) p[i] = fine * (p[i] + border + 0.5) - 0.5;
  const ImageSize size = camera.image_size();
  return Camera::make(camera.model(),
                      {fine * (size.width + 2 * border), fine * (size.height + 2 * border)}, p)
      .value();
}

cv::Mat rendered(const SceneClass& kind, const Camera& camera, const Board& board,
                 const calvin::PoseOfRow& pose, Uniform& random) {
  // What is blurred comes from beyond the border of the picture too. A lens blurs before the pixels
  // sample, and ink does not run in steps of them: pixels that are blurred afterwards have moved
  // upright edges by a hundredth of a pixel before.
  const int border = kind.cut ? 16 : 0;
  const int fine = kind.ink > 0 ? 4 : 2;
  const calvin::BoardRenderer renderer(enlarged(camera, border, fine));
  calvin::RenderOptions options;
  options.dark = kind.dark;
  options.light = kind.bright;
  const calvin::PoseOfRow pose_of_row = [&](double v) {
    return pose((v + 0.5) / fine - 0.5 - border);
  };
  cv::Mat image;
  const auto render = [&](double background) {
    options.background = background;
    cv::Mat out;
    to_mat(kind.rolling > 0 ? renderer.render(board, pose_of_row, options)
                            : renderer.render(board, pose(0), options))
        .convertTo(out, CV_32F);
    return out;
  };
  if (kind.clutter) {
    const cv::Mat black = render(0);
    const cv::Mat white = render(255);
    cv::Mat around;
    clutter(camera.image_size(), random).convertTo(around, CV_32F, 1 / 255.0);
    cv::resize(around, around, black.size(), 0, 0, cv::INTER_LINEAR);
    image = black + (white - black).mul(around);
  } else {
    image = render(random(80, 170));
  }
  if (kind.ink > 0) {
    const int across = 2 * kind.ink * fine + 1;
    cv::erode(image, image, cv::getStructuringElement(cv::MORPH_ELLIPSE, {across, across}));
  }
  if (kind.light > 0) {
    const double angle = random(0, 2 * kPi);
    const double w = std::hypot(image.cols, image.rows) / 2;
    for (int y = 0; y < image.rows; ++y) {
      for (int x = 0; x < image.cols; ++x) {
        const double t =
            ((x - image.cols / 2.0) * std::cos(angle) + (y - image.rows / 2.0) * std::sin(angle)) /
            w;
        image.at<float>(y, x) *= static_cast<float>(1 - kind.light * (t + 1) / 2);
      }
    }
  }
  if (kind.blur > 0) cv::GaussianBlur(image, image, {0, 0}, fine * kind.blur);
  if (kind.motion > 0) {
    blur_along(image, random(0.3, 1) * kind.motion * fine, random(0, kPi));
  }
  cv::resize(image, image, {}, 1.0 / fine, 1.0 / fine, cv::INTER_AREA);
  image *= kind.exposure;
  const ImageSize size = camera.image_size();
  return image({border, border, size.width, size.height}).clone();
}

}  // namespace

const std::vector<SceneClass>& scene_classes() {
  static const std::vector<SceneClass> kClasses = {
      {.name = "plain"},
      {.name = "35 px squares", .square_from = 33, .square_to = 37, .tilt = 0.35},
      {.name = "tilt", .tilt = 1.15},
      {.name = "small squares", .square_from = 9, .square_to = 15, .tilt = 0.4},
      {.name = "square board", .board = "checkerboard:10x10:25mm"},
      {.name = "large", .fill_from = 0.8, .fill_to = 1.0, .tilt = 0.3},
      {.name = "blur", .blur = 3.5, .square_from = 20, .square_to = 70},
      {.name = "motion", .motion = 10, .square_from = 20, .square_to = 70},
      {.name = "rolling shutter", .rolling = 20},
      {.name = "noise", .noise = 15},
      {.name = "low contrast", .noise = 2, .dark = 110, .bright = 130},
      {.name = "uneven light", .light = 0.85},
      {.name = "fisheye", .fill_from = 0.3, .fill_to = 0.9, .fisheye = true},
      {.name = "clutter", .clutter = true},
      {.name = "jpeg 50", .jpeg = 50},
      {.name = "over-exposed", .blur = 1.5, .exposure = 2.6},
      {.name = "ink gain", .ink = 1},
      {.name = "inverted", .dark = 220, .bright = 30},
      {.name = "all at once",
       .noise = 6,
       .blur = 1.5,
       .motion = 4,
       .square_from = 14,
       .square_to = 60,
       .light = 0.6,
       .dark = 40,
       .bright = 120,
       .jpeg = 60,
       .clutter = true},
      {.name = "fingers", .covered = true},
      {.name = "cards", .carded = true},
      {.name = "out of frame", .fill_from = 0.7, .fill_to = 1.6, .cut = true},
  };
  return kClasses;
}

Scene make_scene(const SceneClass& kind, ImageSize size, std::uint64_t seed) {
  Uniform random(seed, 77);
  Scene scene;
  const char* usual = seed % 3 == 0 ? "checkerboard:11x8:25mm" : "checkerboard:9x6:25mm";
  scene.board = calvin::parse_board(*kind.board != 0 ? kind.board : usual).value();
  const Camera camera = camera_of(kind, size, random);
  const calvin::PoseOfRow pose =
      motion_of(kind, camera, pose_of(kind, camera, scene.board, random), random);
  scene.truth = calvin::true_observation(camera, scene.board, pose);
  cv::Mat image = rendered(kind, camera, scene.board, pose, random);
  // The colours tell which corner is which, and they are exchanged.
  if (kind.bright < kind.dark) {
    for (int& id : scene.truth.ids) id = scene.board.point_count() - 1 - id;
  }
  if (kind.covered || kind.carded) cover(image, scene, kind.carded, random);
  scene.clean = image.clone();
  cv::Mat noise(image.size(), CV_32F);
  cv::RNG generator(seed + 1);
  generator.fill(noise, cv::RNG::NORMAL, 0, kind.noise);
  cv::Mat(image + noise).convertTo(scene.image, CV_8U);
  if (kind.jpeg > 0) {
    std::vector<std::uint8_t> bytes;
    cv::imencode(".jpg", scene.image, bytes, {cv::IMWRITE_JPEG_QUALITY, kind.jpeg});
    scene.image = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
  }
  return scene;
}

cv::Mat make_negative(ImageSize size, std::uint64_t seed) {
  Uniform random(seed, 99);
  cv::Mat image = clutter(size, random);
  const int kind = static_cast<int>(seed % 6);
  if (kind == 0) {
    // A board of another size.
    static const char* const kOthers[] = {"8x6", "9x5",  "10x6", "9x7",
                                          "7x5", "11x8", "8x5",  "10x7"};
    const Board board =
        calvin::parse_board(fmt::format("checkerboard:{}:25mm", kOthers[seed / 6 % 8])).value();
    const SceneClass scene{.name = "", .tilt = 0.6, .clutter = true};
    const Camera camera = camera_of(scene, size, random);
    SE3 pose = pose_of(scene, camera, board, random);
    image = rendered(
        scene, camera, board, [&](double /*v*/) { return pose; }, random);
    image.convertTo(image, CV_8U);
  } else if (kind == 1 || kind == 2) {
    draw_tiles(image, kind == 1, random);
  } else if (kind == 3) {
    draw_textile(image, random);
  } else if (kind == 4) {
    draw_page(image, seed % 12 == 4, random);
  }
  cv::GaussianBlur(image, image, {0, 0}, random(0.6, 1.5));
  cv::Mat noise(image.size(), CV_16S), sum;
  cv::RNG generator(seed + 5);
  generator.fill(noise, cv::RNG::NORMAL, 0, 3);
  image.convertTo(sum, CV_16S);
  cv::Mat(sum + noise).convertTo(image, CV_8U);
  return image;
}

}  // namespace bench
