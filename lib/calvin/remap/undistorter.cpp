// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Makes an undistorter, renders frames with it, and takes pixels, boxes and observations from the
// source to the output.

#include "calvin/remap/undistorter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calvin/remap/kernels/choice.hpp"
#include "calvin/remap/kernels/row_renderer.hpp"

namespace calvin {

namespace {

// The pixel, if it is inside a picture of that size: to the outer edges of the border pixels.
std::optional<Pixel> within(std::optional<Pixel> pixel, ImageSize size) {
  if (pixel && pixel->u >= -0.5 && pixel->v >= -0.5 && pixel->u <= size.width - 0.5 &&
      pixel->v <= size.height - 0.5) {
    return pixel;
  }
  return std::nullopt;
}

// How much longer lengths become around a pixel on the way from one camera to another: the square
// root of the change of area.
double magnification(const VirtualCamera& from, const VirtualCamera& to, Pixel at, Pixel image) {
  const auto right = transfer(from, to, {at.u + 0.5, at.v});
  const auto below = transfer(from, to, {at.u, at.v + 0.5});
  if (!right || !below) return 1;
  return 2 * std::sqrt(std::abs((right->u - image.u) * (below->v - image.v) -
                                (right->v - image.v) * (below->u - image.u)));
}

bool contains(const Rectangle& box, Pixel p) {
  return p.u + 0.5 >= box.x && p.u + 0.5 <= box.x + box.width && p.v + 0.5 >= box.y &&
         p.v + 0.5 <= box.y + box.height;
}

// Calls f for points along the border of a box, as far as it lies in a picture of that size: at
// least one per pixel, and the corners.
template <typename F>
void for_border(const Rectangle& box, ImageSize size, F f) {
  const double left = std::max(box.x, 0.0) - 0.5;
  const double top = std::max(box.y, 0.0) - 0.5;
  const double right = std::min(box.x + box.width, 0.0 + size.width) - 0.5;
  const double bottom = std::min(box.y + box.height, 0.0 + size.height) - 0.5;
  if (!(right > left) || !(bottom > top)) return;
  const int columns = static_cast<int>(std::ceil(right - left));
  const int rows = static_cast<int>(std::ceil(bottom - top));
  for (int i = 0; i <= columns; ++i) {
    const double u = std::lerp(left, right, static_cast<double>(i) / columns);
    f(Pixel{u, top});
    f(Pixel{u, bottom});
  }
  for (int i = 1; i < rows; ++i) {
    const double v = std::lerp(top, bottom, static_cast<double>(i) / rows);
    f(Pixel{left, v});
    f(Pixel{right, v});
  }
}

// The smallest box around points.
struct Bounds {
  double left = std::numeric_limits<double>::infinity();
  double top = left;
  double right = -left;
  double bottom = -left;

  void add(Pixel p) {
    left = std::min(left, p.u + 0.5);
    right = std::max(right, p.u + 0.5);
    top = std::min(top, p.v + 0.5);
    bottom = std::max(bottom, p.v + 0.5);
  }
  [[nodiscard]] std::optional<Rectangle> within(ImageSize size) const {
    const double x = std::max(left, 0.0);
    const double y = std::max(top, 0.0);
    const double width = std::min(right, 0.0 + size.width) - x;
    const double height = std::min(bottom, 0.0 + size.height) - y;
    if (!(width > 0) || !(height > 0)) return std::nullopt;
    return Rectangle{x, y, width, height};
  }
};

}  // namespace

Result<Undistorter> Undistorter::make(const Camera& source, const ViewOptions& options,
                                      const std::vector<PlaneLayout>& planes,
                                      const std::stop_token& stop) {
  const auto view = output_view(source, options);
  if (!view) return tl::unexpected(view.error());
  return make(source, *view, planes, stop);
}

Result<Undistorter> Undistorter::make_back(const Camera& camera, const ViewOptions& options,
                                           const std::vector<PlaneLayout>& planes,
                                           const std::stop_token& stop) {
  const auto view = output_view(camera, options);
  if (!view) return tl::unexpected(view.error());
  return make_back(camera, *view, planes, stop);
}

Result<Undistorter> Undistorter::make(const Camera& source, const OutputView& view,
                                      const std::vector<PlaneLayout>& planes,
                                      const std::stop_token& stop) {
  return between({VirtualCamera(source), view.camera, view.limited}, planes, stop);
}

Result<Undistorter> Undistorter::make_back(const Camera& camera, const OutputView& view,
                                           const std::vector<PlaneLayout>& planes,
                                           const std::stop_token& stop) {
  return between({view.camera, VirtualCamera(camera), view.limited}, planes, stop);
}

Result<Undistorter> Undistorter::between(Undistorter cameras,
                                         const std::vector<PlaneLayout>& planes,
                                         const std::stop_token& stop) {
  Undistorter result = std::move(cameras);
  const PixelFunction source_of = [&result](Pixel pixel) {
    return transfer(result.output_, result.source_, pixel);
  };
  auto map =
      RemapMap::build(result.source_.image_size(), result.output_.image_size(), source_of, stop);
  if (!map) return tl::unexpected(map.error());
  result.map_ = std::make_shared<const RemapMap>(*std::move(map));
  std::vector<std::pair<PlaneSites, int>> known;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const PlaneLayout& layout = planes[i];
    if (i > 0 && layout == planes[i - 1] && result.planes_.back().count < 2) {
      ++result.planes_.back().count;
      continue;
    }
    const std::pair key = {layout.sites(), pixels_per_lane_of(layout)};
    const auto it = std::find(known.begin(), known.end(), key);
    result.planes_.push_back({layout, static_cast<std::size_t>(it - known.begin()), i, 1});
    if (it != known.end()) continue;
    auto plane = PlaneMap::build(result.map_, source_of, layout.sites(), key.second, stop);
    if (!plane) return tl::unexpected(plane.error());
    result.maps_.push_back(*std::move(plane));
    known.push_back(key);
  }
  return result;
}

