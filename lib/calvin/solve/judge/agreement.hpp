// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What residuals have in common from one group of views to the next. Internal.
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace calvin {

// Residuals in parts, of the image or of a board, each with the score of a shift and its
// information. Errors that the views have each for themselves, noise and bends alike, make the
// scores of two groups agree as often as disagree; what all views share makes them agree.
class Agreement {
 public:
  static constexpr std::size_t kGroups = 16;  // views are dealt out to these in turn

  explicit Agreement(std::size_t parts) : parts_(parts) {}

  void add(std::size_t group, std::size_t part, double score, double information) {
    parts_[part].score[group % kGroups] += score;
    parts_[part].information[group % kGroups] += information;
  }

  [[nodiscard]] std::size_t parts() const { return parts_.size(); }
  // Score and information of a part, of all groups.
  [[nodiscard]] std::pair<double, double> total(std::size_t part) const;

  // The sum over parts and pairs of groups of what their scores have in common, over its standard
  // deviation, which the pairs themselves tell.
  [[nodiscard]] double deviations() const;
  // The variance of what is shared: of a shift of each part, in units of (score / information)^2.
  [[nodiscard]] double variance() const;

 private:
  struct Sums {
    std::array<double, kGroups> score{};
    std::array<double, kGroups> information{};
  };
  std::vector<Sums> parts_;
};

}  // namespace calvin
