// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The mean of the board over each pixel.

#include "calvin/synth/render.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <utility>

#include <Eigen/LU>

#include "calvin/camera/image_transform.hpp"
#include "calvin/synth/filter.hpp"
#include "calvin/synth/light_spot.hpp"
#include "calvin/synth/random.hpp"
#include "calvin/synth/rays.hpp"
#include "calvin/synth/scene.hpp"
#include "calvin/target/artwork/artwork.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin {

namespace {

using synth::Vertex;

// Positive where the camera is in front of the board.
double front_side(const SE3& camera_from_board) {
  return camera_from_board.rotation.col(2).dot(camera_from_board.translation);
}

// Takes a ray to the board plane, (x, y, 1) / distance.
Eigen::Matrix3d plane_from_ray_of(const SE3& camera_from_board) {
  Eigen::Matrix3d ray_from_plane;
  ray_from_plane << camera_from_board.rotation.col(0), camera_from_board.rotation.col(1),
      camera_from_board.translation;
  // Seen edge-on, or from a pose that is no number, there is no board.
  Eigen::Matrix3d plane_from_ray = ray_from_plane.inverse();
  if (!plane_from_ray.allFinite()) plane_from_ray.setZero();
  return plane_from_ray;
}

synth::SceneLevels levels_of(const RenderOptions& options, bool from_behind) {
  const double exposure = std::max(options.exposure, 0.0);
  // From behind, a board is a blank light card.
  return {exposure * (from_behind ? options.light : options.dark), exposure * options.light,
          exposure * options.background};
}

// Where a row of the rays meets the board plane.
struct NodeRow {
  std::vector<Eigen::Vector3d> at;  // (x, y, w) as in Vertex
  std::vector<synth::Scene::Cell> cells;

  explicit NodeRow(std::size_t count) : at(count), cells(count, synth::Scene::nothing()) {}

  void fill(const float* rays, const synth::Scene& scene, const Eigen::Matrix3d& plane_from_ray) {
    for (std::size_t i = 0; i < at.size(); ++i, rays += 3) {
      at[i] = plane_from_ray * Eigen::Map<const Eigen::Vector3f>(rays).cast<double>();
      cells[i] = at[i].z() > 0 ? scene.cell_at(at[i].x() / at[i].z(), at[i].y() / at[i].z())
                               : synth::Scene::nothing();
    }
  }
  [[nodiscard]] Vertex vertex(std::size_t i, float u, float v) const {
    return {u, v, at[i].x(), at[i].y(), at[i].z()};
  }
};

void render_row(const synth::Scene& scene, const synth::SceneLevels& levels, const NodeRow& upper,
                const NodeRow& lower, float* out, std::size_t width) {
  for (std::size_t i = 0; i < width; ++i) {
    const auto corners = [&] {
      return synth::PixelCorners{upper.vertex(i, 0, 0), upper.vertex(i + 1, 1, 0),
                                 lower.vertex(i + 1, 1, 1), lower.vertex(i, 0, 1)};
    };
    out[i] = static_cast<float>(scene.mean(
        levels, corners, {upper.cells[i], upper.cells[i + 1], lower.cells[i + 1], lower.cells[i]}));
  }
}

// Where a point of the board is seen: in the row that is taken when it is seen there.
std::optional<Pixel> project_in_row(const Camera& camera, const PoseOfRow& camera_from_board,
                                    const Eigen::Vector3d& point) {
  constexpr int kRounds = 30;
  constexpr double kClose = 1e-9;  // px
  double row = (camera.image_size().height - 1) / 2.0;
  for (int i = 0; i < kRounds; ++i) {
    const auto uv = camera.project(camera_from_board(row) * point);
    if (!uv || std::abs(uv->v - row) < kClose) return uv;
    row = uv->v;
  }
  return std::nullopt;  // it falls as fast as the rows are taken
}

// Lamps and the panes of a window, the same ones for the same number.
void add_lamps(synth::FloatImage& image, const RenderOptions& options) {
  for (int i = 0; i < options.lamps; ++i) {
    synth::Uniform random(1, static_cast<std::uint64_t>(i));
    const double across = random(2, 12);
    const double down = random(2, 12);
    const synth::LightSpot lamp = {{random(0, image.width), random(0, image.height)},
                                   across * across + options.blur * options.blur,
                                   0,
                                   down * down + options.blur * options.blur,
                                   options.exposure * options.glow};
    synth::add_light(image, [&](double /*v*/) { return std::optional(lamp); });
  }
}

}  // namespace

BoardRenderer::BoardRenderer(const Camera& camera)
    : camera_(camera), size_(camera.image_size()), rays_(synth::pixel_corner_rays(camera)) {}

