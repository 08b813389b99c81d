// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The families of AprilTag: what is printed of each tag, against libapriltag, and the texts of
// boards with them.
#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>

#include "calvin/target/artwork/artwork.hpp"
#include "calvin/target/kinds.hpp"
#include "calvin_config.h"
#if CALVIN_HAVE_APRILTAG
#include "april_tags.hpp"
#endif

namespace calvin {
namespace {

#if CALVIN_HAVE_APRILTAG

// What is neither a bit nor border nor the ring around it is paper: the corners of round tags.
bool is_paper(const apriltag_family_t& family, int col, int row) {
  const int last = family.width_at_border - 1;
  const int depth = std::min({col, row, last - col, last - row});
  bool is_bit = false;
  for (unsigned i = 0; i < family.nbits; ++i) {
    is_bit = is_bit ||
             (static_cast<int>(family.bit_x[i]) == col && static_cast<int>(family.bit_y[i]) == row);
  }
  return !is_bit && depth < (family.reversed_border ? -1 : 0);
}

TEST(TagFamilies, ArePrintedAsByLibapriltag) {
  if (!has_april_tag_3()) GTEST_SKIP() << "this build does not know AprilTag 3";
  for (const scenes::AprilMaker& maker : scenes::kAprilMakers) {
    const auto family = scenes::april_family(maker.name);
    const MarkerDictionary* own = find_family(maker.name);
    ASSERT_NE(own, nullptr) << maker.name;
    ASSERT_EQ(own->codes.size(), family->ncodes) << maker.name;
    const int every = std::max(static_cast<int>(family->ncodes) / 150, 1);
    for (int id = 0; id < static_cast<int>(family->ncodes); id += every) {
      TagGrid board{1, 1, 1, 0.5, own, true, id};
      const Artwork artwork = artwork_of(board);
      const GrayImage picture = scenes::april_picture(*family, id);
      const int more = (picture.width - artwork.cols()) / 2;
      const int corner = 1 + own->outside;  // behind what is free around the tag
      for (int row = 0; row < artwork.rows(); ++row) {
        for (int col = 0; col < artwork.cols(); ++col) {
          const bool is_light = is_paper(*family, col - corner, row - corner) ||
                                picture.view().at(col + more, row + more) != 0;
          ASSERT_EQ(!artwork.is_dark(col, row), is_light)
              << maker.name << " " << id << " " << col << " " << row;
        }
      }
    }
  }
}

#endif

TEST(TagFamilies, HaveTextsAndGapsForTheirBits) {
  if (!has_april_tag_3()) GTEST_SKIP() << "this build does not know AprilTag 3";
  for (const auto& [text, canonical] : {
           std::pair{"apriltag:Standard41h12:4x3:50mm:40mm",
                     "apriltag:tagStandard41h12:4x3:50mm:40mm"},
           {"apriltag:tagCustom48h12:2x2:60mm:40mm:first=42207",
            "apriltag:tagCustom48h12:2x2:60mm:40mm:first=42207"},
           {"apriltag:tagCircle49h12:2x1:50mm:6cm:inverted",
            "apriltag:tagCircle49h12:2x1:50mm:60mm:inverted"},
           {"apriltag:tagCircle21h7:1x1:50mm:5mm", "apriltag:tagCircle21h7:1x1:50mm:5mm"},
           {"apriltag:tagStandard52h13:25mm:3=0,0+7=43mm,0",
            "apriltag:tagStandard52h13:25mm:3=0,0+7=43mm,0"},
       }) {
    const auto board = parse_board(text);
    ASSERT_TRUE(board.has_value()) << text << ": " << board.error().message;
    EXPECT_EQ(board->text(), canonical) << text;
    EXPECT_EQ(parse_board(canonical).value(), *board) << text;
  }
  for (const auto& [text, why] :
       {std::pair{"apriltag:tagStandard41h12:4x3:50mm:39.9mm", "at least 0.8 of a tag's side"},
        {"apriltag:tagCustom48h12:2x2:60mm:39mm", "at least 0.667 of a tag's side"},
        {"apriltag:tagStandard41h12:4x3:50mm:50mm:border=2", "are 1 bit wide"},
        {"apriltag:tagCircle21h7:2x2:50mm:50mm:first=36", "has 38"},
        {"apriltag:tagStandard52h13:25mm:3=0,0+7=41mm,0", "lie over each other"},
        {"apriltag:tagStandard42h12:4x3:50mm:50mm", "there is no dictionary"},
        {"apriltag:tagcircle21h7:1x1:50mm:1mm",
         "there is no dictionary 'tagcircle21h7', but "
         "'tagCircle21h7'"},
        {"apriltag:standard41H12:1x1:50mm:50mm", "no dictionary 'standard41H12', but"},
        {"apriltag:5x7:40mm:10mm", "a dictionary or family is missing before '5x7'"},
        {"apriltag:tagCircle21h7:1x1:50mm:1mm", "what is free around a single tag"},
        {"apriltag:tag36h11:2x1:50mm:1mm", "gaps are at least half as wide as a bit"},
        {"aruco:4x3:50mm:50mm:tagStandard41h12", "apriltag:tagStandard41h12:..."},
        {"aprilgrid:4x3:50mm:0.3:tagStandard41h12", "apriltag:tagStandard41h12:..."},
        {"charuco:5x7:40mm:20mm:tagStandard41h12", "apriltag:tagStandard41h12:..."}}) {
    const auto refused = parse_board(text);
    ASSERT_FALSE(refused) << text;
    EXPECT_NE(refused.error().message.find(why), std::string::npos) << refused.error().message;
    EXPECT_NE(refused.error().message.find("A right text is"), std::string::npos);
  }
}

// A build without a library names it, the package that has it, and the boards that it would have.
TEST(TagFamilies, ThatABuildLacksAreExplained) {
  const bool has_any = !marker_dictionaries().empty();
  const auto message_of = [](const char* text) { return parse_board(text).error().message; };
  if (!has_april_tag_3()) {
    const std::string message = message_of("apriltag:tagCircle21h7:2x2:50mm:50mm");
    EXPECT_NE(message.find("libapriltag-dev"), std::string::npos) << message;
    if (has_any) {
      EXPECT_NE(message.find("apriltag:tagStandard41h12:..."), std::string::npos) << message;
    }
  } else if (!has_opencv_dictionaries()) {
    const std::string message = message_of("aruco:4x3:50mm:50mm:DICT_6X6_250");
    EXPECT_NE(message.find("made without OpenCV"), std::string::npos) << message;
    EXPECT_TRUE(parse_board("aprilgrid:6x6:88mm:0.3").has_value());
    EXPECT_TRUE(parse_board("apriltag:tag16h5:3x3:88mm:30mm").has_value());
  } else {
    GTEST_SKIP() << "this build lacks none";
  }
}

// What is printed of a tag lies around its four corners, on paper of its own.
TEST(TagFamilies, LieOnTheirOutline) {
  if (!has_april_tag_3()) GTEST_SKIP() << "this build does not know AprilTag 3";
  const Board touching = parse_board("apriltag:tagStandard41h12:3x2:50mm:40mm").value();
  const Artwork artwork = artwork_of(touching);
  EXPECT_EQ(artwork.cols(), 3 * 9 + 2);
  EXPECT_TRUE(std::ranges::is_sorted(artwork.x));
  EXPECT_NEAR(artwork.x[1], -0.02, 1e-12) << "two bits before the first corner";
  EXPECT_NEAR(artwork.x[11] - artwork.x[10], 0.01, 1e-12) << "nothing lies between two tags";
  EXPECT_LT(artwork.outline.left, artwork.x[1] - 0.009);
  const Board single = parse_board("apriltag:tagStandard41h12:50mm:7=0,0").value();
  EXPECT_NEAR(single.outline().left, -0.025 - 0.03, 1e-12);
  EXPECT_NEAR(single.extent().left, -0.025, 1e-12);
}

}  // namespace
}  // namespace calvin
