// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Renders boards through any camera, with exact ground truth.
//
// Intensities are linear: grey level = exposure * reflectance, without gamma, lens shading or
// glare. A pixel is the mean of the scene over its square, to the accuracy of a straight edge
// within one pixel; edges lie where the camera's project() puts them to better than 0.002 px.
// Around a board of squares runs a light margin of one square, around that a constant background,
// which also stands where the camera model is not valid. From behind a board is a blank light card.
// The tags of a list are cards of their own, each painted over those whose middle is farther away.
//
// A light (board `dot`, and each of a `wand`) is a small ball that glows, seen from all sides:
// exactly a Gaussian in the image, in a dark room where other lamps may stand still.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "calvin/camera/camera.hpp"
#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

struct Artwork;
struct PlacedArtwork;

namespace synth {
class Scene;
struct FloatImage;
struct SceneLevels;
}  // namespace synth

struct RenderOptions {
  double noise = 0;        // grey levels, 1 sigma, Gaussian, independent from pixel to pixel
  double blur = 0;         // px, 1 sigma, Gaussian, on top of the pixel's own square; up to 50
  std::uint64_t seed = 0;  // of the noise alone
  double exposure = 1;     // factor on the grey levels below; the result is cut off at 255
  double dark = 30;        // grey levels of the scene
  double light = 220;
  double background = 128;
  // Of a light alone, before a room of the level `dark`:
  double glow = 1000;  // grey levels in its middle, without blur
  int lamps = 0;       // as bright as that, which stand still in the image at places of their own
};

// The seed of one frame's noise in a sequence: independent from frame to frame.
[[nodiscard]] std::uint64_t noise_seed(std::uint64_t sequence, std::uint64_t frame) noexcept;

// Where the board is while a row of the image is taken: a rolling shutter takes one after the
// other.
using PoseOfRow = std::function<SE3(double v)>;

// Renders many views through one camera: what depends on the camera alone is computed once.
// Immutable; safe to share between threads.
class BoardRenderer {
 public:
  explicit BoardRenderer(const Camera& camera);

  // The image is the same for the same arguments on every machine, but for a grey level in rare
  // pixels where the processor's rounding decides.
  [[nodiscard]] GrayImage render(const Board& board, const SE3& camera_from_board,
                                 const RenderOptions& options = {}) const;
  // Each row as of its own pose.
  [[nodiscard]] GrayImage render(const Board& board, const PoseOfRow& camera_from_board,
                                 const RenderOptions& options = {}) const;

 private:
  [[nodiscard]] const float* rays_above(int row) const;
  [[nodiscard]] GrayImage render_lights(const Board& board, const PoseOfRow& camera_from_board,
                                        bool moves, const RenderOptions& options) const;
  [[nodiscard]] GrayImage render_rows(const Board& board, const PoseOfRow& camera_from_board,
                                      bool moves, const RenderOptions& options) const;
  struct Rows {
    int first = 0;
    int end = 0;
  };
  // The grey levels of a sheet as it is seen from its face or from behind.
  using LevelsOfSide = std::function<synth::SceneLevels(bool from_behind)>;
  void paint(const synth::Scene& scene, const PoseOfRow& camera_from_sheet, bool moves,
             const LevelsOfSide& levels_of_side, Rows rows, synth::FloatImage& image) const;
  [[nodiscard]] Rows rows_of(const Artwork& artwork, const PoseOfRow& camera_from_sheet,
                             bool moves) const;
  void paint_cards(std::vector<PlacedArtwork> sheets, const PoseOfRow& camera_from_board,
                   bool moves, const RenderOptions& options, synth::FloatImage& image) const;

  Camera camera_;
  ImageSize size_;
  // Rays of the pixels' corners, (width + 1) * (height + 1), x y z; zero where not valid.
  std::vector<float> rays_;
};

// One view; BoardRenderer is quicker for several.
[[nodiscard]] GrayImage render_board(const Camera& camera, const Board& board,
                                     const SE3& camera_from_board,
                                     const RenderOptions& options = {});

// Whether the camera is on the side from which a board is seen; a light has no other one.
[[nodiscard]] bool sees_face(const Board& board, const SE3& camera_from_board);

// Every control point whose image is valid and inside the image, with sigma 0. Empty where the
// board turns its back.
[[nodiscard]] Observation true_observation(const Camera& camera, const Board& board,
                                           const SE3& camera_from_board);
[[nodiscard]] Observation true_observation(const Camera& camera, const Board& board,
                                           const PoseOfRow& camera_from_board);

// A plausible camera for images of any size: brown5 with mild barrel distortion, pixels not quite
// square and a principal point off the centre. `field_of_view` in rad is that of the longer side,
// kept within 10 to 110 degrees.
[[nodiscard]] Camera default_camera(ImageSize size, double field_of_view = 1.2217304763960306);

}  // namespace calvin
