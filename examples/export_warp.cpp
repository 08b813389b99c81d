// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-export-warp [OPTIONS] CALIBRATION FORMAT FILE...: what calibundistort does to the pixels,
// in the files of hardware and of other programs.
#include <algorithm>
#include <cstdio>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "calvin/camera/frame_fit.hpp"
#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/io/settings.hpp"
#include "export_warp_text.hpp"
#include "output_files.hpp"
#include "tool_main.hpp"

namespace {

using calvin::Result;
using export_warp::Warp;

constexpr std::string_view kUsage =
    R"(Usage: calvin-export-warp [OPTIONS] CALIBRATION FORMAT FILE...
Writes where in the camera's picture each pixel of an undistorted one lies. CALIBRATION is what the
property of calibundistort takes; FORMAT and the number of files that it needs:

  dw100       1  vertex map of NXP's DW100 (i.MX8M Plus), binary
  ffmpeg      2  columns and rows for ffmpeg's remap filter, PGM
  stmap       1  STMap as Nuke has it, y from below, OpenEXR
  stmap-down  1  the same with y from above
  nvdewarper  1  configuration of DeepStream's nvdewarper
  glsl        1  fragment shader, for glshader and others

  --input WxH         size of the camera's frames (default: that of the calibration)
  --output WxH        size of the undistorted frames (default: that of the input)
  --alpha A           0 (default): no invalid pixel, to 1: all pixels of the camera
  --alpha-mode MODE   calvin (default), opencv
  --zoom Z            enlarges the middle (default 1)
  --pan D --tilt D --roll D    looks right, up, and turns clockwise, degrees
  --projection NAME   rectilinear (default), cylindrical, equirectangular, stereographic, panini,
                      fisheye
  --help              this text
)";

struct Format {
  std::string_view name;
  std::vector<Result<std::string> (*)(const Warp&)> files;
};
const std::vector<Format>& formats() {
  static const std::vector<Format> kFormats = {
      {"dw100", {[](const Warp& w) -> Result<std::string> { return export_warp::dw100(w); }}},
      {"ffmpeg",
       {[](const Warp& w) -> Result<std::string> { return export_warp::ffmpeg_map(w, false); },
        [](const Warp& w) -> Result<std::string> { return export_warp::ffmpeg_map(w, true); }}},
      {"stmap",
       {[](const Warp& w) -> Result<std::string> { return export_warp::stmap(w, false); }}},
      {"stmap-down",
       {[](const Warp& w) -> Result<std::string> { return export_warp::stmap(w, true); }}},
      {"nvdewarper", {export_warp::nvdewarper}},
      {"glsl", {export_warp::glsl}},
  };
  return kFormats;
}

constexpr std::string_view kProjections[] = {"rectilinear",   "cylindrical", "equirectangular",
                                             "stereographic", "panini",      "fisheye"};
constexpr std::string_view kAlphaModes[] = {"calvin", "opencv"};

struct Arguments {
  std::string calibration;
  const Format* format = nullptr;
  std::vector<std::string> files;
  calvin::ImageSize input;
  calvin::ViewOptions view;
};

int wrong_usage(std::string_view why) {
  fmt::print(stderr, "calvin-export-warp: {}\n\n{}", why, kUsage);
  return 2;
}

int failed(const calvin::Error& error) {
  fmt::print(stderr, "calvin-export-warp: {}\n", error.message);
  return 1;
}

bool take_size(std::string_view text, calvin::ImageSize& size) {
  const auto sides = calvin::split(text, 'x');
  if (sides.size() != 2) return false;
  size = {calvin::parse_int(sides[0]).value_or(0), calvin::parse_int(sides[1]).value_or(0)};
  return size.width >= 2 && size.height >= 2 && size.width <= 16384 && size.height <= 16384;
}

bool take_number(std::string_view text, double low, double high, double unit, double& value) {
  const auto number = calvin::parse_double(text);
  if (!number || *number < low || *number > high) return false;
  value = *number * unit;
  return true;
}

template <typename E>
bool take_name(std::string_view text, std::span<const std::string_view> names, E& value) {
  const auto it = std::find(names.begin(), names.end(), text);
  value = static_cast<E>(it - names.begin());
  return it != names.end();
}

