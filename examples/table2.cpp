// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-table2 [OPTIONS] [FILE...]: the experiment of the Calvin paper's Table 2: the camera is
// calibrated from many sets of 25 views, and the mean and the standard deviation of each parameter
// tell how far a single calibration can be trusted. Beside the spread stands what each calibration
// predicted of itself, and OpenCV's spread on the same corners.
#include <cmath>
#include <cstdio>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "calvin/session/refine_with_camera.hpp"
#include "table2_pictures.hpp"
#include "table2_sets.hpp"
#include "table2_statistics.hpp"
#ifdef TABLE2_OPENCV
#include "table2_opencv.hpp"
#endif
#include "tool_main.hpp"

namespace {

using table2::Table;

constexpr int kPaperSets = 10;

constexpr std::string_view kUsage =
    R"(Usage: calvin-table2 [OPTIONS] [FILE...]
Calibrates from many sets of views and prints mean and standard deviation of each parameter. Without
files: simulated views as in the paper. With files: observations (JSON lines, or corners.vnl).
`--pictures --runs 5` is the paper's comparison of 1 run and 5 runs.

  --sets N       how many sets (default 1000, 10 with files)
  --views N      views of a set (default 25)
  --model NAME   the camera model (default brown4)
  --seed N       of the random numbers (default 1)
  --pictures     detect the simulated views in rendered pictures (then 10 sets by default)
  --runs N       beside one solve, N of them with the corners looked at again between
  --board TEXT   the board of corners.vnl, for example checkerboard:9x6:25mm
  --size WxH     the size of its pictures
  --no-opencv    leave OpenCV out
  --help         this text
)";

struct Arguments {
  int sets = 0;
  int views = 25;
  int seed = 1;
  int runs = 1;
  bool pictures = false;
  std::string model = "brown4";
  std::string board;
  calvin::ImageSize size;
  bool opencv = true;
  std::vector<std::string> files;
};

// What is wrong with an option and its value; empty where nothing is.
std::string take(std::string_view option, std::string_view value, Arguments& arguments) {
  const int number = calvin::parse_int(value).value_or(-1);
  const bool counts = option == "--sets" || option == "--views";
  if (counts && number < 2) return fmt::format("{} needs a number from 2.", option);
  if (option == "--sets") arguments.sets = number;
  if (option == "--views") arguments.views = number;
  if (option == "--seed") arguments.seed = number;
  if (option == "--runs" && number < 1) return "--runs needs a number from 1.";
  if (option == "--runs") arguments.runs = number;
  if (option == "--model") arguments.model = value;
  if (option == "--board") arguments.board = value;
  if (option == "--size") {
    const auto sides = calvin::split(value, 'x');
    if (sides.size() != 2) return "--size needs a size as 640x480.";
    arguments.size = {calvin::parse_int(sides[0]).value_or(0),
                      calvin::parse_int(sides[1]).value_or(0)};
    if (arguments.size.width < 1 || arguments.size.height < 1) return "--size needs a size.";
  }
  return "";
}

std::string parse(std::span<char* const> words, Arguments& arguments) {
  constexpr std::string_view kValued[] = {"--sets",  "--views", "--seed", "--runs",
                                          "--model", "--board", "--size"};
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string_view word = words[i];
    if (word == "--no-opencv") {
      arguments.opencv = false;
    } else if (word == "--pictures") {
      arguments.pictures = true;
    } else if (std::find(std::begin(kValued), std::end(kValued), word) != std::end(kValued)) {
      if (i + 1 == words.size()) return fmt::format("{} needs a value.", word);
      if (std::string why = take(word, words[++i], arguments); !why.empty()) return why;
    } else if (word.starts_with("--")) {
      return fmt::format("there is no option '{}'.", word);
    } else {
      arguments.files.emplace_back(word);
    }
  }
  const bool corners = arguments.files.empty() && !arguments.pictures;
  if (arguments.sets == 0) arguments.sets = corners ? 1000 : kPaperSets;
  if (arguments.pictures && !arguments.files.empty()) return "--pictures goes without files.";
  if (arguments.runs > 1 && !arguments.pictures) return "--runs needs --pictures to look at.";
  return "";
}

