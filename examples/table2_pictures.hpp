// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Sets of views for table2 that are detected in rendered pictures, so that corners can be looked at
// again.
#pragma once

#include <utility>
#include <vector>

#include "calvin/detect/detector.hpp"
#include "calvin/detect/patches.hpp"
#include "calvin/synth/render.hpp"
#include "table2_sets.hpp"

namespace table2 {

inline std::vector<calvin::View> photograph(int views, Random& random) {
  static const calvin::BoardRenderer kRenderer(paper_camera());
  const calvin::Board board = paper_board();
  const auto detector = calvin::make_detector(board).value();
  std::vector<calvin::View> set;
  while (static_cast<int>(set.size()) < views) {
    calvin::RenderOptions options;
    options.noise = 2;
    options.blur = 1;
    options.seed = random();
    const auto image = kRenderer.render(board, random_pose(paper_camera(), board, random), options);
    calvin::View view;
    view.board = board;
    view.observation = detector->detect(image.view()).observation;
    if (!view.observation.found()) continue;
    view.observation.board = board.text();
    view.observation.image_size = kSize;
    view.observation.patches = calvin::cut_patches(image.view(), view.observation, board);
    set.push_back(std::move(view));
  }
  return set;
}

}  // namespace table2
