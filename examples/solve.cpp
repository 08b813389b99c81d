// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-solve [OPTIONS] CALIBRATION.json VIEWS...: one camera from what was seen of boards or of
// known points, by the search of solve() or by one of the methods of older tools.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/camera/camera.hpp"
#include "calvin/core/text.hpp"
#include "calvin/detect/grids/thresholded_dots.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/solve/heikkila/ellipse_centers.hpp"
#include "calvin/solve/methods/methods.hpp"
#include "calvin/solve/residuals/board_shape.hpp"
#include "calvin/solve/residuals/straightness.hpp"
#include "calvin/solve/solve.hpp"

#include "print_calibration.hpp"
#include "solve_views.hpp"
#include "solve_zooming.hpp"

namespace {

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;
constexpr double kMillimetre = 1e-3;  // m

constexpr std::string_view kUsage =
    R"(Usage: calvin-solve [OPTIONS] CALIBRATION.json VIEWS...
Calibrates one camera and writes it to CALIBRATION.json. VIEWS are files of observations (the journal
of calibsolve), folders of pictures, FOLDER/PREFIX* in quotes, or text files of known points and
where a picture shows them, one file for each picture: a row 'X Y Z u v' for each point.

  --board BOARD      the board in pictures, checkerboard:9x6:25mm if not given
  --size WxH         the pictures' size, px, for rows of points
  --columns C,C,...  what the rows hold: id X Y Z diameter nx ny nz u v sigma, _ for what does not
                     count; -Z turns an axis round, for points of a left-handed frame
  --unit mm          the unit of X Y Z: mm cm m in
  --points FILE      the points stand in a file of their own, those of VIEWS are u v alone
  --point-columns C  what the rows of that file hold
  --from-corner      u v count from the corner of the top-left pixel, not from its centre
  --ellipse-centers  u v are centres of the images of dots, whose diameters the rows have: the images
                     of the dots' centres, which are elsewhere, are found with the camera. Dots in
                     space need the normals nx ny nz of the surface, too
  --diameter LENGTH  of all dots, where the rows have none: 10mm
  --model MODEL      the camera model, brown5 if not given; auto chooses one
  --method METHOD    start by one of {}; if not given, starts are searched.
                     discorpy: the distortion alone, of one picture of a grid of dots or lines or
                     several; with it the board is dots:1mm or lines:1mm, any part of which is seen.
                     sturm-maybank: planes through a lens that zooms from view to view. Each has its
                     own f and k1, and CALIBRATION.json is a zoom table by the numbers of the views
  --no-refine        what the method finds by itself
  --fix P,P,...      hold parameters: aspect, center, k3, fx=fy, fx=800 ...
  --initial FILE     start from a calibration, which also says at what values to hold
  --skew             estimate the angle between the axes of the image
  --keep-all         no view and no point is left out as an outlier
  --drop N,N,...     leave out views, by their number in the list that is printed
  --camera NAME      the name of the camera
  --pitch LENGTH     of the pixels, as 3.45um: lengths on the sensor are printed in mm, too
  --help             this text
)";

std::string usage() { return fmt::format(kUsage, calvin::join(calvin::method_names(), ", ")); }

struct Arguments {
  std::string board = "checkerboard:9x6:25mm";
  solve_views::RowsOptions rows;
  calvin::SolveOptions options;
  std::string initial;
  std::optional<double> pitch;  // m
  std::vector<std::size_t> drop;
  std::vector<std::string> words;
};

int wrong_usage(std::string_view why) {
  fmt::print(stderr, "calvin-solve: {}\n\n{}", why, usage());
  return kWrongUsage;
}

int failed(const calvin::Error& error) {
  fmt::print(stderr, "calvin-solve: {}\n", error.message);
  return kFailed;
}

// Whether the text is a length, which is written to `to`, m.
bool set_length(std::string_view text, std::optional<double>& to) {
  const auto length = calvin::parse_length(text);
  if (length) to = *length;
  return length.has_value();
}

bool set_size(std::string_view value, solve_views::RowsOptions& rows) {
  const auto sides = calvin::split(value, 'x');
  const auto width = calvin::parse_int(sides.front());
  const auto height = calvin::parse_int(sides.back());
  if (sides.size() != 2 || !width || !height) return false;
  rows.size = calvin::ImageSize{*width, *height};
  return calvin::check_image_size(*rows.size).has_value();
}

bool set_columns(std::string_view value, std::vector<calvin::PointColumn>& columns) {
  auto parsed = calvin::parse_point_columns(value);
  if (!parsed) {
    fmt::print(stderr, "calvin-solve: {}\n", parsed.error().message);
    return false;
  }
  columns = *std::move(parsed);
  return true;
}

bool set_drop(std::string_view value, std::vector<std::size_t>& drop) {
  for (const std::string_view number : calvin::split(value, ',')) {
    const auto index = calvin::parse_int(number);
    if (!index || *index < 0) return false;
    drop.push_back(static_cast<std::size_t>(*index));
  }
  return true;
}

