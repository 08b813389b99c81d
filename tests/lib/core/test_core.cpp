// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The small plain types that everything else is made of, and the words that travel.
#include <gtest/gtest.h>

#include "calvin/core/calibration.hpp"
#include "calvin/core/image.hpp"
#include "calvin/core/reason.hpp"
#include "calvin/core/text.hpp"

namespace calvin {
namespace {

// Applications compare them: docs/elements/calibsolve.md.
TEST(Reasons, AreTheWordsThatAreDocumented) {
  EXPECT_EQ(to_string(Reason::kAccepted), "accepted");
  EXPECT_EQ(to_string(Reason::kTooSimilar), "too-similar");
  EXPECT_EQ(to_string(Reason::kMoving), "moving");
  EXPECT_EQ(to_string(Reason::kBlurred), "blurred");
  EXPECT_EQ(to_string(Reason::kTooFewPoints), "too-few-points");
  EXPECT_EQ(to_string(Reason::kTooSmall), "too-small");
  EXPECT_EQ(to_string(Reason::kWrongBoard), "wrong-board");
  EXPECT_EQ(to_string(Reason::kOffSize), "off-size");
  EXPECT_EQ(to_string(Reason::kOutlier), "outlier");
  EXPECT_EQ(to_string(Reason::kNotFound), "not-found");
}

TEST(Numbers, AreTheWholeText) {
  EXPECT_EQ(parse_double("-1.5e3"), -1500);
  EXPECT_EQ(parse_double("+2"), 2);
  for (const char* wrong : {"", " 1", "1 ", "1mm", "+-1", "++1", "1,5", "inf", "nan", "1e999"}) {
    EXPECT_FALSE(parse_double(wrong)) << wrong;
  }
  EXPECT_EQ(parse_int("+12"), 12);
  EXPECT_EQ(parse_int("-12"), -12);
  for (const char* wrong : {"", "1.0", "99999999999", "0x10"}) EXPECT_FALSE(parse_int(wrong));
}

TEST(Numbers, AreWrittenAsTheyAreRead) {
  EXPECT_EQ(format_double(0.025), "0.025");
  EXPECT_EQ(format_double(-0.0), "0");
  for (const double x : {1.0 / 3, 1e-300, -123456789.123456789, 1e22}) {
    EXPECT_EQ(parse_double(format_double(x)), x);
  }
}

TEST(Texts, AreSplitAndTrimmed) {
  using Fields = std::vector<std::string_view>;
  EXPECT_EQ(split(" a : b:", ':'), (Fields{"a", "b", ""}));
  EXPECT_EQ(split("", ':'), Fields{""});
  EXPECT_EQ(trim("\t a b\r\n"), "a b");
  EXPECT_EQ(trim(" \n"), "");
  EXPECT_EQ(join(Fields{"a", "b", "c"}, ", "), "a, b, c");
  EXPECT_EQ(join(Fields{}, ", "), "");
}

TEST(Texts, KnowTheirControlCharacters) {
  for (const char c : {'\0', '\n', '\x1f', '\x7f'}) EXPECT_TRUE(is_control(c));
  for (const char c : {' ', 'a', '\x80', '\xff', '~'}) EXPECT_FALSE(is_control(c));
}

TEST(Images, AreSeenByTheirStrideAndStep) {
  const std::uint8_t bytes[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  EXPECT_EQ((ImageView{bytes, 2, 2, 6, 2}.at(1, 1)), 8);
  EXPECT_EQ((ImageView{bytes, 3, 2, 4}.at(2, 1)), 6);
  GrayImage image(3, 2, 7);
  image.row(1)[2] = 9;
  EXPECT_EQ(image.view().at(2, 1), 9);
  EXPECT_EQ(image.view().at(2, 0), 7);
  EXPECT_EQ(image.view().stride, 3);
}

// The transposed point, then mirrored: there and back is where it was.
TEST(Orientations, HaveAnInverse) {
  const auto turned = [](const Orientation& o, int x, int y, ImageSize size) {
    if (o.transpose) std::swap(x, y);
    const ImageSize to = o.size_of(size);
    return std::pair{o.flip_x ? to.width - 1 - x : x, o.flip_y ? to.height - 1 - y : y};
  };
  for (int i = 0; i < 8; ++i) {
    const Orientation o = {(i & 1) != 0, (i & 2) != 0, (i & 4) != 0};
    const ImageSize size = {5, 3};
    const auto [x, y] = turned(o, 1, 2, size);
    EXPECT_EQ(turned(o.inverse(), x, y, o.size_of(size)), (std::pair{1, 2})) << i;
    EXPECT_EQ(o.inverse().inverse(), o);
    EXPECT_EQ(o.inverse().size_of(o.size_of(size)), size);
  }
}

TEST(Calibrations, FindTheirParametersByName) {
  Calibration c;
  c.parameters = {{"fx", 500, 0.5}, {"fy", 501, {}}};
  EXPECT_EQ(c.find("fy")->value, 501);
  EXPECT_EQ(*c.find("fx")->sigma, 0.5);
  EXPECT_EQ(c.find("f"), nullptr);
}

TEST(Text, HasTwoDigitsThatCountForPeople) {
  EXPECT_EQ(two_digits(0.01834), "0.018");
  EXPECT_EQ(two_digits(3.46), "3.5");
  EXPECT_EQ(two_digits(104.6), "105");
  EXPECT_EQ(two_digits(-12.3), "-12");
  EXPECT_EQ(two_digits(0), "0");
}

}  // namespace
}  // namespace calvin