const float* BoardRenderer::rays_above(int row) const {
  return rays_.data() +
         3 * (static_cast<std::size_t>(size_.width) + 1) * static_cast<std::size_t>(row);
}

GrayImage BoardRenderer::render(const Board& board, const SE3& camera_from_board,
                                const RenderOptions& options) const {
  return render_rows(
      board, [&](double /*v*/) { return camera_from_board; }, false, options);
}

GrayImage BoardRenderer::render(const Board& board, const PoseOfRow& camera_from_board,
                                const RenderOptions& options) const {
  return render_rows(board, camera_from_board, true, options);
}

GrayImage BoardRenderer::render_lights(const Board& board, const PoseOfRow& camera_from_board,
                                       bool moves, const RenderOptions& options) const {
  synth::FloatImage image(size_);
  const double exposure = std::max(options.exposure, 0.0);
  std::ranges::fill(image.pixels, static_cast<float>(exposure * options.dark));
  add_lamps(image, options);
  for (const Eigen::Vector3d& light : board.points()) {
    const auto spot_of = [&](double v) {
      return synth::light_spot(camera_, camera_from_board(v) * light, PointLight::kDiameter,
                               exposure * options.glow, options.blur);
    };
    const auto still = spot_of(0);
    synth::add_light(image, [&](double v) { return moves ? spot_of(v) : still; });
  }
  return synth::quantise(image, options.noise, options.seed);
}

// The rows from `first` to before `end`.
void BoardRenderer::paint(const synth::Scene& scene, const PoseOfRow& camera_from_sheet, bool moves,
                          const LevelsOfSide& levels_of_side, Rows rows,
                          synth::FloatImage& image) const {
  const auto width = static_cast<std::size_t>(size_.width);
  NodeRow upper(width + 1);
  NodeRow lower(width + 1);
  SE3 pose = camera_from_sheet(rows.first);
  Eigen::Matrix3d plane_from_ray = plane_from_ray_of(pose);
  lower.fill(rays_above(rows.first), scene, plane_from_ray);
  for (int y = rows.first; y < rows.end; ++y) {
    std::swap(upper, lower);
    if (moves) {
      pose = camera_from_sheet(y);
      plane_from_ray = plane_from_ray_of(pose);
      upper.fill(rays_above(y), scene, plane_from_ray);
    }
    lower.fill(rays_above(y + 1), scene, plane_from_ray);
    render_row(scene, levels_of_side(front_side(pose) < 0), upper, lower, image.row(y), width);
  }
}

// The rows in which a sheet may be seen: all of them where it moves, or parts of it are out of what
// the camera can see.
BoardRenderer::Rows BoardRenderer::rows_of(const Artwork& artwork,
                                           const PoseOfRow& camera_from_sheet, bool moves) const {
  const Rows all = {0, size_.height};
  if (moves) return all;
  const BoardArea& area = artwork.outline;
  const double around = artwork.margin;
  double top = size_.height;
  double bottom = 0;
  for (const double x : {area.left - around, area.right + around}) {
    for (const double y : {area.top - around, area.bottom + around}) {
      const auto at = camera_.project(camera_from_sheet(0) * Eigen::Vector3d(x, y, 0));
      if (!at) return all;
      top = std::min(top, at->v);
      bottom = std::max(bottom, at->v);
    }
  }
  // Sides are bent by the lens.
  const double bent = 2 + 0.1 * (bottom - top);
  const auto row = [&](double v) {
    return static_cast<int>(std::clamp(v, 0.0, static_cast<double>(size_.height)));
  };
  return {row(top - bent), row(bottom + bent)};
}

// Sheets that lie in space, the farthest one first: each is painted over those before it, by the
// share of a pixel that it covers.
void BoardRenderer::paint_cards(std::vector<PlacedArtwork> sheets,
                                const PoseOfRow& camera_from_board, bool moves,
                                const RenderOptions& options, synth::FloatImage& image) const {
  const auto front = camera_from_board(0);
  std::ranges::stable_sort(sheets, std::greater(), [&](const PlacedArtwork& sheet) {
    const BoardArea& area = sheet.artwork.outline;
    const Eigen::Vector3d middle((area.left + area.right) / 2, (area.top + area.bottom) / 2, 0);
    return (front * (sheet.board_from_sheet * middle)).norm();
  });
  std::ranges::fill(image.pixels, static_cast<float>(levels_of(options, false).background));
  synth::FloatImage ink(size_);
  synth::FloatImage cover(size_);
  for (const PlacedArtwork& sheet : sheets) {
    const synth::Scene scene(sheet.artwork);
    const auto pose = [&](double v) { return camera_from_board(v) * sheet.board_from_sheet; };
    const Rows rows = rows_of(sheet.artwork, pose, moves);
    const auto levels = [&](bool from_behind) {
      synth::SceneLevels all = levels_of(options, from_behind);
      all.background = 0;
      return all;
    };
    paint(scene, pose, moves, levels, rows, ink);
    paint(
        scene, pose, moves,
        [](bool) {
          return synth::SceneLevels{1, 1, 0};
        },
        rows, cover);
    const auto width = static_cast<std::size_t>(size_.width);
    for (std::size_t i = width * static_cast<std::size_t>(rows.first);
         i < width * static_cast<std::size_t>(rows.end); ++i) {
      image.pixels[i] = image.pixels[i] * (1 - cover.pixels[i]) + ink.pixels[i];
    }
  }
}

