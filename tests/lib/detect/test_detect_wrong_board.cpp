// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A board of another size than is looked for: no part of the right one, and its size is said.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/detect/detector.hpp"
#include "calvin/synth/render.hpp"
#include "calvin_config.h"
#include "scenes.hpp"

#if CALVIN_HAVE_OPENCV
#include <opencv2/imgcodecs.hpp>
#endif

namespace calvin {
namespace {

// Columns and rows that are asked for beside those of the board.
constexpr std::array<std::array<int, 2>, 14> kWrong = {{{1, 0},
                                                        {0, 1},
                                                        {-1, 0},
                                                        {0, -1},
                                                        {1, 1},
                                                        {-1, -1},
                                                        {1, -1},
                                                        {-1, 1},
                                                        {2, 0},
                                                        {0, 2},
                                                        {-2, 0},
                                                        {3, 2},
                                                        {-2, -2},
                                                        {-3, -1}}};

struct Count {
  int asked = 0;
  int accepted = 0;
  int said = 0;  // sizes

  void check(const std::string& what) const {
    std::cout << "  " << what << ": " << asked << " asked, " << accepted << " accepted, " << said
              << " sizes said\n";
    EXPECT_LE(accepted, 0.005 * asked) << what;
    EXPECT_GE(said, 0.95 * asked) << what;
  }
};

// A board and the detectors of others.
class WrongBoards {
 public:
  explicit WrongBoards(const Checkerboard& shown) : shown_(shown) {
    for (const auto& [cols, rows] : kWrong) {
      const Checkerboard other = {shown.cols + cols, shown.rows + rows, shown.size};
      detectors_.push_back(std::move(*make_detector(Board(other))));
    }
  }
  void look(const ImageView& image, Count& count) {
    for (const auto& detector : detectors_) {
      const Detection d = detector->detect(image);
      ++count.asked;
      count.accepted += d.observation.found() ? 1 : 0;
      count.said += d.reason == Reason::kWrongBoard && std::minmax({d.seen_cols, d.seen_rows}) ==
                                                           std::minmax({shown_.cols, shown_.rows})
                        ? 1
                        : 0;
    }
  }

 private:
  Checkerboard shown_;
  std::vector<std::unique_ptr<Detector>> detectors_;
};

// How the sheet was cut, in squares beyond the outermost corners, above and below and at its sides:
// the pattern, and its paper. What lies around it, and how much darker its right margin is made by
// a shadow that has no edge.
struct Cut {
  const char* name;
  std::array<double, 2> pattern;
  std::array<double, 2> paper;
  std::uint8_t floor = 90;
  double shadow = 0;
};
constexpr Cut kCuts[] = {{"whole", {1, 1}, {2, 2}},
                         {"narrow margin", {1, 1}, {1.15, 1.15}},
                         {"narrow margin on black", {1, 1}, {1.12, 1.12}, 12},
                         {"cut squares", {0.5, 0.5}, {0.9, 0.9}},
                         {"some cut squares, narrow margin on black", {1, 0.5}, {1.12, 0.65}, 12},
                         {"shadow", {1, 1}, {1.3, 1.3}, 90, 0.55}};

// Whether all of the sheet, as it is cut, is in the image.
bool is_in_view(const Camera& camera, const Checkerboard& board, const SE3& pose,
                const std::array<double, 2>& beyond) {
  for (const double x : {-beyond[1], board.cols - 1 + beyond[1]}) {
    for (const double y : {-beyond[0], board.rows - 1 + beyond[0]}) {
      const auto at = camera.project(pose * Eigen::Vector3d(x * board.size, y * board.size, 0));
      if (!at || at->u < 2 || at->v < 2 || at->u > camera.image_size().width - 3 ||
          at->v > camera.image_size().height - 3) {
        return false;
      }
    }
  }
  return true;
}

void cut(GrayImage& image, const Camera& camera, const Checkerboard& board, const SE3& pose,
         const Cut& how) {
  const SE3 board_from_camera = pose.inverse();
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      const auto ray = camera.unproject({static_cast<double>(u), static_cast<double>(v)});
      if (!ray) continue;
      const Eigen::Vector3d way = board_from_camera.rotation * *ray;
      const Eigen::Vector3d at =
          board_from_camera.translation - way * (board_from_camera.translation.z() / way.z());
      const double x = at.x() / board.size;
      const double y = at.y() / board.size;
      const double beside = std::max(-x, x - board.cols + 1);  // squares
      const double above = std::max(-y, y - board.rows + 1);
      if (above > how.paper[0] || beside > how.paper[1]) {
        image.row(v)[u] = how.floor;
      } else if (above > how.pattern[0] || beside > how.pattern[1]) {
        image.row(v)[u] = 220;
      }
      const double shade = how.shadow * std::clamp((x - board.cols + 1.0) / how.paper[1], 0.0, 1.0);
      image.row(v)[u] = static_cast<std::uint8_t>(std::lround(image.row(v)[u] * (1 - shade)));
    }
  }
}