// An option that is a text; false where it is none.
bool set_text(std::string_view option, std::string_view value, Arguments& arguments) {
  struct Text {
    std::string_view option;
    std::string* to;
  };
  for (const Text& text : {Text{"--board", &arguments.board},
                           {"--points", &arguments.rows.points},
                           {"--model", &arguments.options.model},
                           {"--method", &arguments.options.method},
                           {"--initial", &arguments.initial},
                           {"--camera", &arguments.options.camera}}) {
    if (text.option != option) continue;
    *text.to = value;
    return true;
  }
  return false;
}

// An option with a value; false where the value is wrong.
bool set_option(std::string_view option, std::string_view value, Arguments& arguments) {
  solve_views::RowsOptions& rows = arguments.rows;
  if (set_text(option, value, arguments)) return true;
  if (option == "--size") return set_size(value, rows);
  if (option == "--columns") return set_columns(value, rows.format.columns);
  if (option == "--point-columns") return set_columns(value, rows.point_format.columns);
  if (option == "--drop") return set_drop(value, arguments.drop);
  if (option == "--fix") {
    for (const std::string_view word : calvin::split(value, ',')) {
      arguments.options.fix.emplace_back(word);
    }
    return true;
  }
  if (option == "--diameter") return set_length(value, rows.diameter);
  if (option == "--unit") {
    const bool is_unit = set_length(fmt::format("1{}", value), rows.format.unit);
    rows.point_format.unit = rows.format.unit;
    return is_unit;
  }
  return option == "--pitch" && set_length(value, arguments.pitch);
}

// An option without a value; false where it is none.
bool set_flag(std::string_view option, Arguments& arguments) {
  if (option == "--no-refine") {
    arguments.options.refine = false;
  } else if (option == "--ellipse-centers") {
    arguments.options.ellipse_centers = true;
  } else if (option == "--from-corner") {
    arguments.rows.from_corner = true;
  } else if (option == "--skew") {
    arguments.options.skew = true;
  } else if (option == "--keep-all") {
    arguments.options.reject_outliers = false;
  } else {
    return false;
  }
  return true;
}

// Absent for wrong usage, which was said.
std::optional<Arguments> parse(std::span<char*> given) {
  Arguments arguments;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const std::string_view word = given[i];
    if (!word.starts_with("--")) {
      arguments.words.emplace_back(word);
    } else if (!set_flag(word, arguments) &&
               (i + 1 == given.size() || !set_option(word, given[++i], arguments))) {
      wrong_usage(fmt::format("'{}' is no option, or needs another value.", word));
      return std::nullopt;
    }
  }
  if (arguments.words.size() < 2) {
    wrong_usage("it takes a file to write, and views.");
    return std::nullopt;
  }
  return arguments;
}

// The views without those to drop.
calvin::Result<solve_views::NamedViews> views_of(const Arguments& arguments) {
  solve_views::RowsOptions rows = arguments.rows;
  const bool is_discorpy = arguments.options.method == "discorpy" && !arguments.options.refine;
  if (is_discorpy && arguments.board.starts_with("dots")) {
    rows.places = calvin::detect::at_thresholded_dots;
  }
  auto all = solve_views::read({arguments.words.begin() + 1, arguments.words.end()},
                               arguments.board, rows);
  if (!all) return all;
  solve_views::NamedViews kept;
  for (std::size_t i = 0; i < all->size(); ++i) {
    const auto& drop = arguments.drop;
    if (std::find(drop.begin(), drop.end(), i) == drop.end()) kept.push_back((*all)[i]);
  }
  if (kept.empty()) {
    return calvin::make_error(calvin::ErrorCode::kNotFound, "There is no view of a board.");
  }
  return kept;
}

// The distances of the points of a view from where the camera puts them on the board as it is bent,
// px.
struct Distances {
  double mean = 0;
  double farthest = 0;
  int id = 0;  // of the point that is farthest
};
Distances distances_of(const calvin::View& view, const std::set<int>& left_out,
                       const calvin::SE3& camera_from_board, const calvin::BoardWarp& warp,
                       const calvin::Camera& camera) {
  Distances all;
  double count = 0;
  const auto points = calvin::bent_points(view.board, warp);
  const calvin::Observation& seen = view.observation;
  for (std::size_t i = 0; i < seen.ids.size(); ++i) {
    const auto index = view.board.index_of(seen.ids[i]);
    if (!index || left_out.contains(seen.ids[i])) continue;
    const auto at = camera.project(camera_from_board * points[*index]);
    if (!at) continue;
    const double distance = std::hypot(at->u - seen.uv[i].u, at->v - seen.uv[i].v);
    all.mean += distance;
    ++count;
    if (distance < all.farthest) continue;
    all.farthest = distance;
    all.id = seen.ids[i];
  }
  all.mean /= std::max(count, 1.0);
  return all;
}

