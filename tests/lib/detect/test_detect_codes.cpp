// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Boards with a code: in pictures of every class their corners are found as those of checkerboards
// are, none has the name of another, and what the detector says of its errors is so.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <iostream>
#include <string>

#include <gtest/gtest.h>

#include "calvin/detect/detector.hpp"
#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"
#include "calvin/target/kinds.hpp"
#include "calvin/target/marker_dictionary.hpp"
#include "detect_scenes.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

ImageView view_of(const cv::Mat& image) {
  return {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step[0]), 1};
}

struct Kind {
  const char* name;
  const char* board;
  const char* other;  // a board of this kind that is not this one
  double least;       // percent of the corners that are named in pictures of the classes that are
  double least_hard;  // not hard, and of those that are
  bool is_variant = false;  // of a kind before
};
constexpr Kind kKinds[] = {
    {"Circles", "checkerboard:14x9:20mm:circles", "checkerboard:14x9:20mm:circles=2.2+3.2+2.3", 95,
     85},
    {"Puzzle", "puzzle:14x9:20mm", "puzzle:14x9:20mm:200,100", 98, 90},
    {"PuzzlePlace", "puzzle:10x11:20mm:333,77", "puzzle:10x11:20mm", 98, 90, true},
    {"Charuco", "charuco:8x6:40mm:30mm:DICT_5X5_100", "charuco:8x6:40mm:30mm:DICT_4X4_100", 98, 94},
    {"CharucoLegacy", "charuco:7x8:40mm:30mm:DICT_6X6_250:legacy",
     "charuco:7x8:40mm:30mm:DICT_6X6_250", 98, 94, true},
    {"CharucoInverted", "charuco:6x8:40mm:24mm:DICT_4X4_50:inverted",
     "charuco:6x8:40mm:24mm:DICT_4X4_50", 98, 94, true},
    {"AprilGrid", "aprilgrid:6x6:88mm:0.3", "aprilgrid:6x6:88mm:0.3:first=36", 98, 60},
    {"AprilGridThin", "aprilgrid:5x4:88mm:0.25:tag25h9:border=1:first=7",
     "aprilgrid:5x4:88mm:0.25:tag16h5:border=1:first=7", 98, 60, true},
    {"Aruco", "aruco:6x4:80mm:20mm:DICT_6X6_250", "aruco:6x4:80mm:20mm:DICT_6X6_250:first=30", 98,
     60},
    {"ArucoInverted", "aruco:5x5:88mm:30mm:DICT_4X4_50:inverted", "aruco:5x5:88mm:30mm:DICT_4X4_50",
     98, 60, true},
    {"AprilTags", "apriltag:tag25h9:5x4:88mm:20mm:first=7",
     "aruco:5x4:88mm:20mm:DICT_APRILTAG_25h9:first=7", 98, 60},
};

bool is_named_by_circles(const Kind& kind) { return std::strstr(kind.board, "circles") != nullptr; }
bool has_markers(const Kind& kind) {
  return std::strstr(kind.board, "puzzle") == nullptr && !is_named_by_circles(kind);
}

// What came of the pictures of a class.
struct Score {
  int visible = 0;       // corners
  int named = 0;         // corners with their own name, within a pixel
  int wrong = 0;         // corners with the name of another
  double square = 0;     // px^2, over corners
  double predicted = 0;  // px^2

  void add(const Score& other) {
    visible += other.visible;
    named += other.named;
    wrong += other.wrong;
    square += other.square;
    predicted += other.predicted;
  }
  [[nodiscard]] double named_share() const { return 100.0 * named / std::max(visible, 1); }
  [[nodiscard]] double rms() const { return std::sqrt(square / std::max(named, 1)); }
  [[nodiscard]] double predicted_share() const {
    return std::sqrt(predicted / std::max(square, 1e-12));
  }
};

double distance(const Pixel& a, const Pixel& b) { return std::hypot(a.u - b.u, a.v - b.v); }

void add(const bench::Scene& scene, const Observation& seen, Score& score) {
  score.visible += static_cast<int>(scene.truth.ids.size());
  for (std::size_t i = 0; i < seen.ids.size(); ++i) {
    const auto at = std::ranges::find(scene.truth.ids, seen.ids[i]) - scene.truth.ids.begin();
    const auto own = static_cast<std::size_t>(at);
    const bool right =
        own < scene.truth.ids.size() && distance(scene.truth.uv[own], seen.uv[i]) < 1;
    if (!right) {
      // A place that is none is nobody's; one that is another corner's has a wrong name.
      for (std::size_t k = 0; k < scene.truth.uv.size(); ++k) {
        score.wrong += k != own && distance(scene.truth.uv[k], seen.uv[i]) < 1.5 ? 1 : 0;
      }
      continue;
    }
    ++score.named;
    score.square += std::pow(distance(scene.truth.uv[own], seen.uv[i]), 2);
    score.predicted += 2 * seen.sigma[i] * seen.sigma[i];
  }
}

