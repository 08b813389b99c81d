// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Families of AprilTags beside libapriltag: what it prints is found by ours, what we draw and
// render is found by it, with the same ids and corners.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iostream>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "april_tags.hpp"
#include "calvin/detect/detector.hpp"
#include "calvin/detect/tags/code_index.hpp"
#include "calvin/detect/tags/tag_pattern.hpp"
#include "calvin/draw/board_drawing.hpp"
#include "calvin/synth/render.hpp"
#include "calvin/target/kinds.hpp"
#include "read_picture.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

struct Family {
  const char* name;
  const char* measures;  // of a grid of 4 x 3 tags that fills most of a picture
  int first = 0;         // of its tags
  int most_wrong = 0;    // bits, that the codes can bear
  int peer_wrong = 2;    // what the tables of libapriltag are made for
};
// The tables of libapriltag for two wrong bits of the large families take gigabytes.
constexpr Family kFamilies[] = {
    {"tag36h11", "80mm:20mm", 500, 5, 2},           {"tagStandard41h12", "50mm:40mm", 2100, 5, 2},
    {"tagStandard52h13", "60mm:45mm", 48700, 6, 0}, {"tagCustom48h12", "60mm:40mm", 42199, 5, 0},
    {"tagCircle21h7", "50mm:40mm", 26, 3, 0},       {"tagCircle49h12", "50mm:65mm", 65500, 5, 0}};

class AprilTags : public ::testing::TestWithParam<Family> {
 protected:
  void SetUp() override {
    if (find_family(GetParam().name) == nullptr) GTEST_SKIP() << "this build does not know it";
  }
  static std::string text_of(const char* size, const char* measures, int first) {
    return std::string("apriltag:") + GetParam().name + ":" + size + ":" + measures +
           ":first=" + std::to_string(first);
  }
  static Board grid() {
    return parse_board(text_of("4x3", GetParam().measures, GetParam().first)).value();
  }
};
INSTANTIATE_TEST_SUITE_P(Families, AprilTags, ::testing::ValuesIn(kFamilies),
                         [](const auto& test) { return std::string(test.param.name); });

double distance(const Pixel& a, const Pixel& b) { return std::hypot(a.u - b.u, a.v - b.v); }

// As the detections of libapriltag, in the order of their ids.
std::vector<scenes::AprilDetection> tags_of(const Observation& seen, const TagGrid& board) {
  std::vector<scenes::AprilDetection> all;
  const Grid grid = board.grid();
  for (int row = 0; row < board.rows; ++row) {
    for (int col = 0; col < board.cols; ++col) {
      scenes::AprilDetection tag{board.tag_in(col, row), {}};
      int corners = 0;
      for (const auto& [k, right, below] : {std::array{0, 0, 0}, {1, 1, 0}, {2, 1, 1}, {3, 0, 1}}) {
        const int id = grid.id({2 * col + right, 2 * row + below});
        const auto at = std::ranges::find(seen.ids, id) - seen.ids.begin();
        if (at == std::ssize(seen.ids)) continue;
        ++corners;
        tag.corners[static_cast<std::size_t>(k)] = seen.uv[static_cast<std::size_t>(at)];
      }
      if (corners == 4) all.push_back(tag);
    }
  }
  return all;
}

// px, of the corners of all tags, which have to be the same.
struct Errors {
  int count = 0;
  double square = 0;
  double worst = 0;

  void add(const std::vector<scenes::AprilDetection>& seen,
           const std::vector<scenes::AprilDetection>& truth) {
    ASSERT_EQ(seen.size(), truth.size());
    for (std::size_t i = 0; i < seen.size(); ++i) {
      ASSERT_EQ(seen[i].id, truth[i].id);
      for (std::size_t k = 0; k < 4; ++k) {
        const double off = distance(seen[i].corners[k], truth[i].corners[k]);
        worst = std::max(worst, off);
        square += off * off;
        ++count;
      }
    }
  }
  [[nodiscard]] double rms() const { return std::sqrt(square / std::max(count, 1)); }
};

