// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What is common to all fits of nodes: where they begin, how large their windows are, and whether
// what was fitted is a corner of the lattice.
#pragma once

#include "calvin/core/image.hpp"
#include "calvin/detect/checkerboard/corners/saddle_fit.hpp"
#include "calvin/detect/checkerboard/lattice.hpp"

namespace calvin::detect {

inline constexpr float kRoughly = 0.1F;      // px, last step of a fit that a better one follows
inline constexpr float kCloseRadius = 4.5F;  // px, of a fit with something else near it
// The ratio of a window to the one before, which had something else in it.
inline constexpr float kSmaller = 0.75F;
inline constexpr float kOfNoise = 1.4F;  // of the noise: a larger residual has another reason

inline constexpr float kFirstRadius = 8;      // px, of the first fit
inline constexpr float kMostNoise = 0.15F;    // of the contrast
inline constexpr float kLargestMove = 0.35F;  // of the spacing, between levels

// The distance from a node to the nearest of the next grid lines, px.
[[nodiscard]] float spacing_at(const Lattice& lattice, Cell c);

// The part of it that is a window's, px: all of it, where nothing is printed on the edges.
[[nodiscard]] float clear_at(const Lattice& lattice, Cell c);

// How far from the edges of a node nothing else is printed, px.
[[nodiscard]] float room_at(const Lattice& lattice, Cell c);

// The dots around a node, as far as they are known.
[[nodiscard]] EdgeDots dots_at(const Lattice& lattice, Cell c);

// The radius of the smallest window about a corner, px: half a square may lie beyond it, or less.
[[nodiscard]] float closest_radius(float spacing);

// Where the fit of a node begins.
[[nodiscard]] SaddleFit fit_of(const Node& node);

// Lets a fit begin with the widths of another one, at `least` px.
void take_widths(const SaddleFit& from, float least, SaddleFit& fit);

// fit_of() for squares that light or ink has parted, where what was fitted without that may be a
// far too wide edge.
[[nodiscard]] SaddleFit parted_fit(SaddleFit fit);

// Fits once more with squares that are parted, where the residual asks for it; keeps the better
// fit.
void fit_parted(const ImageView& image, float radius, int steps, SaddleFit& fit);

// Sets how the rows and columns run at a node, by a plane through the nodes around it; leaves it
// where these are too few.
void expect_directions(const Lattice& lattice, Cell c, ExpectedEdges& expected);

// Whether something else than a corner is in the window of a fit. `most`: noise, of the contrast.
[[nodiscard]] bool is_noisy(const SaddleFit& fit, float most);

// Whether the colours of a fit are those of its cell.
[[nodiscard]] bool colours_fit(const SaddleFit& fit, Cell c);

// From a node to where it was fitted, px.
[[nodiscard]] float distance(const SaddleFit& fit, const Node& node);

// A fit in the middle of the window of another one; its radius is 0 where that window is too small
// or where there is none.
[[nodiscard]] SaddleFit inner_fit(const ImageView& image, const SaddleFit& outer);

// Moves a node to where it was fitted.
void take(const SaddleFit& fit, Node& node);

// Moves a node to where its neighbours let it be expected, where it has one on both sides: what is
// printed next to a corner may hide it in a smaller level, and lead its fit away.
void put_between_neighbours(Lattice& lattice, Cell c);

// A fit of a node by itself, which begins with `f`; its noise is infinite where there is no corner.
[[nodiscard]] SaddleFit quick_fit(const ImageView& image, const Lattice& lattice, Cell c,
                                  float radius, SaddleFit f, int steps);

// The first fit, from where the node was found. `last` is the last one that was good, which the
// next corner is likely to look like; it has no contrast before the first.
[[nodiscard]] SaddleFit first_fit(const ImageView& image, const Lattice& lattice, Cell c,
                                  SaddleFit& last);

}  // namespace calvin::detect
