// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Grids of square tags beside OpenCV's detector of ArUco markers: no fewer corners, and nearer to
// the truth; several grids at once, and parts of them; photographs.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "calvin/detect/detector.hpp"
#include "calvin/detect/tags/code_index.hpp"
#include "calvin/solve/solve.hpp"
#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"
#include "calvin/target/kinds.hpp"
#include "detect_scenes.hpp"
#include "opencv_tags.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

ImageView view_of(const cv::Mat& image) {
  return {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step[0]), 1};
}

class Tags : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has_opencv_dictionaries()) GTEST_SKIP() << "this build knows no dictionary of markers";
  }
};

// Corners that are where the truth has them, within 2 px, and their errors.
struct Score {
  int corners = 0;
  double square = 0;  // px^2

  void add(const Observation& truth, const Observation& seen) {
    for (std::size_t i = 0; i < seen.ids.size(); ++i) {
      const auto at = std::ranges::find(truth.ids, seen.ids[i]) - truth.ids.begin();
      if (at == static_cast<std::ptrdiff_t>(truth.ids.size())) continue;
      const Pixel& own = truth.uv[static_cast<std::size_t>(at)];
      const double off = std::hypot(own.u - seen.uv[i].u, own.v - seen.uv[i].v);
      if (off > 2) continue;
      ++corners;
      square += off * off;
    }
  }
  [[nodiscard]] double rms() const { return std::sqrt(square / std::max(corners, 1)); }
};

// As by looking at all codes in all turns: codes with some wrong bits, and any bits.
TEST_F(Tags, HaveTheNearestOfAllCodes) {
  for (const char* name :
       {"DICT_4X4_50", "DICT_6X6_250", "DICT_ARUCO_ORIGINAL", "tagStandard41h12"}) {
    if (find_dictionary(name) == nullptr) continue;
    const MarkerDictionary& dictionary = *find_dictionary(name);
    const detect::QuarterTurn turned_by_one(dictionary);
    const int bits = dictionary.bit_count();
    constexpr int kMostWrong = 3;
    const detect::CodeIndex index(dictionary, kMostWrong);
    scenes::Random random(5);
    int known = 0;
    for (int n = 0; n < 400; ++n) {
      std::uint64_t code = random() & ((std::uint64_t{1} << bits) - 1);
      if (n % 4 != 0) {
        code = dictionary.codes[random() % dictionary.codes.size()];
        for (int turns = 0; turns < n % 4; ++turns) code = turned_by_one(code);
        for (int wrong = 0; wrong < n % 6; ++wrong) code ^= std::uint64_t{1} << random() % bits;
      }
      int least = bits;
      std::uint64_t turned = code;
      for (int turns = 0; turns < 4; ++turns) {
        for (const std::uint64_t own : dictionary.codes) {
          least = std::min(least, std::popcount(turned ^ own));
        }
        turned = turned_by_one(turned);
      }
      const auto found = index.nearest(code);
      ASSERT_EQ(found.has_value(), least <= kMostWrong) << name << ' ' << n;
      if (!found) continue;
      ++known;
      EXPECT_EQ(found->wrong, least);
      // Turned back by as many quarters it is the code that was named.
      for (int turns = found->turns; turns % 4 != 0; ++turns) {
        code = turned_by_one(code);
      }
      EXPECT_EQ(std::popcount(code ^ dictionary.codes[static_cast<std::size_t>(found->id)]), least)
          << name << ' ' << n;
    }
    EXPECT_GE(known, 150) << name;
  }
}

