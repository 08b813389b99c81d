// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-compare [OPTIONS] A B: how far two calibrations of one camera are apart, in px over the
// image, the rotation that is between them left out. The files are of any format that calvin reads,
// and of any two camera models.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/solve/difference.hpp"

#include "tool_main.hpp"

namespace {

using calvin::Calibration;
using calvin::Camera;
using calvin::Difference;

constexpr int kOther = 3;  // the exit status where --limit is exceeded

constexpr std::string_view kUsage =
    R"(Usage: calvin-compare [OPTIONS] A B
Prints how far two calibrations of one camera are apart: for each pixel of A, where B sees the same
ray, a turn of the whole camera left out.

  --scale      scale B to the size of A's images
  --whole      fit the turn over the whole image, not only where both calibrations saw corners
  --limit PX   exit with status 3 where the difference exceeds PX in the covered (else the whole) image
  --table N    columns of the table (default 9)
  --help       this text
)";

struct Arguments {
  std::string a;
  std::string b;
  bool scale = false;
  bool whole = false;
  std::optional<double> limit;
  int table = 9;
};

int wrong_usage(std::string_view why) {
  fmt::print(stderr, "calvin-compare: {}\n\n{}", why, kUsage);
  return 2;
}

int failed(const calvin::Error& error) {
  fmt::print(stderr, "{}\n", error.message);
  return 1;
}

// What is wrong with the arguments; empty where nothing is.
std::string parse(std::span<char* const> words, Arguments& arguments) {
  int files = 0;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string_view word = words[i];
    const std::string_view next = i + 1 < words.size() ? words[i + 1] : std::string_view();
    if (word == "--scale") {
      arguments.scale = true;
    } else if (word == "--whole") {
      arguments.whole = true;
    } else if (word == "--limit") {
      arguments.limit = calvin::parse_double(next);
      if (!(arguments.limit.value_or(-1) >= 0)) return "--limit needs a number of px.";
      ++i;
    } else if (word == "--table") {
      arguments.table = calvin::parse_int(next).value_or(0);
      if (arguments.table < 2 || arguments.table > 65) return "--table needs a number, 2 to 65.";
      ++i;
    } else if (word.starts_with("--")) {
      return fmt::format("there is no option '{}'.", word);
    } else if (++files <= 2) {
      (files == 1 ? arguments.a : arguments.b) = word;
    }
  }
  return files == 2 ? "" : "two calibration files are needed.";
}

// OpenCV's files need not say for which size of images they are: then the other's counts.
void complete_sizes(Calibration& a, Calibration& b) {
  if (a.image_size.width == 0) a.image_size = b.image_size;
  if (b.image_size.width == 0) b.image_size = a.image_size;
}

// The covered regions, in px of `size`.
std::vector<std::vector<calvin::Pixel>> covered(const Calibration& a, const Calibration& b) {
  std::vector<std::vector<calvin::Pixel>> regions;
  for (const Calibration* c : {&a, &b}) {
    if (c->covered.size() < 3) continue;
    const double sx = static_cast<double>(a.image_size.width) / c->image_size.width;
    const double sy = static_cast<double>(a.image_size.height) / c->image_size.height;
    std::vector<calvin::Pixel> region = c->covered;
    for (calvin::Pixel& p : region) p = {sx * (p.u + 0.5) - 0.5, sy * (p.v + 0.5) - 0.5};
    regions.push_back(std::move(region));
  }
  return regions;
}

void print_summary(std::string_view where, const Difference::Summary& s) {
  if (s.cells == 0) return;
  fmt::print("{:<8} max {:.4f} px at ({:.0f}, {:.0f}), rms {:.4f} px\n", where, s.max, s.worst.u,
             s.worst.v, s.rms);
}

void print_rotation(const Difference& d) {
  const auto& w = d.rotation;
  const double angle = std::hypot(w[0], w[1], w[2]);
  fmt::print("rotation {:.5f} degrees", angle * 180 / std::numbers::pi);
  if (angle > 0) {
    fmt::print(" about ({:.4f}, {:.4f}, {:.4f})", w[0] / angle, w[1] / angle, w[2] / angle);
  }
  fmt::print("\n");
}

