// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Drawn boards, read back and measured.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/draw/board_drawing.hpp"
#include "calvin_config.h"

#if CALVIN_HAVE_OPENCV
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#endif

#include "calvin/core/file.hpp"
#include "calvin/core/image.hpp"
#include "calvin/target/kinds.hpp"
#include "read_picture.hpp"

namespace calvin {
namespace {

Board board_of(std::string_view text) { return parse_board(text).value(); }

TEST(BoardLayout, TheDefaultBoardFitsOnA4Lying) {
  const auto page = lay_out_board(board_of(kDefaultBoard), "auto");
  ASSERT_TRUE(page.has_value()) << page.error().message;
  EXPECT_DOUBLE_EQ(page->width, 0.297);
  EXPECT_DOUBLE_EQ(page->height, 0.210);
  EXPECT_TRUE(lay_out_board(board_of(kDefaultBoard), "letter").has_value());
}

TEST(BoardLayout, OfALightIsNone) {
  for (const char* paper : {"auto", "fit", "a4"}) {
    const auto page = lay_out_board(board_of("dot"), paper);
    ASSERT_FALSE(page.has_value());
    EXPECT_NE(page.error().message.find("nothing to print"), std::string::npos);
  }
  EXPECT_FALSE(draw_board(board_of("dot"), {}).has_value());
}

TEST(BoardLayout, OfPointsIsOneWhereTheyAreDotsOfASheet) {
  using Dot = PointBoard::Dot;
  const auto refused = [](std::vector<Dot> dots) {
    const Board board = PointBoard::make("plate", std::move(dots)).value();
    const auto page = lay_out_board(board, "fit");
    return page ? std::string() : page.error().message;
  };
  const double size = 0.01;
  const std::vector<Dot> dots = {
      {0, 0, 0, size}, {1, 0.05, 0, size}, {2, 0, 0.05, size}, {3, 0.05, 0.05, size}};
  EXPECT_EQ(refused(dots), "");
  std::vector<Dot> raised = dots;
  raised[3].z = 0.02;
  EXPECT_NE(refused(raised).find("not on a sheet: there is nothing to print"), std::string::npos);
  std::vector<Dot> points = dots;
  for (Dot& dot : points) dot.diameter = 0;
  EXPECT_NE(refused(points).find("without a size: there is nothing to print"), std::string::npos);
}

TEST(BoardLayout, TheBorderIsAtLeastHalfASquare) {
  for (const char* text : {"checkerboard:9x6:25mm", "checkerboard:6x9:25mm", "checkerboard:4x3:8mm",
                           "checkerboard:20x14:1in", "checkerboard:3x2:100mm"}) {
    for (const char* paper : {"auto", "fit", "A0"}) {
      const auto board = *board_of(text).as<Checkerboard>();
      const auto page = lay_out_board(board, paper);
      ASSERT_TRUE(page.has_value()) << page.error().message;
      const double border = std::max(board.size / 2, 0.005) - 1e-9;
      EXPECT_GE(page->x - board.size, border) << text << " on " << paper;
      EXPECT_GE(page->y - board.size, border);
      EXPECT_GE(page->width - (page->x + board.cols * board.size), border);
      EXPECT_GE(page->height - (page->y + board.rows * board.size), border);
      EXPECT_EQ(page->width > page->height, board.cols > board.rows) << text << " on " << paper;
    }
  }
}

TEST(BoardLayout, ABoardThatDoesNotFitIsToldWhatWould) {
  const auto page = lay_out_board(board_of("checkerboard:9x6:40mm"), "a4");
  ASSERT_FALSE(page.has_value());
  EXPECT_NE(page.error().message.find("'a2'"), std::string::npos) << page.error().message;
  EXPECT_NE(page.error().message.find("checkerboard:9x6:25mm"), std::string::npos);
  EXPECT_TRUE(lay_out_board(board_of("checkerboard:9x6:40mm"), "a2").has_value());
  EXPECT_FALSE(lay_out_board(board_of("checkerboard:9x6:25.1mm"), "a4").has_value());
  EXPECT_TRUE(lay_out_board(board_of("checkerboard:9x6:25mm"), "a4").has_value());
}

TEST(BoardLayout, PapersAndBoardsOutOfRange) {
  const auto unknown = lay_out_board(board_of(kDefaultBoard), "a4x");
  ASSERT_FALSE(unknown.has_value());
  for (const std::string& name : paper_names()) {
    EXPECT_NE(unknown.error().message.find(name), std::string::npos) << name;
  }
  EXPECT_FALSE(lay_out_board(board_of("checkerboard:9x6:1000m"), "auto").has_value());
}

TEST(Drawing, TheFormatIsTheExtension) {
  EXPECT_EQ(*drawing_format("a.b/board.SVG"), DrawingFormat::kSvg);
  EXPECT_EQ(*drawing_format("board.pdf"), DrawingFormat::kPdf);
  EXPECT_EQ(*drawing_format("board.Png"), DrawingFormat::kPng);
  for (const char* wrong : {"", "board", "pdf", ".pdf", "board.jpg", "board.pdf.gz"}) {
    EXPECT_FALSE(drawing_format(wrong).has_value()) << wrong;
  }
}

#if CALVIN_HAVE_CAIRO

// Mean darkness 0..1 of the pixels whose row (or column) is near the middle of a square, as the
// extent and the centre of the dark run between two places: where the ink really is.
struct Run {
  double length = 0;  // px
  double centre = 0;  // px, the centre of the first pixel is 0
};

Run dark_run(const GrayImage& image, bool along_x, double across, double from, double to) {
  double sum = 0;
  double moment = 0;
  for (int i = static_cast<int>(std::lround(from)); i <= static_cast<int>(std::lround(to)); ++i) {
    const int other = static_cast<int>(std::lround(across));
    const double dark = 1 - image.view().at(along_x ? i : other, along_x ? other : i) / 255.0;
    sum += dark;
    moment += i * dark;
  }
  return {sum, moment / sum};
}

// Every dark square's extent and centre, and the colour of every square, at `scale` px per m.
void expect_true_to_scale(const GrayImage& image, const Checkerboard& board,
                          const BoardLayout& page, double scale, double tolerance) {
  const double side = board.size * scale;
  for (int j = 0; j <= board.rows; ++j) {
    for (int i = 0; i <= board.cols; ++i) {
      const double u = (page.x + (i - 0.5) * board.size) * scale - 0.5;
      const double v = (page.y + (j - 0.5) * board.size) * scale - 0.5;
      const int grey =
          image.view().at(static_cast<int>(std::lround(u)), static_cast<int>(std::lround(v)));
      ASSERT_EQ(grey, (i + j) % 2 == 0 ? 0 : 255) << "square " << i << ", " << j;
      if (grey != 0) continue;
      const Run x = dark_run(image, true, v, u - 0.9 * side, u + 0.9 * side);
      const Run y = dark_run(image, false, u, v - 0.9 * side, v + 0.9 * side);
      EXPECT_NEAR(x.length, side, tolerance) << "square " << i << ", " << j;
      EXPECT_NEAR(y.length, side, tolerance) << "square " << i << ", " << j;
      EXPECT_NEAR(x.centre, u, tolerance) << "square " << i << ", " << j;
      EXPECT_NEAR(y.centre, v, tolerance) << "square " << i << ", " << j;
    }
  }
}

std::uint32_t big_endian(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

TEST(Drawing, PngIsTrueToScale) {
  struct Case {
    const char* board;
    const char* paper;
    double dpi;
  };
  for (const Case& c :
       {Case{"checkerboard:9x6:25mm", "a4", 300}, Case{"checkerboard:9x6:25mm", "letter", 97},
        Case{"checkerboard:4x7:13.7mm", "fit", 150}}) {
    const auto board = *board_of(c.board).as<Checkerboard>();
    const auto png = draw_board(board, {DrawingFormat::kPng, c.paper, c.dpi});
    ASSERT_TRUE(png.has_value()) << png.error().message;
    const GrayImage image = scenes::decode_png(*png);
    const BoardLayout page = lay_out_board(board, c.paper).value();
    EXPECT_NEAR(image.width, page.width / 0.0254 * c.dpi, 1) << c.board;
    EXPECT_NEAR(image.height, page.height / 0.0254 * c.dpi, 1) << c.board;
    expect_true_to_scale(image, board, page, c.dpi / 0.0254, 0.1);
  }
}

TEST(Drawing, PngTellsItsResolution) {
  const auto png = draw_board(board_of("checkerboard:4x3:10mm"), {DrawingFormat::kPng, "fit", 300});
  ASSERT_TRUE(png.has_value()) << png.error().message;
  const auto at = png->find("pHYs");
  ASSERT_NE(at, std::string::npos);
  EXPECT_LT(at, png->find("IDAT"));
  EXPECT_EQ(big_endian(*png, at - 4), 9u);
  EXPECT_EQ(big_endian(*png, at + 4), 11811u) << "300 dpi, as other programs write it";
  EXPECT_EQ(big_endian(*png, at + 8), 11811u);
  EXPECT_EQ((*png)[at + 12], 1) << "the unit is the metre";
  EXPECT_EQ(big_endian(*png, at + 13), 0x78a53f76u) << "the CRC of these 13 bytes, from zlib";
}

#if CALVIN_HAVE_OPENCV
TEST(Drawing, TheDetectorFindsTheCornersWhereTheyAre) {
  const auto board = *board_of("checkerboard:9x6:25mm").as<Checkerboard>();
  const double dpi = 100;
  const auto png = draw_board(board, {DrawingFormat::kPng, "a4", dpi});
  ASSERT_TRUE(png.has_value()) << png.error().message;
  GrayImage image = scenes::decode_png(*png);
  const BoardLayout page = lay_out_board(board, "a4").value();
  std::vector<cv::Point2f> corners;
  const cv::Mat view(image.height, image.width, CV_8U, image.pixels.data());
  ASSERT_TRUE(cv::findChessboardCornersSB(view, {board.cols, board.rows}, corners));
  if (corners.front().y > corners.back().y) std::reverse(corners.begin(), corners.end());
  const auto points = board.grid().points();
  ASSERT_EQ(corners.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(corners[i].x, (page.x + points[i].x()) * dpi / 0.0254 - 0.5, 0.15) << i;
    EXPECT_NEAR(corners[i].y, (page.y + points[i].y()) * dpi / 0.0254 - 0.5, 0.15) << i;
  }
}
#endif

// The numbers of a text, all else skipped.
std::vector<double> numbers_of(std::string_view text) {
  std::vector<double> numbers;
  for (const char* p = text.data(); p < text.data() + text.size();) {
    double value = 0;
    const auto [end, error] = std::from_chars(p, text.data() + text.size(), value);
    if (error == std::errc()) numbers.push_back(value);
    p = error == std::errc() ? end : p + 1;
  }
  return numbers;
}

// The value of an attribute of an XML tag; empty where it has none of that name.
std::string_view attribute(std::string_view tag, std::string_view name) {
  const std::string start = std::string(" ").append(name).append("=\"");
  const auto at = tag.find(start);
  if (at == std::string_view::npos) return {};
  const auto value = at + start.size();
  return tag.substr(value, tag.find('"', value) - value);
}

// A length with its unit, mm. Absent: not a number, or in a unit that depends on the screen.
std::optional<double> millimetres(std::string_view length) {
  const auto numbers = numbers_of(length);
  if (numbers.size() != 1) return std::nullopt;
  for (const auto& [unit, size] :
       {std::pair("mm", 1.0), {"cm", 10.0}, {"in", 25.4}, {"pt", 25.4 / 72}}) {
    if (length.ends_with(unit)) return numbers[0] * size;
  }
  return std::nullopt;
}

// The tags of a name, in the order in which they are drawn.
std::vector<std::string_view> tags_of(std::string_view xml, std::string_view name) {
  const std::string start = std::string("<").append(name).append(" ");
  std::vector<std::string_view> tags;
  for (auto at = xml.find(start); at != std::string_view::npos; at = xml.find(start, at + 1)) {
    tags.push_back(xml.substr(at, xml.find('>', at) - at));
  }
  return tags;
}

// Whether a path is filled with black, as an attribute or in its style.
bool is_filled_black(std::string_view path) {
  std::string plain(path);
  std::erase(plain, ' ');
  return plain.find("fill:rgb(0%,0%,0%)") != std::string::npos ||
         plain.find("fill=\"rgb(0%,0%,0%)\"") != std::string::npos;
}

// The extents of the polygons of a path.
struct Extent {
  double left = 1e9;
  double top = 1e9;
  double right = -1e9;
  double bottom = -1e9;
};
std::vector<Extent> polygons_of(std::string_view path) {
  std::vector<Extent> polygons;
  for (auto at = path.find('M'); at != std::string_view::npos;) {
    const auto next = path.find('M', at + 1);
    const auto numbers = numbers_of(path.substr(at, next - at));
    Extent e;
    for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) {
      e = {std::min(e.left, numbers[i]), std::min(e.top, numbers[i + 1]),
           std::max(e.right, numbers[i]), std::max(e.bottom, numbers[i + 1])};
    }
    // Cairo may begin another polygon where the last one ends.
    if (numbers.size() > 2) polygons.push_back(e);
    at = next;
  }
  return polygons;
}

// Of the size of its page and of one unit of its coordinates, whatever units they are written in.
TEST(Drawing, SvgIsInMillimetres) {
  const auto board = *board_of("checkerboard:9x6:25mm").as<Checkerboard>();
  const auto svg = draw_board(board, {DrawingFormat::kSvg, "a4"});
  ASSERT_TRUE(svg.has_value()) << svg.error().message;
  const auto roots = tags_of(*svg, "svg");
  ASSERT_EQ(roots.size(), 1u);
  const auto width = millimetres(attribute(roots[0], "width"));
  const auto height = millimetres(attribute(roots[0], "height"));
  ASSERT_TRUE(width && height) << roots[0];
  EXPECT_NEAR(*width, 297, 0.005);
  EXPECT_NEAR(*height, 210, 0.005);
  const auto view = numbers_of(attribute(roots[0], "viewBox"));
  ASSERT_EQ(view.size(), 4u) << roots[0];
  EXPECT_EQ(view[0], 0);
  EXPECT_EQ(view[1], 0);
  const double unit = *width / view[2];  // mm
  EXPECT_NEAR(view[3] * unit, *height, 0.005);

  const auto paths = tags_of(*svg, "path");
  const auto ink = std::find_if(paths.begin(), paths.end(), is_filled_black);
  ASSERT_NE(ink, paths.end());
  EXPECT_TRUE(attribute(*ink, "transform").empty());
  const auto polygons = polygons_of(attribute(*ink, "d"));
  const BoardLayout page = lay_out_board(board, "a4").value();
  std::size_t square = 0;
  for (int j = 0; j <= board.rows; ++j) {
    for (int i = j % 2; i <= board.cols; i += 2, ++square) {
      ASSERT_LT(square, polygons.size());
      const Extent& e = polygons[square];
      EXPECT_NEAR(e.left * unit, page.x * 1e3 + (i - 1) * 25, 0.005);
      EXPECT_NEAR(e.top * unit, page.y * 1e3 + (j - 1) * 25, 0.005);
      EXPECT_NEAR(e.right * unit, page.x * 1e3 + i * 25, 0.005);
      EXPECT_NEAR(e.bottom * unit, page.y * 1e3 + j * 25, 0.005);
    }
  }
  EXPECT_EQ(square, polygons.size());
}

TEST(Drawing, PdfIsTrueToScale) {
  const auto board = *board_of("checkerboard:9x6:25mm").as<Checkerboard>();
  const auto pdf = draw_board(board, {DrawingFormat::kPdf, "a4"});
  ASSERT_TRUE(pdf.has_value()) << pdf.error().message;
  const double dpi = 200;
  const auto page_of_pdf = scenes::decode_pdf(*pdf, dpi);
  if (!page_of_pdf) GTEST_SKIP() << "pdftoppm is not installed";
  const GrayImage& image = *page_of_pdf;
  // The renderer covers the page with whole pixels.
  EXPECT_NEAR(image.width, 297 / 25.4 * dpi + 0.5, 0.51);
  EXPECT_NEAR(image.height, 210 / 25.4 * dpi + 0.5, 0.51);
  // The renderer draws whole pixels: half a pixel at either edge.
  expect_true_to_scale(image, board, lay_out_board(board, "a4").value(), dpi / 0.0254, 1.01);
}

TEST(Drawing, TooManyPixelsAreRefused) {
  const Board board = board_of("checkerboard:9x6:100mm");
  const auto png = draw_board(board, {DrawingFormat::kPng, "fit", 2400});
  ASSERT_FALSE(png.has_value());
  EXPECT_EQ(png.error().code, ErrorCode::kInvalidArgument);
  for (const double dpi : {0.0, -300.0, 1e9, std::nan("")}) {
    EXPECT_FALSE(draw_board(board, {DrawingFormat::kPng, "fit", dpi}).has_value()) << dpi;
  }
}

#else

TEST(Drawing, SaysThatThisBuildCannot) {
  const auto drawing = draw_board(board_of(kDefaultBoard), {});
  ASSERT_FALSE(drawing.has_value());
  EXPECT_EQ(drawing.error().code, ErrorCode::kUnsupported);
}

#endif

}  // namespace
}  // namespace calvin