class Codes : public ::testing::TestWithParam<Kind> {
 protected:
  void SetUp() override {
    if (has_markers(GetParam()) && !has_opencv_dictionaries()) {
      GTEST_SKIP() << "this build knows no dictionary of markers";
    }
  }
};
INSTANTIATE_TEST_SUITE_P(Boards, Codes, ::testing::ValuesIn(kKinds),
                         [](const auto& test) { return test.param.name; });

// Where squares are small, or a picture is out of focus or shaken, markers cannot always be told
// from the corners beside them; ink and light that have run leave nothing between the two.
bool is_hard(const bench::SceneClass& kind) {
  const std::string name = kind.name;
  const char* const kHard[] = {"small squares", "blur",     "motion",
                               "over-exposed",  "ink gain", "all at once"};
  return std::ranges::find(kHard, name) != std::end(kHard);
}

TEST_P(Codes, NameTheCornersThatAreSeen) {
  const Board board = parse_board(GetParam().board).value();
  const auto detector = make_detector(board).value();
  const bool full = scenes::full_count();
  const ImageSize size = full ? ImageSize{1920, 1080} : ImageSize{1280, 720};
  const int pictures = full ? 190 : 1;
  Score all;
  Score hard;
  int classes = 0;
  for (bench::SceneClass kind : bench::scene_classes()) {
    if (kind.dark > kind.bright || *kind.board != 0) continue;
    // What another place, order, colour or border does is seen in half of the classes.
    if (!full && GetParam().is_variant && ++classes % 2 == 0) continue;
    kind.board = GetParam().board;
    Score score;
    for (int i = 0; i < pictures; ++i) {
      const auto scene = bench::make_scene(kind, size, 4000 + static_cast<std::uint64_t>(i));
      const Observation seen = detector->detect(view_of(scene.image)).observation;
      EXPECT_TRUE(seen.ambiguous.empty()) << kind.name;
      add(scene, seen, score);
    }
    std::cout << GetParam().name << ", " << kind.name << ": " << score.named_share() << " % named, "
              << score.wrong << " wrong, RMS " << score.rms() << " px, predicted over real "
              << score.predicted_share() << "\n";
    (is_hard(kind) ? hard : all).add(score);
  }
  EXPECT_EQ(all.wrong + hard.wrong, 0);
  EXPECT_GE(all.named_share(), GetParam().least);
  EXPECT_GE(hard.named_share(), GetParam().least_hard);
  // A few pictures tell it roughly.
  EXPECT_GE(all.predicted_share(), full ? 0.8 : 0.7);
  EXPECT_LE(all.predicted_share(), full ? 1.25 : 1.5);
}

TEST_P(Codes, AreNotThoseOfAnotherBoard) {
  const auto detector = make_detector(parse_board(GetParam().board).value()).value();
  bench::SceneClass kind{.name = "plain"};
  for (const char* other : {GetParam().other, "checkerboard:14x9:20mm"}) {
    kind.board = other;
    for (std::uint64_t seed = 0; seed < (scenes::full_count() ? 100 : 2); ++seed) {
      const auto scene = bench::make_scene(kind, {1280, 720}, seed);
      EXPECT_FALSE(detector->detect(view_of(scene.image)).observation.found()) << other << seed;
    }
  }
}

TEST_P(Codes, AreInNoOtherPicture) {
  const auto detector = make_detector(parse_board(GetParam().board).value()).value();
  const bool full = scenes::full_count();
  const ImageSize size = full ? ImageSize{1920, 1080} : ImageSize{800, 600};
  for (std::uint64_t seed = 0; seed < (full ? 1200 : 8); ++seed) {
    const auto picture = bench::make_negative(size, 5000 + seed);
    EXPECT_FALSE(detector->detect(view_of(picture)).observation.found()) << seed;
  }
}

// Of a board from elsewhere in the map the text is known, whichever way it lies; the lengths are
// those of the board that is looked for.
TEST(WrongPuzzle, IsSaidByItsPlace) {
  const auto detector = make_detector(parse_board("puzzle:14x9:20mm").value()).value();
  for (const char* text : {"puzzle:9x6:20mm:250,411", "puzzle:8x11:20mm:499,2", "puzzle:16x9:20mm",
                           "puzzle:14x9:20mm:1,1", "puzzle:7x7:20mm:333,166"}) {
    const Board board = parse_board(text).value();
    const Camera camera = default_camera({960, 720});
    const Grid grid = board.grid().value();
    const Eigen::Vector3d middle((grid.cols - 1) * grid.pitch / 2, (grid.rows - 1) * grid.pitch / 2,
                                 0);
    for (const double turn : {0.1, 1.6, 3.3, 4.7}) {
      const Eigen::Matrix3d rotation = exp_so3({0.2, -0.1, turn});
      const SE3 pose = {rotation, Eigen::Vector3d(0, 0, 0.55) - rotation * middle};
      const auto image = render_board(camera, board, pose, {.noise = 2, .blur = 0.7});
      const Detection d = detector->detect(image.view());
      EXPECT_FALSE(d.observation.found()) << text << " " << turn;
      EXPECT_EQ(d.reason, Reason::kWrongBoard) << text << " " << turn;
      EXPECT_EQ(d.seen_board, text) << turn;
    }
  }
}