TEST_F(Tags, AreFoundAsOftenAsByOpenCvAndNearerToTheTruth) {
  const bool full = scenes::full_count();
  for (const char* text : {"aruco:6x4:80mm:20mm:DICT_6X6_250", "aruco:5x5:60mm:15mm:DICT_4X4_50",
                           "aruco:5x4:60mm:25mm:DICT_ARUCO_ORIGINAL:inverted"}) {
    const Board board = parse_board(text).value();
    const auto detector = make_detector(board).value();
    int classes = 0;
    for (bench::SceneClass kind : bench::scene_classes()) {
      if (kind.dark > kind.bright || *kind.board != 0) continue;
      if (!full && ++classes % 2 == 0) continue;
      kind.board = text;
      Score own;
      Score theirs;
      for (std::uint64_t i = 0; i < (full ? 60 : 2); ++i) {
        const auto scene = bench::make_scene(kind, {1280, 720}, 7000 + i);
        own.add(scene.truth, detector->detect(view_of(scene.image)).observation);
        theirs.add(scene.truth, scenes::opencv_tags(scene.image, board, true));
      }
      std::cout << text << ", " << kind.name << ": " << own.corners << " corners, RMS " << own.rms()
                << " px; OpenCV " << theirs.corners << ", " << theirs.rms() << " px\n";
      // A corner of which a side is covered is none; OpenCV takes what covers it for the side.
      EXPECT_GE(own.corners, 0.97 * theirs.corners) << text << " " << kind.name;
      if (theirs.corners > 0) {
        EXPECT_LT(own.rms(), theirs.rms()) << text << " " << kind.name;
      }
    }
  }
}

// Two boards with tags of one dictionary, one of another, and a second sheet of the first, in one
// picture.
TEST_F(Tags, OfSeveralBoardsAreToldApart) {
  const Board first = parse_board("aruco:3x2:40mm:10mm:DICT_5X5_100").value();
  const Board second = parse_board("aruco:2x3:40mm:10mm:DICT_5X5_100:first=6").value();
  const Board other = parse_board("apriltag:tag36h11:2x2:40mm:10mm:border=2").value();
  const Board all[] = {other, second, first, first};
  const Camera camera = Camera::make("pinhole", {640, 480}, {600, 600, 319.5, 239.5}).value();
  cv::Mat picture(960, 1280, CV_8U, cv::Scalar(128));
  std::vector<Observation> truth;
  const Board* const places[] = {&first, &second, &other, &first};
  for (int i = 0; i < 4; ++i) {
    const BoardArea area = places[i]->extent();
    const Eigen::Matrix3d rotation = exp_so3({0.2, -0.1 * i, 0.7 * i});
    const SE3 pose = {rotation,
                      Eigen::Vector3d(0, 0, 0.35) -
                          rotation * Eigen::Vector3d(area.width() / 2, area.height() / 2, 0)};
    GrayImage part = render_board(camera, *places[i], pose, {.noise = 2, .blur = 0.7});
    const cv::Rect at(640 * (i % 2), 480 * (i / 2), 640, 480);
    cv::Mat(480, 640, CV_8U, part.pixels.data()).copyTo(picture(at));
    truth.push_back(true_observation(camera, *places[i], pose));
    for (Pixel& p : truth.back().uv) p = {p.u + at.x, p.v + at.y};
  }
  const auto detector = make_detector(all).value();
  const auto found = detector->detect_all(view_of(picture));
  ASSERT_EQ(found.size(), 4U);
  const int shown[] = {2, 1, 0, 3};
  for (std::size_t i = 0; i < 4; ++i) {
    const Observation& seen = found[i].observation;
    const Observation& own = truth[static_cast<std::size_t>(shown[i])];
    EXPECT_EQ(seen.board, all[i].text());
    ASSERT_EQ(seen.ids, own.ids) << i;
    for (std::size_t k = 0; k < own.ids.size(); ++k) {
      EXPECT_NEAR(seen.uv[k].u, own.uv[k].u, 0.1) << i;
      EXPECT_NEAR(seen.uv[k].v, own.uv[k].v, 0.1) << i;
    }
  }
}

// Sheets that are found of a board in pictures of another one, or of itself.
std::vector<std::size_t> sheets_in_pictures(const char* shown, const char* asked) {
  const Board board = parse_board(shown).value();
  const auto detector = make_detector(parse_board(asked).value()).value();
  const Camera camera = default_camera({1280, 960});
  const BoardRenderer renderer(camera);
  const Motion motion(MotionKind::kRandom, camera, board, 0);
  std::vector<std::size_t> sheets;
  for (int n = 0; n < (scenes::full_count() ? 200 : 30); ++n) {
    const GrayImage picture =
        renderer.render(board, motion.camera_from_board(n), {.noise = 2, .blur = 0.7});
    const auto found = detector->detect_all(picture.view());
    sheets.push_back(static_cast<std::size_t>(
        std::ranges::count_if(found, [](const Detection& d) { return d.observation.found(); })));
  }
  return sheets;
}

