// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Looks for the steepest places across a side, lays a line through most of them, and gathers the
// pixels near a curve.

#include "calvin/detect/tags/side_pixels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "calvin/detect/checkerboard/corners/grey_at.hpp"

namespace calvin::detect {

namespace {

constexpr int kProfiles = 10;          // across a side
constexpr int kFewestPlaces = 4;       // of a side that leaves the image
constexpr double kLastProfile = 0.85;  // |t|

struct Steepest {
  double t = 0;
  double n = 0;
  double change = 0;  // grey levels, outwards
};

std::optional<Steepest> steepest_at(const ImageView& image, const SideFrame& frame,
                                    const SideGuess& guess, double t) {
  // Far enough for the noise, near enough for a narrow gap: the reach ends well before it.
  const double step = std::clamp(0.25 * guess.reach, 0.25, 1.0);
  constexpr std::size_t kApart = 4;  // steps between the grey levels that are compared
  const auto places = static_cast<int>(2 * guess.reach / step + 1e-9) + 1;
  const double before = guess.bend * (1 - t * t);
  Steepest best{t, 0, 0};
  std::array<std::optional<float>, kApart> last;
  for (int i = 0; i < places + static_cast<int>(kApart); ++i) {
    const double n = -guess.reach + (i - 0.5 * kApart) * step;
    const Point p = frame.at(t, before + n);
    const auto out = grey_at(image, static_cast<float>(p.x()), static_cast<float>(p.y()));
    const auto in = std::exchange(last[static_cast<std::size_t>(i) % kApart], out);
    if (!in || !out) continue;
    const double change = static_cast<double>(*out - *in) * (guess.inverted ? -1 : 1);
    if (change > best.change) best = {t, n - 0.5 * kApart * step, change};
  }
  constexpr double kLeast = 4;  // grey levels
  if (best.change < kLeast) return std::nullopt;
  return best;
}

// A line through the places that are not farther from it than the others let be expected.
std::optional<SideCurve> line_of(const std::vector<Steepest>& places, double reach, int fewest) {
  constexpr int kRounds = 4;
  SideCurve line;
  std::vector<double> all;
  for (const Steepest& p : places) all.push_back(p.n);
  std::ranges::nth_element(all, all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2));
  line.offset = all[all.size() / 2];
  double tolerance = std::max(reach, 1.0);
  for (int round = 0; round < kRounds; ++round) {
    double count = 0;
    double t1 = 0;
    double t2 = 0;
    double n1 = 0;
    double tn = 0;
    for (const Steepest& p : places) {
      if (std::abs(p.n - line.at(p.t)) > tolerance) continue;
      ++count;
      t1 += p.t;
      t2 += p.t * p.t;
      n1 += p.n;
      tn += p.t * p.n;
    }
    const double determinant = count * t2 - t1 * t1;
    if (count < fewest || !(determinant > 0.02)) return std::nullopt;
    line.offset = (n1 * t2 - t1 * tn) / determinant;
    line.slope = (count * tn - t1 * n1) / determinant;
    tolerance = std::max(0.5 * tolerance, 0.75);
  }
  return line;
}

// An interval of x, empty where it ends before it begins.
struct Interval {
  double first;
  double last;