// Of a strip of the board one of the two codes is hardly seen: it is no board from elsewhere in the
// map.
TEST(WrongPuzzle, IsNoStripOfAnotherOne) {
  const Board board = parse_board("puzzle:14x9:17mm").value();
  const Board wanted = parse_board("puzzle:12x9:17mm").value();
  const Camera camera = default_camera({640, 480});
  const Motion motion(MotionKind::kRandom, camera, board, 0);
  const auto detector = make_detector(wanted).value();
  for (int n = 30; n < 40; ++n) {
    const GrayImage image = render_board(camera, board, motion.camera_from_board(n),
                                         {.noise = 2, .blur = 0.7, .seed = unsigned(n)});
    EXPECT_EQ(detector->detect(image.view()).seen_board, board.text()) << n;
  }
}

// Of an AprilGrid with other tags, or more of them, the text is known too.
TEST(WrongAprilGrid, IsSaidByItsTags) {
  if (!has_opencv_dictionaries()) GTEST_SKIP() << "this build knows no dictionary of markers";
  const auto detector = make_detector(parse_board("aprilgrid:4x3:40mm:0.3").value()).value();
  for (const char* text : {"aprilgrid:4x3:40mm:0.3:first=12", "aprilgrid:4x4:40mm:0.3",
                           "aprilgrid:3x5:40mm:0.3", "aprilgrid:2x3:40mm:0.3:first=100"}) {
    const Board board = parse_board(text).value();
    const BoardArea area = board.extent();
    const Eigen::Vector3d middle(area.width() / 2, area.height() / 2, 0);
    for (const double turn : {0.1, 1.6, 3.3, 4.7}) {
      const Eigen::Matrix3d rotation = exp_so3({0.2, -0.1, turn});
      const SE3 pose = {rotation, Eigen::Vector3d(0, 0, 0.45) - rotation * middle};
      const auto image =
          render_board(default_camera({960, 720}), board, pose, {.noise = 2, .blur = 0.7});
      const Detection d = detector->detect(image.view());
      EXPECT_FALSE(d.observation.found()) << text << " " << turn;
      EXPECT_EQ(d.reason, Reason::kWrongBoard) << text << " " << turn;
      EXPECT_EQ(d.seen_board, text) << turn;
    }
  }
}

// A part anywhere of a board that is far larger than the picture, in any turn.
TEST_P(Codes, NameAPartInTheMidstOfABoard) {
  if (is_named_by_circles(GetParam())) GTEST_SKIP() << "most parts are without a circle";
  const Board board = parse_board(GetParam().board).value();
  const auto detector = make_detector(board).value();
  const Camera camera = default_camera({640, 480});
  const Grid grid = board.grid().value();
  // A corner of a tag needs a part of two sides: many tags are cut by the border of the picture.
  const std::size_t least = board.as<TagGrid>() != nullptr ? 35 : 75;  // percent
  scenes::Random random(3);
  for (int n = 0; n < 24; ++n) {
    const Eigen::Vector3d middle(scenes::uniform(random, 1.5, grid.cols - 2.5) * grid.mean_step(),
                                 scenes::uniform(random, 1.5, grid.rows - 2.5) * grid.mean_step(),
                                 0);
    const Eigen::Matrix3d rotation = exp_so3({0, 0, scenes::uniform(random, 0, 6.28)});
    const SE3 pose = {rotation, Eigen::Vector3d(0, 0, 5 * grid.mean_step()) - rotation * middle};
    const Observation truth = true_observation(camera, board, pose);
    const auto image = render_board(camera, board, pose, {.noise = 3, .blur = 0.8});
    const Observation seen = detector->detect(image.view()).observation;
    ASSERT_GE(100 * seen.ids.size(), least * truth.ids.size()) << n;
    for (std::size_t i = 0; i < seen.ids.size(); ++i) {
      const auto own = std::ranges::find(truth.ids, seen.ids[i]) - truth.ids.begin();
      ASSERT_LT(static_cast<std::size_t>(own), truth.ids.size()) << n;
      EXPECT_LT(distance(truth.uv[static_cast<std::size_t>(own)], seen.uv[i]), 0.2) << n;
    }
  }
}