// Lines for each view: how well it fits, and where the camera was.
void print_view(std::string_view name, const calvin::ViewRecord& record, const Distances& d) {
  const calvin::SE3 camera_from_board = calvin::to_se3(record.camera_from_board);
  const Eigen::Vector3d t = camera_from_board.translation / kMillimetre;
  const Eigen::Vector3d place = camera_from_board.inverse().translation / kMillimetre;
  fmt::print("view {}: {} points, rms {:.4f} px, mean {:.4f}, farthest {:.4f} (point {})\n", name,
             record.points, record.rms, d.mean, d.farthest, d.id);
  fmt::print("  T {:.3f} {:.3f} {:.3f} mm, camera at {:.3f} {:.3f} {:.3f} mm\n", t.x(), t.y(),
             t.z(), place.x(), place.y(), place.z());
}

// `views` as they were solved, `names` by what they are called; `has_poses`: whether the focal
// length is known, without which there are none.
void print_views(const calvin::Solution& solution, const std::vector<calvin::View>& views,
                 const solve_views::NamedViews& names, bool has_poses) {
  std::vector<bool> rejected(views.size(), false);
  std::vector<std::set<int>> left_out(views.size());  // points of each view
  for (const calvin::RejectedCorner& corner : solution.rejected_corners) {
    left_out[corner.view].insert(corner.id);
  }
  for (const calvin::RejectedView& view : solution.rejected) {
    rejected[view.index] = true;
    fmt::print("view {}: left out ({})\n", names[view.index].name, calvin::to_string(view.reason));
  }
  const auto camera = calvin::Camera::make(solution.calibration);
  auto record = solution.calibration.views.begin();
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (rejected[i] || record == solution.calibration.views.end() || !camera) continue;
    if (has_poses) {
      const Distances d =
          distances_of(views[i], left_out[i], calvin::to_se3(record->camera_from_board),
                       solution.calibration.warp.value_or(calvin::BoardWarp()), *camera);
      print_view(names[i].name, *record, d);
    } else {
      fmt::print("view {}: {} points, rms {:.4f} px\n", names[i].name, record->points, record->rms);
    }
    ++record;
  }
}

// How straight rows and columns of the boards become.
void print_straightness(const std::vector<calvin::View>& views, const calvin::Solution& solution) {
  const auto camera = calvin::Camera::make(solution.calibration);
  const auto straight =
      camera ? calvin::straightness(views, solution.rejected_corners, *camera) : std::nullopt;
  if (!straight) return;
  fmt::print(
      "straightness: {} rows and columns, rms {:.4f} px from straight lines, {:.4f} as seen\n",
      straight->lines, straight->mended, straight->seen);
}

void print_on_sensor(const calvin::Calibration& calibration, double pitch) {
  const auto* fx = calibration.find("fx");
  const auto* fy = calibration.find("fy");
  if (fx == nullptr || fy == nullptr) return;
  fmt::print("on the sensor: f {:.6g} mm along x, {:.6g} mm along y\n",
             fx->value * pitch / kMillimetre, fy->value * pitch / kMillimetre);
}

int run_zooming(const Arguments& arguments) {
  const auto options = solve_zooming::options_of(arguments.options, !arguments.initial.empty());
  if (!options) return failed(options.error());
  const auto named = views_of(arguments);
  if (!named) return failed(named.error());
  const auto done = solve_zooming::run(arguments.words.front(), *named, *options);
  return done ? 0 : failed(done.error());
}

}  // namespace

int main(int argc, char** argv) {
  const std::span<char*> given(argv + 1, static_cast<std::size_t>(argc - 1));
  if (given.size() == 1 && std::string_view(given[0]) == "--help") {
    fmt::print("{}", usage());
    return 0;
  }
  auto arguments = parse(given);
  if (!arguments) return kWrongUsage;
  if (arguments->options.method == solve_zooming::kMethod) return run_zooming(*arguments);
  if (!arguments->initial.empty()) {
    auto initial = calvin::read_calibration(arguments->initial);
    if (!initial) return failed(initial.error());
    arguments->options.initial = *std::move(initial);
  }
  if (const auto known = calvin::check(arguments->options); !known) return failed(known.error());
  const auto named = views_of(*arguments);
  if (!named) return failed(named.error());
  std::vector<calvin::View> views;
  for (const auto& view : *named) views.push_back(view.view);
  const auto solution =
      calvin::solve(views, views.front().observation.image_size, arguments->options);
  if (!solution) return failed(solution.error());
  const auto& file = arguments->words.front();
  if (const auto written = calvin::write_calibration(file, solution->calibration); !written) {
    return failed(written.error());
  }
  calvin_tools::print(solution->calibration);
  if (arguments->pitch) print_on_sensor(solution->calibration, *arguments->pitch);
  if (arguments->options.ellipse_centers) {
    const bool own = calvin::own_least_squares(arguments->options).has_value();
    views = calvin::without_center_bias(views, *solution,
                                        own ? calvin::conic_bias : calvin::center_bias);
  }
  print_views(*solution, views, *named, calvin::is_refined(arguments->options.method));
  print_straightness(views, *solution);
  calvin_tools::print_verdict(solution->calibration);
  return 0;
}
