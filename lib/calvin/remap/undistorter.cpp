// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/remap/undistorter.hpp"

#include <algorithm>
#include <cmath>

namespace calvin {

namespace {

// Inside the picture as a viewer sees it: to the outer edges of the border pixels.
std::optional<Pixel> within(std::optional<Pixel> pixel, ImageSize size) {
  if (pixel && pixel->u >= -0.5 && pixel->v >= -0.5 && pixel->u <= size.width - 0.5 &&
      pixel->v <= size.height - 0.5) {
    return pixel;
  }
  return std::nullopt;
}

// How much longer lengths become around a pixel on the way from one camera to another: the square
// root of the change of area.
double magnification(const Camera& from, const Camera& to, Pixel at, Pixel image) {
  const auto right = transfer(from, to, {at.u + 0.5, at.v});
  const auto below = transfer(from, to, {at.u, at.v + 0.5});
  if (!right || !below) return 1;
  return 2 * std::sqrt(std::abs((right->u - image.u) * (below->v - image.v) -
                                (right->v - image.v) * (below->u - image.u)));
}

}  // namespace

Result<Undistorter> Undistorter::make(const Camera& source, const ViewOptions& options,
                                      std::vector<PlaneLayout> planes,
                                      const std::stop_token& stop) {
  const auto output = output_camera(source, options);
  if (!output) return tl::unexpected(output.error());
  Undistorter result(source, *output);
  std::vector<PlaneSites> known;
  for (const PlaneLayout& layout : planes) {
    const auto it = std::find(known.begin(), known.end(), layout.sites());
    result.planes_.push_back({layout, static_cast<std::size_t>(it - known.begin())});
    if (it != known.end()) continue;
    auto map = RemapMap::build(source, *output, layout.sites(), stop);
    if (!map) return tl::unexpected(map.error());
    result.maps_.push_back(*std::move(map));
    known.push_back(layout.sites());
  }
  return result;
}

void Undistorter::apply(std::size_t plane, PlaneMemory<const std::uint8_t> source,
                        PlaneMemory<std::uint8_t> output) const noexcept {
  const Plane& p = planes_[plane];
  remap_plane(maps_[p.map], p.layout, source, output);
}

std::optional<Pixel> Undistorter::to_output(Pixel source) const noexcept {
  return within(transfer(source_, output_, source), output_.image_size());
}

std::optional<Pixel> Undistorter::to_source(Pixel output) const noexcept {
  return within(transfer(output_, source_, output), source_.image_size());
}

Observation Undistorter::to_output(const Observation& observation) const {
  Observation mapped = observation;
  mapped.image_size = output_.image_size();
  mapped.ids.clear();
  mapped.uv.clear();
  mapped.sigma.clear();
  for (std::size_t i = 0; i < observation.uv.size(); ++i) {
    const auto pixel = to_output(observation.uv[i]);
    if (!pixel) continue;
    mapped.ids.push_back(observation.ids[i]);
    mapped.uv.push_back(*pixel);
    mapped.sigma.push_back(observation.sigma[i] *
                           magnification(source_, output_, observation.uv[i], *pixel));
  }
  return mapped;
}

}  // namespace calvin