Undistorter::Scratch::Scratch() : rows_(std::make_unique<remap::RowScratch>()) {}
Undistorter::Scratch::~Scratch() = default;
Undistorter::Scratch::Scratch(Scratch&& other) noexcept = default;
Undistorter::Scratch& Undistorter::Scratch::operator=(Scratch&& other) noexcept = default;

void Undistorter::apply(std::size_t plane, PlaneMemory<const std::uint8_t> source,
                        PlaneMemory<std::uint8_t> output, const Sampling& sampling) const noexcept {
  remap::RowScratch scratch;
  for (const Plane& p : planes_) {
    if (plane < p.first || plane >= p.first + p.count) continue;
    const PlaneMap& map = maps_[p.map];
    remap_rows(map, p.layout, {&source, 1}, {&output, 1}, sampling, 0, map.size().height, scratch);
  }
}

void Undistorter::apply(std::span<const PlaneMemory<const std::uint8_t>> sources,
                        std::span<const PlaneMemory<std::uint8_t>> outputs,
                        const Sampling& sampling, int part, int parts) const noexcept {
  remap::RowScratch scratch;
  apply_part(sources, outputs, sampling, part, parts, scratch);
}

void Undistorter::apply(std::span<const PlaneMemory<const std::uint8_t>> sources,
                        std::span<const PlaneMemory<std::uint8_t>> outputs,
                        const Sampling& sampling, int part, int parts,
                        Scratch& scratch) const noexcept {
  apply_part(sources, outputs, sampling, part, parts, *scratch.rows_);
}

void Undistorter::apply_part(std::span<const PlaneMemory<const std::uint8_t>> sources,
                             std::span<const PlaneMemory<std::uint8_t>> outputs,
                             const Sampling& sampling, int part, int parts,
                             remap::RowScratch& scratch) const noexcept {
  for (const Plane& p : planes_) {
    const PlaneMap& map = maps_[p.map];
    const std::int64_t rows = map.size().height;
    remap_rows(map, p.layout, sources.subspan(p.first, p.count), outputs.subspan(p.first, p.count),
               sampling, static_cast<int>(rows * part / parts),
               static_cast<int>(rows * (part + 1) / parts), scratch);
  }
}

std::size_t Undistorter::map_bytes() const noexcept {
  std::size_t sum = map_->bytes();
  for (const PlaneMap& map : maps_) sum += map.bytes();
  return sum;
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
  mapped.patches.reset();
  double larger = 0;  // the sum of the corners' magnifications
  for (std::size_t i = 0; i < observation.uv.size(); ++i) {
    const auto pixel = to_output(observation.uv[i]);
    if (!pixel) continue;
    const double factor = magnification(source_, output_, observation.uv[i], *pixel);
    mapped.ids.push_back(observation.ids[i]);
    mapped.uv.push_back(*pixel);
    mapped.sigma.push_back(observation.sigma[i] * factor);
    larger += factor;
  }
  // Blur grows by the mean magnification of the corners that are left.
  mapped.blur =
      mapped.uv.empty() ? 0 : observation.blur * larger / static_cast<double>(mapped.uv.size());
  return mapped;
}

std::optional<Rectangle> Undistorter::to_output(const Rectangle& box) const {
  Bounds bounds;
  const ImageSize size = output_.image_size();
  for_border(box, source_.image_size(), [&](Pixel p) {
    if (const auto pixel = to_output(p)) bounds.add(*pixel);
  });
  // Where the picture cuts the box, its own border is the edge.
  for_border({0, 0, static_cast<double>(size.width), static_cast<double>(size.height)}, size,
             [&](Pixel p) {
               const auto pixel = to_source(p);
               if (pixel && contains(box, *pixel)) bounds.add(p);
             });
  return bounds.within(size);
}

Pixel Undistorter::nearest_source(Pixel output) const noexcept {
  if (const auto pixel = to_source(output)) return *pixel;
  const ImageSize size = output_.image_size();
  const Pixel middle = {(size.width - 1) / 2.0, (size.height - 1) / 2.0};
  Pixel found = {(source_.image_size().width - 1) / 2.0, (source_.image_size().height - 1) / 2.0};
  double low = 0;
  double high = 1;
  for (int i = 0; i < 40; ++i) {
    const double t = (low + high) / 2;
    const auto pixel =
        to_source({std::lerp(middle.u, output.u, t), std::lerp(middle.v, output.v, t)});
    (pixel ? low : high) = t;
    if (pixel) found = *pixel;
  }
  return found;
}

}  // namespace calvin
