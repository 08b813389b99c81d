// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-zoom [OPTIONS] TABLE.json [ZOOM[,FOCUS]=]CALIBRATION...: the calibrations of a lens that
// zooms as one table, which calibundistort follows, and the calibration of a position between them.
#include <cstdio>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/camera/zoom_interpolation.hpp"
#include "calvin/core/text.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/zoom_io.hpp"
#include "calvin/rig/zoom/left_out.hpp"
#include "calvin/solve/uncertainty.hpp"

#include "output_files.hpp"
#include "tool_main.hpp"

namespace {

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;

constexpr std::string_view kUsage =
    R"(Usage: calvin-zoom [OPTIONS] TABLE.json [ZOOM[,FOCUS]=]CALIBRATION...
       calvin-zoom --at ZOOM[,FOCUS] TABLE.json CALIBRATION
Puts the calibrations of one camera at several settings of its zoom, and of its focus, into a table:
calibundistort calibration=TABLE.json follows the lens. Where the lens stood is in front of each
file, or in it: calibsolve device=NODE reads it from a V4L2 camera. Each line that is printed says how
far the table without this setting is from it, in the worst place.

  --at ZOOM[,FOCUS]  write the calibration of that position to CALIBRATION, in the native format
  --camera NAME      the name of the camera
  --help             this text
)";

struct Arguments {
  std::optional<calvin::LensPosition> at;
  std::optional<std::string> camera;
  std::vector<std::string> words;
};

int wrong_usage(std::string_view why) {
  fmt::print(stderr, "calvin-zoom: {}\n\n{}", why, kUsage);
  return kWrongUsage;
}

int failed(const calvin::Error& error) {
  fmt::print(stderr, "calvin-zoom: {}\n", error.message);
  return kFailed;
}

// ZOOM or ZOOM,FOCUS.
std::optional<calvin::LensPosition> parse_position(std::string_view text) {
  const auto numbers = calvin::split(text, ',');
  if (numbers.size() > 2) return std::nullopt;
  calvin::LensPosition position;
  position.zoom = calvin::parse_double(numbers.front());
  if (numbers.size() == 2) position.focus = calvin::parse_double(numbers.back());
  const bool good = position.zoom && (numbers.size() == 1 || position.focus);
  return good ? std::optional(position) : std::nullopt;
}

// Absent for wrong usage, which was said.
std::optional<Arguments> parse(std::span<char*> given) {
  Arguments arguments;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const std::string_view word = given[i];
    const bool has_value = i + 1 < given.size();
    if (word == "--at" && has_value) {
      arguments.at = parse_position(given[++i]);
      if (!arguments.at) {
        wrong_usage("--at takes a number, or two with a comma between them.");
        return std::nullopt;
      }
    } else if (word == "--camera" && has_value) {
      arguments.camera = given[++i];
    } else if (word.starts_with("--")) {
      wrong_usage(fmt::format("'{}' is no option, or needs a value.", word));
      return std::nullopt;
    } else {
      arguments.words.emplace_back(word);
    }
  }
  if (arguments.words.size() < 2 || (arguments.at && arguments.words.size() != 2)) {
    wrong_usage(arguments.at ? "--at takes a table and a file to write."
                             : "it takes a file to write, and calibrations.");
    return std::nullopt;
  }
  return arguments;
}

// A file, with where the lens stood if that is in front of it.
struct Setting {
  std::optional<calvin::LensPosition> position;
  std::string file;
};

// ZOOM,FOCUS=FILE or FILE, whose name may be like that, too.
Setting parse_setting(const std::string& word) {
  const auto equals = word.find('=');
  std::error_code error;
  const auto position = equals == std::string::npos || std::filesystem::exists(word, error)
                            ? std::nullopt
                            : parse_position(std::string_view(word).substr(0, equals));
  return {position, position ? word.substr(equals + 1) : word};
}

// A calibration with where the lens stood, as the word or the file says.
calvin::Result<calvin::Calibration> read_setting(const std::string& word) {
  const auto [position, file] = parse_setting(word);
  auto calibration = calvin::read_calibration(file);
  if (!calibration) return calibration;
  if (position) {
    calibration->zoom = position->zoom;
    if (position->focus) calibration->focus = position->focus;
  }
  if (!calibration->zoom) {
    return calvin::make_error(
        calvin::ErrorCode::kInvalidArgument,
        fmt::format("'{}' does not say where the zoom of the lens stood: give it as ZOOM={}.", file,
                    file));
  }
  return calibration;
}

