// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The search of a picture for sheets of several boards, in one pass through its pyramid.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/detect/checkerboard/board_match.hpp"
#include "calvin/detect/checkerboard/board_search.hpp"
#include "calvin/detect/checkerboard/code/code_match.hpp"
#include "calvin/detect/checkerboard/code/pattern.hpp"
#include "calvin/detect/checkerboard/fits/fit_grid.hpp"
#include "calvin/detect/checkerboard/fits/refine.hpp"
#include "calvin/detect/checkerboard/lattice.hpp"
#include "calvin/detect/checkerboard/sheets/board_refinement.hpp"
#include "calvin/detect/checkerboard/sheets/lattice_area.hpp"
#include "calvin/detect/checkerboard/sheets/sheet.hpp"
#include "calvin/detect/checkerboard/sheets/wanted_boards.hpp"
#include "calvin/detect/pyramid.hpp"

namespace calvin::detect {

// A checkerboard of another size than all that are wanted.
struct OtherBoard {
  int cols = 0;
  int rows = 0;
  bool certain = false;  // its edges are in view on all sides
  std::string text;      // where its code tells it
};

// Keeps its memory from one image to the next.
class SheetSearch {
 public:
  // `wanted` are boards that differ.
  explicit SheetSearch(std::vector<WantedBoard> wanted);

  [[nodiscard]] const std::vector<WantedBoard>& wanted() const { return wanted_; }

  // Begins with another image, in which no sheet was found yet. It has to stay until the end.
  void begin(const ImageView& image);

  // For a sheet that is expected at a place: prediction() is to be set to where its corners will
  // be. True where all of it is there; it is the last of sheets() then. `before` are fits of the
  // same lattice in the frame before, or empty.
  [[nodiscard]] Lattice& prediction() { return lattice_; }
  [[nodiscard]] bool confirm_prediction(std::size_t wanted, const FitGrid& before);

  // Whether every sheet that is wanted was found.
  [[nodiscard]] bool is_complete() const { return missing() == 0; }

  // Adds the sheets that were not found yet, each in the coarsest level that shows it, until none
  // is missing; further sheets that such a level shows, too. A `thorough` search for further sheets
  // takes one level more. False where it was stopped.
  [[nodiscard]] bool run(bool thorough, const std::stop_token& stop);

  [[nodiscard]] std::span<Sheet> sheets() { return {sheets_.data(), sheet_count_}; }
  [[nodiscard]] std::span<const Sheet> sheets() const { return {sheets_.data(), sheet_count_}; }
  // The largest board of another size that the last search has seen.
  [[nodiscard]] std::optional<OtherBoard> other() const;

 private:
  // A lattice that is a part of a board, as far as was seen.
  struct Part {
    Part(int reach, const Surroundings& surroundings) : lattice(reach, surroundings) {}
    Lattice lattice;  // px of the image
    Match match;
    std::size_t wanted = 0;
    int level = 0;  // where it was seen first
  };

  [[nodiscard]] std::span<Part> parts() { return {parts_.data(), part_count_}; }
  [[nodiscard]] int missing() const;
  [[nodiscard]] int missing(std::size_t wanted) const;
  // How many corners have to be linked in a level, to be looked at as a further sheet.
  [[nodiscard]] int least_group() const;
  void search_level(int level);
  void search_level(int level, const SearchOptions& options);
  [[nodiscard]] bool may_be_blurred(int level) const;
  // `lattice_` in px of the level.
  void look_at_lattice(int level);
  // `lattice_` in px of the image; `enough` as in BoardSearch::complete().
  void complete_in_image(int enough);
  [[nodiscard]] bool is_far_larger_than_all() const;
  // What `lattice_` in px of the image is then.
  [[nodiscard]] OtherBoard far_larger_board();
  // The board `wanted` over a lattice in px of the image.
  [[nodiscard]] Match match(std::size_t wanted, Lattice& lattice);
  // Sets `match_` and `match_wanted_` to the board that explains `lattice_` best.
  void match_boards();
  [[nodiscard]] bool is_better(const Match& match, std::size_t wanted) const;
  void note_part(int level);
  [[nodiscard]] bool is_large(const Part& part) const;
  [[nodiscard]] bool is_rest_hidden(const Part& part, int level) const;
  // Whether another level is of no use.
  [[nodiscard]] bool is_done(int level) const;
  void sort_parts();
  void accept_parts();
  // Whether a lattice, in px of a level, is (a part of) a sheet that was found already.
  [[nodiscard]] bool is_taken(const Lattice& lattice, int level) const;
  // Whether `lattice_`, in px of a level, is part of another board that a smaller level has seen.
  [[nodiscard]] bool is_known_other(int level) const;
  // Notes that `lattice_`, in px of the image, is a board of another size, or may be a part of one.
  // False where a larger one was noted.
  bool note_other(const OtherBoard& size, bool sure);
  [[nodiscard]] bool accept(std::size_t wanted, Match match, Lattice& lattice);
  void add_sheet(std::size_t wanted, const Match& match, const Lattice& lattice, bool searched);

  std::vector<WantedBoard> wanted_;
  int reach_;
  Surroundings surroundings_;
  int most_points_;  // of a board
  ImageView image_;
  Pyramid pyramid_;
  BoardSearch search_;
  Refinement refinement_;
  BoardRefinement board_refinement_;
  CodeMatch code_match_;
  Lattice lattice_;
  Lattice trial_;  // of a board, where there are several
  Lattice best_;
  Match match_;
  std::size_t match_wanted_ = 0;
  std::vector<Sheet> sheets_;  // the first `sheet_count_`; the others are memory
  std::size_t sheet_count_ = 0;
  std::vector<Part> parts_;  // the first `part_count_`, likewise
  std::size_t part_count_ = 0;
  LatticeArea other_area_;
  Lattice other_;               // the largest lattice of another board, in px of the image
  bool other_is_sure_ = false;  // whether other_ is no part of a board that is looked for
  OtherBoard other_size_;
};

}  // namespace calvin::detect
