// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Boards of discs: where their centres are found, how exactly beside what the pixels allow, without
// the bias of an ellipse's centre, and in which pictures there are none.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iostream>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/detect/detector.hpp"
#include "calvin/synth/render.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

double distance(const Pixel& a, const Pixel& b) { return std::hypot(a.u - b.u, a.v - b.v); }

// An id as the other good way to name the discs has it, where a half turn is one.
int turned(const Board& board, int id) { return board.point_count() - 1 - id; }

// A disc that was seen: how far from the truth, and how far that was said to be.
struct Seen {
  Pixel off;
  double sigma = 0;
  int id = 0;  // as the truth has it
};

// Of all discs with their own names; of the two ways to name those of a symmetric board the better
// one. Wrong names are far from the truth.
std::vector<Seen> compare(const Board& board, const Observation& truth, const Observation& seen) {
  const auto by = [&](bool half_turn) {
    std::vector<Seen> all;
    for (std::size_t i = 0; i < seen.ids.size(); ++i) {
      const int id = half_turn ? turned(board, seen.ids[i]) : seen.ids[i];
      const auto own =
          static_cast<std::size_t>(std::ranges::find(truth.ids, id) - truth.ids.begin());
      const Pixel at = own < truth.uv.size() ? truth.uv[own] : Pixel{-1000, -1000};
      all.push_back({{seen.uv[i].u - at.u, seen.uv[i].v - at.v}, seen.sigma[i], id});
    }
    return all;
  };
  const auto square = [](const std::vector<Seen>& all) {
    double sum = 0;
    for (const Seen& s : all) sum += s.off.u * s.off.u + s.off.v * s.off.v;
    return sum;
  };
  const auto as_it_is = by(false);
  if (board.symmetries().empty()) return as_it_is;
  const auto other = by(true);
  return square(other) < square(as_it_is) ? other : as_it_is;
}

// The least error of a centre, px, 1 sigma per coordinate, that any estimate can have which knows
// all but the place (Cramer and Rao): the pixels of a rim of length P with contrast c, blurred by a
// Gaussian of w px, hold c^2 P / (4 sqrt(pi) w) / noise^2.
double bound(const Camera& camera, const SE3& pose, const Eigen::Vector3d& centre, double radius,
             double noise, double blur) {
  constexpr int kParts = 64;
  double length = 0;
  Pixel before;
  for (int k = 0; k <= kParts; ++k) {
    const double angle = 2 * std::numbers::pi * k / kParts;
    const Eigen::Vector3d rim =
        centre + radius * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
    const Pixel at = camera.project(pose * rim).value();
    if (k > 0) length += distance(before, at);
    before = at;
  }
  const double contrast = 190;
  const double width = std::sqrt(blur * blur + 1.0 / 12);
  const double variance = noise * noise + 1.0 / 12;
  return std::sqrt(variance * 4 * std::sqrt(std::numbers::pi) * width /
                   (contrast * contrast * length));
}

struct Kind {
  const char* name;
  const char* board;
  double radius;  // of a disc, of the pitch
};
constexpr Kind kKinds[] = {
    {"Circles", "circles:7x5:30mm", 0.25},
    {"Inverted", "circles:8x6:30mm:inverted", 0.25},
    {"Asymmetric", "acircles:4x11:20mm", 0.25 * std::numbers::sqrt2},
    {"Rings", "dots:14x10:7mm:rings=2.2+12.2+2.8", 0.25},
    {"Large", "dots:9x9:20mm:big=0.0", 0.25},
};

class Circles : public ::testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(Boards, Circles, ::testing::ValuesIn(kKinds),
                         [](const auto& test) { return test.param.name; });

