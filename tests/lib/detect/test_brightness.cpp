// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether a picture is too dark to show a board.
#include "calvin/detect/brightness.hpp"

#include <gtest/gtest.h>

#include "calvin/detect/detector.hpp"
#include "calvin/synth/render.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

GrayImage of(ImageSize size, std::uint8_t value) { return {size.width, size.height, value}; }

TEST(Brightness, BlackIsTooDarkInEitherRange) {
  for (const ImageSize size :
       {ImageSize{1, 1}, ImageSize{64, 48}, ImageSize{641, 481}, ImageSize{3840, 2160}}) {
    EXPECT_TRUE(is_too_dark(of(size, 0).view()));
    EXPECT_TRUE(is_too_dark(of(size, 16).view()));
    EXPECT_FALSE(is_too_dark(of(size, 120).view()));
    EXPECT_FALSE(is_too_dark(of(size, 255).view()));
  }
  EXPECT_FALSE(is_too_dark(ImageView()));
}

// A lamp or a screen in a dark room, and a board in a corner of a room that is dark else.
TEST(Brightness, ABoardIsEnoughAndALampIsNot) {
  GrayImage room = of({1280, 960}, 20);
  for (int y = 100; y < 200; ++y) std::fill_n(room.row(y) + 300, 100, 255);
  EXPECT_TRUE(is_too_dark(room.view()));
  for (int y = 400; y < 700; ++y) std::fill_n(room.row(y) + 500, 200, 60);
  EXPECT_FALSE(is_too_dark(room.view()));
}

// Whoever is told that it is too dark must not have a board that could be found.
TEST(Brightness, APictureInWhichABoardIsFoundIsNotDark) {
  const Camera camera = Camera::make("pinhole", {640, 480}, {500, 500, 319.5, 239.5}).value();
  const auto board = parse_board("checkerboard:9x6:25mm").value();
  RenderOptions options;
  const GrayImage bright =
      render_board(camera, board, to_se3({{0.1, 0.2, 0}, {-0.1, -0.06, 0.4}}), options);
  const auto detector = make_detector(board);
  ASSERT_TRUE(detector);
  ASSERT_FALSE(is_too_dark(bright.view()));
  // Darker and darker, as a diaphragm makes it.
  int found_dark = 0;
  for (int percent = 100; percent >= 4; percent -= 4) {
    GrayImage image = bright;
    for (auto& pixel : image.pixels) pixel = static_cast<std::uint8_t>(pixel * percent / 100);
    found_dark += (*detector)->detect(image.view()).observation.found() && percent >= 20 &&
                  is_too_dark(image.view());
  }
  EXPECT_EQ(found_dark, 0);
}

}  // namespace
}  // namespace calvin
