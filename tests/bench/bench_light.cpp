// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A moving light: found, error of its place and time, beside OpenCV's SimpleBlobDetector.
//   bench_light [FRAMES] [WIDTH HEIGHT]
// FRAMES per class (300) at 1280x720. OpenCV's looks for light blobs in each frame by itself, and
// is credited with the one that is nearest to the light.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <opencv2/features2d.hpp>

#include "detect_subjects.hpp"
#include "light_video.hpp"

namespace bench {
namespace {

struct LightClass {
  const char* name;
  double glow;   // grey levels
  double noise;  // grey levels
  double dark;   // grey levels, of the room
  int lamps;
};
constexpr LightClass kClasses[] = {{"dark room", 1500, 2, 20, 0},
                                   {"dim light", 150, 2, 20, 0},
                                   {"noise 6", 1500, 6, 20, 0},
                                   {"lamps", 1500, 2, 20, 12},
                                   {"lit room", 1500, 3, 120, 6}};

struct Score {
  int found = 0;
  double square = 0;
  std::vector<double> ms;

  void add(double off, double took) {
    ms.push_back(took);
    if (!(off < 5)) return;
    ++found;
    square += off * off;
  }
  [[nodiscard]] double quantile(double share) {
    std::sort(ms.begin(), ms.end());
    return ms[static_cast<std::size_t>(share * static_cast<double>(ms.size() - 1))];
  }
  void print(const char* who, int frames) {
    std::printf(" | %-7s %4d/%-4d %7.4f %7.3f %7.3f", who, found, frames,
                std::sqrt(square / std::max(found, 1)), quantile(0.5), quantile(0.95));
  }
};

cv::Ptr<cv::SimpleBlobDetector> opencv_detector() {
  cv::SimpleBlobDetector::Params params;
  params.filterByColor = true;
  params.blobColor = 255;
  params.minArea = 3;
  params.filterByConvexity = false;
  params.filterByInertia = false;
  return cv::SimpleBlobDetector::create(params);
}

void measure(const LightClass& kind, int frames, calvin::ImageSize size) {
  calvin::scenes::LightVideo video(size, {.noise = kind.noise,
                                          .blur = 0.8,
                                          .dark = kind.dark,
                                          .glow = kind.glow,
                                          .lamps = kind.lamps});
  const calvin::Motion motion(calvin::MotionKind::kRandom, video.camera(), video.light(), 3);
  const auto detector = opencv_detector();
  video.look_at_the_room(3);
  Score ours;
  Score theirs;
  for (int i = 0; i < frames; ++i) {
    const Eigen::Vector3d at = motion.camera_from_board(i).translation;
    const calvin::Pixel truth = video.camera().project(at).value();
    const auto off = [&](double u, double v) { return std::hypot(u - truth.u, v - truth.v); };
    calvin::GrayImage image = video.picture({at});
    double begin = thread_ms();
    const calvin::Observation seen = video.follow(image).observation;
    const double took = thread_ms() - begin;
    ours.add(seen.found() ? off(seen.uv[0].u, seen.uv[0].v) : HUGE_VAL, took);
    const cv::Mat picture(image.height, image.width, CV_8U, image.pixels.data());
    std::vector<cv::KeyPoint> points;
    begin = thread_ms();
    detector->detect(picture, points);
    const double their_time = thread_ms() - begin;
    double nearest = HUGE_VAL;
    for (const cv::KeyPoint& p : points) nearest = std::min(nearest, off(p.pt.x, p.pt.y));
    theirs.add(nearest, their_time);
  }
  std::printf("%-10s", kind.name);
  ours.print("calvin", frames);
  theirs.print("OpenCV", frames);
  std::printf(" | %.1f times faster\n", theirs.quantile(0.5) / ours.quantile(0.5));
  std::fflush(stdout);
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::atoi(argv[1]) : 300;
  const calvin::ImageSize size = argc > 3
                                     ? calvin::ImageSize{std::atoi(argv[2]), std::atoi(argv[3])}
                                     : calvin::ImageSize{1280, 720};
  cv::setNumThreads(1);
  std::printf("%-10s   %-7s %9s %7s %7s %7s\n", "class", "", "found", "RMS px", "ms", "p95");
  for (const auto& kind : bench::kClasses) bench::measure(kind, frames, size);
}
