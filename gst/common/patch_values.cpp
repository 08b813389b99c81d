// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Puts patches into a GstStructure, and takes them out where their sizes agree with each other and
// with the number of corners.

#include "common/patch_values.hpp"

#include <vector>

#include "common/values.hpp"

namespace calvin::gst {

namespace {

constexpr int kLargestSide = 1024;  // px

}  // namespace

void set_patches(GstStructure* structure, const std::shared_ptr<const CornerPatches>& patches) {
  if (!patches) return;
  std::vector<int> origin;
  for (const auto& [x, y] : patches->origin) {
    origin.push_back(x);
    origin.push_back(y);
  }
  const auto side = static_cast<gsize>(patches->side);
  using Owner = std::shared_ptr<const CornerPatches>;
  GBytes* pixels = g_bytes_new_with_free_func(
      patches->pixels.get(), patches->origin.size() * side * side,
      [](gpointer owner) { delete static_cast<Owner*>(owner); }, new Owner(patches));
  gst_structure_set(structure, "patch-side", G_TYPE_INT, patches->side, "patches", G_TYPE_BYTES,
                    pixels, nullptr);
  g_bytes_unref(pixels);
  set_ints(structure, "patch-origin", origin);
}

std::shared_ptr<const CornerPatches> get_patches(const GstStructure* structure,
                                                 std::size_t corners) {
  const GValue* value = gst_structure_get_value(structure, "patches");
  auto patches = std::make_shared<CornerPatches>();
  gst_structure_get_int(structure, "patch-side", &patches->side);
  const std::vector<int> origin = get_ints(structure, "patch-origin");
  if (value == nullptr || !G_VALUE_HOLDS(value, G_TYPE_BYTES) ||
      g_value_get_boxed(value) == nullptr || patches->side < 1 || patches->side > kLargestSide ||
      origin.size() != 2 * corners) {
    return nullptr;
  }
  for (std::size_t i = 0; i < corners; ++i) {
    patches->origin.push_back({origin[2 * i], origin[2 * i + 1]});
  }
  gsize size = 0;
  auto* bytes = static_cast<GBytes*>(g_value_dup_boxed(value));
  const auto* pixels = static_cast<const std::uint8_t*>(g_bytes_get_data(bytes, &size));
  patches->pixels = {pixels, [bytes](const std::uint8_t* /*pixels*/) { g_bytes_unref(bytes); }};
  const auto side = static_cast<gsize>(patches->side);
  if (pixels == nullptr || size != corners * side * side) return nullptr;
  return patches;
}

void remove_patches(GstStructure* structure) {
  gst_structure_remove_fields(structure, "patches", "patch-side", "patch-origin", nullptr);
}

}  // namespace calvin::gst