// Whether there is such an option with such a value.
bool take_option(std::string_view name, std::string_view value, Arguments& a) {
  constexpr double kDegree = std::numbers::pi / 180;
  if (name == "--input") return take_size(value, a.input);
  if (name == "--output") return take_size(value, a.view.output);
  if (name == "--alpha") return take_number(value, 0, 1, 1, a.view.alpha);
  if (name == "--alpha-mode") return take_name(value, kAlphaModes, a.view.alpha_mode);
  if (name == "--zoom") return take_number(value, 0.01, 100, 1, a.view.zoom);
  if (name == "--pan") return take_number(value, -180, 180, kDegree, a.view.pan);
  if (name == "--tilt") return take_number(value, -180, 180, kDegree, a.view.tilt);
  if (name == "--roll") return take_number(value, -180, 180, kDegree, a.view.roll);
  if (name == "--projection") return take_name(value, kProjections, a.view.projection);
  return false;
}

// What is wrong with the arguments; empty where nothing is.
std::string parse(std::span<char* const> words, Arguments& arguments) {
  std::vector<std::string_view> rest;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string_view word = words[i];
    if (!word.starts_with("--")) {
      rest.push_back(word);
      continue;
    }
    const std::string_view value = i + 1 < words.size() ? words[++i] : std::string_view();
    if (!take_option(word, value, arguments)) {
      return fmt::format("'{} {}' is not an option.", word, value);
    }
  }
  if (rest.size() < 2) return "a calibration and a format are needed.";
  arguments.calibration = rest[0];
  const auto it = std::find_if(formats().begin(), formats().end(),
                               [&](const Format& f) { return f.name == rest[1]; });
  if (it == formats().end()) return fmt::format("there is no format '{}'.", rest[1]);
  arguments.format = &*it;
  arguments.files.assign(rest.begin() + 2, rest.end());
  if (arguments.files.size() == it->files.size()) return "";
  return fmt::format("{} needs {}.", it->name, it->files.size() == 1 ? "one file" : "two files");
}

Result<Warp> make_warp(const Arguments& arguments) {
  const auto calibration = calvin::parse_calibration_setting(arguments.calibration);
  if (!calibration) return tl::unexpected(calibration.error());
  const calvin::ImageSize size =
      arguments.input == calvin::ImageSize{} ? calibration->image_size : arguments.input;
  if (size == calvin::ImageSize{}) {
    return calvin::make_error(calvin::ErrorCode::kInvalidArgument,
                              "The calibration does not say its size: add --input WxH.");
  }
  auto fitted = calvin::fit_to_frame(*calibration, size);
  if (!fitted) return tl::unexpected(fitted.error());
  auto view = calvin::output_view(fitted->camera, arguments.view);
  if (!view) return tl::unexpected(view.error());
  return Warp{std::move(fitted->camera), arguments.view, *std::move(view)};
}

// Whether the files to write are two and none that is read or holds something of ours.
calvin::Status check_outputs(const Arguments& arguments) {
  std::vector<output_files::Output> outputs;
  for (const std::string& file : arguments.files) outputs.push_back({file, {}});
  return output_files::check(outputs, {{arguments.calibration}}, kUsage);
}

int export_all(const Arguments& arguments) {
  if (const auto good = check_outputs(arguments); !good) return failed(good.error());
  const auto warp = make_warp(arguments);
  if (!warp) return failed(warp.error());
  if (warp->view.limited) {
    fmt::print(stderr,
               "calvin-export-warp: the view is wider than its projection shows, and limited.\n");
  }
  for (std::size_t i = 0; i < arguments.files.size(); ++i) {
    const auto bytes = arguments.format->files[i](*warp);
    if (!bytes) return failed(bytes.error());
    if (const auto done = calvin::write_file(arguments.files[i], *bytes); !done) {
      return failed(done.error());
    }
    fmt::print("{}: {}, {}x{} px from {}x{} px\n", arguments.files[i], arguments.format->name,
               warp->output().width, warp->output().height, warp->input().width,
               warp->input().height);
  }
  return 0;
}

int run_tool(int argc, char** argv) {
  const std::span<char*> words(argv + 1, static_cast<std::size_t>(std::max(0, argc - 1)));
  if (std::any_of(words.begin(), words.end(), [](std::string_view w) { return w == "--help"; })) {
    fmt::print("{}", kUsage);
    return 0;
  }
  Arguments arguments;
  if (const std::string why = parse(words, arguments); !why.empty()) return wrong_usage(why);
  return export_all(arguments);
}

}  // namespace

int main(int argc, char** argv) {
  return calvin_tools::run("calvin-export-warp", run_tool, argc, argv);
}
