// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The table of unknowns: where those of two cameras on a rig and of two boards stand, and what is
// left to move of unknowns that are held and tied.
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/solve/parameters/parameter_table.hpp"

namespace calvin {
namespace {

// A camera with a skew that is the rig, one that has a place in it, a board that may bend and be of
// another aspect, and one that may be of another aspect alone.
ParameterTable rig() {
  TableCamera first = {"brown4", true};
  TableCamera second = {"ucm", false, 0.25, true, true};
  return ParameterTable({first, second}, {{true, true}, {false, true}});
}

const std::vector<std::string> kNames = {
    "camera0.fx", "camera0.fy", "camera0.cx", "camera0.cy",    "camera0.k1",
    "camera0.k2", "camera0.p1", "camera0.p2", "camera0.skew",  "camera1.fx",
    "camera1.fy", "camera1.cx", "camera1.cy", "camera1.alpha", "camera1.readout",
    "camera1.rx", "camera1.ry", "camera1.rz", "camera1.tx",    "camera1.ty",
    "camera1.tz", "board0.kx",  "board0.ky",  "board0.aspect", "board1.aspect"};

// The names of a range's unknowns, without that of the camera or board.
std::vector<std::string> names_in(const ParameterTable& table, ParameterRange range) {
  std::vector<std::string> names;
  for (int i = 0; i < range.count; ++i) {
    const std::string name = table.name(range[i]);
    names.push_back(name.substr(name.find('.') + 1));
  }
  return names;
}

using Names = std::vector<std::string>;

TEST(ParameterTable, NamesEveryUnknownOnce) {
  const ParameterTable table = rig();
  ASSERT_EQ(table.count(), static_cast<int>(kNames.size()));
  for (int i = 0; i < table.count(); ++i) {
    EXPECT_EQ(table.name(i), kNames[static_cast<std::size_t>(i)]) << i;
  }
}

TEST(ParameterTable, AnswersWithTheRangeOfACameraOrBoard) {
  const ParameterTable table = rig();
  EXPECT_EQ(names_in(table, table.focal(1)), (Names{"fx", "fy"}));
  EXPECT_EQ(names_in(table, table.center(0)), (Names{"cx", "cy"}));
  EXPECT_EQ(names_in(table, table.pinhole(1)), (Names{"fx", "fy", "cx", "cy"}));
  EXPECT_EQ(names_in(table, table.distortion(0)), (Names{"k1", "k2", "p1", "p2"}));
  EXPECT_EQ(names_in(table, table.intrinsics(1)), (Names{"fx", "fy", "cx", "cy", "alpha"}));
  EXPECT_EQ(names_in(table, table.skew(0)), (Names{"skew"}));
  EXPECT_EQ(names_in(table, table.skew(1)), Names());
  EXPECT_EQ(table.camera(0).count, 9);
  EXPECT_EQ(names_in(table, table.camera(1)), (Names{"fx", "fy", "cx", "cy", "alpha"}));
  EXPECT_EQ(names_in(table, table.readout(0)), Names());
  EXPECT_EQ(names_in(table, table.readout(1)), (Names{"readout"}));
  EXPECT_EQ(names_in(table, table.rig_pose(0)), Names());
  EXPECT_EQ(names_in(table, table.rig_pose(1)), (Names{"rx", "ry", "rz", "tx", "ty", "tz"}));
  EXPECT_EQ(names_in(table, table.board(0)), (Names{"kx", "ky", "aspect"}));
  EXPECT_EQ(names_in(table, table.warp(0)), (Names{"kx", "ky"}));
  EXPECT_EQ(names_in(table, table.aspect(0)), (Names{"aspect"}));
  EXPECT_EQ(names_in(table, table.warp(1)), Names());
  EXPECT_EQ(names_in(table, table.aspect(1)), (Names{"aspect"}));
}

TEST(ParameterTable, FindsAParameterByTheNameThatFilesHave) {
  const ParameterTable table = rig();
  EXPECT_EQ(table.name(table.find("k2", 0).value()), "camera0.k2");
  EXPECT_EQ(table.name(table.find("cy", 1).value()), "camera1.cy");
  EXPECT_EQ(table.name(table.find("skew", 0).value()), "camera0.skew");
  EXPECT_FALSE(table.find("skew", 1));
  EXPECT_FALSE(table.find("k1", 1));
  EXPECT_FALSE(table.find("kx", 0));
}

TEST(ParameterTable, KnowsTheSkewOfEveryCamera) {
  const ParameterTable table = rig();
  std::vector<double> values(static_cast<std::size_t>(table.count()));
  std::iota(values.begin(), values.end(), 0.0);
  EXPECT_EQ(table.skew_at(0, values), 8);
  EXPECT_EQ(table.skew_at(1, values), 0.25);
}

TEST(ParameterTable, MovesWhatIsFreeAndWhatIsTiedToIt) {
  ParameterTable table = rig();
  const int fx = table.focal(1)[0];
  const int fy = table.focal(1)[1];
  for (int i = 0; i < table.count(); ++i) {
    if (!table.pinhole(1).has(i)) table.hold(i, 10 + i);
  }
  table.tie({fy, fx, 4});
  table.tie({table.center(1)[1], table.center(1)[0], 0.5});
  ASSERT_TRUE(table.resolve_ties());
  const Eigen::MatrixXd basis = table.basis();
  ASSERT_EQ(basis.rows(), table.count());
  ASSERT_EQ(basis.cols(), 2);
  EXPECT_EQ(basis.cwiseAbs().sum(), 1 + 4 + 1 + 0.5);
  EXPECT_EQ(basis(fx, 0), 1);
  EXPECT_EQ(basis(fy, 0), 4);
  EXPECT_EQ(basis(table.center(1)[0], 1), 1);
  EXPECT_EQ(basis(table.center(1)[1], 1), 0.5);

  std::vector<double> values(static_cast<std::size_t>(table.count()), 1);
  values[static_cast<std::size_t>(fx)] = 100;
  values[static_cast<std::size_t>(fy)] = 900;
  values[static_cast<std::size_t>(table.center(1)[0])] = 60;
  table.apply(values);
  EXPECT_EQ(values[0], 10);
  // Of focal lengths the product is kept, of others the parameter that leads.
  EXPECT_DOUBLE_EQ(values[static_cast<std::size_t>(fx)], 150);
  EXPECT_DOUBLE_EQ(values[static_cast<std::size_t>(fy)], 600);
  EXPECT_EQ(values[static_cast<std::size_t>(table.center(1)[0])], 60);
  EXPECT_EQ(values[static_cast<std::size_t>(table.center(1)[1])], 30);
}

TEST(ParameterTable, HoldsWhatIsTiedToSomethingHeld) {
  ParameterTable table = rig();
  table.tie({table.find("k2", 0).value(), table.find("k1", 0).value(), 3});
  table.tie({table.find("k1", 0).value(), table.find("p1", 0).value(), 2});
  table.hold(table.find("p1", 0).value(), 0.5);
  ASSERT_TRUE(table.resolve_ties());
  EXPECT_EQ(table.held(table.find("k1", 0).value()), 1);
  EXPECT_EQ(table.held(table.find("k2", 0).value()), 3);
  EXPECT_EQ(table.basis().cols(), table.count() - 3);
}

TEST(ParameterTable, RefusesTiesThatLeadNowhere) {
  ParameterTable circle = rig();
  circle.tie({0, 1, 1});
  circle.tie({1, 0, 1});
  EXPECT_FALSE(circle.resolve_ties());
  ParameterTable both = rig();
  both.tie({1, 0, 1});
  both.hold(1, 500);
  const Status refused = both.resolve_ties();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "'camera0.fy' cannot be both fixed and tied to 'camera0.fx'.");
}

}  // namespace
}  // namespace calvin
