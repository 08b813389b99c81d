// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-solve: views from files of observations, pictures or rows of points.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/image.hpp"
#include "calvin/io/point_rows.hpp"
#include "calvin/solve/view.hpp"

#include "rig_views.hpp"

namespace solve_views {

// How rows of points are read.
struct RowsOptions {
  std::string points;  // a file of the points, whose places alone stand in the others; or empty
  calvin::PointRowsFormat point_format;
  calvin::PointRowsFormat format;
  std::optional<calvin::ImageSize> size;
  std::optional<double> diameter;  // m, of dots of rows without one
  // What is done to what is found in pictures; null: it is taken as it is.
  rig_views::OnFound on_found = nullptr;
  // Whether u and v count from the corner of the top-left pixel, and not from its centre.
  bool from_corner = false;
};

struct NamedView {
  // Its number in the list of all, and where it has one the name of its file, or its time.
  std::string name;
  calvin::View view;
};
using NamedViews = std::vector<NamedView>;

inline std::string name_of(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

inline calvin::Result<std::vector<calvin::PointRow>> read_rows(
    const std::string& path, const calvin::PointRowsFormat& format, const RowsOptions& options) {
  auto rows = calvin::read_point_rows(path, format);
  if (!rows || !options.diameter) return rows;
  for (calvin::PointRow& row : *rows) {
    if (row.diameter == 0) row.diameter = *options.diameter;
  }
  return rows;
}

// The place of every point of a board, in the order of its rows or by their ids.
inline calvin::Result<calvin::View> view_of(const std::vector<calvin::PointRow>& rows,
                                            const calvin::Board& board, const RowsOptions& options,
                                            const std::string& path) {
  const double shift = options.from_corner ? 0.5 : 0;
  calvin::View view;
  view.board = board;
  calvin::Observation& seen = view.observation;
  seen.board = board.text();
  seen.image_size = options.size.value();
  const std::vector<int> ids = board.ids();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!rows[i].seen) {
      return calvin::make_error(calvin::ErrorCode::kMalformed,
                                fmt::format("'{}' has no places in a picture: its rows need u and "
                                            "v; give --columns, as in --columns X,Y,Z,u,v.",
                                            path));
    }
    if (!rows[i].id && i >= ids.size()) {
      return calvin::make_error(
          calvin::ErrorCode::kMalformed,
          fmt::format("'{}' has {} rows for {} points.", path, rows.size(), ids.size()));
    }
    seen.ids.push_back(rows[i].id.value_or(i < ids.size() ? ids[i] : 0));
    seen.uv.push_back({rows[i].seen->u - shift, rows[i].seen->v - shift});
    if (rows[i].sigma) seen.sigma.push_back(*rows[i].sigma);
  }
  return view;
}

// A text file of rows: one view.
inline calvin::Result<NamedView> from_rows(const std::string& path, const RowsOptions& options,
                                           const std::optional<calvin::Board>& points) {
  if (const auto there = calvin::read_file(path); !there) {
    return tl::unexpected<calvin::Error>(there.error());
  }
  if (!options.size) {
    return calvin::make_error(
        calvin::ErrorCode::kInvalidArgument,
        fmt::format("'{}' is taken for rows of points, which do not say how large the picture is: "
                    "give --size, as in --size 640x480. Pictures go into a folder.",
                    path));
  }
  calvin::PointRowsFormat format = options.format;
  if (points && format.columns.empty()) {
    format.columns = {{calvin::PointField::kU}, {calvin::PointField::kV}};
  }
  const auto rows = read_rows(path, format, options);
  if (!rows) return tl::unexpected<calvin::Error>(rows.error());
  const auto board =
      points ? calvin::Result<calvin::Board>(*points) : calvin::board_of_rows(*rows, name_of(path));
  if (!board) return tl::unexpected<calvin::Error>(board.error());
  auto view = view_of(*rows, *board, options, path);
  if (!view) return tl::unexpected<calvin::Error>(view.error());
  return NamedView{name_of(path), *std::move(view)};
}

// Whether a file holds observations, which begin with an object.
inline bool are_observations(const std::string& path) {
  return path.ends_with(".jsonl") || path.ends_with(".json");
}

// The names of pictures by the times that their views are given; none for a file of observations.
inline std::map<std::uint64_t, std::string> pictures_by_time(const std::string& source) {
  std::map<std::uint64_t, std::string> names;
  if (!rig_views::are_pictures(source)) return names;
  for (const auto& [number, file] : rig_views::pictures_of(source)) {
    names.emplace(number * rig_views::kNumber, file.filename().string());
  }
  return names;
}