// A tag that was read a little beside its place is none of another sheet.
TEST_F(Tags, OfOneBoardAreOneSheet) {
  for (const char* board :
       {"aruco:5x7:40mm:10mm:DICT_6X6_250", "apriltag:tag36h11:5x7:40mm:10mm"}) {
    const auto sheets = sheets_in_pictures(board, board);
    EXPECT_EQ(std::ranges::count(sheets, 1U), std::ssize(sheets)) << board;
  }
}

// Of boards whose rows are alike: numbered from below, and from another tag on. Of an outermost row
// of which nothing else was read nothing tells.
TEST_F(Tags, OfAnotherBoardAreNoSheet) {
  const std::pair<const char*, const char*> boards[] = {
      {"aprilgrid:6x6:88mm:0.3", "apriltag:tag36h11:6x6:88mm:26.4mm:border=2"},
      {"aruco:5x7:40mm:10mm:DICT_6X6_250", "aruco:5x7:40mm:10mm:DICT_6X6_250:first=12"}};
  for (const auto& [shown, asked] : boards) {
    const auto sheets = sheets_in_pictures(shown, asked);
    EXPECT_GE(100 * std::ranges::count(sheets, 0U), 80 * std::ssize(sheets)) << asked;
    EXPECT_LE(std::ranges::max(sheets), 1U) << asked;
  }
}

