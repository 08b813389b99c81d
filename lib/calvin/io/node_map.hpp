// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Documents to be printed, put together key by key. Internal.
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/calibration.hpp"
#include "calvin/core/text.hpp"
#include "calvin/io/document.hpp"

namespace calvin::io {

[[nodiscard]] inline Node number_node(double x) {
  return {Node::Kind::kPlain, format_double(x), {}, {}};
}
template <typename Integer>
[[nodiscard]] Node integer_node(Integer x) {
  return {Node::Kind::kPlain, fmt::format("{}", x), {}, {}};
}
[[nodiscard]] inline Node text_node(std::string_view x) {
  return {Node::Kind::kString, std::string(x), {}, {}};
}

template <typename Numbers>
[[nodiscard]] Node list_node(const Numbers& values) {
  Node list = {Node::Kind::kList, {}, {}, {}};
  for (const double x : values) list.items.push_back(number_node(x));
  return list;
}

class NodeMap {
 public:
  NodeMap& put(const char* key, Node value) {
    node_.keys.emplace_back(key);
    node_.items.push_back(std::move(value));
    return *this;
  }
  // Nothing where the value is absent or not finite.
  NodeMap& put(const char* key, const std::optional<double>& value) {
    return value && std::isfinite(*value) ? put(key, number_node(*value)) : *this;
  }
  // The rows of a matrix of `size` x `size` numbers, row-major; nothing where it has others.
  NodeMap& put_rows(const char* key, const std::vector<double>& matrix, std::size_t size) {
    if (matrix.empty() || matrix.size() != size * size) return *this;
    Node rows = {Node::Kind::kList, {}, {}, {}};
    for (std::size_t r = 0; r < size; ++r) {
      const auto from = matrix.begin() + static_cast<std::ptrdiff_t>(r * size);
      rows.items.push_back(
          list_node(std::vector<double>(from, from + static_cast<std::ptrdiff_t>(size))));
    }
    return put(key, std::move(rows));
  }
  [[nodiscard]] Node take() { return std::move(node_); }

 private:
  Node node_{Node::Kind::kMap, {}, {}, {}};
};

[[nodiscard]] inline Node pose_node(const Pose& pose) {
  return NodeMap()
      .put("rotation", list_node(pose.rotation))
      .put("translation", list_node(pose.translation))
      .take();
}

}  // namespace calvin::io