// Whether views that say their size are of the one that --size gives, if it does.
inline calvin::Status check_size(const std::string& source, const std::vector<calvin::View>& views,
                                 const RowsOptions& options) {
  if (!options.size || calvin::check_sizes(views, *options.size)) return {};
  const calvin::ImageSize seen = views.front().observation.image_size;
  return calvin::make_error(
      calvin::ErrorCode::kInvalidArgument,
      fmt::format("The views of '{}' are of images of {}x{} px, and --size is {}x{}: leave it out, "
                  "or give their own. Rows of points alone need it.",
                  source, seen.width, seen.height, options.size->width, options.size->height));
}

// The views of one of the arguments.
inline calvin::Result<NamedViews> of(const std::string& source, const std::string& board,
                                     const RowsOptions& options,
                                     const std::optional<calvin::Board>& points) {
  NamedViews named;
  if (rig_views::are_pictures(source) || are_observations(source)) {
    auto views = rig_views::read(source, board, options.on_found);
    if (!views) return tl::unexpected<calvin::Error>(views.error());
    if (const auto sized = check_size(source, *views, options); !sized) {
      return tl::unexpected<calvin::Error>(sized.error());
    }
    const auto files = pictures_by_time(source);
    for (calvin::View& view : *views) {
      const auto at = view.observation.timestamp;
      const auto file = files.find(at);
      std::string name;
      if (file != files.end()) {
        name = file->second;
      } else if (at != calvin::kNoTimestamp) {
        name = fmt::format("{:.3f} s", 1e-9 * static_cast<double>(at));
      }
      named.push_back({std::move(name), std::move(view)});
    }
    return named;
  }
  auto view = from_rows(source, options, points);
  if (!view) return tl::unexpected<calvin::Error>(view.error());
  named.push_back(*std::move(view));
  return named;
}

// Those of all of them.
inline calvin::Result<NamedViews> read(const std::vector<std::string>& sources,
                                       const std::string& board, const RowsOptions& options) {
  std::optional<calvin::Board> points;
  if (!options.points.empty()) {
    const auto rows = read_rows(options.points, options.point_format, options);
    if (!rows) return tl::unexpected<calvin::Error>(rows.error());
    auto of_rows = calvin::board_of_rows(*rows, name_of(options.points));
    if (!of_rows) return tl::unexpected<calvin::Error>(of_rows.error());
    points = *std::move(of_rows);
  }
  NamedViews all;
  for (const std::string& source : sources) {
    auto views = of(source, board, options, points);
    if (!views) return views;
    for (NamedView& view : *views) {
      const std::string between = view.name.empty() ? "" : ", ";
      view.name = fmt::format("{}{}{}", all.size(), between, view.name);
      all.push_back(std::move(view));
    }
  }
  return all;
}

// Whether two views are one: the same file twice, or copies of a picture. Two pictures never show a
// board at the very same places.
inline bool are_same(const calvin::View& a, const calvin::View& b) {
  const calvin::Observation& one = a.observation;
  const calvin::Observation& other = b.observation;
  const auto is_at = [](const calvin::Pixel& p, const calvin::Pixel& q) {
    return p.u == q.u && p.v == q.v;
  };
  return std::ranges::equal(one.uv, other.uv, is_at) && one.ids == other.ids &&
         one.image_size == other.image_size && a.board.points() == b.board.points();
}

// The views without those of the numbers `drop`, and without copies, which would count as if they
// were measured by themselves and make sigmas too small. Copies of what is dropped go, too.
inline calvin::Result<NamedViews> kept_of(const NamedViews& all,
                                          const std::vector<std::size_t>& drop) {
  for (const std::size_t number : drop) {
    if (number < all.size() || all.empty()) continue;
    return calvin::make_error(
        calvin::ErrorCode::kInvalidArgument,
        fmt::format("There is no view {} to --drop: there are {}, numbered from 0 to {}.", number,
                    all.size(), all.size() - 1));
  }
  std::vector<std::size_t> different;
  NamedViews kept;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto first = std::ranges::find_if(
        different, [&](std::size_t k) { return are_same(all[k].view, all[i].view); });
    if (first != different.end()) {
      fmt::print("view {} is the same as view {}, and counts once\n", all[i].name,
                 all[*first].name);
      continue;
    }
    different.push_back(i);
    if (std::ranges::find(drop, i) == drop.end()) kept.push_back(all[i]);
  }
  return kept;
}

}  // namespace solve_views