// A sheet that is followed is all that is looked at: another one is found when the whole picture is
// searched again, a second later.
TEST_F(Tags, AreFollowedUntilTheNextSearch) {
  constexpr std::uint64_t kFrame = 33'000'000;  // ns
  const Board board = parse_board("aruco:3x2:40mm:10mm:DICT_5X5_100").value();
  const Camera camera = Camera::make("pinhole", {640, 480}, {600, 600, 319.5, 239.5}).value();
  const auto detector = make_detector(board).value();
  for (int frame = 0; frame < 40; ++frame) {
    cv::Mat picture(480, 1280, CV_8U, cv::Scalar(128));
    Observation truth;
    for (const int part : {0, 1}) {
      if (part == 1 && frame == 0) continue;
      const SE3 pose = {exp_so3({0.2, 0.1, 0.3 + 0.01 * frame}),
                        {-0.07 + 0.001 * frame, -0.05 + 0.0004 * frame, 0.35}};
      GrayImage image = render_board(camera, board, pose, {.noise = 2, .blur = 0.7});
      cv::Mat(480, 640, CV_8U, image.pixels.data()).copyTo(picture({640 * part, 0, 640, 480}));
      if (part == 0) truth = true_observation(camera, board, pose);
    }
    const std::uint64_t time = static_cast<std::uint64_t>(frame) * kFrame;
    const auto found = detector->follow_all(view_of(picture), time);
    ASSERT_EQ(found.size(), time < 1'000'000'000 ? 1U : 2U) << frame;
    const Observation& seen = found[0].observation;
    ASSERT_EQ(seen.ids, truth.ids) << frame;
    for (std::size_t k = 0; k < truth.ids.size(); ++k) {
      EXPECT_NEAR(seen.uv[k].u, truth.uv[k].u, 0.15) << frame;
      EXPECT_NEAR(seen.uv[k].v, truth.uv[k].v, 0.15) << frame;
    }
  }
  // One that is gone is not found where it was.
  const cv::Mat empty(480, 1280, CV_8U, cv::Scalar(128));
  EXPECT_FALSE(detector->follow(view_of(empty), 41 * kFrame).observation.found());
}

TEST_F(Tags, MayStandAlone) {
  for (const char* text : {"aruco:1x1:60mm:10mm:DICT_6X6_250:first=17",
                           "apriltag:tag36h11:1x1:60mm:20mm", "aruco:2x1:60mm:10mm:DICT_4X4_50"}) {
    const Board board = parse_board(text).value();
    const Camera camera = default_camera({640, 480});
    const auto detector = make_detector(board).value();
    for (int i = 0; i < 8; ++i) {
      const Eigen::Matrix3d rotation = exp_so3({0.3, -0.2, 0.8 * i});
      const SE3 pose = {rotation,
                        Eigen::Vector3d(0, 0, 0.4) - rotation * Eigen::Vector3d(0.03, 0.03, 0)};
      const GrayImage image = render_board(camera, board, pose, {.noise = 2, .blur = 0.7});
      const Observation truth = true_observation(camera, board, pose);
      const Observation seen = detector->detect(image.view()).observation;
      ASSERT_EQ(seen.ids, truth.ids) << text << " " << i;
      for (std::size_t k = 0; k < truth.ids.size(); ++k) {
        EXPECT_NEAR(seen.uv[k].u, truth.uv[k].u, 0.15) << text << " " << i;
        EXPECT_NEAR(seen.uv[k].v, truth.uv[k].v, 0.15) << text << " " << i;
      }
    }
  }
}

TEST_F(Tags, OfAnyImageOfAnySizeAreNoTrouble) {
  const auto detector =
      make_detector(parse_board("aruco:1x1:60mm:10mm:DICT_6X6_250").value()).value();
  scenes::Random random(1);
  for (const ImageSize size : {ImageSize{0, 0}, {1, 1}, {3, 200}, {200, 2}, {17, 9}, {160, 121}}) {
    GrayImage image(size.width, size.height);
    for (auto& pixel : image.pixels) pixel = static_cast<std::uint8_t>(random());
    EXPECT_FALSE(detector->detect(image.view()).observation.found()) << size.width;
  }
  std::stop_source stop;
  stop.request_stop();
  const GrayImage image(640, 480, 128);
  EXPECT_FALSE(detector->detect(image.view(), stop.get_token()).observation.found());
}

// The same photographs by both: a calibration of these corners fits better.
TEST_F(Tags, OfPhotographsFitACamera) {
  const char* data = std::getenv("CALVIN_DATA");
  const auto folder =
      std::filesystem::path(data == nullptr ? "" : data) / "aruco-gridboard-abakisita";
  if (data == nullptr || !std::filesystem::is_directory(folder)) {
    GTEST_SKIP() << "without CALVIN_DATA there is no aruco-gridboard-abakisita";
  }
  const Board board = parse_board("aruco:4x5:37.5mm:5mm:DICT_6X6_1000").value();
  const auto detector = make_detector(board).value();
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".jpg") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  std::vector<View> own;
  std::vector<View> theirs;
  int own_corners = 0;
  int their_corners = 0;
  for (const auto& file : files) {
    const cv::Mat image = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
    own.push_back({.observation = detector->detect(view_of(image)).observation, .board = board});
    theirs.push_back({.observation = scenes::opencv_tags(image, board, false), .board = board});
    own_corners += static_cast<int>(own.back().observation.ids.size());
    their_corners += static_cast<int>(theirs.back().observation.ids.size());
  }
  SolveOptions options;
  options.model = "brown5";
  const auto by_own = solve(own, {640, 480}, options);
  const auto by_theirs = solve(theirs, {640, 480}, options);
  ASSERT_TRUE(by_own) << by_own.error().message;
  ASSERT_TRUE(by_theirs) << by_theirs.error().message;
  const double own_rms = by_own->calibration.rms.value();
  const double their_rms = by_theirs->calibration.rms.value();
  std::cout << own_corners << " corners, rms " << own_rms << " px; OpenCV " << their_corners << ", "
            << their_rms << " px\n";
  // How a processor rounds decides about a corner here and there.
  EXPECT_GE(own_corners + 2, their_corners);
  EXPECT_LT(own_rms, 0.5 * their_rms);
}

}  // namespace
}  // namespace calvin
