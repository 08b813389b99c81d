// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-rig and calvin-light: whether files that are given for cameras are theirs, by the names of
// cameras in them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/result.hpp"
#include "calvin/solve/view.hpp"

namespace camera_names {

// A file, the camera that it says that it is of (empty: it says none), and that it is given for.
struct Use {
  std::string file;
  std::string own;
  std::string given;
};

// The camera that all views name; empty where they name several, or none.
inline std::string name_in(const std::vector<calvin::View>& views) {
  if (views.empty()) return "";
  const std::string& name = views.front().observation.camera;
  const auto is_other = [&](const calvin::View& view) { return view.observation.camera != name; };
  return std::ranges::any_of(views, is_other) ? "" : name;
}

// `how`: how they are given, as in "with the calibration of". Files that have the names of each
// other's cameras are an error. A name that merely differs is said, as cameras may have been
// renamed; one that several files have, which may be that of calibdetect, tells nothing.
inline calvin::Status check(std::vector<Use> uses, std::string_view how) {
  std::erase_if(uses, [](const Use& use) { return use.own.empty(); });
  std::multiset<std::string> own;
  std::multiset<std::string> given;
  for (const Use& use : uses) {
    own.insert(use.own);
    given.insert(use.given);
  }
  std::erase_if(uses, [&](const Use& use) { return use.own == use.given; });
  if (uses.empty()) return {};
  const Use& first = uses.front();
  if (own == given) {
    return calvin::make_error(
        calvin::ErrorCode::kInvalidArgument,
        fmt::format(
            "'{}' is of '{}', and is given {} '{}': {}.", first.file, first.own, how, first.given,
            uses.size() == 2
                ? fmt::format("exchange it and '{}'", uses.back().file)
                : fmt::format("so are {} files, each for another camera of these", uses.size())));
  }
  for (const Use& use : uses) {
    if (own.count(use.own) > 1) continue;
    fmt::print("{} is of '{}', and is given {} '{}': that is taken for the same camera.\n",
               use.file, use.own, how, use.given);
  }
  return {};
}

}  // namespace camera_names
