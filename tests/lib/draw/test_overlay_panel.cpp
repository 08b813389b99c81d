// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The panel of the overlay: where it and its words are, and the colours of its chips.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/draw/overlay.hpp"
#include "calvin_config.h"

namespace calvin {
namespace {

constexpr ImageSize kFrame{640, 480};

Progress under_way() {
  Progress progress;
  progress.parameters = {{"focal length", 0}, {"principal point", 0.5}, {"distortion", 1}};
  progress.coverage_map = {4, std::vector<bool>(12, true)};
  return progress;
}

bool is_within(const OverlayWords& words, const OverlayBox& box) {
  return words.at.u >= box.x && words.at.u + words.width <= box.x + box.width &&
         words.at.v - words.size / 2 >= box.y && words.at.v + words.size / 2 <= box.y + box.height;
}

TEST(OverlayPanel, HasALineForEachBarAndChip) {
  for (const ImageSize frame : {kFrame, ImageSize{1920, 1080}, ImageSize{480, 640}}) {
    for (const PanelSide side : {PanelSide::kLeft, PanelSide::kRight}) {
      const OverlayBox box = overlay_panel_box(frame, under_way(), side);
      EXPECT_GE(box.x, 0);
      EXPECT_LE(box.x + box.width, frame.width);
      EXPECT_EQ(side == PanelSide::kLeft, box.x < frame.width / 2);
      const auto words = overlay_panel_words(frame, under_way(), side);
      ASSERT_EQ(words.size(), 9U);
      EXPECT_EQ(words[0].text, "covered");
      EXPECT_EQ(words[7].text, "distortion");
      EXPECT_EQ(words[8].text, "where boards were");
      for (std::size_t i = 0; i < words.size(); ++i) {
        EXPECT_TRUE(is_within(words[i], box)) << words[i].text;
        if (i == 0) continue;
        EXPECT_GT(words[i].at.v - words[i - 1].at.v, words[i].size);
      }
    }
  }
}

TEST(OverlayPanel, HasTheNumbersOnceItIsDone) {
  Progress progress = under_way();
  progress.summary = {"fx 1", "fy 2"};
  EXPECT_EQ(overlay_panel_words(kFrame, progress, PanelSide::kLeft).size(), 9U) << "not yet";
  progress.done = true;
  const auto words = overlay_panel_words(kFrame, progress, PanelSide::kLeft);
  ASSERT_EQ(words.size(), 2U);
  EXPECT_EQ(words[1].text, "fy 2");
  // Anybody may write a meta.
  progress.summary.assign(100000, "x");
  EXPECT_LE(overlay_panel_words(kFrame, progress, PanelSide::kLeft).size(), 20U);
  progress.done = false;
  progress.parameters.assign(100000, {"y", 1});
  EXPECT_LE(overlay_panel_words(kFrame, progress, PanelSide::kLeft).size(), 10U);
}

TEST(OverlayPanel, LeavesHalfOfTheFrameToOtherWords) {
  const OverlayBox left = overlay_panel_box(kFrame, under_way(), PanelSide::kLeft);
  const OverlaySpan beside = beside_panel(left, kFrame);
  EXPECT_GT(beside.left, left.x + left.width);
  EXPECT_EQ(beside.right, 640);
  const OverlayBox right = overlay_panel_box(kFrame, under_way(), PanelSide::kRight);
  EXPECT_EQ(beside_panel(right, kFrame).left, 0);
  EXPECT_LT(beside_panel(right, kFrame).right, right.x);
  const OverlaySpan narrow =
      beside_panel(overlay_panel_box({120, 480}, under_way(), PanelSide::kLeft), {120, 480});
  EXPECT_GE(narrow.right - narrow.left, 60);
}

TEST(OverlayPanel, HidesACornerWhereOneIsUnderIt) {
  Observation seen;
  seen.image_size = {1280, 960};  // twice the frame
  const auto is_hidden = [&](Pixel at) {
    seen.uv = {{1200, 900}, at};
    return hides_corner({10, 20, 100, 50}, std::vector{seen}, kFrame);
  };
  EXPECT_TRUE(is_hidden({60, 80}));
  EXPECT_FALSE(is_hidden({10, 80}));
  EXPECT_FALSE(is_hidden({240, 80}));
  EXPECT_FALSE(is_hidden({60, 160}));
  EXPECT_FALSE(is_hidden({NAN, 80}));
  seen.image_size = {};
  EXPECT_FALSE(is_hidden({60, 80})) << "of a picture whose size nobody knows";
}

TEST(OverlayPanel, HidesASquareAroundTheCorners) {
  Observation seen;
  seen.image_size = kFrame;
  // Squares of 20 px, from `left` on to the right.
  const auto is_hidden = [&](double left) {
    seen.uv.clear();
    for (int i = 0; i < 20; ++i) seen.uv.push_back({left + 20 * (i % 5), 200.0 + 20 * (i / 5)});
    return hides_square({10, 180, 100, 50}, std::vector{seen}, kFrame);
  };
  EXPECT_TRUE(is_hidden(100));
  EXPECT_TRUE(is_hidden(125));
  EXPECT_FALSE(is_hidden(135));
  EXPECT_FALSE(is_hidden(NAN));
}

TEST(OverlayPanel, HidesAnOutlineWhereAPlaceOfItIsUnderIt) {
  const OverlayBox box = {10, 20, 100, 50};  // of 640 x 480
  EXPECT_TRUE(hides_outline(box, std::vector<Pixel>{{0.5, 0.5}, {0.1, 0.1}}, kFrame));
  EXPECT_FALSE(hides_outline(box, std::vector<Pixel>{{0.5, 0.5}, {0.1, 0.2}}, kFrame));
  EXPECT_FALSE(hides_outline(box, std::vector<Pixel>{{NAN, 0.1}}, kFrame));
  EXPECT_FALSE(hides_outline(box, {}, kFrame));
}

#if CALVIN_HAVE_CAIRO

struct Colour {
  int alpha = 0;
  int red = 0;
  int green = 0;
};

Colour colour_at(const Progress& progress, int x, int y, const OverlayParts& parts = {}) {
  const auto tiles = draw_overlay(kFrame, {}, progress, parts);
  EXPECT_TRUE(tiles.has_value());
  for (const OverlayTile& tile : *tiles) {
    const int u = x - tile.x;
    const int v = y - tile.y;
    if (u < 0 || v < 0 || u >= tile.width || v >= tile.height) continue;
    std::uint32_t pixel = 0;
    std::copy_n(&tile.pixels[static_cast<std::size_t>(4 * (v * tile.width + u))], 4,
                reinterpret_cast<std::uint8_t*>(&pixel));
    return {static_cast<int>(pixel >> 24), static_cast<int>(pixel >> 16 & 255),
            static_cast<int>(pixel >> 8 & 255)};
  }
  return {};
}

TEST(OverlayPanel, ChipsFillAndTurnGreen) {
  const Progress progress = under_way();
  const auto words = overlay_panel_words(kFrame, progress, PanelSide::kRight);
  const auto chip = [&](std::size_t i, double along) {
    const OverlayWords& at = words.at(5 + i);
    return colour_at(progress, static_cast<int>(at.at.u + along * at.width),
                     static_cast<int>(at.at.v), {.panel = PanelSide::kRight});
  };
  EXPECT_LT(chip(0, 0).alpha, 250) << "of what is unknown there is nothing";
  const Colour half = chip(1, 0.3);
  EXPECT_GT(half.red, 180);
  EXPECT_GT(half.green, 180);
  EXPECT_LT(chip(1, 0.7).alpha, 250);
  const Colour known = chip(2, 0.9);
  EXPECT_GT(known.green, 2 * known.red);
}

TEST(OverlayPanel, KeepsItsBarsWhereNobodyAddsWords) {
  Progress progress = under_way();
  progress.done = true;
  progress.summary = {"fx 1", "fy 2", "cx 3", "cy 4"};
  progress.coverage = 1;
  const auto first = overlay_panel_words(kFrame, under_way(), PanelSide::kLeft).front();
  const auto is_bar = [&](bool words) {
    const Colour c = colour_at(progress, static_cast<int>(first.at.u), static_cast<int>(first.at.v),
                               {.words = words});
    return c.alpha > 250;
  };
  EXPECT_FALSE(is_bar(true));
  EXPECT_TRUE(is_bar(false));
}

TEST(OverlayPanel, ADoneSessionHasAGreenBorder) {
  Progress progress = under_way();
  EXPECT_EQ(colour_at(progress, 0, 300).alpha, 0);
  progress.done = true;
  const Colour border = colour_at(progress, 0, 300);
  EXPECT_GT(border.alpha, 250);
  EXPECT_GT(border.green, 2 * border.red);
  EXPECT_EQ(colour_at(progress, 3, 300).alpha, 0) << "thinner than that of a view";
  progress.captured = true;
  const Colour taken = colour_at(progress, 3, 300);
  EXPECT_GT(std::min(taken.green, taken.red), 250);
}

#endif

}  // namespace
}  // namespace calvin