// In pictures of every size, tilt, blur and noise.
TEST_P(Circles, AreFoundAsExactlyAsPixelsAllow) {
  const Board board = parse_board(GetParam().board).value();
  const auto detector = make_detector(board).value();
  const double radius = GetParam().radius * (board.grid() ? board.cell_size(0) : 0.02);
  const int pictures = scenes::full_count() ? 100 : 1;
  scenes::Random random(21);
  int visible = 0;
  int named = 0;
  int wrong = 0;
  double square = 0;
  double predicted = 0;
  double least = 0;
  std::vector<ImageSize> sizes = {{640, 480}, {1280, 720}};
  if (scenes::full_count()) sizes.push_back({1920, 1080});
  for (const ImageSize size : sizes) {
    for (const double tilt : {0.0, 0.5, 1.0}) {
      for (const double noise : {2.0, 6.0}) {
        for (int i = 0; i < pictures; ++i) {
          const double blur = scenes::uniform(random, 0.5, 1.6);
          const Camera camera = default_camera(size);
          const SE3 pose = scenes::random_pose(camera, board, random, tilt);
          const auto image =
              render_board(camera, board, pose, {.noise = noise, .blur = blur, .seed = random()});
          const Observation truth = true_observation(camera, board, pose);
          const Observation seen = detector->detect(image.view()).observation;
          visible += static_cast<int>(truth.ids.size());
          for (const Seen& s : compare(board, truth, seen)) {
            if (std::hypot(s.off.u, s.off.v) > 1) {
              ++wrong;
              continue;
            }
            ++named;
            const auto at = board.points()[*board.index_of(s.id)];
            square += s.off.u * s.off.u + s.off.v * s.off.v;
            predicted += 2 * s.sigma * s.sigma;
            least += 2 * std::pow(bound(camera, pose, at, radius, noise, blur), 2);
          }
        }
      }
    }
  }
  std::cout << GetParam().name << ": " << 100.0 * named / visible << " % named, RMS "
            << std::sqrt(square / named) << " px, " << std::sqrt(square / least)
            << " times the bound, predicted over real " << std::sqrt(predicted / square) << "\n";
  EXPECT_EQ(wrong, 0);
  EXPECT_GE(100 * named, 95 * visible);
  EXPECT_LE(std::sqrt(square / least), 1.3);
  EXPECT_NEAR(std::sqrt(predicted / square), 1, 0.25);
}

// The centre of an ellipse is not where the centre of the disc is seen: the mean of what is found
// in pictures without noise, at 60 degrees and through lenses of every kind.
TEST_P(Circles, HaveNoBias) {
  const Board board = parse_board(GetParam().board).value();
  const auto detector = make_detector(board).value();
  scenes::Random random(5);
  for (const char* model : {"pinhole", "brown5", "fisheye"}) {
    double sum = 0;
    int count = 0;
    std::vector<double> all;
    for (int i = 0; i < (scenes::full_count() ? 100 : 5); ++i) {
      const ImageSize size{1280, 960};
      const Camera camera = scenes::random_camera(model, random, size);
      const SE3 pose = scenes::random_pose(camera, board, random, std::numbers::pi / 3);
      const auto image = render_board(camera, board, pose, {.noise = 0, .blur = 0.8});
      const Observation truth = true_observation(camera, board, pose);
      const Observation seen = detector->detect(image.view()).observation;
      for (const Seen& s : compare(board, truth, seen)) {
        sum += s.off.u * s.off.u + s.off.v * s.off.v;
        all.push_back(std::hypot(s.off.u, s.off.v));
        ++count;
      }
    }
    std::cout << GetParam().name << ", " << model << ": RMS " << std::sqrt(sum / count) << " px of "
              << count << "\n";
    // Discs at the rim of what a fisheye sees are slivers.
    const bool is_wide = scenes::is_wide(model);
    EXPECT_LT(std::sqrt(sum / count), is_wide ? 0.05 : 0.01) << model;
    ASSERT_FALSE(all.empty());
    std::ranges::nth_element(all, all.begin() + all.size() / 2);
    EXPECT_LT(all[all.size() / 2], is_wide ? 0.015 : 0.005) << model;
  }
}

TEST_P(Circles, AreInNoPictureOfAnotherBoard) {
  const auto detector = make_detector(parse_board(GetParam().board).value()).value();
  const Camera camera = default_camera({960, 720});
  scenes::Random random(9);
  for (const char* text :
       {"circles:6x5:30mm", "circles:9x6:30mm", "acircles:4x9:20mm", "acircles:5x11:20mm",
        "dots:14x10:7mm:rings=3.2+12.2+2.8", "dots:9x9:20mm:big=4.3", "checkerboard:9x6:25mm",
        "puzzle:9x6:25mm", "circles:7x4:30mm:inverted"}) {
    const Board other = parse_board(text).value();
    for (int i = 0; i < 4; ++i) {
      const SE3 pose = scenes::random_pose(camera, other, random, 0.4);
      const auto image = render_board(camera, other, pose, {.noise = 2, .blur = 0.8});
      EXPECT_FALSE(detector->detect(image.view()).observation.found()) << text << " " << i;
    }
  }
}