  // Where offset + slope x is from `low` to `high`.
  void cut(double offset, double slope, double low, double high) {
    if (std::abs(slope) < 1e-9) {
      if (offset < low || offset > high) last = first - 1;
      return;
    }
    const double a = (low - offset) / slope;
    const double b = (high - offset) / slope;
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
};

// A blurred edge at a distance in sigmas, within 3e-4: Abramowitz and Stegun, 7.1.27.
float blurred_edge(float sigmas) {
  const float x = std::abs(0.70710678F * sigmas);
  const float p = 1 + x * (0.278393F + x * (0.230389F + x * (0.000972F + x * 0.078108F)));
  const float square = p * p;
  const float rest = 0.5F / (square * square);
  return sigmas > 0 ? 1 - rest : rest;
}

// A row of bits as blur along the side leaves it, 1 sigma of which is `width`, by t.
SideBits::Row blurred(const std::vector<double>& cuts, const std::vector<float>& bits,
                      double width) {
  constexpr double kFar = 5;  // sigmas, from where a blurred edge is over
  constexpr int kSamples = SideBits::kSamples;
  constexpr double kSpacing = 2.0 / (kSamples - 1);
  // The sample at a place, or the one after it.
  const auto sample_from = [](double t) {
    return static_cast<int>(std::clamp(std::ceil((t + 1) / kSpacing), 0.0, double{kSamples}));
  };
  SideBits::Row row{};
  for (std::size_t k = 0; k < cuts.size(); ++k) {
    const float change = (k < bits.size() ? bits[k] : 0) - (k == 0 ? 0 : bits[k - 1]);
    if (change == 0) continue;
    const int from = sample_from(cuts[k] - kFar * width);
    const int over = sample_from(cuts[k] + kFar * width);
    const auto first = static_cast<float>((from * kSpacing - 1 - cuts[k]) / width);
    const auto by_sample = static_cast<float>(kSpacing / width);
    float* at = row.data() + from;
    for (int i = 0; i < over - from; ++i) {
      at[i] += change * blurred_edge(first + static_cast<float>(i) * by_sample);
    }
    for (int i = over; i < kSamples; ++i) row[static_cast<std::size_t>(i)] += change;
  }
  row[kSamples] = row[kSamples - 1];
  return row;
}

}  // namespace

double room_inside(const SideGuess& guess) {
  return -guess.border.at - std::abs(guess.border.slope);
}
double room_outside(const SideGuess& guess) { return guess.gap.at - std::abs(guess.gap.slope); }

SideFrame::SideFrame(const SideGuess& guess)
    : middle_(0.5 * (guess.from + guess.to)),
      along_(guess.to - guess.from),
      half_(std::max(0.5 * along_.norm(), 1e-6)) {
  along_ /= 2 * half_;
  outwards_ = {along_.y(), -along_.x()};
}

std::optional<SideCurve> coarse_side(const ImageView& image, const SideFrame& frame,
                                     const SideGuess& guess) {
  std::vector<Steepest> places;
  int in_image = 0;
  for (int i = 0; i < kProfiles; ++i) {
    const double t = kLastProfile * (2.0 * i / (kProfiles - 1) - 1);
    if (!is_in(image, frame.at(t, 0))) continue;
    ++in_image;
    if (const auto place = steepest_at(image, frame, guess, t)) places.push_back(*place);
  }
  const int fewest = std::max(kFewestPlaces, in_image / 2);
  if (static_cast<int>(places.size()) < fewest) return std::nullopt;
  auto line = line_of(places, guess.reach, fewest);
  if (line) line->bend = guess.bend;
  return line;
}

void gather_side(const ImageView& image, const SideFrame& frame, const SideGuess& guess,
                 const SideCurve& curve, const SideBand& band, SidePixels& pixels) {
  pixels.clear();
  const auto [inside, outside, end, width, every] = band;
  const double lowest = std::min({curve.at(-1), curve.at(1), curve.at(0)}) - inside;
  const double highest = std::max({curve.at(-1), curve.at(1), curve.at(0)}) + outside;
  double top = frame.at(-end, lowest).y();
  double bottom = top;
  for (const Point& p : {frame.at(-end, highest), frame.at(end, lowest), frame.at(end, highest)}) {
    top = std::min(top, p.y());
    bottom = std::max(bottom, p.y());
  }
  const double t_step = frame.along().x() / frame.half();
  const double n_step = frame.outwards().x();
  // Lines across the side are rows where it is steep, and else columns.
  const bool is_steep = std::abs(frame.along().y()) > std::abs(frame.along().x());
  const int row_step = is_steep ? every : 1;
  const int step = is_steep ? 1 : every;
  const double last_row = std::min(image.height - 1.0, std::floor(bottom));
  for (int y = static_cast<int>(std::max(0.0, std::ceil(top))); y <= last_row; y += row_step) {
    const Point start(0, y);
    const double t_start = frame.along(start);
    const double n_start = frame.across(start);
    const auto off = [&](double x) {
      return n_start + x * n_step - curve.at(t_start + x * t_step);
    };
    Interval x{0, static_cast<double>(image.width - 1)};
    x.cut(t_start, t_step, -end, end);
    // By the straight line first, as far as the bend moves it.
    x.cut(n_start - curve.offset - curve.slope * t_start, n_step - curve.slope * t_step,
          std::min(curve.bend, 0.0) - inside, std::max(curve.bend, 0.0) + outside);
    int first = static_cast<int>(std::ceil(x.first / step)) * step;
    int last = static_cast<int>(std::floor(x.last));
    const auto is_near = [&](int u) { return off(u) >= -inside && off(u) <= outside; };
    while (first <= last && !is_near(first)) first += step;
    while (first <= last && !is_near(last)) --last;
    if (first > last) continue;
    const int count = (last - first) / step + 1;
    const std::size_t at = pixels.append(count);
    const std::uint8_t* row = image.data + y * image.stride + first;
    const auto first_t = static_cast<float>(t_start + first * t_step);
    const auto first_n = static_cast<float>(n_start + first * n_step);
    const auto by_t = static_cast<float>(step * t_step);
    const auto by_n = static_cast<float>(step * n_step);
    float* t = pixels.t.data() + at;
    float* n = pixels.n.data() + at;
    float* grey = pixels.grey.data() + at;
    for (int i = 0; i < count; ++i) {
      t[i] = first_t + static_cast<float>(i) * by_t;
      n[i] = first_n + static_cast<float>(i) * by_n;
      grey[i] = row[i * step];
    }
  }
  pixels.finish();
  const double blur = width / frame.half();
  SideBits bits{
      blurred(guess.cuts, guess.first, blur), blurred(guess.cuts, guess.behind, blur), {}};
  if (guess.beyond) bits.beyond.fill(1);
  if (!guess.outer.empty()) bits.beyond = blurred(guess.outer_cuts, guess.outer, blur);
  add_bits(pixels, bits, guess.beyond || !guess.outer.empty());
}

}  // namespace calvin::detect
