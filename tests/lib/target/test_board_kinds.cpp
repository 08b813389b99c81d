// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What boards of each kind answer: their points by id, neighbours, extent, and what they look like.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/target/board.hpp"
#include "calvin/target/kinds.hpp"

#include "board_kinds.hpp"

namespace calvin {
namespace {

using scenes::five_dots;

Board point_board() { return PointBoard::make("plate.json", five_dots()).value(); }

// All that are printed, and the light.
const std::vector<scenes::NamedBoard> kBoards = [] {
  auto all = scenes::board_of_each_kind();
  all.push_back({"PointLight", PointLight{}});
  all.push_back({"Wand", PointLight{{0, 0.15, 0.5}}});
  for (const auto& [name, text] :
       {std::pair{"TagList", "apriltag:tag36h11:60mm:3=0,0+9/90mm=0,-0.2m,30:border=2"},
        {"TagsInSpace", "aruco:60mm:0=0,0,50mm,0,90,0+2=30mm,1mm,0,-90,0,12.5:DICT_4X4_50"}}) {
    if (const auto board = parse_board(text)) all.push_back({name, *board});
  }
  return all;
}();

class BoardKinds : public ::testing::TestWithParam<scenes::NamedBoard> {
 protected:
  static const Board& board() { return GetParam().board; }
};
INSTANTIATE_TEST_SUITE_P(Each, BoardKinds, ::testing::ValuesIn(kBoards), scenes::name_of);

TEST_P(BoardKinds, HasAPointForEachIdAndForNoOther) {
  const auto ids = board().ids();
  ASSERT_EQ(static_cast<int>(ids.size()), board().point_count());
  ASSERT_EQ(board().points().size(), ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) EXPECT_EQ(board().index_of(ids[i]), i);
  int known = 0;
  for (int id = -5; id < 100; ++id) known += board().index_of(id).has_value() ? 1 : 0;
  EXPECT_EQ(known, board().point_count());
}

TEST_P(BoardKinds, ANeighbourIsOneBothWays) {
  for (const int id : board().ids()) {
    for (const int other : board().neighbours(id)) {
      const auto back = board().neighbours(other);
      EXPECT_NE(std::find(back.begin(), back.end(), id), back.end()) << id << " " << other;
    }
  }
  EXPECT_TRUE(board().neighbours(-1).empty());
}

TEST_P(BoardKinds, ThePointsFillTheExtentAndTheOutlineIsAroundIt) {
  const BoardArea extent = board().extent();
  const BoardArea outline = board().outline();
  BoardArea seen = {1e9, 1e9, -1e9, -1e9};
  for (const Eigen::Vector3d& p : board().points()) {
    seen = {std::min(seen.left, p.x()), std::min(seen.top, p.y()), std::max(seen.right, p.x()),
            std::max(seen.bottom, p.y())};
  }
  EXPECT_NEAR(extent.left, seen.left, 1e-15);
  EXPECT_NEAR(extent.right, seen.right, 1e-15);
  EXPECT_NEAR(extent.top, seen.top, 1e-15);
  EXPECT_NEAR(extent.bottom, seen.bottom, 1e-15);
  EXPECT_LT(outline.left, extent.left);
  EXPECT_LT(outline.top, extent.top);
  EXPECT_GT(outline.right, extent.right);
  EXPECT_GT(outline.bottom, extent.bottom);
}

TEST_P(BoardKinds, HasATextThatIsItself) {
  if (board().as<PointBoard>() != nullptr) return;  // it has the name of its file
  const auto again = parse_board(board().text());
  ASSERT_TRUE(again.has_value()) << again.error().message;
  EXPECT_EQ(again->text(), board().text());
  EXPECT_TRUE(again->looks_like(board()));
}

TEST_P(BoardKinds, LooksLikeNoOtherKind) {
  int alike = 0;
  for (const auto& other : kBoards) alike += other.board.looks_like(board()) ? 1 : 0;
  EXPECT_EQ(alike, 1);
}

TEST_P(BoardKinds, IsEqualToItselfAlone) {
  int equal = 0;
  for (const auto& other : kBoards) equal += other.board == board() ? 1 : 0;
  EXPECT_EQ(equal, 1);
  EXPECT_TRUE(board().looks_like(board()));
  EXPECT_TRUE(board().check().has_value());
}

TEST(Checkerboards, KnowTheirNeighbours) {
  const Board board = Checkerboard{4, 3, 0.1};
  EXPECT_EQ(board.neighbours(0), (std::vector<int>{1, 4}));
  EXPECT_EQ(board.neighbours(5), (std::vector<int>{1, 4, 6, 9}));
  EXPECT_EQ(board.neighbours(11), (std::vector<int>{7, 10}));
  EXPECT_EQ(board.neighbours(7), (std::vector<int>{3, 6, 11})) << "a row does not go on below";
}

TEST(Checkerboards, LookLikeThoseOfAnotherSizeAndThoseOnTheirSide) {
  const Board board = Checkerboard{9, 6, 0.025};
  EXPECT_TRUE(board.looks_like(Checkerboard{9, 6, 0.1}));
  EXPECT_TRUE(board.looks_like(Checkerboard{6, 9, 0.025}));
  EXPECT_FALSE(board.looks_like(Checkerboard{9, 7, 0.025}));
  EXPECT_FALSE(board.looks_like(point_board()));
  EXPECT_NE(board, Board(Checkerboard{6, 9, 0.025}));
}

// Three circles that lie alike after a turn and a shift name nothing: two views would be one.
TEST(MarkedCheckerboards, HaveCirclesThatTellTheirTurn) {
  const Board board = parse_board("checkerboard:9x6:25mm:circles").value();
  const auto& marked = *board.as<MarkedCheckerboard>();
  EXPECT_EQ(marked.circles, (std::vector<GridPlace>{{4, 3}, {5, 3}, {4, 4}}));
  EXPECT_TRUE(board.symmetries().empty());
  EXPECT_EQ(board.point_count(), 54);
  EXPECT_TRUE(board.looks_like(parse_board("checkerboard:9x6:10mm:circles").value()));
  EXPECT_FALSE(board.looks_like(parse_board("checkerboard:9x6:25mm").value()));
  EXPECT_FALSE(board.looks_like(parse_board("checkerboard:9x6:25mm:circles=1.1+2.1+1.2").value()));
  EXPECT_TRUE(parse_board("checkerboard:6x5:25mm:circles"));
  // On squares of both colours, in a row of which half is turned: told by the colours.
  EXPECT_TRUE(parse_board("checkerboard:9x6:25mm:circles=1.1+2.1+3.1+4.1"));
  for (const auto& [text, why] :
       {std::pair{"checkerboard:9x6:25mm:circles=1.1+2.1", "at least 3"},
        {"checkerboard:9x6:25mm:circles=1.1+2.1+3.1", "look the same"},
        {"checkerboard:9x6:25mm:circles=1.1+2.1+1.2+2.2", "look the same"},
        {"checkerboard:9x6:25mm:circles=0.1+2.1+1.2", "not between four inner corners"},
        {"checkerboard:9x6:25mm:circles=9.1+2.1+1.2", "not between four inner corners"},
        {"checkerboard:9x6:25mm:circles=1+2+3", "COLUMN.ROW"},
        {"checkerboard:9x6:25mm:dots", "neither 'circles'"},
        {"checkerboard:7x4:25mm:circles", "at least 20 are needed"},
        {"checkerboard:2x3:25mm:circles", "not between four inner corners"}}) {
    const auto refused = parse_board(text);
    ASSERT_FALSE(refused) << text;
    EXPECT_NE(refused.error().message.find(why), std::string::npos) << refused.error().message;
    EXPECT_NE(refused.error().message.find("A right text is"), std::string::npos);
  }
}

// A size shows in no picture, and a code in every one.
TEST(BoardsWithACode, LookLikeThoseOfTheSameCode) {
  const Board board = PuzzleBoard{9, 6, 0.025, 4, 5};
  EXPECT_TRUE(board.looks_like(PuzzleBoard{9, 6, 0.1, 4, 5}));
  EXPECT_FALSE(board.looks_like(PuzzleBoard{6, 9, 0.025, 4, 5}));
  EXPECT_FALSE(board.looks_like(PuzzleBoard{9, 6, 0.025, 5, 4}));
  EXPECT_TRUE(board.symmetries().empty());
  const MarkerDictionary* dictionary = find_dictionary("DICT_4X4_50");
  if (dictionary == nullptr) GTEST_SKIP() << "this build knows no markers";
  const CharucoBoard charuco{6, 4, 0.04, 0.03, dictionary};
  EXPECT_TRUE(charuco.looks_like({6, 4, 0.08, 0.05, dictionary}));
  EXPECT_FALSE(charuco.looks_like({6, 4, 0.04, 0.03, dictionary, true}));
  EXPECT_FALSE(charuco.looks_like({6, 4, 0.04, 0.03, dictionary, false, true}));
  EXPECT_FALSE(charuco.looks_like({6, 4, 0.04, 0.03, find_dictionary("DICT_4X4_100")}));
  EXPECT_TRUE(charuco.symmetries().empty());
}

// OpenCV's order, as its samples lay out the points of an asymmetric grid.
TEST(CircleGrids, AreOpenCvs) {
  const Board board = parse_board("acircles:4x11:20mm").value();
  const auto points = board.points();
  ASSERT_EQ(points.size(), 44U);
  for (int row = 0; row < 11; ++row) {
    for (int col = 0; col < 4; ++col) {
      const auto& p = points[static_cast<std::size_t>(4 * row + col)];
      EXPECT_NEAR(p.x(), (2 * col + row % 2) * 0.02, 1e-12);
      EXPECT_NEAR(p.y(), row * 0.02, 1e-12);
    }
  }
  EXPECT_EQ(board.neighbours(0), (std::vector<int>{4}));
  EXPECT_EQ(board.neighbours(5), (std::vector<int>{1, 2, 9, 10}));
  EXPECT_FALSE(board.grid().has_value());
}

TEST(CircleGrids, TellTheirTurnByMarksAndByShiftedRows) {
  const auto turns = [](const char* text) {
    std::vector<int> all;
    for (const Relabelling& r : parse_board(text).value().symmetries()) {
      all.push_back(r.quarter_turns);
    }
    return all;
  };
  EXPECT_EQ(turns("circles:7x5:30mm"), (std::vector<int>{2}));
  EXPECT_EQ(turns("circles:5x5:30mm"), (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(turns("dots:5x5:30mm:big=0.0"), std::vector<int>());
  EXPECT_EQ(turns("dots:5x5:30mm:big=2.2"), (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(turns("dots:7x5:30mm:rings=0.0+6.4"), (std::vector<int>{2}));
  EXPECT_EQ(turns("dots:7x5:30mm:rings=0.0:big=6.4"), std::vector<int>());
  EXPECT_EQ(turns("acircles:4x11:20mm"), std::vector<int>());
  EXPECT_EQ(turns("acircles:4x10:20mm"), (std::vector<int>{2}));
}

TEST(CircleGrids, LookLikeThoseOfAnotherSizeWithTheSameMarks) {
  const auto board = [](const char* text) { return parse_board(text).value(); };
  EXPECT_TRUE(board("circles:7x5:30mm").looks_like(board("circles:5x7:12mm")));
  EXPECT_FALSE(board("circles:7x5:30mm").looks_like(board("circles:7x5:30mm:inverted")));
  EXPECT_FALSE(board("circles:7x5:30mm").looks_like(board("dots:7x5:30mm:big=0.0")));
  EXPECT_FALSE(board("acircles:4x11:20mm").looks_like(board("acircles:11x4:20mm")));
  EXPECT_EQ(board("dots:7x5:30mm:rings=3.3+1.0+3.3").text(), "dots:7x5:30mm:rings=1.0+3.3");
  EXPECT_EQ(board("dots:7x5:30mm").text(), "circles:7x5:30mm");
}

TEST(CircleGrids, OfWrongMarksThereAreNone) {
  for (const auto& [text, why] : {std::pair{"dots:7x5:30mm:rings=7.0", "no dot at column 7"},
                                  {"dots:7x5:30mm:rings=1.1:big=1.1", "not both"},
                                  {"dots:7x5:30mm:rings=1", "COLUMN.ROW"},
                                  {"dots:7x5:30mm:rings=", "COLUMN.ROW"},
                                  {"dots:7x5:30mm:holes=1.1", "rings="},
                                  {"circles:7x5:30mm:big=0.0", "'inverted'"},
                                  {"circles:7x5", "a distance"},
                                  {"acircles:1x9:20mm", "out of range"}}) {
    const auto board = parse_board(text);
    ASSERT_FALSE(board) << text;
    EXPECT_NE(board.error().message.find(why), std::string::npos) << board.error().message;
    EXPECT_NE(board.error().message.find("A right text is"), std::string::npos);
  }
}

TEST(AprilGrids, LookLikeThoseOfTheSameTags) {
  const auto board = parse_board("aprilgrid:4x3:40mm:0.3");
  if (!board) GTEST_SKIP() << "this build knows no markers";
  EXPECT_TRUE(board->looks_like(parse_board("aprilgrid:4x3:88mm:0.3").value()));
  for (const char* other :
       {"aprilgrid:3x4:40mm:0.3", "aprilgrid:4x3:40mm:0.25", "aprilgrid:4x3:40mm:0.3:first=12",
        "aprilgrid:4x3:40mm:0.3:border=1", "aprilgrid:4x3:40mm:0.3:tag36h10"}) {
    EXPECT_FALSE(board->looks_like(parse_board(other).value())) << other;
  }
  EXPECT_EQ(board->neighbours(9), (std::vector<int>{1, 8, 10, 17}));
  EXPECT_NEAR(board->cell_size(0), 0.04, 1e-15);
}

TEST(PointBoards, AreInTheOrderOfTheirIds) {
  const Board board = point_board();
  EXPECT_EQ(board.text(), "points:plate.json");
  EXPECT_EQ(board.ids(), (std::vector<int>{3, 7, 20, 40, 41}));
  EXPECT_FALSE(board.grid().has_value());
  EXPECT_TRUE(board.symmetries().empty());
  EXPECT_EQ(board.points()[1], Eigen::Vector3d(0.1, 0.03, 0));
  EXPECT_NEAR(board.cell_size(3), 0.05, 1e-15);
  EXPECT_NEAR(board.cell_size(40), 0.03, 1e-15);
  EXPECT_EQ(board.neighbours(20), (std::vector<int>{3, 7, 40, 41}));
  EXPECT_EQ(board.neighbours(40), (std::vector<int>{3, 7, 20}));
  EXPECT_NEAR(board.outline().right, 0.12, 1e-15) << "a diameter beyond the centre of the dot";
}

TEST(PointBoards, OfWrongDotsThereAreNone) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](auto change, std::string_view why) {
    auto dots = five_dots();
    change(dots);
    const auto board = PointBoard::make("x", dots);
    ASSERT_FALSE(board.has_value()) << why;
    EXPECT_EQ(board.error().code, ErrorCode::kInvalidArgument);
    EXPECT_NE(board.error().message.find(why), std::string::npos) << board.error().message;
  };
  refused([](auto& dots) { dots.resize(3); }, "at least 4");
  refused([](auto& dots) { dots[2].id = 3; }, "given twice");
  refused([](auto& dots) { dots[2].id = -1; }, "no id");
  refused([](auto& dots) { dots[1].x = kNan; }, "no place");
  refused([](auto& dots) { dots[1].diameter = -0.01; }, "no size");
  refused([](auto& dots) { dots[1].x = 0.045; }, "touch");
  refused(
      [](auto& dots) {
        for (std::size_t i = 0; i < dots.size(); ++i) {
          dots[i].x = 0.03 * static_cast<double>(i);
          dots[i].y = 0.04;
        }
      },
      "on one line");
}

TEST(PointBoards, MayLieInSpace) {
  auto dots = five_dots();
  for (PointBoard::Dot& dot : dots) dot.diameter = 0;
  EXPECT_TRUE(PointBoard::make("flat", dots)->is_flat());
  dots[0].z = -0.1;
  dots[3] = {40, 0.05, 0.03, 0, 0};  // before the first one: another place in space
  const auto cube = PointBoard::make("cube.txt", dots);
  ASSERT_TRUE(cube) << cube.error().message;
  EXPECT_FALSE(cube->is_flat());
  EXPECT_EQ(cube->points()[2], Eigen::Vector3d(0.05, 0.03, -0.1));
  EXPECT_NEAR(cube->cell_size(20), 0.1, 1e-15);
  // Three of them on one line in the plane, but not in space.
  EXPECT_TRUE(PointBoard::make("wall", {{0, 0, 0}, {1, 1, 0}, {2, 2, 0, 0, 1}, {3, 3, 0}}));
  EXPECT_FALSE(
      PointBoard::make("rod", {{0, 0, 0}, {1, 0, 0, 0, 1}, {2, 0, 0, 0, 2}, {3, 0, 0, 0, 3}}));
}

TEST(PointBoards, AreNotCalledWhatNoFileOrMessageTakes) {
  for (const std::string& name : {std::string("plate"), std::string("plate.json"),
                                  std::string("Kn\xC3\xB6\xC3\xBE"), std::string(4096, 'x')}) {
    EXPECT_TRUE(PointBoard::make(name, five_dots())) << name;
  }
  for (const std::string& name :
       {std::string(), std::string(" plate"), std::string("a\nb"), std::string("a\0b", 3),
        std::string("a;b"), std::string("a#b"), std::string("\xFF"), std::string(4097, 'x'),
        std::string(1 << 20, 'x')}) {
    const auto board = PointBoard::make(name, five_dots());
    ASSERT_FALSE(board) << name.size() << " bytes";
    EXPECT_EQ(board.error().code, ErrorCode::kInvalidArgument);
    EXPECT_NE(board.error().message.find("board name"), std::string::npos);
    EXPECT_LT(board.error().message.size(), 400u);
  }
}

TEST(PointBoards, AreStillBoardsWhenMovedFrom) {
  PointBoard dots = PointBoard::make("plate", five_dots()).value();
  Board board = dots;
  const PointBoard taken = std::move(dots);
  const Board other = std::move(board);
  EXPECT_EQ(dots, taken);  // NOLINT(bugprone-use-after-move): it is this that is asked
  EXPECT_EQ(dots.count(), 5);
  EXPECT_EQ(board, other);  // NOLINT(bugprone-use-after-move): likewise
  EXPECT_EQ(board.text(), "points:plate");
}

}  // namespace
}  // namespace calvin