// A part of a board with marks names its discs as long as one mark that tells its turn is in view.
TEST(MarkedDots, NameAPartOfABoard) {
  const Board board = parse_board("dots:14x10:7mm:rings=2.2+12.2+2.8").value();
  const auto detector = make_detector(board).value();
  const Camera camera = default_camera({800, 600});
  scenes::Random random(4);
  int found = 0;
  for (int i = 0; i < 30; ++i) {
    const Eigen::Matrix3d rotation = exp_so3({0.3, -0.2, scenes::uniform(random, 0, 6.28)});
    const Eigen::Vector3d middle(scenes::uniform(random, 3, 10) * 0.007,
                                 scenes::uniform(random, 3, 6) * 0.007, 0);
    const SE3 pose = {rotation, Eigen::Vector3d(0, 0, 0.07) - rotation * middle};
    const auto image = render_board(camera, board, pose, {.noise = 2, .blur = 0.8});
    const Observation truth = true_observation(camera, board, pose);
    const Observation seen = detector->detect(image.view()).observation;
    found += seen.found() ? 1 : 0;
    for (const Seen& s : compare(board, truth, seen)) {
      EXPECT_LT(std::hypot(s.off.u, s.off.v), 0.2) << i << " " << s.id;
    }
  }
  EXPECT_GE(found, 12);
}

// Of a board without marks a part could be any.
TEST(PlainCircles, NameNoPartOfABoard) {
  const Board board = parse_board("circles:7x5:30mm").value();
  const auto detector = make_detector(board).value();
  const Camera camera = default_camera({640, 480});
  const SE3 pose = {Eigen::Matrix3d::Identity(), Eigen::Vector3d(-0.16, -0.06, 0.14)};
  const auto image = render_board(camera, board, pose, {.noise = 2, .blur = 0.8});
  EXPECT_FALSE(detector->detect(image.view()).observation.found());
}

TEST(SmallBoardsOfCircles, AreRefused) {
  for (const char* text : {"circles:7x2:30mm", "acircles:2x3:20mm", "acircles:2x4:20mm"}) {
    const auto detector = make_detector(parse_board(text).value());
    ASSERT_FALSE(detector.has_value()) << text;
    EXPECT_NE(detector.error().message.find("at least 3x3 circles"), std::string::npos);
  }
  for (const char* text : {"circles:3x3:30mm", "acircles:3x3:20mm", "acircles:2x5:20mm"}) {
    const Board board = parse_board(text).value();
    const auto detector = make_detector(board).value();
    const Camera camera = default_camera({640, 480});
    const BoardArea area = board.extent();
    const SE3 pose = {exp_so3({0.2, 0.1, 0.1}),
                      Eigen::Vector3d(-area.width() / 2, -area.height() / 2, 0.3)};
    const auto image = render_board(camera, board, pose, {.noise = 2, .blur = 0.8});
    EXPECT_EQ(detector->detect(image.view()).observation.ids.size(),
              static_cast<std::size_t>(board.point_count()))
        << text;
  }
}

// Who holds up a board of another size hears which.
TEST(WrongCircles, AreSaidByTheirText) {
  const auto detector = make_detector(parse_board("circles:7x5:30mm").value()).value();
  const Camera camera = default_camera({960, 720});
  scenes::Random random(2);
  for (const char* text : {"circles:8x6:30mm", "circles:6x4:30mm", "circles:7x4:30mm"}) {
    const Board board = parse_board(text).value();
    const SE3 pose = {exp_so3({0.2, 0.1, 0.3}), Eigen::Vector3d(-0.08, -0.08, 0.5)};
    const auto image = render_board(camera, board, pose, {.noise = 2, .blur = 0.8});
    const Detection d = detector->detect(image.view());
    EXPECT_EQ(d.reason, Reason::kWrongBoard) << text;
    EXPECT_EQ(d.seen_board, text);
  }
}

