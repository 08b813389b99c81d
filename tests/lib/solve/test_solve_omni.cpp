// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A real camera that sees more than half of the world, against Ceres with the same model.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/camera/lens_table.hpp"
#include "calvin/target/kinds.hpp"
#include "ceres_solver.hpp"
#include "plain_options.hpp"

namespace calvin {
namespace {

constexpr ImageSize kOmniSize = {1280, 960};

// The numbers of every matrix in one of OpenCV's XML files.
std::vector<std::vector<double>> read_matrices(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  const std::string all = text.str();
  const std::string open = "<data>";
  std::vector<std::vector<double>> matrices;
  for (auto at = all.find(open); at != std::string::npos; at = all.find(open, at + 1)) {
    const auto first = at + open.size();
    std::istringstream words(all.substr(first, all.find("</data>", first) - first));
    words.imbue(std::locale::classic());
    matrices.emplace_back();
    for (double x; words >> x;) matrices.back().push_back(x);
  }
  return matrices;
}

// First the points of the board in every view, then where they were seen.
std::vector<View> to_views(const std::vector<std::vector<double>>& matrices) {
  const Board board = Checkerboard{6, 9, 0.2};
  const auto printed = board.points();
  const std::size_t n = matrices.size() / 2;
  std::vector<View> views;
  for (std::size_t v = 0; v < n; ++v) {
    View view;
    view.board = board;
    view.observation.image_size = kOmniSize;
    const std::vector<double>& uv = matrices[n + v];
    for (std::size_t i = 0; 2 * i < uv.size(); ++i) {
      EXPECT_NEAR(matrices[v][3 * i], printed[i].x(), 1e-9);
      EXPECT_NEAR(matrices[v][3 * i + 1], printed[i].y(), 1e-9);
      view.observation.ids.push_back(static_cast<int>(i));
      view.observation.uv.push_back({uv[2 * i], uv[2 * i + 1]});
    }
    views.push_back(std::move(view));
  }
  return views;
}

std::vector<std::string_view> wide_models() {
  std::vector<std::string_view> models = model_names();
  std::erase_if(models, [](std::string_view model) { return find_lens(model)->perspective; });
  return models;
}

class Omni : public ::testing::TestWithParam<std::string_view> {};
INSTANTIATE_TEST_SUITE_P(Peers, Omni, ::testing::ValuesIn(wide_models()),
                         [](const auto& test) { return std::string(test.param); });

TEST_P(Omni, IsFittedAsWellAsByCeres) {
  const char* data = std::getenv("CALVIN_DATA");
  const auto file =
      std::filesystem::path(data == nullptr ? "" : data) / "omni-points-opencv/omni_calib_data.xml";
  if (data == nullptr || !std::filesystem::exists(file)) {
    GTEST_SKIP() << "CALVIN_DATA does not name a folder with omni-points-opencv";
  }
  const auto views = to_views(read_matrices(file));
  ASSERT_EQ(views.size(), 15u);
  const auto solution = solve(views, kOmniSize, scenes::plain_options(GetParam()));
  ASSERT_TRUE(solution.has_value()) << solution.error().message;
  ASSERT_TRUE(solution->rejected.empty());
  const Calibration& ours = solution->calibration;

  std::vector<double> camera;
  for (const Parameter& p : ours.parameters) camera.push_back(p.value);
  std::vector<SE3> poses;
  for (const ViewRecord& view : ours.views) poses.push_back(to_se3(view.camera_from_board));
  formulas::CeresSolver ceres(GetParam(), views, {});
  double best = std::numeric_limits<double>::infinity();
  for (const double longer : {0.9, 0.97, 1.0, 1.03, 1.1}) {
    std::vector<double> from = camera;
    from[0] *= longer;
    from[1] *= longer;
    ceres.start(from, poses);
    best = std::min(best, ceres.solve().cost);
  }
  const double theirs = std::sqrt(best / (15 * 54));
  RecordProperty("rms", std::to_string(*ours.rms));
  RecordProperty("ceres", std::to_string(theirs));
  EXPECT_LE(*ours.rms, 1.001 * theirs);
}

}  // namespace
}  // namespace calvin
