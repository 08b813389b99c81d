// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The methods of the tools that came before, by name: each is a start of its own, which the least
// squares of solve() refines. docs/methods.md tells which tool had which.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "calvin/camera/camera.hpp"
#include "calvin/core/result.hpp"
#include "calvin/solve/methods/method_result.hpp"
#include "calvin/solve/options.hpp"

namespace calvin {

// "bakstein", "dlt" ...
[[nodiscard]] const std::vector<std::string_view>& method_names();

// Whether the method makes its camera of one view, and refuses several.
[[nodiscard]] bool takes_one_view(std::string_view method);

// The names of the methods that take views of a stream, which are several.
[[nodiscard]] std::vector<std::string_view> methods_of_several_views();

// kInvalidArgument for a name that is none of these: the message shows them.
[[nodiscard]] Status check_method(std::string_view method);

// Whether the least squares of solve() follow a method: not where it knows no focal length, which
// they would have to. True for a name that is none.
[[nodiscard]] bool is_refined(std::string_view method);

// The options by which solve() takes the own steps of a method of which one is a least squares:
// over all corners, in its own model. Absent where they are refined, and for other methods.
[[nodiscard]] std::optional<SolveOptions> own_least_squares(const SolveOptions& options);

// What a method adds to the remarks of a camera that was solved by it, refined or not.
[[nodiscard]] std::optional<std::string> closing_remark(std::string_view method,
                                                        const Camera& camera);

// What a method is told of the options: skew, and which of `fix` it may make use of.
[[nodiscard]] MethodInput method_input(std::span<const PointSet> views, ImageSize size,
                                       const SolveOptions& options);

// What the method makes of the views. kDegenerate where it finds no camera: the message says what
// to do.
[[nodiscard]] Result<MethodResult> run_method(std::string_view method, const MethodInput& input);

}  // namespace calvin
