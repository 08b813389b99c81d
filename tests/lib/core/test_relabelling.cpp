// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The texts of relabellings, which messages and metas carry.
#include <gtest/gtest.h>

#include "calvin/core/observation.hpp"

namespace calvin {
namespace {

TEST(Relabellings, HaveTheTextsThatAreDocumented) {
  EXPECT_EQ(to_text({}), "");
  EXPECT_EQ(to_text({2}), "rotate180");
  EXPECT_EQ(to_text({0, 2, 0}), "shift(2,0)");
  EXPECT_EQ(to_text({1, 0, -1}), "rotate90 shift(0,-1)");
}

// Whole turns change nothing.
TEST(Relabellings, HaveTheTextOfTheirTurnWithinAWholeOne) {
  EXPECT_EQ(to_text({7, 0, 0}), "rotate270");
  EXPECT_EQ(to_text({-1, 0, 0}), "rotate270");
  EXPECT_EQ(to_text({4, 0, 0}), "");
  EXPECT_EQ(to_text({-6, 1, 0}), "rotate180 shift(1,0)");
}

TEST(Relabellings, AreReadBack) {
  for (int turns = 0; turns < 4; ++turns) {
    for (int cols = -2; cols <= 2; ++cols) {
      for (int rows = -2; rows <= 2; ++rows) {
        const Relabelling given = {turns, cols, rows};
        EXPECT_EQ(parse_relabelling(to_text(given)), given) << to_text(given);
      }
    }
  }
}

TEST(Relabellings, OfOtherTextsThereAreNone) {
  for (const char* text :
       {"rotate", "rotate45", "rotate0", "rotate360", "rotate-90", "shift", "shift()", "shift(1)",
        "shift(1,2", "shift(1,2,3)", "shift(0,0)", "rotate90 rotate90", "shift(1,0) rotate90",
        "rotate90  shift(1,0)", "mirror", "rotate90x", "shift(99999999999,0)"}) {
    EXPECT_FALSE(parse_relabelling(text).has_value()) << text;
  }
}

}  // namespace
}  // namespace calvin
