// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Boards with a code: corners named, corner error and time, beside OpenCV's detectors of ChArUco
// boards and of AprilTags, and libapriltag's of the families of AprilTag 3.
//   bench_codes [PICTURES] [WIDTH HEIGHT]
// PICTURES per class (100) at 1920x1080. CALVIN_BENCH_CLASS: the classes alone whose names hold it.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include <opencv2/core/version.hpp>
#if CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR >= 7
#include <opencv2/objdetect/charuco_detector.hpp>
#else
#include <opencv2/aruco/charuco.hpp>
#endif

#include "calvin/target/kinds.hpp"
#if BENCH_HAVE_APRILTAG
#include "april_tags.hpp"
#endif
#include "detect_scenes.hpp"
#include "detect_subjects.hpp"

namespace bench {
namespace {

// A board in both tongues; OpenCV's where it has none of its own is empty.
struct Subjects {
  const char* board;
  int cols;  // squares
  int rows;
  int dictionary;                // of OpenCV, negative where it does not know the board
  float marker;                  // of a square
  const char* family = nullptr;  // of libapriltag, whose detector is the peer then
  int bits = 0;                  // that may be wrong for it: its tables for more take gigabytes
};
// Boards with an odd number of rows are the same in every version; ids count from the upper left.
std::vector<std::pair<int, cv::Point2f>> by_opencv_charuco(const cv::Mat& image,
                                                           const Subjects& board) {
  std::vector<int> ids;
  std::vector<cv::Point2f> corners;
#if CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR >= 7
  static const auto detector_of = [](const Subjects& b) {
    const auto dictionary = cv::aruco::getPredefinedDictionary(b.dictionary);
    return cv::aruco::CharucoDetector(
        cv::aruco::CharucoBoard({b.cols, b.rows}, 1, b.marker, dictionary));
  };
  detector_of(board).detectBoard(image, corners, ids);
#else
  const auto dictionary = cv::aruco::getPredefinedDictionary(board.dictionary);
  const auto charuco =
      cv::aruco::CharucoBoard::create(board.cols, board.rows, 1, board.marker, dictionary);
  std::vector<std::vector<cv::Point2f>> markers;
  std::vector<int> marker_ids;
  cv::aruco::detectMarkers(image, dictionary, markers, marker_ids);
  if (!marker_ids.empty()) {
    cv::aruco::interpolateCornersCharuco(markers, marker_ids, image, charuco, corners, ids);
  }
#endif
  std::vector<std::pair<int, cv::Point2f>> all;
  for (std::size_t i = 0; i < ids.size(); ++i) all.emplace_back(ids[i], corners[i]);
  return all;
}

// The corners of single tags, each fitted to the edges of its tag.
std::vector<std::pair<int, std::vector<cv::Point2f>>> tags_by_opencv(const cv::Mat& image,
                                                                     int dictionary, int border) {
  std::vector<std::vector<cv::Point2f>> tags;
  std::vector<int> ids;
#if CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR >= 7
  cv::aruco::DetectorParameters parameters;
  parameters.markerBorderBits = border;
  parameters.cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
  cv::aruco::ArucoDetector(cv::aruco::getPredefinedDictionary(dictionary), parameters)
      .detectMarkers(image, tags, ids);
#else
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->markerBorderBits = border;
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
  cv::aruco::detectMarkers(image, cv::aruco::getPredefinedDictionary(dictionary), tags, ids,
                           parameters);
#endif
  std::vector<std::pair<int, std::vector<cv::Point2f>>> all;
  for (std::size_t i = 0; i < ids.size(); ++i) all.emplace_back(ids[i], tags[i]);
  return all;
}

std::vector<std::pair<int, cv::Point2f>> by_opencv_april(const cv::Mat& image,
                                                         const calvin::AprilGrid& board) {
  std::vector<std::pair<int, cv::Point2f>> all;
  const calvin::Grid grid = board.grid();
  for (const auto& [id, corners] :
       tags_by_opencv(image, cv::aruco::DICT_APRILTAG_36h11, board.border)) {
    const int at = id - board.first;
    if (at < 0 || at >= board.cols * board.rows) continue;
    const int col = 2 * (at % board.cols);
    const int row = 2 * (board.rows - 1 - at / board.cols);
    // Its first corner is the lower right one: Kalibr has tags the other way up.
    const int ids_around[] = {grid.id({col + 1, row + 1}), grid.id({col, row + 1}),
                              grid.id({col, row}), grid.id({col + 1, row})};
    for (std::size_t k = 0; k < 4; ++k) all.emplace_back(ids_around[k], corners[k]);
  }
  return all;
}

std::vector<std::pair<int, cv::Point2f>> by_opencv_grid(const cv::Mat& image,
                                                        const calvin::TagGrid& board,
                                                        int dictionary) {
  std::vector<std::pair<int, cv::Point2f>> all;
  const calvin::Grid grid = board.grid();
  for (const auto& [id, corners] : tags_by_opencv(image, dictionary, board.border)) {
    const auto place = board.place_of(id);
    if (!place) continue;
    const int col = 2 * place->col;
    const int row = 2 * place->row;
    const int ids_around[] = {grid.id({col, row}), grid.id({col + 1, row}),
                              grid.id({col + 1, row + 1}), grid.id({col, row + 1})};
    for (std::size_t k = 0; k < 4; ++k) all.emplace_back(ids_around[k], corners[k]);
  }
  return all;
}

const Subjects kBoards[] = {
    {"puzzle:14x9:20mm", 0, 0, -1, 0},
    {"charuco:8x5:40mm:30mm:DICT_5X5_100", 8, 5, cv::aruco::DICT_5X5_100, 0.75F},
    {"charuco:11x7:30mm:22mm:DICT_4X4_100", 11, 7, cv::aruco::DICT_4X4_100, 22.0F / 30},
    {"aprilgrid:6x6:88mm:0.3", 0, 0, cv::aruco::DICT_APRILTAG_36h11, 0},
    {"aprilgrid:5x4:88mm:0.3:border=1", 0, 0, cv::aruco::DICT_APRILTAG_36h11, 0},
    {"aruco:6x5:60mm:15mm:DICT_6X6_250", 0, 0, cv::aruco::DICT_6X6_250, 0},
    {"aruco:5x5:60mm:15mm:DICT_4X4_50", 0, 0, cv::aruco::DICT_4X4_50, 0},
    {"apriltag:tag36h11:6x5:60mm:15mm", 0, 0, -1, 0, "tag36h11", 2},
    {"apriltag:tagStandard41h12:6x5:40mm:32mm", 0, 0, -1, 0, "tagStandard41h12", 2},
    {"apriltag:tagCustom48h12:6x5:42mm:28mm", 0, 0, -1, 0, "tagCustom48h12", 0},
    {"apriltag:tagCircle49h12:5x4:40mm:50mm", 0, 0, -1, 0, "tagCircle49h12", 0},
};

bool has_peer(const Subjects& board) {
#if BENCH_HAVE_APRILTAG
  if (board.family != nullptr) return true;
#endif
  return board.dictionary >= 0;
}

#if BENCH_HAVE_APRILTAG
std::vector<std::pair<int, cv::Point2f>> by_libapriltag(const cv::Mat& image,
                                                        const calvin::TagGrid& board,
                                                        const Subjects& subjects) {
  static std::map<std::string, calvin::scenes::AprilDetector> detectors;
  const auto [detector, is_new] =
      detectors.try_emplace(subjects.family, subjects.family, subjects.bits);
  const calvin::ImageView view = {image.data, image.cols, image.rows,
                                  static_cast<std::ptrdiff_t>(image.step[0]), 1};
  std::vector<std::pair<int, cv::Point2f>> all;
  const calvin::Grid grid = board.grid();
  for (const auto& tag : detector->second.detect(view)) {
    const auto place = board.place_of(tag.id);
    for (int k = 0; place && k < 4; ++k) {
      const int id =
          grid.id({2 * place->col + (k == 1 || k == 2 ? 1 : 0), 2 * place->row + (k >= 2 ? 1 : 0)});
      const calvin::Pixel& p = tag.corners[static_cast<std::size_t>(k)];
      all.emplace_back(id, cv::Point2f(static_cast<float>(p.u), static_cast<float>(p.v)));
    }
  }
  return all;
}
#endif

std::vector<std::pair<int, cv::Point2f>> by_peer(const cv::Mat& image, const Subjects& board) {
  const calvin::Board text = calvin::parse_board(board.board).value();
#if BENCH_HAVE_APRILTAG
  if (board.family != nullptr) return by_libapriltag(image, *text.as<calvin::TagGrid>(), board);
#endif
  if (const auto* april = text.as<calvin::AprilGrid>()) return by_opencv_april(image, *april);
  if (const auto* tags = text.as<calvin::TagGrid>()) {
    return by_opencv_grid(image, *tags, board.dictionary);
  }
  return by_opencv_charuco(image, board);
}

struct Score {
  int named = 0;  // within a pixel and a half: OpenCV's corners were half a pixel off before 4.12
  int wrong = 0;
  double square = 0;
  std::vector<double> ms;