// Rows of the sets that could be solved.
struct Results {
  std::vector<std::string> names;
  std::vector<calvin::Calibration> calibrations;
  Table ours;
  Table again;   // of all runs; no rows where there is one
  Table opencv;  // no rows where it is left out
};

Table stack(const std::vector<Eigen::VectorXd>& rows) {
  Table table(static_cast<Eigen::Index>(rows.size()), rows.empty() ? 0 : rows.front().size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    table.row(static_cast<Eigen::Index>(i)) = rows[i].transpose();
  }
  return table;
}

Eigen::VectorXd values_of(const calvin::Calibration& c) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(c.parameters.size()));
  for (std::size_t i = 0; i < c.parameters.size(); ++i) {
    values[static_cast<Eigen::Index>(i)] = c.parameters[i].value;
  }
  return values;
}

// The least squares over all corners, of ours and OpenCV alike.
calvin::Status add(const std::vector<calvin::View>& set, const Arguments& arguments,
                   std::vector<Eigen::VectorXd>& again, std::vector<Eigen::VectorXd>& opencv,
                   Results& results) {
  calvin::SolveOptions options;
  options.model = arguments.model;
  options.reject_outliers = false;
  options.checks = false;
  // OpenCV takes the board for flat: a version that estimates its shape is told not to.
  [](auto& o) {
    if constexpr (requires { o.warp = false; }) o.warp = false;
  }(options);
  const calvin::ImageSize size = set.front().observation.image_size;
  auto solution = calvin::solve(set, size, options);
  if (!solution) return tl::unexpected(solution.error());
  results.calibrations.push_back(std::move(solution->calibration));
  if (arguments.runs > 1) {
    const auto last = calvin::solve_in_runs(set, size, options, arguments.runs);
    if (!last) return tl::unexpected(last.error());
    again.push_back(values_of(last->calibration));
  }
#ifdef TABLE2_OPENCV
  if (arguments.opencv && (arguments.model == "brown4" || arguments.model == "brown5")) {
    opencv.push_back(table2::opencv_parameters(set, size, arguments.model == "brown5"));
  }
#else
  (void)opencv;
#endif
  return {};
}

// Prints why a set is left out, and goes on.
void report(int set, const calvin::Status& status) {
  if (!status) fmt::print("set {} is left out: {}\n", set, status.error().message);
}

std::string number(double value) { return fmt::format("{:.6g}", value); }

// sqrt of the mean variance that the calibrations told of themselves.
double predicted(const Results& results, std::size_t parameter) {
  double variance = 0;
  for (const calvin::Calibration& c : results.calibrations) {
    variance += std::pow(c.parameters[parameter].sigma.value_or(0), 2);
  }
  return std::sqrt(variance / static_cast<double>(results.calibrations.size()));
}

void print_rows(const Results& results, bool simulated, int runs) {
  const bool opencv = results.opencv.rows() > 1;
  const bool again = results.again.rows() > 1;
  const Eigen::VectorXd mean = table2::means(results.ours);
  const Eigen::VectorXd spread = table2::spreads(results.ours);
  fmt::print("{:<5}", "");
  if (simulated) fmt::print(" {:>22}", "paper: mean spread");
  fmt::print(" {:>48}", "ours: mean spread predicted ratio");
  if (again) fmt::print(" {:>24}", fmt::format("{} runs: mean spread", runs));
  if (opencv) fmt::print(" {:>24}", "OpenCV: mean spread");
  fmt::print("\n");
  for (std::size_t i = 0; i < results.names.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    fmt::print("{:<5}", results.names[i]);
    if (simulated) {
      const table2::PaperRow& paper = table2::kPaper[i];
      fmt::print(" {:>12} {:>9}", paper.mean == 0 ? "-" : number(paper.mean), number(paper.spread));
    }
    const double expected = predicted(results, i);
    fmt::print(" {:>14} {:>12} {:>12} {:>7}", number(mean[k]), number(spread[k]), number(expected),
               expected > 0 ? fmt::format("{:.4f}", spread[k] / expected) : "-");
    if (again) {
      fmt::print(" {:>12} {:>11}", number(table2::means(results.again)[k]),
                 number(table2::spreads(results.again)[k]));
    }
    if (opencv) {
      fmt::print(" {:>12} {:>11}", number(table2::means(results.opencv)[k]),
                 number(table2::spreads(results.opencv)[k]));
    }
    fmt::print("\n");
  }
}

