// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Parses `fx=..,fy=..,width=..`; every wrong key or number is named in the error.

#include "calvin/io/key_list.hpp"

#include <algorithm>
#include <array>
#include <map>

#include <fmt/format.h>

#include "calvin/camera/camera.hpp"
#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"

namespace calvin {

namespace {

constexpr std::string_view kExample =
    "A right text is 'fx=520,fy=518,cx=325,cy=236,k1=-0.28,k2=0.09,width=640,height=480'.";

// What a list without `model` may mean. k4 says nothing: fisheye has one, and others do.
constexpr std::array<std::string_view, 3> kGuesses = {"pinhole", "brown4", "brown5"};

using Keys = std::map<std::string_view, std::string_view>;

tl::unexpected<Error> wrong(std::string_view why, ErrorCode code = ErrorCode::kInvalidArgument) {
  return make_error(
      code, fmt::format("The calibration text is wrong: {}. {}", shortened(why, 300), kExample));
}

Result<Keys> split_keys(std::string_view text) {
  Keys keys;
  for (const std::string_view field : split(text, ',')) {
    const auto equals = field.find('=');
    if (equals == std::string_view::npos) {
      return wrong(fmt::format("'{}' is not name=value", shortened(field, 40)));
    }
    const auto key = trim(field.substr(0, equals));
    if (!keys.emplace(key, trim(field.substr(equals + 1))).second) {
      return wrong(fmt::format("'{}' occurs twice", key));
    }
  }
  return keys;
}

bool knows(std::string_view model, std::string_view key) {
  const auto names = parameter_names(model);
  return key == "skew" || std::find(names.begin(), names.end(), key) != names.end();
}

// Takes `model` out of the keys.
Result<std::string> take_model(Keys& keys) {
  if (const auto it = keys.find("model"); it != keys.end()) {
    std::string model(it->second);
    keys.erase(it);
    const auto& known = model_names();
    if (std::find(known.begin(), known.end(), model) == known.end()) {
      return wrong(fmt::format("there is no camera model '{}'; there are {}", shortened(model, 40),
                               join(known, ", ")),
                   ErrorCode::kUnsupported);
    }
    return model;
  }
  for (const std::string_view model : kGuesses) {
    if (std::all_of(keys.begin(), keys.end(), [&](auto& k) { return knows(model, k.first); })) {
      return std::string(model);
    }
  }
  const std::string_view largest = kGuesses.back();
  const auto unknown =
      std::find_if(keys.begin(), keys.end(), [&](auto& k) { return !knows(largest, k.first); });
  return wrong(fmt::format("'{}' is not of {} ({}) and no model is named (model=fisheye)",
                           shortened(unknown->first, 40), largest,
                           join(parameter_names(largest), " ")));
}

// Takes `width` and `height` out of the keys; 0x0 where neither is there.
Result<ImageSize> take_size(Keys& keys) {
  ImageSize size;
  if (keys.contains("width") != keys.contains("height")) {
    return wrong("width and height belong together");
  }
  for (const auto& [key, side] : {std::pair("width", &size.width), {"height", &size.height}}) {
    const auto it = keys.find(key);
    if (it == keys.end()) continue;
    const auto value = parse_int(it->second);
    if (!value || *value < 1) {
      return wrong(
          fmt::format("{} is '{}', not a number of pixels", key, shortened(it->second, 40)));
    }
    *side = *value;
    keys.erase(it);
  }
  return size;
}

Result<std::vector<Parameter>> read_parameters(const std::string& model, const Keys& keys) {
  std::vector<Parameter> parameters;
  for (const std::string_view name : parameter_names(model)) {
    parameters.push_back({std::string(name), 0, {}});
  }
  for (const std::string_view needed : {"fx", "fy", "cx", "cy"}) {
    if (!keys.contains(needed)) return wrong(fmt::format("{} is missing", needed));
  }
  if (keys.contains("skew")) parameters.push_back({"skew", 0, {}});
  for (const auto& [key, text] : keys) {
    const auto it = std::find_if(parameters.begin(), parameters.end(),
                                 [k = key](const Parameter& p) { return p.name == k; });
    if (it == parameters.end()) {
      return wrong(fmt::format("'{}' is not of the model {} ({})", shortened(key, 40), model,
                               join(parameter_names(model), " ")));
    }
    const auto value = parse_double(text);
    if (!value) {
      return wrong(fmt::format("{} is '{}', not a number", key, shortened(text, 40)));
    }
    it->value = *value;
  }
  return parameters;
}

}  // namespace

Result<Calibration> parse_key_list(std::string_view text) {
  auto keys = split_keys(text);
  if (!keys) return tl::unexpected(keys.error());
  const auto size = take_size(*keys);
  if (!size) return tl::unexpected(size.error());
  auto model = take_model(*keys);
  if (!model) return tl::unexpected(model.error());
  auto parameters = read_parameters(*model, *keys);
  if (!parameters) return tl::unexpected(parameters.error());
  Calibration calibration;
  calibration.image_size = *size;
  calibration.model = std::move(*model);
  calibration.parameters = std::move(*parameters);
  Calibration sized = calibration;
  if (sized.image_size == ImageSize{}) sized.image_size = {1, 1};
  if (const auto camera = Camera::make(sized); !camera) {
    return make_error(camera.error().code, fmt::format("{} {}", camera.error().message, kExample));
  }
  return calibration;
}

}  // namespace calvin
