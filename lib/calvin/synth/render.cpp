// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The mean of the board over each pixel: the polygon that the pixel covers on the board is cut at
// the edges of the squares.

#include "calvin/synth/render.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/LU>

#include "calvin/synth/filter.hpp"
#include "calvin/synth/random.hpp"
#include "calvin/synth/rays.hpp"

namespace calvin {

namespace {

// A pixel's corner: its place in the pixel, and what it shows of the board plane in homogeneous
// coordinates, (x/w, y/w) in squares. These change over a pixel as the ray does, which is nearly
// linear for any lens, where x/w is not.
struct Vertex {
  float u, v;
  double x, y, w;
};

// A polygon small enough to stay on the stack; convex but for the lens's distortion in one pixel.
struct Polygon {
  std::array<Vertex, 32> vertices;
  std::size_t count = 0;

  void push(const Vertex& vertex) {
    if (count < vertices.size()) vertices[count++] = vertex;
  }
  [[nodiscard]] double area() const {
    double twice = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const Vertex& a = vertices[i];
      const Vertex& b = vertices[i + 1 < count ? i + 1 : 0];
      twice += static_cast<double>(a.u * b.v - b.u * a.v);
    }
    return std::abs(twice) / 2;
  }
};

// Cuts `all` along coordinate / w = at (Sutherland and Hodgman): the part below it and the rest.
void cut(const Polygon& all, double Vertex::*coordinate, double at, Polygon& below,
         Polygon& above) {
  below.count = 0;
  above.count = 0;
  for (std::size_t i = 0; i < all.count; ++i) {
    const Vertex& a = all.vertices[i];
    const Vertex& b = all.vertices[i + 1 < all.count ? i + 1 : 0];
    const double da = a.*coordinate - at * a.w;
    const double db = b.*coordinate - at * b.w;
    (da < 0 ? below : above).push(a);
    if ((da < 0) == (db < 0)) continue;
    const double t = da / (da - db);
    const auto tf = static_cast<float>(t);
    const Vertex crossing = {a.u + tf * (b.u - a.u), a.v + tf * (b.v - a.v), a.x + t * (b.x - a.x),
                             a.y + t * (b.y - a.y), a.w + t * (b.w - a.w)};
    below.push(crossing);
    above.push(crossing);
  }
}

// What a ray meets: square (col, row) of the board plane, counted from control point 0; -1 is the
// first square of the pattern, -2 the margin, kOutside and count + 1 all that lies beyond.
struct Square {
  int col;
  int row;
  friend bool operator==(const Square&, const Square&) = default;
};
constexpr int kOutside = -3;
constexpr int kNothing = -4;  // the ray does not meet the board plane

class Scene {
 public:
  Scene(const Board& board, const RenderOptions& options, bool from_behind)
      : cols_(board.cols), rows_(board.rows) {
    const double exposure = std::max(options.exposure, 0.0);
    dark_ = exposure * (from_behind ? options.light : options.dark);
    light_ = exposure * options.light;
    background_ = exposure * options.background;
  }

  [[nodiscard]] Square square_at(double x, double y) const {
    return {index(x, cols_), index(y, rows_)};
  }
  [[nodiscard]] double background() const { return background_; }
  [[nodiscard]] double value(Square s) const {
    if (s.col <= kOutside || s.row <= kOutside || s.col > cols_ || s.row > rows_) {
      return background_;
    }
    if (s.col < -1 || s.row < -1 || s.col == cols_ || s.row == rows_) return light_;
    return (s.col + s.row) % 2 == 0 ? dark_ : light_;
  }

  // The mean over a pixel whose corners see the squares `seen`.
  [[nodiscard]] double mean(const Polygon& pixel, const std::array<Square, 4>& seen) const {
    const auto [left, right] = std::minmax({seen[0].col, seen[1].col, seen[2].col, seen[3].col});
    const auto [top, bottom] = std::minmax({seen[0].row, seen[1].row, seen[2].row, seen[3].row});
    if (left == kNothing || left > cols_ || top > rows_ || right == kOutside ||
        bottom == kOutside) {
      return background_;
    }
    double sum = 0;
    Polygon rest = pixel, column, next;
    for (int col = left; col <= right; ++col) {
      cut(rest, &Vertex::x, col < right ? col + 1 : kFar, column, next);
      rest = next;
      Polygon piece;
      for (int row = top; row <= bottom; ++row) {
        cut(column, &Vertex::y, row < bottom ? row + 1 : kFar, piece, next);
        column = next;
        sum += piece.area() * value({col, row});
      }
    }
    return sum;
  }

 private:
  static constexpr double kFar = 1e30;
  static int index(double x, int count) {
    return static_cast<int>(std::floor(std::clamp(x, -2.5, count + 1.5)));
  }

  int cols_;
  int rows_;
  double dark_;
  double light_;
  double background_;
};

// Positive where the camera is in front of the board.
double front_side(const SE3& camera_from_board) {
  return camera_from_board.rotation.col(2).dot(camera_from_board.translation);
}

Eigen::Matrix3d plane_from_ray_of(const Board& board, const SE3& camera_from_board) {
  Eigen::Matrix3d ray_from_plane;
  ray_from_plane << board.size * camera_from_board.rotation.col(0),
      board.size * camera_from_board.rotation.col(1), camera_from_board.translation;
  // Seen edge-on, or from a pose that is no number, there is no board.
  Eigen::Matrix3d plane_from_ray = ray_from_plane.inverse();
  if (!plane_from_ray.allFinite()) plane_from_ray.setZero();
  return plane_from_ray;
}

// What a camera sees of the board from one place.
struct BoardView {
  Scene scene;
  Eigen::Matrix3d plane_from_ray;  // takes a ray to (x, y, 1) / distance