GrayImage BoardRenderer::render_rows(const Board& board, const PoseOfRow& camera_from_board,
                                     bool moves, const RenderOptions& options) const {
  if (board.as<PointLight>() != nullptr) {
    return render_lights(board, camera_from_board, moves, options);
  }
  synth::FloatImage image(size_);
  if (board.as<TagList>() != nullptr) {
    paint_cards(artworks_of(board), camera_from_board, moves, options, image);
  } else {
    const auto levels = [&](bool from_behind) { return levels_of(options, from_behind); };
    paint(synth::Scene(artwork_of(board)), camera_from_board, moves, levels, {0, size_.height},
          image);
  }
  synth::blur(image, options.blur);
  return synth::quantise(image, options.noise, options.seed);
}

std::uint64_t noise_seed(std::uint64_t sequence, std::uint64_t frame) noexcept {
  return synth::mix(sequence, frame);
}

GrayImage render_board(const Camera& camera, const Board& board, const SE3& camera_from_board,
                       const RenderOptions& options) {
  return BoardRenderer(camera).render(board, camera_from_board, options);
}

bool sees_face(const Board& board, const SE3& camera_from_board) {
  if (const auto* list = board.as<TagList>()) {
    return std::ranges::any_of(list->tags, [&](const TagList::Tag& tag) {
      return front_side(camera_from_board * TagList::board_from_grid(tag)) > 0;
    });
  }
  return board.as<PointLight>() != nullptr || front_side(camera_from_board) > 0;
}

Observation true_observation(const Camera& camera, const Board& board,
                             const SE3& camera_from_board) {
  return true_observation(camera, board, [&](double /*v*/) { return camera_from_board; });
}

Observation true_observation(const Camera& camera, const Board& board,
                             const PoseOfRow& camera_from_board) {
  Observation observation;
  observation.board = board.text();
  observation.image_size = camera.image_size();
  if (!sees_face(board, camera_from_board(0))) return observation;
  const auto points = board.points();
  const auto ids = board.ids();
  const auto* list = board.as<TagList>();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (list != nullptr &&
        front_side(camera_from_board(0) * TagList::board_from_grid(*list->tag_of(ids[i]))) <= 0) {
      continue;
    }
    const auto uv = project_in_row(camera, camera_from_board, points[i]);
    if (!uv || !(uv->u >= -0.5) || !(uv->v >= -0.5) || !(uv->u < camera.image_size().width - 0.5) ||
        !(uv->v < camera.image_size().height - 0.5)) {
      continue;
    }
    observation.ids.push_back(ids[i]);
    observation.uv.push_back(*uv);
    observation.sigma.push_back(0);
  }
  if (observation.found()) observation.ambiguous = board.symmetries();
  return observation;
}

Camera default_camera(ImageSize size, double field_of_view) {
  constexpr double kRadPerDegree = std::numbers::pi / 180;
  const double r = std::tan(std::clamp(field_of_view, 10 * kRadPerDegree, 110 * kRadPerDegree) / 2);
  // Beyond 70 degrees the distortion at the border grows no further: the image would fold back.
  const double s = std::min(1.0, 0.5 / (r * r));
  const std::array<double, 5> lens = {-0.25 * s, 0.08 * s * s, 6e-4, -4e-4, -0.01 * s * s * s};
  const double edge = r * (1 + r * r * (lens[0] + r * r * (lens[1] + r * r * lens[4])));
  const int width = std::clamp(size.width, 1, 65536);
  const int height = std::clamp(size.height, 1, 65536);
  const double f = std::max(width, height) / (2 * edge);
  return Camera::make("brown5", {width, height},
                      {f, 1.003 * f, coordinate_at(0.511, width), coordinate_at(0.492, height),
                       lens[0], lens[1], lens[2], lens[3], lens[4]})
      .value();
}

}  // namespace calvin
