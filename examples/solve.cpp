// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-solve [OPTIONS] CALIBRATION.json VIEWS...: one camera from what was seen of boards or of
// known points, by the search of solve() or by one of the methods of older tools.
#include <cstdio>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/detect/grids/thresholded_dots.hpp"
#include "calvin/detect/patches.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/session/refine_with_camera.hpp"
#include "calvin/solve/heikkila/ellipse_centers.hpp"
#include "calvin/solve/methods/methods.hpp"
#include "calvin/solve/solve.hpp"

#include "output_files.hpp"
#include "print_calibration.hpp"
#include "solve_par.hpp"
#include "solve_print.hpp"
#include "solve_views.hpp"
#include "solve_zooming.hpp"
#include "tool_main.hpp"

namespace {

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;

constexpr std::string_view kUsage =
    R"(Usage: calvin-solve [OPTIONS] CALIBRATION.json VIEWS...
Calibrates one camera and writes it to CALIBRATION.json. VIEWS are files of observations (the journal
of calibsolve), folders of pictures, FOLDER/PREFIX* in quotes, or text files of known points and
where a picture shows them, one file for each picture: a row 'X Y Z u v' for each point.

  --board BOARD      the board in pictures, checkerboard:9x6:25mm if not given; of a file of
                     observations, which has its board, another size of it
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
  --runs N           solve N times, the corners of pictures refined by the camera of the run before
                     (recompute corners), 1 if not given
  --fix P,P,...      hold parameters: aspect, center, k3, fx=fy, fx=800 ...
  --initial FILE     start from a calibration, which also says at what values to hold
  --skew             estimate the angle between the axes of the image
  --keep-all         no view and no point is left out as an outlier
  --drop N,N,...     leave out views, by their number in the list that is printed
  --camera NAME      the name of the camera
  --par S,F,U0,V0,K1,K2,T1,T2
                     no views: the camera that Heikkila's toolbox has found, mm and px
  --sensor WxHmm     the size of the sensor that par supposes
  --release-3        par is of release 3 of the toolbox, whose distortion goes the other way
  --pitch LENGTH     of the pixels, as 3.45um: lengths on the sensor are printed in mm, too
  --help             this text
)";

std::string usage() { return fmt::format(kUsage, calvin::join(calvin::method_names(), ", ")); }