  void add(const calvin::Observation& truth, int id, calvin::Pixel at) {
    const auto own = std::find(truth.ids.begin(), truth.ids.end(), id);
    if (own == truth.ids.end()) {
      ++wrong;
      return;
    }
    const calvin::Pixel& there = truth.uv[static_cast<std::size_t>(own - truth.ids.begin())];
    const double apart = std::hypot(at.u - there.u, at.v - there.v);
    if (apart > 1.5) {
      ++wrong;
      return;
    }
    ++named;
    square += apart * apart;
  }
  [[nodiscard]] double quantile(double share) {
    std::sort(ms.begin(), ms.end());
    return ms.empty() ? 0
                      : ms[static_cast<std::size_t>(share * static_cast<double>(ms.size() - 1))];
  }
};

void print(const char* who, Score& score, int visible) {
  std::printf(" | %-8s %6.2f %5d %7.4f %6.2f %6.2f", who, 100.0 * score.named / visible,
              score.wrong, std::sqrt(score.square / std::max(score.named, 1)), score.quantile(0.5),
              score.quantile(0.95));
}

void measure(const Subjects& board, SceneClass kind, int pictures, calvin::ImageSize size) {
  kind.board = board.board;
  Score ours;
  Score peer;
  int visible = 0;
  for (int i = 0; i < pictures; ++i) {
    const Scene scene = make_scene(kind, size, 9000 + static_cast<std::uint64_t>(i));
    visible += static_cast<int>(scene.truth.ids.size());
    const Found found = Subject("calvin", by_calvin).look(scene.image, scene.board);
    ours.ms.push_back(found.ms);
    const auto& seen = found.observation;
    for (std::size_t k = 0; k < seen.ids.size(); ++k)
      ours.add(scene.truth, seen.ids[k], seen.uv[k]);
    if (!has_peer(board)) continue;
    if (i == 0) (void)by_peer(scene.image, board);  // makes tables
    const double begin = thread_ms();
    const auto theirs = by_peer(scene.image, board);
    peer.ms.push_back(thread_ms() - begin);
    for (const auto& [id, at] : theirs) peer.add(scene.truth, id, {at.x, at.y});
  }
  std::printf("%-16s", kind.name);
  print("calvin", ours, visible);
  if (has_peer(board)) {
    print(board.family != nullptr ? "apriltag" : "OpenCV", peer, visible);
    std::printf(" | %.1f times faster", peer.quantile(0.5) / ours.quantile(0.5));
  }
  std::printf("\n");
  std::fflush(stdout);
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
  const int pictures = argc > 1 ? std::atoi(argv[1]) : 100;
  const calvin::ImageSize size = argc > 3
                                     ? calvin::ImageSize{std::atoi(argv[2]), std::atoi(argv[3])}
                                     : calvin::ImageSize{1920, 1080};
  const char* only = std::getenv("CALVIN_BENCH_CLASS");
  cv::setNumThreads(1);
  std::printf("%-16s   %-8s %6s %5s %7s %6s %6s\n", "class", "", "named%", "wrong", "RMS px", "ms",
              "p95");
  for (const auto& board : bench::kBoards) {
    std::printf("%s\n", board.board);
    if (!calvin::parse_board(board.board)) continue;  // made without its library
    for (const auto& kind : bench::scene_classes()) {
      const std::string name = kind.name;
      if (kind.dark > kind.bright || *kind.board != 0) continue;
      if (only == nullptr || name.find(only) != std::string::npos) {
        bench::measure(board, kind, pictures, size);
      }
    }
  }
}
