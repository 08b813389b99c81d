// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Draws clutter, tiles, textiles, printed pages and covering cards with OpenCV, and blurs along a
// direction.

#include "scene_drawing.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

namespace bench {

using calvin::synth::Uniform;

namespace {

constexpr double kPi = std::numbers::pi;

}  // namespace

int whole(Uniform& random, int low, int high) {
  return low + static_cast<int>(random(0, high - low + 1));
}

cv::Mat clutter(calvin::ImageSize size, Uniform& random) {
  cv::Mat image(size.height, size.width, CV_8UC1, cv::Scalar(random(60, 200)));
  for (int i = 0; i < 120; ++i) {
    const cv::Point a(whole(random, 0, size.width), whole(random, 0, size.height));
    const cv::Point b(whole(random, 0, size.width), whole(random, 0, size.height));
    const int reach = whole(random, 5, size.width / 12);
    const cv::Scalar grey(whole(random, 10, 245));
    switch (i % 4) {
      case 0:
        cv::line(image, a, b, grey, whole(random, 1, 6), cv::LINE_AA);
        break;
      case 1:
        cv::circle(image, a, reach, grey, cv::FILLED, cv::LINE_AA);
        break;
      case 2:
        cv::rectangle(image, a, a + cv::Point(reach, whole(random, 5, 80)), grey, cv::FILLED);
        break;
      default:
        cv::putText(image, fmt::format("{:x}", whole(random, 1 << 20, 1 << 28)), a,
                    cv::FONT_HERSHEY_SIMPLEX, random(0.4, 2), grey, whole(random, 1, 3),
                    cv::LINE_AA);
    }
  }
  return image;
}

void blur_along(cv::Mat& image, double length, double angle) {
  const int reach = static_cast<int>(std::ceil(length / 2)) + 1;
  cv::Mat kernel = cv::Mat::zeros(2 * reach + 1, 2 * reach + 1, CV_32F);
  for (int i = 0; i < 200; ++i) {
    const double t = ((i + 0.5) / 200 - 0.5) * length;
    const double x = reach + t * std::cos(angle);
    const double y = reach + t * std::sin(angle);
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const auto fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
    kernel.at<float>(y0, x0) += (1 - fx) * (1 - fy) / 200;
    kernel.at<float>(y0, x0 + 1) += fx * (1 - fy) / 200;
    kernel.at<float>(y0 + 1, x0) += (1 - fx) * fy / 200;
    kernel.at<float>(y0 + 1, x0 + 1) += fx * fy / 200;
  }
  cv::filter2D(image, image, -1, kernel, {-1, -1}, 0, cv::BORDER_REPLICATE);
}

void lay_card(cv::Mat& mask, cv::Point2d on, cv::Point2d middle, Uniform& random) {
  const double angle = random(0, 2 * kPi);
  const cv::Point2d out(std::cos(angle), std::sin(angle));
  const double beyond = (on - middle).dot(out);
  if (beyond < 15) on += (15 - beyond) * out;
  const cv::Point2d along(-out.y, out.x);
  const double reach = 2 * std::hypot(mask.cols, mask.rows);
  std::vector<cv::Point> corners;
  for (const cv::Point2d& p : {on - reach * along, on + reach * along, on + reach * (along + out),
                               on + reach * (out - along)}) {
    corners.emplace_back(cvRound(16 * p.x), cvRound(16 * p.y));
  }
  cv::fillConvexPoly(mask, corners, 255, cv::LINE_AA, 4);
}

void draw_tiles(cv::Mat& image, bool checkered, Uniform& random) {
  const double side = random(14, 90);
  const int n = 80;
  cv::Mat flat(n * 20, n * 20, CV_8UC1, cv::Scalar(random(120, 220)));
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const double grey =
          checkered ? ((x + y) % 2 == 0 ? 50 : 200) + random(-15, 15) : random(100, 180);
      const int gap = checkered ? 0 : 1;
      cv::rectangle(flat, {x * 20 + gap, y * 20 + gap, 20 - 2 * gap, 20 - 2 * gap}, grey,
                    cv::FILLED);
    }
  }
  const float w = static_cast<float>(image.cols), h = static_cast<float>(image.rows);
  const auto lean = static_cast<float>(random(0.0, 0.35));
  const auto reach = static_cast<float>(20 * std::max(w, h) / side / 2);
  const float m = static_cast<float>(n) * 10;
  const cv::Point2f from[4] = {{m - reach, m - reach},
                               {m + reach, m - reach},
                               {m + reach, m + reach},
                               {m - reach, m + reach}};
  const cv::Point2f to[4] = {{-w * 0.2F + lean * w, -20},
                             {w * 1.2F - lean * w, -20},
                             {w * 1.3F, h * 1.3F},
                             {-w * 0.3F, h * 1.3F}};
  cv::warpPerspective(flat, image, cv::getPerspectiveTransform(from, to), image.size(),
                      cv::INTER_AREA, cv::BORDER_CONSTANT, 128);
}

void draw_textile(cv::Mat& image, Uniform& random) {
  const double a = random(0.2, 0.9), b = random(0.2, 0.9), turn = random(0, kPi);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const double u = x * std::cos(turn) + y * std::sin(turn),
                   v = y * std::cos(turn) - x * std::sin(turn);
      image.at<std::uint8_t>(y, x) =
          cv::saturate_cast<std::uint8_t>(128 + 50 * std::sin(a * u) + 50 * std::sin(b * v));
    }
  }
}

void draw_page(cv::Mat& image, bool keys, Uniform& random) {
  image.setTo(230);
  const double scale = random(0.4, 1.2);
  for (int y = 20; y < image.rows; y += static_cast<int>(34 * scale)) {
    for (int x = 10; x < image.cols; x += static_cast<int>(40 * scale)) {
      if (keys)
        cv::rectangle(image, {x, y, static_cast<int>(30 * scale), static_cast<int>(26 * scale)}, 40,
                      cv::FILLED);
      cv::putText(image, std::string(1, static_cast<char>(whole(random, 65, 90))),
                  {x + 4, y + static_cast<int>(20 * scale)}, cv::FONT_HERSHEY_SIMPLEX, scale * 0.7,
                  whole(random, 0, 255), 2, cv::LINE_AA);
    }
  }
}

}  // namespace bench