struct Arguments {
  std::string board;  // that of --board; empty: as the views have it
  solve_views::RowsOptions rows;
  calvin::SolveOptions options;
  std::string initial;
  std::optional<double> pitch;  // m
  int runs = 1;
  solve_par::Par par;
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
  if (option == "--par") return solve_par::set_numbers(value, arguments.par);
  if (option == "--sensor") return solve_par::set_sensor(value, arguments.par);
  if (option == "--fix") {
    for (const std::string_view word : calvin::split(value, ',')) {
      arguments.options.fix.emplace_back(word);
    }
    return true;
  }
  if (option == "--runs") {
    constexpr int kMost = 100;
    arguments.runs = calvin::parse_int(value).value_or(0);
    return arguments.runs > 0 && arguments.runs <= kMost;
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
  if (option == "--release-3") {
    arguments.par.is_release_3 = true;
  } else if (option == "--no-refine") {
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
  if (arguments.words.size() != 1 && arguments.par.is_given) {
    wrong_usage("with --par it takes a file to write, and no views.");
    return std::nullopt;
  }
  if (arguments.runs > 1 && !arguments.options.refine) {
    wrong_usage("--runs refines corners by the camera of a run, and --no-refine refines nothing.");
    return std::nullopt;
  }
  if (arguments.words.size() < 2 && !arguments.par.is_given) {
    wrong_usage("it takes a file to write, and views.");
    return std::nullopt;
  }
  return arguments;
}

// Whether the file to write is neither one that is read nor one that holds something else. A
// calibration to start from may be improved where it is.
calvin::Status check_output(const Arguments& arguments) {
  std::vector<std::string> inputs(arguments.words.begin() + 1, arguments.words.end());
  if (!arguments.rows.points.empty()) inputs.push_back(arguments.rows.points);
  output_files::Output output = {arguments.words.front(), {output_files::kCalibration}};
  if (arguments.options.method == solve_zooming::kMethod) {
    output.kinds.push_back(output_files::kZoomTable);
  }
  return output_files::check({{output}}, inputs, kUsage);
}

// The views without those to drop.
calvin::Result<solve_views::NamedViews> views_of(const Arguments& arguments) {
  solve_views::RowsOptions rows = arguments.rows;
  const bool is_discorpy = arguments.options.method == "discorpy" && !arguments.options.refine;
  if (is_discorpy && arguments.board.starts_with("dots")) {
    rows.on_found = [](const calvin::ImageView& image, const calvin::Observation& seen,
                       const calvin::Board&) {
      return calvin::detect::at_thresholded_dots(image, seen);
    };
  } else if (arguments.runs > 1) {
    rows.on_found = [](const calvin::ImageView& image, const calvin::Observation& seen,
                       const calvin::Board& board) {
      calvin::Observation kept = seen;
      kept.patches = calvin::cut_patches(image, seen, board);
      return kept;
    };
  }
  auto all = solve_views::read({arguments.words.begin() + 1, arguments.words.end()},
                               arguments.board, rows);
  if (!all) return all;
  auto kept = solve_views::kept_of(*all, arguments.drop);
  if (kept && kept->empty()) {
    return calvin::make_error(
        calvin::ErrorCode::kNotFound,
        all->empty() ? "There is no view of a board." : "--drop leaves no view of a board.");
  }
  return kept;
}

int run_zooming(const Arguments& arguments) {
  const auto options = solve_zooming::options_of(arguments.options, !arguments.initial.empty());
  if (!options) return failed(options.error());
  const auto named = views_of(arguments);
  if (!named) return failed(named.error());
  const auto done = solve_zooming::run(arguments.words.front(), *named, *options);
  return done ? 0 : failed(done.error());
}

// The camera of --par.
int run_par(const Arguments& arguments) {
  if (!arguments.rows.size) return wrong_usage("--par needs the pictures' --size.");
  auto calibration = solve_par::calibration_of(arguments.par, *arguments.rows.size,
                                               arguments.rows.from_corner ? 0.5 : 0);
  if (!calibration) return failed(calibration.error());
  calibration->camera = arguments.options.camera;
  const auto written = calvin::write_calibration(arguments.words.front(), *calibration);
  calvin_tools::print(*calibration);
  return written ? 0 : failed(written.error());
}

// `views` as they were solved.
void print(const Arguments& arguments, const calvin::Solution& solution,
           std::vector<calvin::View> views, const solve_views::NamedViews& named) {
  calvin_tools::print(solution.calibration);
  if (arguments.pitch) solve_print::print_on_sensor(solution.calibration, *arguments.pitch);
  if (arguments.options.ellipse_centers) {
    const bool own = calvin::own_least_squares(arguments.options).has_value();
    views = calvin::without_center_bias(views, solution,
                                        own ? calvin::conic_bias : calvin::center_bias);
  }
  if (arguments.runs > 1) calvin::refine_with_camera(views, solution);
  solve_print::print_views(solution, views, named, calvin::is_refined(arguments.options.method));
  solve_print::print_straightness(views, solution);
  calvin_tools::print_verdict(solution.calibration);
}

int run(Arguments arguments) {
  if (!arguments.initial.empty()) {
    auto initial = calvin::read_calibration(arguments.initial);
    if (!initial) return failed(initial.error());
    arguments.options.initial = *std::move(initial);
  }
  if (const auto known = calvin::check(arguments.options); !known) return failed(known.error());
  const auto named = views_of(arguments);
  if (!named) return failed(named.error());
  std::vector<calvin::View> views;
  for (const auto& view : *named) views.push_back(view.view);
  const auto solution = calvin::solve_in_runs(views, views.front().observation.image_size,
                                              arguments.options, arguments.runs);
  if (!solution) return failed(solution.error());
  const auto written = calvin::write_calibration(arguments.words.front(), solution->calibration);
  print(arguments, *solution, std::move(views), *named);
  return written ? 0 : failed(written.error());
}

int run_tool(int argc, char** argv) {
  const std::span<char*> given(argv + 1, static_cast<std::size_t>(argc - 1));
  if (given.size() == 1 && std::string_view(given[0]) == "--help") {
    fmt::print("{}", usage());
    return 0;
  }
  const auto arguments = parse(given);
  if (!arguments) return kWrongUsage;
  if (const auto good = check_output(*arguments); !good) return failed(good.error());
  if (arguments->par.is_given) return run_par(*arguments);
  if (arguments->options.method == solve_zooming::kMethod) return run_zooming(*arguments);
  return run(*arguments);
}

}  // namespace

int main(int argc, char** argv) { return calvin_tools::run("calvin-solve", run_tool, argc, argv); }