// A tag as libapriltag prints it in a quad of a picture that is a little out of focus: each pixel
// is the mean of 25 samples, one anywhere in each part of two pixels by two.
GrayImage picture_of(const GrayImage& tag, const detect::Quad& border, int cells,
                     scenes::Random& random) {
  constexpr int kSamples = 5;
  GrayImage image(240, 240, 128);
  const Eigen::Matrix3d from_image = detect::from_cells(border, cells).inverse();
  const int before = (tag.width - cells) / 2;  // cells, from the border to the edge of the print
  std::normal_distribution<double> noise(0, 2);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      double sum = 0;
      for (int i = 0; i < kSamples * kSamples; ++i) {
        const auto apart = [&](int k) {
          return 2 * (k + scenes::uniform(random, 0, 1)) / kSamples - 1;
        };
        const Eigen::Vector3d p =
            from_image * Eigen::Vector3d(x + apart(i % kSamples), y + apart(i / kSamples), 1);
        const int col = static_cast<int>(std::floor(p.x() / p.z())) + before;
        const int row = static_cast<int>(std::floor(p.y() / p.z())) + before;
        const bool is_on_it = col >= 0 && row >= 0 && col < tag.width && row < tag.height;
        sum += !is_on_it ? 128 : tag.view().at(col, row) != 0 ? 220 : 30;
      }
      image.row(y)[x] = static_cast<std::uint8_t>(
          std::clamp(std::lround(sum / (kSamples * kSamples) + noise(random)), 0L, 255L));
    }
  }
  return image;
}

TEST_P(AprilTags, AreFoundAsLibapriltagPrintsThem) {
  const auto family = scenes::april_family(GetParam().name);
  scenes::Random random(3);
  Errors own;
  for (int i = 0; i < 3; ++i) {
    const int id = static_cast<int>(random() % family->ncodes);
    const auto detector =
        make_detector(parse_board(text_of("1x1", "50mm:10mm", id)).value()).value();
    // A tilted quad, turned all around.
    const double reach = 85.0 * family->width_at_border / family->total_width;
    detect::Quad quad;
    for (std::size_t k = 0; k < 4; ++k) {
      const double angle = 0.5 * std::numbers::pi * static_cast<double>(k) + 1.3 * i;
      const double far = 1 + 0.12 * std::sin(angle);  // nearer below than above
      quad[k] = detect::Point(120 + far * reach * std::cos(angle), 120 + reach * std::sin(angle));
    }
    const GrayImage image =
        picture_of(scenes::april_picture(*family, id), quad, family->width_at_border, random);
    const Observation seen = detector->detect(image.view()).observation;
    ASSERT_EQ(seen.ids.size(), 4U) << i << " " << id;
    const std::size_t clockwise[] = {0, 1, 3, 2};
    for (std::size_t k = 0; k < 4; ++k) {
      const Pixel& p = seen.uv[clockwise[k]];
      const double off = std::hypot(p.u - quad[k].x(), p.v - quad[k].y());
      own.worst = std::max(own.worst, off);
    }
  }
  std::cout << GetParam().name << ": at most " << own.worst << " px\n";
  EXPECT_LT(own.worst, 0.1);
}

TEST_P(AprilTags, AreFoundByLibapriltagAsTheyAreRendered) {
  const Board board = grid();
  const TagGrid& tags = *board.as<TagGrid>();
  const auto detector = make_detector(board).value();
  const scenes::AprilDetector peer(GetParam().name, GetParam().peer_wrong);
  // libapriltag takes the sides of tags for straight.
  const Camera camera = Camera::make("pinhole", {800, 600}, {600, 600, 399.5, 299.5}).value();
  const BoardArea area = board.extent();
  Errors own;
  Errors theirs;
  for (const double tilt : {0.1, 0.7}) {
    const Eigen::Matrix3d rotation = exp_so3({tilt, -0.3 * tilt, 0.2 + 2 * tilt});
    const SE3 pose = {rotation,
                      Eigen::Vector3d(0, 0, 1.6 * area.width()) -
                          rotation * Eigen::Vector3d(area.width() / 2, area.height() / 2, 0)};
    const GrayImage image = render_board(camera, board, pose, {.noise = 2, .blur = 0.7});
    const auto truth = tags_of(true_observation(camera, board, pose), tags);
    ASSERT_EQ(truth.size(), 12U);
    own.add(tags_of(detector->detect(image.view()).observation, tags), truth);
    theirs.add(peer.detect(image.view()), truth);
  }
  std::cout << GetParam().name << ": RMS " << own.rms() << " px, libapriltag " << theirs.rms()
            << " px\n";
  EXPECT_LT(own.worst, 0.1);
  EXPECT_LT(theirs.rms(), 0.1) << "its corners are the same ones";
  EXPECT_LT(own.rms(), theirs.rms());
}

