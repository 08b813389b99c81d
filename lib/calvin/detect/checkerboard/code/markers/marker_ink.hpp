// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The markers of a board as a picture shows them: taken out of the pixels, they leave the squares
// of a plain checkerboard. Where blur runs them into the edges beside them, corners can be fitted
// after that alone.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/detect/checkerboard/board_match.hpp"
#include "calvin/detect/checkerboard/code/code.hpp"
#include "calvin/detect/checkerboard/code/markers/marker_drawing.hpp"
#include "calvin/detect/checkerboard/lattice.hpp"
#include "calvin/detect/surface.hpp"

namespace calvin::detect {

// Keeps its memory.
class MarkerInk {
 public:
  // An image (of step 1) without the markers of a board that lies over a lattice in a way; edges
  // have a blur of `width` px, 1 sigma. Valid until the next call.
  [[nodiscard]] ImageView taken_off(const ImageView& image, const Code& code,
                                    const GridAlignment& alignment, const Lattice& lattice,
                                    float width);

 private:
  struct Marker {
    Cell cell;              // of the square's upper left corner
    bool is_whole = false;  // the lattice has all corners of the square
    MarkerDrawing drawing;
  };
  void take_lattice(const Lattice& lattice, const GridAlignment& alignment);
  [[nodiscard]] bool take_cells(const Code& code, const GridAlignment& alignment, Cell at);
  void draw(const Code& code, const GridAlignment& alignment, const Lattice& lattice,
            ImageSize size, float width);
  // The grey levels in the middle of a marker's square, less those of the squares beside it; and
  // the share of the square's own ground that is seen there. False where they cannot be told.
  [[nodiscard]] bool take_samples(const ImageView& image, const Lattice& lattice,
                                  const Marker& marker, float width);
  void take_contrasts(const ImageView& image, const Lattice& lattice, float width);
  void take_off(const MarkerDrawing& drawing, float contrast, const ImageView& image);
  [[nodiscard]] std::span<const Marker> markers() const {
    return std::span(markers_).first(count_);
  }

  static constexpr int kSteps = 12;
  struct Sample {
    float grey = 0;
    float ground = 0;
  };

  Lattice all_{0};  // with the nodes around the board that are expected
  MarkerCells cells_;
  std::vector<Marker> markers_;
  std::size_t count_ = 0;                                     // of markers in use
  std::array<Sample, std::size_t{kSteps} * kSteps> samples_;  // in rows
  std::optional<Surface<2>> contrasts_;                       // over the board
  std::vector<std::uint8_t> pixels_;
};

}  // namespace calvin::detect
