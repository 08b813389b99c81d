// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Manual points: which are taken, what their user is told, and what a session makes of them: the
// pose of a known camera, or a camera by Tsai's method, against the truth.
#include <cmath>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/io/calibration_io.hpp"
#include "calvin/session/points/expected_points.hpp"
#include "calvin/session/points/known_points.hpp"
#include "calvin/session/points/manual_points.hpp"
#include "calvin/session/points/point_fit.hpp"
#include "calvin/synth/render.hpp"
#include "known_points.hpp"
#include "session_fixture.hpp"
#include "temporary_folder.hpp"

namespace calvin {
namespace {

using scenes::kSize;

// Eight corners of a cube of 200 mm.
const std::vector<Eigen::Vector3d> kCube = {{0, 0, 0},     {0.2, 0, 0},    {0, 0.2, 0},
                                            {0.2, 0.2, 0}, {0, 0, 0.2},    {0.2, 0, 0.2},
                                            {0, 0.2, 0.2}, {0.2, 0.2, 0.2}};
const SE3 kPose = {exp_so3({0.4, -0.5, 0.1}), {-0.1, -0.05, 0.9}};

bool has(const PointAnswer& answer, const char* words) {
  return answer.hint.find(words) != std::string::npos;
}

TEST(ManualPoints, OfTheirOwnMakeABoard) {
  ManualPoints points;
  points.begin(kSize, std::nullopt);
  EXPECT_EQ(points.hint(), "");
  EXPECT_FALSE(points.view());
  for (int i = 0; i < 3; ++i) {
    const PointAnswer answer = points.add({{100.0 + 50 * i, 200}, kCube[i], {}});
    ASSERT_TRUE(answer.accepted()) << answer.hint;
    EXPECT_EQ(answer.id, i);
    EXPECT_EQ(answer.sigma, kClickSigma);
    EXPECT_FALSE(answer.snapped);
    EXPECT_TRUE(has(answer, "no corner")) << answer.hint;
    EXPECT_FALSE(points.view());
  }
  EXPECT_EQ(points.hint(), "1 point more is needed.");
  const PointAnswer disc =
      points.add({{300, 333}, kCube[3], {}}, FoundPoint{{302, 335}, 0.05, FoundPoint::Kind::kDisc});
  EXPECT_TRUE(has(disc, "the centre of the disc there, to 0.05 px")) << disc.hint;
  const PointAnswer last = points.add({{300, 333}, kCube[3], {}}, FoundPoint{{301.2, 334.1}, 0.03});
  EXPECT_TRUE(last.snapped);
  EXPECT_TRUE(has(last, "the corner there, to 0.03 px")) << last.hint;
  EXPECT_EQ(points.hint(), "Solve now (Return), or choose more.");
  const auto placed = points.placed(3);
  ASSERT_EQ(placed.size(), 3U) << "the newest ones";
  EXPECT_EQ(placed.back().id, 3);
  EXPECT_DOUBLE_EQ(placed.back().at.u, (301.2 + 0.5) / kSize.width);
  EXPECT_DOUBLE_EQ(placed.back().at.v, (334.1 + 0.5) / kSize.height);
  const auto view = points.view();
  ASSERT_TRUE(view);
  EXPECT_TRUE(points.suffice()) << "of a known camera";
  EXPECT_EQ(view->observation.ids, (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(view->observation.uv[3].u, 301.2);
  EXPECT_EQ(view->observation.sigma[3], 0.03);
  EXPECT_EQ(view->observation.sigma[0], kClickSigma);
  EXPECT_TRUE(check(*view, kSize));

  // A place again takes the new pixel, and so does a measured one, as it is.
  const PointAnswer again = points.add({{310, 340}, kCube[3], 0.2}, FoundPoint{{1, 1}, 0.03});
  EXPECT_TRUE(again.accepted());
  EXPECT_EQ(again.count, 4U);
  EXPECT_EQ(again.at.u, 310);
  EXPECT_EQ(points.view()->observation.sigma[3], 0.2);

  const PointAnswer gone = points.remove(0);
  EXPECT_TRUE(gone.accepted());
  EXPECT_EQ(gone.id, 0);
  EXPECT_FALSE(points.view());
  EXPECT_EQ(points.remove(7).verdict, PointVerdict::kNotThere);
  // A new one has an id of its own.
  EXPECT_EQ(points.add({{500, 500}, kCube[5], {}}).id, 4);
}

TEST(ManualPoints, AreRefusedWithAReason) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  ManualPoints points;
  points.begin(kSize, std::nullopt);
  EXPECT_EQ(points.remove().verdict, PointVerdict::kNotThere);
  EXPECT_EQ(points.add({{-3, 5}, kCube[0], {}}).verdict, PointVerdict::kOutside);
  EXPECT_TRUE(has(points.add({{kNone, 5}, kCube[0], {}}), "two numbers"));
  EXPECT_EQ(points.add({{3, 5}, {}, {}}).verdict, PointVerdict::kNoPlace);
  EXPECT_EQ(points.add({{3, 5}, Eigen::Vector3d(0, kNone, 0), {}}).verdict, PointVerdict::kNoPlace);
  EXPECT_TRUE(points.add({{3, 5}, kCube[0], {}}).accepted());
  EXPECT_EQ(points.add({{3.2, 5}, kCube[1], {}}).verdict, PointVerdict::kTwice);
  for (const double along : {0.1, 0.2, 0.3, 0.4}) {
    EXPECT_TRUE(points.add({{3 + 100 * along, 5}, Eigen::Vector3d(along, 0, 0), {}}).accepted());
  }
  EXPECT_FALSE(points.view());
  const char* line = "All points, or all but one, lie on one line: choose others beside it.";
  EXPECT_EQ(points.hint(), line);
  EXPECT_TRUE(points.add({{30, 90}, kCube[2], {}}).accepted());
  EXPECT_EQ(points.hint(), line);
  EXPECT_FALSE(points.view());
  EXPECT_TRUE(points.add({{60, 90}, kCube[3], {}}).accepted());
  EXPECT_TRUE(points.view());
}

// Those of a board come in the order of its ids, without the ones that have a pixel.
TEST(ManualPoints, OfABoardComeInItsOrder) {
  ManualPoints points;
  points.begin(kSize, parse_board("checkerboard:3x3:10mm").value());
  points.set_unknowns(9);
  EXPECT_TRUE(
      points.hint().starts_with("Next: the point 0 of checkerboard:3x3:10mm, at 0 0 0 mm."));
  EXPECT_EQ(points.add({{10, 10}, Eigen::Vector3d(0.01, 0, 0), {}}).id, 1);
  EXPECT_EQ(points.add({{20, 10}, {}, {}}).id, 0);
  const PointAnswer third = points.add({{30, 10}, {}, {}});
  EXPECT_EQ(third.id, 2);
  EXPECT_TRUE(has(third, "Next: the point 3 of checkerboard:3x3:10mm, at 0 10 0 mm."))
      << third.hint;
  EXPECT_EQ(points.add({{9, 9}, Eigen::Vector3d(0.015, 0, 0), {}}).verdict,
            PointVerdict::kNotOnBoard);
  for (int i = 3; i < 9; ++i) EXPECT_EQ(points.add({{10.0 * i, 50.0 + i * i}, {}, {}}).id, i);
  EXPECT_EQ(points.add({{400, 400}, {}, {}}).verdict, PointVerdict::kNoneLeft);
  ASSERT_TRUE(points.view());
  EXPECT_EQ(points.view()->observation.board, "checkerboard:3x3:10mm");
  EXPECT_FALSE(points.suffice()) << "a plane alone";
  EXPECT_TRUE(points.hint().find("in one plane") != std::string::npos) << points.hint();
  points.set_unknowns(0);
  EXPECT_TRUE(points.suffice());
}

TEST(KnownPoints, AreOfAFileOrOfABoard) {
  const TemporaryFolder folder;
  const std::string path = folder.path("plate.txt");
  std::ofstream(path) << "# unit: mm\nX Y Z u v sigma\n0 0 0 100 100 .2\n50 0 0 200 100 .2\n"
                         "0 50 0 100 200 .2\n50 50 20 200 200 .2\n";
  for (const std::string& text : {path, "points:" + path}) {
    const auto known = read_known_points(text);
    ASSERT_TRUE(known) << known.error().message;
    EXPECT_TRUE(known->is_file);
    EXPECT_EQ(known->board.point_count(), 4);
    ASSERT_EQ(known->seen.size(), 4U);
    EXPECT_EQ(known->seen[3].sigma, 0.2);
    EXPECT_NEAR(known->seen[3].world->z(), 0.02, 1e-15);
  }
  const auto board = read_known_points("checkerboard:9x6:25mm");
  ASSERT_TRUE(board);
  EXPECT_FALSE(board->is_file);
  for (const char* text : {"/no/such/file", "points:", "dot", "dots:1mm", "checkerboard:2",
                           "checkerboard:9x6:25mm;checkerboard:8x5:25mm"}) {
    const auto wrong = read_known_points(text);
    ASSERT_FALSE(wrong) << text;
    EXPECT_NE(wrong.error().message.find("cannot be used"), std::string::npos);
  }
  EXPECT_EQ(points_text("", "points:a.txt"), "points:a.txt");
  EXPECT_EQ(points_text("b.txt", "points:a.txt"), "b.txt");
  EXPECT_EQ(points_text("", "checkerboard:9x6:25mm"), "");
  EXPECT_EQ(points_text(" ", "points:a.txt;checkerboard:9x6:25mm"), "");
}

TEST(PointFit, FindsTheOneThatWasChosenWrongly) {
  const Camera camera = default_camera(kSize);
  ManualPoints points;
  points.begin(kSize, std::nullopt);
  for (const Eigen::Vector3d& p : kCube) {
    ASSERT_TRUE(points.add({camera.project(kPose * p).value(), p, {}}).accepted());
  }
  View view = points.view().value();
  const auto right = fit_points(camera, view);
  ASSERT_TRUE(right);
  EXPECT_TRUE(right->agrees());
  EXPECT_LT(right->rms, 1e-6);
  view.observation.uv[5].u += 40;
  const auto wrong = fit_points(camera, view);
  ASSERT_TRUE(wrong && wrong->odd);
  EXPECT_EQ(*wrong->odd, 5);
  EXPECT_LT(wrong->rms_without, 1e-6);
  EXPECT_NE(to_text(*wrong).find("without the point 5"), std::string::npos);
  std::swap(view.observation.uv[0], view.observation.uv[1]);
  std::swap(view.observation.uv[2], view.observation.uv[7]);
  const auto order = fit_points(camera, view);
  ASSERT_TRUE(order);
  EXPECT_FALSE(order->odd);
  EXPECT_NE(to_text(*order).find("in their order"), std::string::npos);
}

// Four corners of a board, found, tell where the others are; what is wanted no more is left out.
TEST(ExpectedPoints, AreWhereTheCameraHasThem) {
  const Camera camera = default_camera(kSize);
  const Board board = parse_board("checkerboard:9x6:25mm").value();
  const SE3 pose = {exp_so3({0.3, -0.4, 0.1}), {-0.1, -0.06, 0.5}};
  const Observation truth = true_observation(camera, board, pose);
  ASSERT_EQ(truth.ids.size(), 54U);
  ManualPoints points;
  points.begin(kSize, board);
  for (const std::size_t i : {0U, 8U, 45U, 53U}) {
    const Pixel at = {truth.uv[i].u + 0.1, truth.uv[i].v - 0.1};
    ASSERT_TRUE(points.add({at, board.points()[i], 0.1}).accepted());
  }
  View view = points.view().value();
  const auto all = expected_points(camera, view, {}, 100, 5);
  ASSERT_EQ(all.size(), 50U);
  for (const ExpectedPoint& point : all) {
    const auto i = static_cast<std::size_t>(point.id);
    EXPECT_NEAR(point.choice.at.u, truth.uv[i].u, 0.5);
    EXPECT_NEAR(point.choice.at.v, truth.uv[i].v, 0.5);
    EXPECT_EQ(point.reach, 5);
  }
  const auto some = expected_points(camera, view, {1, 2, 4}, 3, 1000);
  ASSERT_EQ(some.size(), 3U);
  EXPECT_EQ(some[0].id, 3);
  EXPECT_EQ(some[1].id, 5);
  EXPECT_LT(some[0].reach,
            0.45 * std::hypot(truth.uv[4].u - truth.uv[3].u, truth.uv[4].v - truth.uv[3].v));
  view.observation.uv[0].u += 60;
  EXPECT_TRUE(expected_points(camera, view, {}, 100, 5).empty()) << "they contradict each other";
}

class ManualPointSessions : public CalibrationSessions {
 protected:
  // Takes and solves what the session asks for.
  std::optional<Solution> solve_last() {
    EXPECT_EQ(session_.end_of_stream(), LastWork::kSolve);
    const auto job = session_.take_solve();
    if (!job) return std::nullopt;
    auto solution = solve_job(*job, {});
    EXPECT_TRUE(solution) << solution.error().message;
    if (!solution) return std::nullopt;
    EXPECT_TRUE(session_.solved(*job, *solution));
    session_.reported(*job);
    return *std::move(solution);
  }

  const Camera truth_ = default_camera(kSize);
};

// A cube whose corners are clicked before a known camera: its pose, as told from the first solve.
TEST_F(ManualPointSessions, GiveThePoseOfAKnownCamera) {
  const TemporaryFolder folder;
  const std::string file = folder.path("camera.json");
  ASSERT_TRUE(write_calibration(file, truth_.to_calibration()));
  SessionSettings settings;
  settings.fix = "all";
  settings.initial = file;
  begin(settings);
  EXPECT_FALSE(session_.clicks_choose()) << "places come with the points";
  for (std::size_t i = 0; i < kCube.size(); ++i) {
    const PointAnswer answer =
        session_.add_point({truth_.project(kPose * kCube[i]).value(), kCube[i], 0.1}, {}, times(3));
    ASSERT_TRUE(answer.accepted()) << answer.hint;
    EXPECT_EQ(answer.hint.find("fit the camera") != std::string::npos, i >= 3) << answer.hint;
    EXPECT_EQ(session_.progress().hint, answer.hint);
  }
  const auto solution = solve_last();
  ASSERT_TRUE(solution && solution->calibration.views.size() == 1);
  const SE3 found = to_se3(solution->calibration.views[0].camera_from_board);
  EXPECT_LT((found.translation - kPose.translation).norm(), 1e-7);
  EXPECT_LT((found.rotation - kPose.rotation).norm(), 1e-7);
  EXPECT_EQ(solution->calibration.find("fx")->value, truth_.fx());
  EXPECT_TRUE(session_.verdict().status);

  // A point that goes takes the view with it, and what was solved of it.
  EXPECT_TRUE(session_.remove_point({}).accepted());
  EXPECT_EQ(session_.views().views().size(), 1U);
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(session_.remove_point(0).accepted());
  EXPECT_EQ(session_.views().views().size(), 0U);
  EXPECT_FALSE(session_.calibration());
  const Error lack = session_.verdict().status.error();
  EXPECT_NE(lack.message.find("1 point more is needed"), std::string::npos) << lack.message;
}

// The points of a file with their pixels, solved by Tsai's method, which takes one view.
TEST_F(ManualPointSessions, OfAFileAreSolvedByTsai) {
  const TemporaryFolder folder;
  const std::string path = folder.path("box.txt");
  scenes::Random random(11);
  const Board box = scenes::object(scenes::Object::kSpace, random);
  const SE3 pose = scenes::pose_for(truth_, box, scenes::Object::kSpace, random);
  {
    std::ofstream file(path);
    file.precision(12);
    file << "unit: m\nX Y Z u v\n";
    for (const Eigen::Vector3d& p : box.points()) {
      const Pixel at = truth_.project(pose * p).value();
      file << p.x() << " " << p.y() << " " << p.z() << " " << at.u << " " << at.v << "\n";
    }
  }
  SessionSettings settings;
  settings.method = "tsai";
  EXPECT_FALSE(make_plan(settings)) << "of several views";
  settings.points = path;
  begin(settings);
  EXPECT_TRUE(session_.clicks_choose());
  const auto report = session_.take_points_report();
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->accepted());
  EXPECT_EQ(report->count, 40U);
  EXPECT_TRUE(has(*report, "40 of 40 points with a pixel are taken.")) << report->hint;
  // A board that is found is no part of it.
  EXPECT_NE(show(1).reason, Reason::kAccepted);
  const auto solution = solve_last();
  ASSERT_TRUE(solution);
  EXPECT_NEAR(solution->calibration.find("fx")->value, truth_.fx(), 1e-3 * truth_.fx());
  EXPECT_LT(*solution->calibration.rms, 0.01);

  // A reset takes the file up again; frames of another size refuse what is outside them.
  session_.reset();
  EXPECT_EQ(session_.take_points_report()->count, 40U);
  std::optional<Error> warning;
  EXPECT_TRUE(session_.set_size({64, 48}, warning));
  const auto outside = session_.take_points_report();
  ASSERT_TRUE(outside);
  EXPECT_EQ(outside->verdict, PointVerdict::kOutside);
  EXPECT_EQ(session_.views().views().size(), 0U);
}

// With boards that were found: one view more.
TEST_F(ManualPointSessions, AreOneViewMoreBesideBoards) {
  begin();
  show(3);
  EXPECT_EQ(session_.views().views().size(), 3U);
  for (std::size_t i = 0; i < kCube.size(); ++i) {
    ASSERT_TRUE(
        session_.add_point({truth_.project(kPose * kCube[i]).value(), kCube[i], {}}, {}, times(50))
            .accepted());
    EXPECT_EQ(session_.views().views().size(), i < 3 ? 3U : 4U);
  }
  show(1);
  EXPECT_EQ(session_.views().views().size(), 5U);
  EXPECT_TRUE(session_.remove_view(3)) << "all of the points";
  EXPECT_EQ(session_.views().views().size(), 4U);
  EXPECT_FALSE(session_.has_points());
}

// Clicks choose corners of a board only while it is not found.
TEST_F(ManualPointSessions, ChooseCornersOfABoardThatIsNotFound) {
  SessionSettings settings;
  settings.points = "checkerboard:9x6:25mm";
  begin(settings);
  EXPECT_TRUE(session_.clicks_choose());
  show(1);
  EXPECT_FALSE(session_.clicks_choose());
  Observation none;
  none.timestamp = times(9).timestamp;
  (void)session_.offer(none, times(9));
  EXPECT_TRUE(session_.clicks_choose());
  EXPECT_TRUE(session_.progress().hint.starts_with("Next: the point 0"))
      << session_.progress().hint;
}

}  // namespace
}  // namespace calvin