  BoardView(const Board& board, const RenderOptions& options, const SE3& camera_from_board)
      : scene(board, options, front_side(camera_from_board) < 0),
        plane_from_ray(plane_from_ray_of(board, camera_from_board)) {}
};

// Where a row of the rays meets the board plane.
struct NodeRow {
  std::vector<Eigen::Vector3d> at;  // (x, y, w) as in Vertex
  std::vector<Square> squares;

  explicit NodeRow(std::size_t count) : at(count), squares(count) {}

  void fill(const float* rays, const BoardView& view) {
    for (std::size_t i = 0; i < at.size(); ++i, rays += 3) {
      at[i] = view.plane_from_ray * Eigen::Map<const Eigen::Vector3f>(rays).cast<double>();
      squares[i] = at[i].z() > 0
                       ? view.scene.square_at(at[i].x() / at[i].z(), at[i].y() / at[i].z())
                       : Square{kNothing, kNothing};
    }
  }
  [[nodiscard]] Vertex vertex(std::size_t i, float u, float v) const {
    return {u, v, at[i].x(), at[i].y(), at[i].z()};
  }
};

void render_row(const Scene& scene, const NodeRow& upper, const NodeRow& lower, float* out,
                std::size_t width) {
  for (std::size_t i = 0; i < width; ++i) {
    const std::array<Square, 4> seen = {upper.squares[i], upper.squares[i + 1],
                                        lower.squares[i + 1], lower.squares[i]};
    if (seen[0] == seen[1] && seen[0] == seen[2] && seen[0] == seen[3]) {
      out[i] = static_cast<float>(scene.value(seen[0]));
      continue;
    }
    Polygon pixel;
    pixel.push(upper.vertex(i, 0, 0));
    pixel.push(upper.vertex(i + 1, 1, 0));
    pixel.push(lower.vertex(i + 1, 1, 1));
    pixel.push(lower.vertex(i, 0, 1));
    out[i] = static_cast<float>(scene.mean(pixel, seen));
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

}  // namespace

BoardRenderer::BoardRenderer(const Camera& camera)
    : size_(camera.image_size()), rays_(synth::pixel_corner_rays(camera)) {}

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

GrayImage BoardRenderer::render_rows(const Board& board, const PoseOfRow& camera_from_board,
                                     bool moves, const RenderOptions& options) const {
  synth::FloatImage image(size_);
  const auto width = static_cast<std::size_t>(size_.width);
  NodeRow upper(width + 1);
  NodeRow lower(width + 1);
  BoardView view(board, options, camera_from_board(0));
  lower.fill(rays_above(0), view);
  for (int y = 0; y < size_.height; ++y) {
    std::swap(upper, lower);
    if (moves) {
      view = BoardView(board, options, camera_from_board(y));
      upper.fill(rays_above(y), view);
    }
    lower.fill(rays_above(y + 1), view);
    render_row(view.scene, upper, lower, image.row(y), width);
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

Observation true_observation(const Camera& camera, const Board& board,
                             const SE3& camera_from_board) {
  return true_observation(camera, board, [&](double /*v*/) { return camera_from_board; });
}

Observation true_observation(const Camera& camera, const Board& board,
                             const PoseOfRow& camera_from_board) {
  Observation observation;
  observation.board = board.text();
  observation.image_size = camera.image_size();
  if (!(front_side(camera_from_board(0)) > 0)) return observation;
  const auto points = board.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto uv = project_in_row(camera, camera_from_board, points[i]);
    if (!uv || !(uv->u >= -0.5) || !(uv->v >= -0.5) || !(uv->u < camera.image_size().width - 0.5) ||
        !(uv->v < camera.image_size().height - 0.5)) {
      continue;
    }
    observation.ids.push_back(static_cast<int>(i));
    observation.uv.push_back(*uv);
    observation.sigma.push_back(0);
  }
  if (observation.found()) observation.ambiguous = board.symmetries();
  return observation;
}

Camera default_camera(ImageSize size, double field_of_view) {
  constexpr double kDegree = std::numbers::pi / 180;
  const double r = std::tan(std::clamp(field_of_view, 10 * kDegree, 110 * kDegree) / 2);
  // Beyond 70 degrees the distortion at the border grows no further: the image would fold back.
  const double s = std::min(1.0, 0.5 / (r * r));
  const std::array<double, 5> lens = {-0.25 * s, 0.08 * s * s, 6e-4, -4e-4, -0.01 * s * s * s};
  const double edge = r * (1 + r * r * (lens[0] + r * r * (lens[1] + r * r * lens[4])));
  const int width = std::clamp(size.width, 1, 65536);
  const int height = std::clamp(size.height, 1, 65536);
  const double f = std::max(width, height) / (2 * edge);
  return Camera::make("brown5", {width, height},
                      {f, 1.003 * f, 0.511 * width - 0.5, 0.492 * height - 0.5, lens[0], lens[1],
                       lens[2], lens[3], lens[4]})
      .value();
}

}  // namespace calvin
