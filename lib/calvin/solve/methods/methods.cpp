// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The table of methods.

#include "calvin/solve/methods/methods.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/solve/methods/bakstein.hpp"
#include "calvin/solve/methods/discorpy.hpp"
#include "calvin/solve/methods/dlt.hpp"
#include "calvin/solve/methods/heikkila.hpp"
#include "calvin/solve/methods/tsai.hpp"
#include "calvin/solve/methods/zhang.hpp"

namespace calvin {

namespace {

struct Method {
  std::string_view name;
  Result<MethodResult> (*run)(const MethodInput&);
  bool takes_one_view = false;
  bool is_refined = true;
  // The model of its own least squares, which are those of solve(); none: it has no such step.
  std::string_view own_model = "";
  // What it says of the camera in the end; null: nothing.
  std::string (*remark)(const Camera&) = nullptr;
};
constexpr std::array kMethods = {
    Method{"bakstein", bakstein_method},
    Method{"discorpy", discorpy_method, false, false},
    Method{"dlt", dlt_method},
    Method{"heikkila", heikkila_method, false, true, "brown4", inverse_remark},
    Method{"tsai", tsai_method, true},
    Method{"zhang", zhang_method},
};

const Method* find_method(std::string_view name) {
  const auto at = std::find_if(kMethods.begin(), kMethods.end(),
                               [name](const Method& m) { return m.name == name; });
  return at == kMethods.end() ? nullptr : &*at;
}

}  // namespace

const std::vector<std::string_view>& method_names() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all;
    for (const Method& method : kMethods) all.push_back(method.name);
    return all;
  }();
  return names;
}

bool takes_one_view(std::string_view method) {
  return std::any_of(kMethods.begin(), kMethods.end(),
                     [method](const Method& m) { return m.name == method && m.takes_one_view; });
}

std::vector<std::string_view> methods_of_several_views() {
  std::vector<std::string_view> all = method_names();
  std::erase_if(all, takes_one_view);
  return all;
}

Status check_method(std::string_view method) {
  if (find_method(method) != nullptr) return {};
  const auto& names = method_names();
  if (method.empty()) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("Without the least squares there is nothing but a method: give "
                                  "one of {}.",
                                  join(names, ", ")));
  }
  return make_error(
      ErrorCode::kInvalidArgument,
      fmt::format("The method '{}' is not known. Known methods: {}.", method, join(names, ", ")));
}

bool is_refined(std::string_view method) {
  const Method* known = find_method(method);
  return known == nullptr || known->is_refined;
}

std::optional<SolveOptions> own_least_squares(const SolveOptions& options) {
  const Method* known = find_method(options.method);
  if (options.refine || known == nullptr || known->own_model.empty()) return std::nullopt;
  SolveOptions own;
  own.model = known->own_model;
  own.camera = options.camera;
  own.max_iterations = options.max_iterations;
  own.reject_outliers = false;
  own.method = options.method;
  own.ellipse_centers = options.ellipse_centers;
  own.initial = options.initial;
  own.checks = false;
  own.warp = false;
  own.fix = options.fix;
  return own;
}

std::optional<std::string> closing_remark(std::string_view method, const Camera& camera) {
  const Method* known = find_method(method);
  if (known == nullptr || known->remark == nullptr) return std::nullopt;
  return known->remark(camera);
}

MethodInput method_input(std::span<const PointSet> views, ImageSize size,
                         const SolveOptions& options) {
  const auto fixes = [&options](std::string_view word) {
    return std::any_of(options.fix.begin(), options.fix.end(),
                       [word](const std::string& fix) { return trim(fix) == word; });
  };
  MethodInput input = {views, size, options.skew};
  input.refine = options.refine;
  input.model = options.model;
  input.reject_outliers = options.reject_outliers;
  if (options.initial) return input;
  input.centered = fixes("center") || (fixes("cx") && fixes("cy"));
  input.square = fixes("aspect") || fixes("fx=fy") || fixes("fy=fx");
  return input;
}

Result<MethodResult> run_method(std::string_view method, const MethodInput& input) {
  if (const Status known = check_method(method); !known) return tl::unexpected(known.error());
  if (input.views.empty()) {
    return make_error(ErrorCode::kDegenerate, "There is no view to calibrate from.");
  }
  return find_method(method)->run(input);
}

}  // namespace calvin