TEST(RenderedBoards, OfAnotherSizeAreNoPartOfTheBoard) {
  constexpr Checkerboard kShown = {9, 6, 0.025};
  const Camera camera = default_camera({800, 600});
  const BoardRenderer renderer(camera);
  for (const Cut& how : kCuts) {
    WrongBoards boards(kShown);
    Count count;
    scenes::Random random(11);
    const int pictures = scenes::full_count() ? 120 : 10;
    for (int n = 0; n < pictures;) {
      const SE3 pose = scenes::random_pose(camera, Board(kShown), random, 0.6);
      if (!is_in_view(camera, kShown, pose, how.paper)) continue;
      ++n;
      GrayImage image = renderer.render(Board(kShown), pose, {.blur = 0.8});
      cut(image, camera, kShown, pose, how);
      boards.look(image.view(), count);
    }
    count.check(how.name);
  }
}

// Half a small square beyond the outermost corners there is the next edge.
TEST(SmallBoards, OfWhichTheOutermostSquaresWereCutAreFoundWhole) {
  constexpr Checkerboard kShown = {9, 6, 0.025};
  constexpr Cut kHalf = {"half squares", {0.5, 0.5}, {1.2, 1.2}};
  const Camera camera = default_camera({320, 240});
  const BoardRenderer renderer(camera);
  const auto detector = std::move(*make_detector(Board(kShown)));
  scenes::Random random(4);
  const int pictures = 40;
  int whole = 0;
  for (int n = 0; n < pictures; ++n) {
    SE3 pose = {exp_so3({0, 0, scenes::uniform(random, 0, 6.28)}), {0, 0, 0}};
    const double square = scenes::uniform(random, 12, 15);  // px
    pose.translation = Eigen::Vector3d(0, 0, camera.fx() * kShown.size / square) -
                       pose.rotation * Eigen::Vector3d(0.1, 0.0625, 0);
    GrayImage image = renderer.render(Board(kShown), pose, {.noise = 1, .blur = 0.4});
    cut(image, camera, kShown, pose, kHalf);
    const Observation seen = detector->detect(image.view()).observation;
    const Observation truth = true_observation(camera, Board(kShown), pose);
    whole += seen.ids.size() == truth.ids.size() ? 1 : 0;
    for (const Pixel& p : seen.uv) {
      double least = 1e9;
      for (const Pixel& t : truth.uv) least = std::min(least, std::hypot(t.u - p.u, t.v - p.v));
      EXPECT_LT(least, 0.3) << n;
    }
  }
  std::cout << "  " << whole << " of " << pictures << " whole\n";
  EXPECT_GE(whole, pictures * 80 / 100);
}

#if CALVIN_HAVE_OPENCV
// Boards with cut squares, with narrow margins, in the hand, in a shadow and before a fisheye.
TEST(RealBoards, OfAnotherSizeAreNoPartOfTheBoard) {
  struct Set {
    const char* folder;
    const char* prefix;
    Checkerboard board;
  };
  const Set sets[] = {{"opencv-samples", "left", {9, 6, 0.025}},
                      {"photonvision-gloworm_960_720", "img", {8, 6, 0.0254}},
                      {"photonvision-gloworm_320_240", "img", {8, 6, 0.0254}},
                      {"fisheye-derlunz", "3D_L", {15, 9, 0.026}},
                      {"fisheye-stereo-stereopi", "left_", {9, 6, 0.025}}};
  const char* data = std::getenv("CALVIN_DATA");
  if (data == nullptr) GTEST_SKIP() << "CALVIN_DATA names no folder";
  Count count;
  for (const Set& set : sets) {
    const auto folder = std::filesystem::path(data) / set.folder;
    if (!std::filesystem::exists(folder)) continue;
    const auto right = std::move(*make_detector(Board(set.board)));
    WrongBoards boards(set.board);
    for (const auto& file : std::filesystem::directory_iterator(folder)) {
      if (!file.path().filename().string().starts_with(set.prefix)) continue;
      const cv::Mat image = cv::imread(file.path().string(), cv::IMREAD_GRAYSCALE);
      if (image.empty()) continue;
      const ImageView view = {image.data, image.cols, image.rows,
                              static_cast<std::ptrdiff_t>(image.step[0]), 1};
      const Observation seen = right->detect(view).observation;
      if (static_cast<int>(seen.ids.size()) != set.board.grid().count()) continue;
      // The margins are in view: the corners keep two squares off the border.
      const Pixel a = seen.uv[0];
      const Pixel b = seen.uv[1];
      const double room = 2 * std::hypot(b.u - a.u, b.v - a.v);
      const bool inside = std::all_of(seen.uv.begin(), seen.uv.end(), [&](const Pixel& p) {
        return p.u > room && p.v > room && p.u < image.cols - room && p.v < image.rows - room;
      });
      if (inside) boards.look(view, count);
    }
  }
  count.check("real pictures");
}
#endif

}  // namespace
}  // namespace calvin
