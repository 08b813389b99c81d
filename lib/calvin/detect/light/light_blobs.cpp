// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Links each run with those of the row above, and adds up what the runs of a blob hold.

#include "calvin/detect/light/light_blobs.hpp"

#include <numeric>

namespace calvin::detect {

std::size_t BlobJoiner::root_of(std::size_t run) {
  while (parent_[run] != run) {
    parent_[run] = parent_[parent_[run]];
    run = parent_[run];
  }
  return run;
}

void BlobJoiner::link_rows(const std::vector<BrightRun>& runs) {
  std::size_t above = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const BrightRun& run = runs[i];
    while (runs[above].row < run.row - 1 ||
           (runs[above].row == run.row - 1 && runs[above].last < run.first - 1)) {
      ++above;
    }
    for (std::size_t k = above; runs[k].row == run.row - 1 && runs[k].first <= run.last + 1; ++k) {
      parent_[root_of(k)] = root_of(i);
    }
  }
}

const std::vector<LightBlob>& BlobJoiner::join(const ImageView& image,
                                               const LightBackground& background,
                                               const std::vector<BrightRun>& runs) {
  parent_.resize(runs.size());
  std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  blob_.resize(runs.size());
  blobs_.clear();
  link_rows(runs);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (root_of(i) != i) continue;
    blob_[i] = blobs_.size();
    blobs_.push_back({{image.width, image.height, -1, -1}});
  }
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const BrightRun& run = runs[i];
    LightBlob& blob = blobs_[blob_[root_of(i)]];
    blob.box = {std::min(blob.box.left, run.first), std::min(blob.box.top, run.row),
                std::max(blob.box.right, run.last), std::max(blob.box.bottom, run.row)};
    for (int x = run.first; x <= run.last; ++x) {
      const int above = image.at(x, run.row) - background.level(x, run.row);
      ++blob.pixels;
      blob.peak = std::max(blob.peak, above);
      blob.flux += above;
    }
  }
  return blobs_;
}

}  // namespace calvin::detect
