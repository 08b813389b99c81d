// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What is in pictures besides boards, and what happens to them.
#pragma once

#include <opencv2/core.hpp>

#include "calvin/core/image.hpp"
#include "calvin/synth/random.hpp"

namespace bench {

// From low to high, both included.
[[nodiscard]] int whole(calvin::synth::Uniform& random, int low, int high);

// Lines, discs, boxes, and words.
[[nodiscard]] cv::Mat clutter(calvin::ImageSize size, calvin::synth::Uniform& random);

// By a motion of so many px; floating point.
void blur_along(cv::Mat& image, double length, double angle);

// A card from a line on, anywhere but over the board's middle.
void lay_card(cv::Mat& mask, cv::Point2d on, cv::Point2d middle, calvin::synth::Uniform& random);

// A floor of tiles to the borders, in perspective; checkered, or with joints.
void draw_tiles(cv::Mat& image, bool checkered, calvin::synth::Uniform& random);

// Two waves.
void draw_textile(cv::Mat& image, calvin::synth::Uniform& random);

// A page, or a keyboard.
void draw_page(cv::Mat& image, bool keys, calvin::synth::Uniform& random);

}  // namespace bench