// Lengths of the changes at some of the cells, px; '-' where a model has no value.
void print_table(const Difference& d, int columns, int rows) {
  const int height = static_cast<int>(d.cells.size()) / d.columns;
  const auto cell = [&](int x, int y) -> const Difference::Cell& {
    const int column = (2 * x * (d.columns - 1) + columns - 1) / (2 * (columns - 1));
    const int row = (2 * y * (height - 1) + rows - 1) / (2 * (rows - 1));
    return d.cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(d.columns) +
                   static_cast<std::size_t>(column)];
  };
  fmt::print("\nchange in px at\n{:>7}", "");
  for (int x = 0; x < columns; ++x) fmt::print(" {:>8.0f}", cell(x, 0).at.u);
  for (int y = 0; y < rows; ++y) {
    fmt::print("\n{:>7.0f}", cell(0, y).at.v);
    for (int x = 0; x < columns; ++x) {
      const auto& change = cell(x, y).change;
      fmt::print(" {:>8}", change ? fmt::format("{:.4f}", std::hypot(change->u, change->v)) : "-");
    }
  }
  fmt::print("\n");
}

// B as it would be for images of A's size; the same part of the scene must be in both.
calvin::Result<Camera> scaled_to(const Camera& b, calvin::ImageSize size) {
  const calvin::ImageSize from = b.image_size();
  const double stretch = static_cast<double>(size.width) * from.height / size.height / from.width;
  if (std::abs(stretch - 1) > 0.01) {
    return calvin::make_error(
        calvin::ErrorCode::kInvalidArgument,
        fmt::format("Images of {}x{} px are not those of {}x{} px scaled: their sides are of "
                    "another ratio, so something was cut off. Compare calibrations of the same "
                    "mode of the camera.",
                    from.width, from.height, size.width, size.height));
  }
  return b.scaled(size);
}

int compare(const Arguments& arguments) {
  auto first = calvin::read_calibration(arguments.a);
  if (!first) return failed(first.error());
  auto second = calvin::read_calibration(arguments.b);
  if (!second) return failed(second.error());
  complete_sizes(*first, *second);
  const auto a = Camera::make(*first);
  if (!a) return failed(a.error());
  auto b = Camera::make(*second);
  if (!b) return failed(b.error());
  if (arguments.scale) b = scaled_to(*b, a->image_size());
  if (!b) return failed(b.error());

  calvin::DifferenceOptions options;
  if (!arguments.whole) options.focus = covered(*first, *second);
  const auto all = calvin::difference(*a, *b, options);
  if (!all) return failed(all.error());
  print_summary("image", all->image);
  if (!options.focus.empty()) print_summary("covered", all->focus);
  print_rotation(*all);
  const auto left_out = all->cells.size() - static_cast<std::size_t>(all->image.cells);
  if (left_out > 0) {
    fmt::print("a model has no value for {:.1f} % of the image\n",
               100.0 * static_cast<double>(left_out) / static_cast<double>(all->cells.size()));
  }
  const calvin::ImageSize size = a->image_size();
  print_table(*all, arguments.table, std::clamp(arguments.table * size.height / size.width, 2, 40));
  return arguments.limit && all->focus.max > *arguments.limit ? kOther : 0;
}

int run_tool(int argc, char** argv) {
  const std::span<char*> words(argv + 1, static_cast<std::size_t>(std::max(0, argc - 1)));
  if (std::any_of(words.begin(), words.end(), [](std::string_view w) { return w == "--help"; })) {
    fmt::print("{}", kUsage);
    return 0;
  }
  Arguments arguments;
  if (const std::string why = parse(words, arguments); !why.empty()) return wrong_usage(why);
  return compare(arguments);
}

}  // namespace

int main(int argc, char** argv) {
  return calvin_tools::run("calvin-compare", run_tool, argc, argv);
}