#if CALVIN_HAVE_CAIRO

// A picture of a quarter of the size, a little out of focus: means of 8 x 8 pixels.
GrayImage quarter_of(const GrayImage& image) {
  GrayImage small(image.width / 4 - 1, image.height / 4 - 1);
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) {
      int sum = 0;
      for (int i = 0; i < 64; ++i) sum += image.view().at(4 * x + i % 8, 4 * y + i / 8);
      small.row(y)[x] = static_cast<std::uint8_t>((sum + 32) / 64);
    }
  }
  return small;
}

TEST_P(AprilTags, AreFoundByLibapriltagAsTheyAreDrawn) {
  constexpr double kDpi = 4 * 25.4;  // all sides of tags lie between pixels
  const Board board = grid();
  const TagGrid& tags = *board.as<TagGrid>();
  const auto png = draw_board(board, {DrawingFormat::kPng, "fit", kDpi});
  ASSERT_TRUE(png.has_value()) << png.error().message;
  const GrayImage image = quarter_of(scenes::decode_png(*png));
  const BoardLayout page = lay_out_board(board, "fit").value();
  Observation truth;
  for (int id = 0; id < board.point_count(); ++id) {
    const Eigen::Vector3d p = board.points()[static_cast<std::size_t>(id)];
    truth.ids.push_back(id);
    const auto in_quarter = [](double m) { return m * kDpi / 0.0254 / 4 - 1; };
    truth.uv.push_back({in_quarter(p.x() + page.x), in_quarter(p.y() + page.y)});
  }
  Errors own;
  Errors theirs;
  own.add(tags_of(make_detector(board).value()->detect(image.view()).observation, tags),
          tags_of(truth, tags));
  theirs.add(scenes::AprilDetector(GetParam().name, GetParam().peer_wrong).detect(image.view()),
             tags_of(truth, tags));
  std::cout << GetParam().name << ": at most " << own.worst << " px, libapriltag " << theirs.worst
            << " px\n";
  EXPECT_LT(own.worst, 0.1);
  // Where sides lie along rows of pixels it has them as far outside, those of tag36h11 too.
  EXPECT_LT(theirs.worst, 0.3);
}

#endif

// Codes with as many wrong bits as they can bear, turned in any way, are found; and what a code is
// not farther from than that.
TEST_P(AprilTags, HaveCodesThatBearWrongBits) {
  const MarkerDictionary& dictionary = *find_family(GetParam().name);
  const int bits = dictionary.bit_count();
  const int most_wrong = GetParam().most_wrong;
  EXPECT_EQ(dictionary.distance == 0 ? most_wrong : (dictionary.distance - 1) / 2, most_wrong);
  const detect::CodeIndex index(dictionary, most_wrong);
  const detect::QuarterTurn turned(dictionary);
  scenes::Random random(7);
  for (int n = 0; n < 2000; ++n) {
    const auto id = static_cast<int>(random() % dictionary.codes.size());
    std::uint64_t code = dictionary.codes[static_cast<std::size_t>(id)];
    EXPECT_EQ(turned(turned(turned(turned(code)))), code);
    EXPECT_EQ(turned(turned(code)), detect::half_turned(code, bits));
    const int turns = n % 4;
    for (int k = 0; k < turns; ++k) code = turned(code);
    std::uint64_t wrong = 0;
    while (std::popcount(wrong) < n % (most_wrong + 1))
      wrong |= std::uint64_t{1} << random() % bits;
    const auto found = index.nearest(code ^ wrong);
    ASSERT_TRUE(found.has_value()) << n;
    EXPECT_EQ(found->id, id) << n;
    EXPECT_EQ(found->turns, turns) << n;
    EXPECT_EQ(found->wrong, std::popcount(wrong)) << n;
  }
}

}  // namespace
}  // namespace calvin
