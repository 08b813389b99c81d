// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Boards of discs: found, error of the centres and time, beside OpenCV's findCirclesGrid.
//   bench_circles [PICTURES] [WIDTH HEIGHT]
// PICTURES per class (100) at 1920x1080, of random poses before a lens with barrel distortion.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <opencv2/calib3d.hpp>

#include "calvin/synth/render.hpp"
#include "detect_subjects.hpp"
#include "scenes.hpp"

namespace bench {
namespace {

struct Circles {
  const char* board;
  cv::Size size;
  int flags;
};
const Circles kBoards[] = {
    {"circles:7x5:30mm", {7, 5}, cv::CALIB_CB_SYMMETRIC_GRID},
    {"acircles:4x11:20mm", {4, 11}, cv::CALIB_CB_ASYMMETRIC_GRID},
    {"circles:14x10:15mm", {14, 10}, cv::CALIB_CB_SYMMETRIC_GRID},
};

struct CircleClass {
  const char* name;
  double tilt;   // rad, at most
  double noise;  // grey levels
  double blur;   // px
};
constexpr CircleClass kClasses[] = {{"facing", 0, 2, 0.7},
                                    {"tilted 60", 1.05, 2, 0.7},
                                    {"noise 8", 0.5, 8, 0.7},
                                    {"blur 2.5", 0.5, 2, 2.5}};

struct Score {
  int boards = 0;
  int discs = 0;
  double square = 0;
  std::vector<double> ms;

  // By the disc that is nearest, whatever its name.
  void add(const calvin::Observation& truth, const std::vector<calvin::Pixel>& centres,
           double took) {
    ms.push_back(took);
    boards += centres.empty() ? 0 : 1;
    for (const calvin::Pixel& p : centres) {
      double least = 25;
      for (const calvin::Pixel& q : truth.uv) {
        least = std::min(least, std::pow(p.u - q.u, 2) + std::pow(p.v - q.v, 2));
      }
      square += least;
      ++discs;
    }
  }
  [[nodiscard]] double quantile(double share) {
    std::sort(ms.begin(), ms.end());
    return ms[static_cast<std::size_t>(share * static_cast<double>(ms.size() - 1))];
  }
  void print(const char* who, int pictures) {
    std::printf(" | %-7s %4d/%-4d %7.4f %7.2f %7.2f", who, boards, pictures,
                std::sqrt(square / std::max(discs, 1)), quantile(0.5), quantile(0.95));
  }
};

void measure(const Circles& circles, const CircleClass& kind, int pictures,
             calvin::ImageSize size) {
  const calvin::Board board = calvin::parse_board(circles.board).value();
  const calvin::Camera camera = calvin::default_camera(size);
  calvin::scenes::Random random(3);
  Score ours;
  Score theirs;
  for (int i = 0; i < pictures; ++i) {
    const calvin::SE3 pose = calvin::scenes::random_pose(camera, board, random, kind.tilt);
    auto image = calvin::render_board(camera, board, pose,
                                      {.noise = kind.noise, .blur = kind.blur, .seed = random()});
    const cv::Mat picture(image.height, image.width, CV_8U, image.pixels.data());
    const auto truth = calvin::true_observation(camera, board, pose);
    const Found found = Subject("calvin", by_calvin).look(picture, board);
    ours.add(truth, found.observation.uv, found.ms);
    std::vector<cv::Point2f> points;
    const double begin = thread_ms();
    const bool seen = cv::findCirclesGrid(picture, circles.size, points, circles.flags);
    const double took = thread_ms() - begin;
    std::vector<calvin::Pixel> centres;
    if (seen) {
      for (const auto& p : points) centres.push_back({p.x, p.y});
    }
    theirs.add(truth, centres, took);
  }
  std::printf("%-10s", kind.name);
  ours.print("calvin", pictures);
  theirs.print("OpenCV", pictures);
  std::printf(" | %.1f times faster\n", theirs.quantile(0.5) / ours.quantile(0.5));
  std::fflush(stdout);
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
  const int pictures = argc > 1 ? std::atoi(argv[1]) : 100;
  const calvin::ImageSize size = argc > 3
                                     ? calvin::ImageSize{std::atoi(argv[2]), std::atoi(argv[3])}
                                     : calvin::ImageSize{1920, 1080};
  cv::setNumThreads(1);
  std::printf("%-10s   %-7s %9s %7s %7s %7s\n", "class", "", "found", "RMS px", "ms", "p95");
  for (const auto& board : bench::kBoards) {
    std::printf("%s\n", board.board);
    for (const auto& kind : bench::kClasses) bench::measure(board, kind, pictures, size);
  }
}