void print_joint(const Results& results, const Arguments& arguments) {
  double square = 0;
  for (const calvin::Calibration& c : results.calibrations) {
    square += table2::normalised_square(c, table2::means(results.ours));
  }
  fmt::print("joint spread over predicted: {:.4f}\n",
             std::sqrt(square / static_cast<double>(results.calibrations.size() - 1)));
  if (!arguments.files.empty() || arguments.pictures || arguments.model != "brown4" ||
      results.ours.rows() < 5 * kPaperSets) {
    return;
  }
  Eigen::VectorXd paper(results.ours.cols());
  for (Eigen::Index i = 0; i < paper.size(); ++i) paper[i] = table2::kPaper[i].spread;
  table2::Random random(static_cast<std::uint64_t>(arguments.seed) + 1000003);
  const auto region = table2::joint_region(results.ours, paper, kPaperSets, random);
  fmt::print("the paper's spreads in our joint 95 % region: {} (distance {:.2f}, limit {:.2f})\n",
             region.inside() ? "yes" : "no", region.distance, region.limit);
}

int run(const Arguments& arguments) {
  table2::Random random(static_cast<std::uint64_t>(arguments.seed));
  table2::Sets sets;
  if (!arguments.files.empty()) {
    std::vector<calvin::View> views;
    for (const std::string& file : arguments.files) {
      auto more = table2::read_views(file, arguments.board, arguments.size);
      if (!more) {
        fmt::print(stderr, "{}\n", more.error().message);
        return 1;
      }
      std::move(more->begin(), more->end(), std::back_inserter(views));
    }
    const auto needed =
        static_cast<std::size_t>(arguments.sets) * static_cast<std::size_t>(arguments.views);
    fmt::print("{} views", views.size());
    if (views.size() < needed) fmt::print("; sets share views, so that the spread is too small");
    fmt::print("\n");
    sets = table2::cut(std::move(views), arguments.sets, arguments.views, random);
  }
  Results results;
  std::vector<Eigen::VectorXd> again;
  std::vector<Eigen::VectorXd> opencv;
  const auto simulated = [&] {
    return arguments.pictures ? table2::photograph(arguments.views, random)
                              : table2::simulate(arguments.views, random);
  };
  for (int i = 0; i < arguments.sets; ++i) {
    if (!arguments.files.empty() && static_cast<std::size_t>(i) >= sets.size()) break;
    const auto set = arguments.files.empty() ? simulated() : sets[static_cast<std::size_t>(i)];
    report(i, add(set, arguments, again, opencv, results));
  }
  if (results.calibrations.size() < 2) {
    fmt::print(stderr,
               "Fewer than two sets of {} views could be calibrated: give more views, or "
               "fewer to a set (--views).\n",
               arguments.views);
    return 1;
  }
  std::vector<Eigen::VectorXd> rows;
  for (const calvin::Calibration& c : results.calibrations) rows.push_back(values_of(c));
  for (const auto& p : results.calibrations.front().parameters) results.names.push_back(p.name);
  results.ours = stack(rows);
  results.again = stack(again);
  results.opencv = stack(opencv);
  fmt::print("{}, {} sets of {} views\n", arguments.model, rows.size(), arguments.views);
  print_rows(results, arguments.files.empty() && arguments.model == "brown4", arguments.runs);
  print_joint(results, arguments);
  return 0;
}

int run_tool(int argc, char** argv) {
  const std::span<char*> words(argv + 1, static_cast<std::size_t>(std::max(0, argc - 1)));
  if (std::any_of(words.begin(), words.end(), [](std::string_view w) { return w == "--help"; })) {
    fmt::print("{}", kUsage);
    return 0;
  }
  Arguments arguments;
  if (const std::string why = parse(words, arguments); !why.empty()) {
    fmt::print(stderr, "calvin-table2: {}\n\n{}", why, kUsage);
    return 2;
  }
  return run(arguments);
}

}  // namespace

int main(int argc, char** argv) { return calvin_tools::run("calvin-table2", run_tool, argc, argv); }
