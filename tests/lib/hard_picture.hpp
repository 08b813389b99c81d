// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Pictures in which everything is bad at once: small blurred squares of little contrast in noise
// and compression, before a cluttered background. Drawn with OpenCV, by no part of the library.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace calvin::hard {

using Random = std::mt19937_64;

inline double draw(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
inline int draw_int(Random& random, int low, int high) {
  return std::uniform_int_distribution<int>(low, high)(random);
}

struct Rules {
  double least_contrast = 80;  // grey levels
  double most_contrast = 120;
  bool is_cut = false;  // by the border of the picture, which leaves .5 to .9 of the corners
};

struct Picture {
  cv::Mat image;
  int cols = 0;  // corners
  int rows = 0;
  double square = 0;  // px, in the middle
  std::vector<cv::Point2d> corners;
};

// A pinhole with one radial coefficient before a board whose corners are whole numbers.
struct Shot {
  cv::Size size;
  double focal = 0;
  double k1 = 0;
  cv::Matx33d rotation;
  cv::Vec3d translation;  // of the first corner

  [[nodiscard]] cv::Point2d project(double x, double y) const {
    const cv::Vec3d p = rotation * cv::Vec3d(x, y, 0) + translation;
    const double a = p[0] / p[2];
    const double b = p[1] / p[2];
    const double scale = focal * (1 + k1 * (a * a + b * b));
    return {scale * a + (size.width - 1) / 2.0, scale * b + (size.height - 1) / 2.0};
  }
  [[nodiscard]] bool has(const cv::Point2d& p, double border) const {
    return p.x >= border && p.y >= border && p.x <= size.width - 1 - border &&
           p.y <= size.height - 1 - border;
  }
};

inline cv::Matx33d random_rotation(Random& random) {
  constexpr double kTilt = 0.65;  // rad
  const double x = draw(random, -kTilt, kTilt);
  const double y = draw(random, -kTilt, kTilt);
  const double z = draw(random, 0, 2 * std::numbers::pi);
  return cv::Matx33d(1, 0, 0, 0, std::cos(x), -std::sin(x), 0, std::sin(x), std::cos(x)) *
         cv::Matx33d(std::cos(y), 0, std::sin(y), 0, 1, 0, -std::sin(y), 0, std::cos(y)) *
         cv::Matx33d(std::cos(z), -std::sin(z), 0, std::sin(z), std::cos(z), 0, 0, 0, 1);
}

// Whether as much of the board is in view as the rules want, and no square of it is below 7 px.
inline bool is_wanted(const Shot& shot, const Picture& picture, const Rules& rules) {
  constexpr double kLeast = 7;  // px
  constexpr double kRim = 1.3;  // squares beyond the corners
  const auto stride = static_cast<std::size_t>(picture.cols);
  double inside = 0;
  for (std::size_t i = 0; i < picture.corners.size(); ++i) {
    const cv::Point2d& p = picture.corners[i];
    if (!shot.has(p, 0)) continue;
    ++inside;
    if (i % stride > 0 && cv::norm(p - picture.corners[i - 1]) < kLeast) return false;
    if (i >= stride && cv::norm(p - picture.corners[i - stride]) < kLeast) return false;
  }
  if (rules.is_cut) {
    const double share = inside / static_cast<double>(picture.corners.size());
    return share >= 0.5 && share <= 0.9;
  }
  for (const double x : {-kRim, picture.cols - 1 + kRim}) {
    for (const double y : {-kRim, picture.rows - 1 + kRim}) {
      if (!shot.has(shot.project(x, y), 3)) return false;
    }
  }
  return true;
}

inline Shot random_shot(Random& random, Picture& picture, const Rules& rules) {
  constexpr std::array<std::array<int, 2>, 4> kSizes = {
      {{640, 480}, {800, 600}, {1024, 768}, {1280, 720}}};
  constexpr std::array<std::array<int, 2>, 4> kBoards = {{{9, 6}, {8, 5}, {7, 6}, {11, 8}}};
  const auto size = kSizes[static_cast<std::size_t>(draw_int(random, 0, 3))];
  const auto board = kBoards[static_cast<std::size_t>(draw_int(random, 0, 3))];
  picture.cols = board[0];
  picture.rows = board[1];
  picture.square = draw(random, 7, 14);
  Shot shot = {
      {size[0], size[1]}, size[0] * draw(random, 0.7, 1.3), draw(random, -0.25, 0.1), {}, {}};
  do {
    if (picture.square < 14)
      picture.square += 0.01;  // tilted boards of squares of 7 px have smaller ones
    shot.rotation = random_rotation(random);
    const cv::Vec3d middle(draw(random, -0.5, 0.5) * size[0] / picture.square,
                           draw(random, -0.5, 0.5) * size[1] / picture.square,
                           shot.focal / picture.square);
    shot.translation =
        middle - shot.rotation * cv::Vec3d((picture.cols - 1) / 2.0, (picture.rows - 1) / 2.0, 0);
    picture.corners.clear();
    for (int row = 0; row < picture.rows; ++row) {
      for (int col = 0; col < picture.cols; ++col) {
        picture.corners.push_back(shot.project(col, row));
      }
    }
  } while (!is_wanted(shot, picture, rules));
  return shot;
}

// Something to be taken for corners: a line, a disc, a frame, letters or stripes.
inline void draw_clutter(cv::Mat& image, Random& random) {
  const cv::Point a(draw_int(random, 0, image.cols), draw_int(random, 0, image.rows));
  const cv::Point b(draw_int(random, 0, image.cols), draw_int(random, 0, image.rows));
  const cv::Scalar grey(draw(random, 10, 245));
  const int kind = draw_int(random, 0, 4);
  const int size = draw_int(random, 4, 14);
  if (kind == 0) {
    cv::line(image, a, b, grey, draw_int(random, 1, 9), cv::LINE_AA);
  } else if (kind == 1) {
    cv::circle(image, a, 4 * size, grey, size % 2 == 0 ? cv::FILLED : 3, cv::LINE_AA);
  } else if (kind == 2) {
    cv::rectangle(image, a, a + cv::Point(8 * size, 5 * draw_int(random, 1, 24)), grey,
                  size % 2 == 0 ? cv::FILLED : 2);
  } else if (kind == 3) {
    cv::putText(image, "Rx" + std::to_string(draw_int(random, 0, 999)), a, draw_int(random, 0, 3),
                draw(random, 0.4, 1.6), grey, draw_int(random, 1, 3), cv::LINE_AA);
  } else {
    for (int k = 0; k < 8; ++k) {
      const cv::Point at = a + cv::Point(2 * size * k, 0);
      cv::rectangle(image, at, at + cv::Point(size, 8 * size), grey, cv::FILLED);
    }
  }
}

inline cv::Mat random_background(Random& random, cv::Size size) {
  constexpr std::array<std::array<int, 2>, 3> kTexture = {
      {{80, 35}, {25, 20}, {7, 8}}};  // px, grey
  constexpr int kThings = 40;
  cv::Mat all(size, CV_32F, cv::Scalar(draw(random, 70, 170)));
  for (const auto& [scale, grey] : kTexture) {
    cv::Mat coarse(size.height / scale + 3, size.width / scale + 3, CV_32F);
    cv::RNG(random()).fill(coarse, cv::RNG::NORMAL, 0, grey);
    cv::Mat fine;
    cv::resize(coarse, fine, size, 0, 0, cv::INTER_CUBIC);
    all += fine;
  }
  for (int i = 0; i < kThings; ++i) draw_clutter(all, random);
  return all;
}

// Paints the board and its paper: the mean over 25 points of each pixel that it reaches.
inline void draw_board(cv::Mat& image, Random& random, const Shot& shot, const Picture& picture,
                       double contrast) {
  constexpr int kPoints = 5;  // a side
  const double dark = draw(random, 30, std::min(120.0, 235 - contrast));
  const double margin = 1 + draw(random, 0.25, 1);
  const double light = draw(random, -0.35, 0.35);  // across the board
  const cv::Matx33d& r = shot.rotation;
  const cv::Vec3d& t = shot.translation;
  const cv::Matx33d inverse =
      cv::Matx33d(r(0, 0), r(0, 1), t[0], r(1, 0), r(1, 1), t[1], r(2, 0), r(2, 1), t[2]).inv();
  const auto grey_at = [&](double u, double v, double behind) {
    const double a = (u - (image.cols - 1) / 2.0) / shot.focal;
    const double b = (v - (image.rows - 1) / 2.0) / shot.focal;
    double scale = 1;
    for (int i = 0; i < 6; ++i) scale = 1 + shot.k1 * (a * a + b * b) / (scale * scale);
    const cv::Vec3d p = inverse * cv::Vec3d(a / scale, b / scale, 1);
    const double x = p[0] / p[2];
    const double y = p[1] / p[2];
    const bool on_paper = x >= -margin && y >= -margin && x < picture.cols - 1 + margin &&
                          y < picture.rows - 1 + margin;
    if (!on_paper) return behind;
    const bool on_squares = x >= -1 && y >= -1 && x < picture.cols && y < picture.rows;
    const int square = static_cast<int>(std::floor(x)) + static_cast<int>(std::floor(y));
    const double grey = on_squares && square % 2 == 0 ? dark : dark + contrast;
    return grey * (1 + light * (x / picture.cols - 0.5));
  };
  std::vector<cv::Point2f> around(picture.corners.begin(), picture.corners.end());
  const int rim = static_cast<int>(6 * picture.square);
  const cv::Rect box = cv::boundingRect(around);
  const cv::Rect reach =
      cv::Rect(box.x - rim, box.y - rim, box.width + 2 * rim, box.height + 2 * rim) &
      cv::Rect({0, 0}, image.size());
  for (int v = reach.y; v < reach.br().y; ++v) {
    for (int u = reach.x; u < reach.br().x; ++u) {
      auto& pixel = image.at<float>(v, u);
      double sum = 0;
      for (int k = 0; k < kPoints * kPoints; ++k) {
        sum += grey_at(u - 0.5 + (k % kPoints + 0.5) / kPoints,
                       v - 0.5 + (k / kPoints + 0.5) / kPoints, static_cast<double>(pixel));
      }
      pixel = static_cast<float>(sum / (kPoints * kPoints));
    }
  }
}

// 640x480 to 1280x720, squares of 7 to 14 px, blur of 1 to 2 px, noise of 8 to 16 grey levels, JPEG
// of a quality of 40 to 70.
inline Picture make_picture(std::uint64_t seed, const Rules& rules) {
  Random random(7919 * seed + 13);
  Picture picture;
  const Shot shot = random_shot(random, picture, rules);
  cv::Mat image = random_background(random, shot.size);
  draw_board(image, random, shot, picture, draw(random, rules.least_contrast, rules.most_contrast));
  const double blur = draw(random, 1, 2);
  cv::GaussianBlur(image, image, {0, 0}, blur, blur, cv::BORDER_REPLICATE);
  cv::Mat noise(shot.size, CV_32F);
  cv::RNG(random()).fill(noise, cv::RNG::NORMAL, 0, draw(random, 8, 16));
  image += noise;
  image.convertTo(picture.image, CV_8U);
  std::vector<unsigned char> file;
  cv::imencode(".jpg", picture.image, file, {cv::IMWRITE_JPEG_QUALITY, draw_int(random, 40, 70)});
  picture.image = cv::imdecode(file, cv::IMREAD_GRAYSCALE);
  return picture;
}

}  // namespace calvin::hard
