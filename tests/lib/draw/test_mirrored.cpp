// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What is drawn and said in a picture that is turned left to right.
#include "calvin/draw/mirrored.hpp"

#include <gtest/gtest.h>

#include "calvin/session/guidance/hint.hpp"

namespace calvin {
namespace {

TEST(Mirrored, CornersAreWhereTheirPixelsAre) {
  Observation seen;
  seen.image_size = {640, 480};
  seen.ids = {4, 7};
  seen.uv = {{0, 10}, {639, 20.5}};
  const Observation turned = mirrored(seen, {320, 240});
  EXPECT_EQ(turned.ids, seen.ids);
  EXPECT_EQ(turned.uv[0].u, 639);
  EXPECT_EQ(turned.uv[0].v, 10);
  EXPECT_EQ(turned.uv[1].u, 0);
  seen.image_size = {0, 0};
  EXPECT_EQ(mirrored(seen, {320, 240}).uv[0].u, 319);
}

TEST(Mirrored, GhostMapAndWordsAreTurned) {
  Progress progress;
  progress.ghost = {{0.1, 0.2}, {0.9, 0.3}};
  progress.coverage_map = {3, {true, false, false, false, true, true}};
  progress.hint = "Move the board to the upper left of the image.";
  const Progress turned = mirrored(progress);
  EXPECT_EQ(turned.ghost[0].u, 0.9);
  EXPECT_EQ(turned.ghost[0].v, 0.2);
  EXPECT_EQ(turned.coverage_map.covered,
            (std::vector<bool>{false, false, true, true, true, false}));
  EXPECT_EQ(turned.hint, "Move the board to the upper right of the image.");
  EXPECT_EQ(mirrored(turned).hint, progress.hint);
}

// Of every sentence that a session says.
TEST(Mirrored, WordsAreThoseOfTheOtherSide) {
  using enum HintDirection;
  for (const HintKind kind : {HintKind::kMove, HintKind::kTilt}) {
    const auto say = [kind](HintDirection direction) {
      Progress progress;
      progress.hint = to_text({kind, direction});
      return progress;
    };
    EXPECT_EQ(mirrored(say(kLeft)).hint, say(kRight).hint);
    EXPECT_EQ(mirrored(say(kTop)).hint, say(kTop).hint);
    EXPECT_EQ(mirrored(say(kUpperLeft)).hint, say(kUpperRight).hint);
    EXPECT_EQ(mirrored(say(kLowerRight)).hint, say(kLowerLeft).hint);
  }
  Progress other;
  other.hint = "bright and leftover, right?";
  EXPECT_EQ(mirrored(other).hint, "bright and leftover, left?");
  other.hint = "'left.json' still holds, on the left";
  EXPECT_EQ(mirrored(other).hint, "'left.json' still holds, on the right");
}

}  // namespace
}  // namespace calvin