// A part of a board with circles is named where they are in view, two of them at least, and is not
// mistaken for another part where they are not.
TEST(Circles, NameTheirSurroundings) {
  const Board board = parse_board("checkerboard:14x9:20mm:circles").value();
  const auto detector = make_detector(board).value();
  const Camera camera = default_camera({640, 480});
  const Grid grid = board.grid().value();
  scenes::Random random(3);
  int named = 0;
  int near = 0;
  for (int n = 0; n < 60; ++n) {
    const double col = scenes::uniform(random, 1.5, grid.cols - 2.5);
    const double row = scenes::uniform(random, 1.5, grid.rows - 2.5);
    const Eigen::Vector3d middle(col * grid.pitch, row * grid.pitch, 0);
    const Eigen::Matrix3d rotation = exp_so3({0, 0, scenes::uniform(random, 0, 6.28)});
    const SE3 pose = {rotation, Eigen::Vector3d(0, 0, 6 * grid.pitch) - rotation * middle};
    const Observation truth = true_observation(camera, board, pose);
    const auto image = render_board(camera, board, pose, {.noise = 3, .blur = 0.8});
    const Observation seen = detector->detect(image.view()).observation;
    // The circles lie around the place (7, 4) of the board, within 1.5 squares; the picture shows
    // 3 squares to any side.
    const bool is_near = std::hypot(col - 7, row - 4) < 1.3;
    near += is_near ? 1 : 0;
    named += is_near && seen.found() ? 1 : 0;
    EXPECT_TRUE(seen.ambiguous.empty());
    for (std::size_t i = 0; i < seen.ids.size(); ++i) {
      const auto own = std::ranges::find(truth.ids, seen.ids[i]) - truth.ids.begin();
      ASSERT_LT(static_cast<std::size_t>(own), truth.ids.size()) << n;
      EXPECT_LT(distance(truth.uv[static_cast<std::size_t>(own)], seen.uv[i]), 0.2) << n;
    }
  }
  EXPECT_GT(near, 3);
  EXPECT_EQ(named, near);
}

// Of a checkerboard without the circles, or with others, the text is known.
TEST(Circles, OfAnotherBoardAreSaid) {
  const auto detector = make_detector(parse_board("checkerboard:9x6:20mm:circles").value()).value();
  for (const char* text :
       {"checkerboard:9x6:20mm", "checkerboard:8x5:20mm",
        "checkerboard:9x6:20mm:circles=1.1+2.1+1.2", "checkerboard:7x7:20mm:circles=1.1+2.1+1.3"}) {
    const Board board = parse_board(text).value();
    const BoardArea area = board.extent();
    const Eigen::Vector3d middle(area.width() / 2, area.height() / 2, 0);
    for (const double turn : {0.1, 1.6, 3.3, 4.7}) {
      const Eigen::Matrix3d rotation = exp_so3({0.2, -0.1, turn});
      const SE3 pose = {rotation, Eigen::Vector3d(0, 0, 0.45) - rotation * middle};
      const auto image =
          render_board(default_camera({960, 720}), board, pose, {.noise = 2, .blur = 0.7});
      const Detection d = detector->detect(image.view());
      EXPECT_FALSE(d.observation.found()) << text << " " << turn;
      EXPECT_EQ(d.reason, Reason::kWrongBoard) << text << " " << turn;
      EXPECT_EQ(d.seen_board, text) << turn;
    }
  }
}

// A board that moves is followed, in whatever turn it was found.
TEST_P(Codes, AreFollowed) {
  const Board board = parse_board(GetParam().board).value();
  const Camera camera = default_camera({640, 480});
  const Grid grid = board.grid().value();
  const BoardArea area = grid.extent();
  const Eigen::Vector3d middle(area.width() / 2, area.height() / 2, 0);
  for (const double turn : {0.1, 1.7, 3.2, 4.8}) {
    const auto detector = make_detector(board).value();
    for (int frame = 0; frame < 5; ++frame) {
      const Eigen::Matrix3d rotation = exp_so3({0.2, 0.1, turn + 0.01 * frame});
      const SE3 pose = {
          rotation, Eigen::Vector3d(0.01 * frame, 0, 17 * grid.mean_step()) - rotation * middle};
      const Observation truth = true_observation(camera, board, pose);
      const auto image = render_board(camera, board, pose, {.noise = 2, .blur = 0.6});
      const auto seen =
          detector->follow(image.view(), static_cast<std::uint64_t>(frame) * 33'000'000)
              .observation;
      ASSERT_EQ(seen.ids, truth.ids) << turn << " " << frame;
      for (std::size_t i = 0; i < seen.ids.size(); ++i) {
        EXPECT_LT(distance(truth.uv[i], seen.uv[i]), 0.2) << turn << " " << frame;
      }
    }
  }
}

}  // namespace
}  // namespace calvin
