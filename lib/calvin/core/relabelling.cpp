// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Prints and parses the text of a relabelling, as messages, metas and files have it.

#include "calvin/core/observation.hpp"

#include <fmt/format.h>

#include "calvin/core/text.hpp"

namespace calvin {

namespace {

constexpr std::string_view kTurn = "rotate";
constexpr std::string_view kShift = "shift(";

bool parse_turn(std::string_view word, Relabelling& to) {
  const auto degrees = parse_int(word.substr(kTurn.size()));
  if (!degrees || *degrees % 90 != 0 || *degrees < 90 || *degrees > 270) return false;
  to.quarter_turns = *degrees / 90;
  return true;
}

bool parse_shift(std::string_view word, Relabelling& to) {
  if (!word.ends_with(')')) return false;
  word.remove_prefix(kShift.size());
  word.remove_suffix(1);
  const auto numbers = split(word, ',');
  if (numbers.size() != 2) return false;
  const auto cols = parse_int(numbers[0]);
  const auto rows = parse_int(numbers[1]);
  if (!cols || !rows) return false;
  to.cols = *cols;
  to.rows = *rows;
  return true;
}

}  // namespace

std::string to_text(const Relabelling& relabelling) {
  constexpr int kWhole = 4;  // quarters of a whole turn
  const auto& [quarter_turns, cols, rows] = relabelling;
  const int turns = (quarter_turns % kWhole + kWhole) % kWhole;
  std::string text = turns == 0 ? "" : fmt::format("{}{}", kTurn, 90 * turns);
  if (cols == 0 && rows == 0) return text;
  if (!text.empty()) text += ' ';
  return text + fmt::format("{}{},{})", kShift, cols, rows);
}

std::optional<Relabelling> parse_relabelling(std::string_view text) {
  Relabelling relabelling;
  if (text.empty()) return relabelling;
  for (const std::string_view word : split(text, ' ')) {
    const bool good = word.starts_with(kTurn)    ? parse_turn(word, relabelling)
                      : word.starts_with(kShift) ? parse_shift(word, relabelling)
                                                 : false;
    if (!good) return std::nullopt;
  }
  // Each text has one meaning, and each meaning one text.
  if (to_text(relabelling) != text) return std::nullopt;
  return relabelling;
}

}  // namespace calvin