std::string text_of(const calvin::Calibration& calibration) {
  std::string text = fmt::format("zoom {}", calvin::format_double(*calibration.zoom));
  if (calibration.focus) text += ", focus " + calvin::format_double(*calibration.focus);
  for (const auto* name : {"fx", "fy"}) {
    text += fmt::format("{} {:.2f}", name[1] == 'x' ? ": f" : "", calibration.find(name)->value);
  }
  text += " px";
  if (const auto error = calibration.expected_error) {
    text += fmt::format(", accurate to {} px (1 sigma)", calvin::two_digits(*error));
  }
  return text;
}

void print(const calvin::ZoomTable& table) {
  for (const calvin::ZoomSetting& setting : table.settings) {
    std::string line = text_of(setting.calibration);
    if (setting.left_out) {
      line +=
          fmt::format("; the table without it is {} px off", calvin::two_digits(*setting.left_out));
    }
    fmt::print("{}\n", line);
  }
  const auto largest = calvin::largest_left_out(table);
  if (largest) {
    fmt::print("Between its settings the table is off by about {} px or less.\n",
               calvin::two_digits(*largest));
  } else {
    fmt::print(
        "Nothing tells how far the table is off between its settings: calibrate at least one "
        "more, between these.\n");
  }
}

// Whether the file to write, of that kind, is neither one that is read nor holds something else.
calvin::Status check_output(const std::string& file, const output_files::Kind& kind,
                            std::span<const std::string> words, std::string_view usage) {
  std::vector<std::string> inputs;
  for (const std::string& word : words) inputs.push_back(parse_setting(word).file);
  return output_files::check({{{file, {kind}}}}, inputs, usage);
}

int make_table(const Arguments& arguments) {
  const std::string& file = arguments.words.front();
  if (parse_setting(file).position) {
    return wrong_usage(fmt::format("'{}' is a setting, and the table to write comes first.", file));
  }
  const auto good =
      check_output(file, output_files::kZoomTable, std::span(arguments.words).subspan(1), kUsage);
  if (!good) return failed(good.error());
  std::vector<calvin::Calibration> calibrations;
  for (std::size_t i = 1; i < arguments.words.size(); ++i) {
    auto calibration = read_setting(arguments.words[i]);
    if (!calibration) return failed(calibration.error());
    if (arguments.camera) calibration->camera = *arguments.camera;
    calibrations.push_back(*std::move(calibration));
  }
  auto table = calvin::make_zoom_table(std::move(calibrations));
  if (!table) return failed(table.error());
  *table = calvin::with_left_out(*std::move(table));
  const auto written = calvin::write_zoom_table(file, *table);
  print(*table);
  return written ? 0 : failed(written.error());
}

int write_position(const Arguments& arguments) {
  const auto good = check_output(arguments.words.back(), output_files::kCalibration,
                                 std::span(arguments.words).first(1),
                                 "calvin-zoom --at ZOOM[,FOCUS] TABLE.json CALIBRATION");
  if (!good) return failed(good.error());
  const auto table = calvin::read_zoom_table(arguments.words.front());
  if (!table) return failed(table.error());
  auto found = calvin::interpolate(*table, *arguments.at);
  if (!found) return failed(found.error());
  calvin::Calibration& calibration = found->calibration;
  if (arguments.camera) calibration.camera = *arguments.camera;
  calibration.expected_error = calvin::expected_error(calibration);
  calibration.expected_error_anywhere = calvin::expected_error_anywhere(calibration);
  if (!found->remark.empty()) {
    fmt::print("{}\n", found->remark);
    calibration.remarks.push_back(found->remark);
  }
  const auto written = calvin::write_calibration(arguments.words.back(), calibration);
  if (!written) return failed(written.error());
  fmt::print("{}\n", text_of(calibration));
  return 0;
}

int run_tool(int argc, char** argv) {
  const std::span<char*> given(argv + 1, static_cast<std::size_t>(argc - 1));
  if (given.size() == 1 && std::string_view(given[0]) == "--help") {
    fmt::print("{}", kUsage);
    return 0;
  }
  const auto arguments = parse(given);
  if (!arguments) return kWrongUsage;
  return arguments->at ? write_position(*arguments) : make_table(*arguments);
}

}  // namespace

int main(int argc, char** argv) { return calvin_tools::run("calvin-zoom", run_tool, argc, argv); }