// A board that moves is followed: in each frame its discs are where a search of the frame has them,
// and have the same names.
TEST_P(Circles, AreFollowed) {
  const Board board = parse_board(GetParam().board).value();
  const auto follows = make_detector(board).value();
  const auto searches = make_detector(board).value();
  const Camera camera = default_camera({1280, 720});
  const BoardArea area = board.extent();
  const double width = std::max(area.width(), area.height());
  for (int frame = 0; frame < (scenes::full_count() ? 35 : 14); ++frame) {
    const double way = 0.004 * width * frame;
    const Eigen::Matrix3d rotation = exp_so3({0.3, 0.01 * frame, 0.2});
    const Eigen::Vector3d middle(area.width() / 2, area.height() / 2, 0);
    const SE3 pose = {rotation, Eigen::Vector3d(way, 0.3 * way, 2.2 * width) - rotation * middle};
    const auto image = render_board(camera, board, pose, {.noise = 2, .blur = 0.8});
    const Observation one =
        follows->follow(image.view(), static_cast<std::uint64_t>(frame) * 33'000'000).observation;
    const Observation other = searches->detect(image.view()).observation;
    ASSERT_EQ(one.ids.size(), static_cast<std::size_t>(board.point_count())) << frame;
    ASSERT_EQ(other.ids, one.ids) << frame;
    for (std::size_t i = 0; i < one.ids.size(); ++i) {
      EXPECT_LT(distance(one.uv[i], other.uv[i]), 0.02) << frame << " " << i;
    }
  }
}

// A jump by one disc, which leaves all but the last row where discs are.
TEST(FollowedCircles, HaveTheirOwnNamesAfterAJump) {
  const Board board = parse_board("circles:7x5:30mm").value();
  const auto detector = make_detector(board).value();
  const Camera camera = default_camera({960, 720});
  for (int frame = 0; frame < 6; ++frame) {
    const double jump = frame < 3 ? 0 : 0.03 * (frame - 2);
    const SE3 pose = {Eigen::Matrix3d::Identity(), Eigen::Vector3d(jump - 0.12, -0.06, 0.4)};
    const auto image = render_board(camera, board, pose, {.noise = 2, .blur = 0.8});
    const Observation truth = true_observation(camera, board, pose);
    const Observation seen =
        detector->follow(image.view(), static_cast<std::uint64_t>(frame) * 33'000'000).observation;
    ASSERT_EQ(seen.ids, truth.ids) << frame;
    for (std::size_t i = 0; i < seen.ids.size(); ++i) {
      EXPECT_LT(distance(seen.uv[i], truth.uv[i]), 0.05) << frame << " " << i;
    }
  }
}

GrayImage side_by_side(const GrayImage& left, const GrayImage& right) {
  GrayImage all(left.width + right.width, left.height);
  for (int y = 0; y < left.height; ++y) {
    std::copy_n(left.pixels.data() + y * left.width, left.width, all.row(y));
    std::copy_n(right.pixels.data() + y * right.width, right.width, all.row(y) + left.width);
  }
  return all;
}

// Boards of several kinds in one picture, in the order of the list; a second sheet of one of them
// comes last.
TEST(SeveralBoards, AreFoundTogether) {
  const std::vector<Board> boards = {parse_board("circles:7x5:30mm").value(),
                                     parse_board("checkerboard:9x6:25mm").value(),
                                     parse_board("acircles:4x11:20mm").value()};
  const auto detector = make_detector(boards).value();
  const Camera camera = default_camera({640, 480});
  const auto picture = [&](const Board& board) {
    const BoardArea area = board.extent();
    const SE3 pose = {exp_so3({0.1, 0.2, 0.1}),
                      Eigen::Vector3d(-area.width() / 2, -area.height() / 2, 0.45)};
    return render_board(camera, board, pose, {.noise = 2, .blur = 0.7});
  };
  const auto image =
      side_by_side(picture(boards[2]), side_by_side(picture(boards[0]), picture(boards[0])));
  for (const bool follows : {false, true}) {
    const auto all =
        follows ? detector->follow_all(image.view(), 1) : detector->detect_all(image.view());
    ASSERT_EQ(all.size(), 4U);
    EXPECT_EQ(all[0].observation.ids.size(), 35U);
    EXPECT_FALSE(all[1].observation.found());
    EXPECT_EQ(all[2].observation.ids.size(), 44U);
    EXPECT_EQ(all[3].observation.ids.size(), 35U);
    EXPECT_EQ(all[3].board, 0U);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(all[i].board, i);
      EXPECT_EQ(all[i].observation.board, boards[i].text());
    }
    EXPECT_LT(all[0].observation.uv.front().u, all[3].observation.uv.front().u);
  }
}

}  // namespace
}  // namespace calvin
