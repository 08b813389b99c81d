// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Boards of every kind as they are drawn, in every format, against their artwork; and ChArUco
// boards against OpenCV's.
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <tuple>

#include <gtest/gtest.h>

#include "calvin/draw/board_drawing.hpp"
#include "calvin/target/artwork/artwork.hpp"
#include "calvin_config.h"

#include "artwork_at.hpp"
#include "board_kinds.hpp"
#include "read_picture.hpp"
#if CALVIN_HAVE_OPENCV
#include "opencv_charuco.hpp"
#endif

namespace calvin {
namespace {

class DrawnBoard : public ::testing::TestWithParam<scenes::NamedBoard> {
 protected:
  static const Board& board() { return GetParam().board; }
};
INSTANTIATE_TEST_SUITE_P(EveryKind, DrawnBoard, ::testing::ValuesIn(scenes::board_of_each_kind()),
                         scenes::name_of);

// What does not fit is told the size that does.
TEST_P(DrawnBoard, FitsInTheSizeThatIsNamed) {
  if (!board().grid()) return;  // of scattered points there is one size
  const auto cells = [](const Board& b, double size) {
    const double factor = size / b.cell_size(b.ids().front());
    const std::string text = b.text();
    Board other = b;
    if (const auto* checkerboard = b.as<Checkerboard>()) other = checkerboard->with_cells_of(size);
    if (const auto* marked = b.as<MarkedCheckerboard>()) other = marked->with_cells_of(size);
    if (const auto* puzzle = b.as<PuzzleBoard>()) other = puzzle->with_cells_of(size);
    if (const auto* charuco = b.as<CharucoBoard>()) other = charuco->with_cells_of(size);
    if (const auto* april = b.as<AprilGrid>()) other = april->with_cells_of(size);
    if (const auto* tags = b.as<TagGrid>()) other = tags->with_cells_of(size);
    if (const auto* circles = b.as<CircleGrid>()) other = circles->with_cells_of(size);
    EXPECT_NEAR(other.outline().width(), factor * b.outline().width(), 1e-12) << text;
    return other;
  };
  const Board large = cells(board(), 0.2);
  const auto page = lay_out_board(large, "a4");
  ASSERT_FALSE(page.has_value());
  const std::string& message = page.error().message;
  const auto from = message.rfind('(') + 1;
  const auto smaller = parse_board(message.substr(from, message.rfind(')') - from));
  ASSERT_TRUE(smaller.has_value()) << message;
  EXPECT_TRUE(smaller->looks_like(board())) << message;
  EXPECT_TRUE(lay_out_board(*smaller, "a4").has_value()) << message;
  const double size = smaller->cell_size(smaller->ids().front());
  EXPECT_FALSE(lay_out_board(cells(*smaller, size + 1e-4), "a4").has_value()) << message;
}

#if CALVIN_HAVE_CAIRO

// Each pixel whose surroundings are of one colour has it; the page is not turned or moved.
void expect_artwork(const GrayImage& image, const Board& board, double dpi) {
  const Artwork artwork = artwork_of(board);
  const BoardLayout page = lay_out_board(board, "fit").value();
  const double pixel = 0.0254 / dpi;
  const auto is_dark = [&](double u, double v) {
    return scenes::is_dark_at(artwork, (u + 0.5) * pixel - page.x, (v + 0.5) * pixel - page.y);
  };
  const int rows = static_cast<int>((page.y + artwork.outline.bottom) / pixel);
  int plain = 0;
  for (int v = 2; v < rows; v += 2) {
    for (int u = 2; u + 2 < image.width; u += 2) {
      const bool dark = is_dark(u, v);
      bool same = true;
      for (const double i : {-1.1, 0.0, 1.1}) {
        for (const double j : {-1.1, 0.0, 1.1}) same = same && is_dark(u + i, v + j) == dark;
      }
      if (!same) continue;
      ++plain;
      ASSERT_EQ(image.view().at(u, v), dark ? 0 : 255) << u << ", " << v;
    }
  }
  EXPECT_GT(plain, image.width * rows / 4 * 2 / 3);
}

TEST_P(DrawnBoard, IsItsArtworkAsPng) {
  const double dpi = 120;
  const auto png = draw_board(board(), {DrawingFormat::kPng, "fit", dpi});
  ASSERT_TRUE(png.has_value()) << png.error().message;
  expect_artwork(scenes::decode_png(*png), board(), dpi);
}

TEST_P(DrawnBoard, IsItsArtworkAsPdf) {
  const double dpi = 120;
  const auto pdf = draw_board(board(), {DrawingFormat::kPdf, "fit"});
  ASSERT_TRUE(pdf.has_value()) << pdf.error().message;
  const auto image = scenes::decode_pdf(*pdf, dpi);
  if (!image) GTEST_SKIP() << "pdftoppm is not installed";
  expect_artwork(*image, board(), dpi);
}

std::size_t count(std::string_view text, std::string_view words) {
  std::size_t all = 0;
  for (auto at = text.find(words); at != std::string_view::npos; at = text.find(words, at + 1)) {
    ++all;
  }
  return all;
}

// Fewer than four curves are no circle; light discs are painted, not left out.
TEST_P(DrawnBoard, HasItsDiscsInSvg) {
  const auto svg = draw_board(board(), {DrawingFormat::kSvg, "fit"});
  ASSERT_TRUE(svg.has_value()) << svg.error().message;
  const Artwork artwork = artwork_of(board());
  const auto glyphs = svg->find("</defs>");  // the caption's letters have curves too
  const std::string_view page =
      std::string_view(*svg).substr(glyphs == std::string::npos ? 0 : glyphs);
  EXPECT_GE(count(page, " C "), 4 * artwork.discs.size());
  std::size_t changes = 0;  // of colour, from one disc to the next
  bool is_dark = true;
  for (const Artwork::Disc& disc : artwork.discs) {
    changes += disc.is_dark != is_dark && !disc.is_dark ? 1 : 0;
    is_dark = disc.is_dark;
  }
  EXPECT_EQ(count(page, "rgb(100%"), 1 + changes) << "the page and the light discs";
}

#if CALVIN_HAVE_OPENCV

// A square is 80 px, a cell of a marker with 4 x 4 bits 10 px.
constexpr int kSquare = 80;
constexpr int kMarker = 60;
constexpr int kCell = 10;
constexpr double kMetre = 4000;  // px

// The middles of all cells, in both pictures.
void expect_same(const CharucoBoard& board, const cv::Mat& expected) {
  const auto png = draw_board(board, {DrawingFormat::kPng, "fit", kMetre * 0.0254});
  ASSERT_TRUE(png.has_value()) << png.error().message;
  const GrayImage image = scenes::decode_png(*png);
  const BoardLayout page = lay_out_board(board, "fit").value();
  const double left = page.x * kMetre - kSquare;
  const double top = page.y * kMetre - kSquare;
  for (int y = kCell / 2; y < expected.rows; y += kCell) {
    for (int x = kCell / 2; x < expected.cols; x += kCell) {
      const int level = image.view().at(static_cast<int>(std::lround(left + x)),
                                        static_cast<int>(std::lround(top + y)));
      const int seen = expected.at<uchar>(y, x);
      ASSERT_EQ(level, board.inverted ? 255 - seen : seen)
          << Board(board).text() << " at " << x << ", " << y;
    }
  }
}

TEST(CharucoDrawing, IsThatOfOpenCv) {
  const MarkerDictionary* dictionary = find_dictionary("DICT_4X4_250");
  ASSERT_NE(dictionary, nullptr);
  constexpr int kNumber = 2;  // OpenCV's, of this dictionary
  const int cells = dictionary->side + 2;
  for (const auto& [cols, rows] : {std::pair{5, 7}, {6, 8}, {7, 4}, {4, 3}}) {
    for (const bool inverted : {false, true}) {
      CharucoBoard board = {cols, rows, kSquare / kMetre, kMarker / kMetre, dictionary};
      board.inverted = inverted;
      const cv::Mat expected = scenes::charuco_picture({cols, rows}, kSquare, kMarker, kNumber);
      const cv::Mat before =
          scenes::legacy_charuco_picture({cols, rows}, kSquare, kMarker, kNumber, cells);
      expect_same(board, expected);
      board.legacy = true;
      expect_same(board, before);
      if (rows % 2 == 1) expect_same(board, expected);
    }
  }
}

#endif
#endif

}  // namespace
}  // namespace calvin
