// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Steepest places across a side, a line through most of them, and the pixels near a curve.

#include "calvin/detect/tags/side_pixels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "calvin/detect/checkerboard/corners/grey_at.hpp"

namespace calvin::detect {

namespace {

constexpr int kProfiles = 14;          // across a side
constexpr int kFewestPlaces = 4;       // of a side that leaves the image
constexpr double kLastProfile = 0.85;  // |t|

struct Steepest {
  double t = 0;
  double n = 0;
  double change = 0;  // grey levels, outwards
};

std::optional<Steepest> steepest_at(const ImageView& image, const SideFrame& frame,
                                    const SideGuess& guess, double t) {
  // Far enough for the noise, near enough for a narrow gap.
  const double step = std::clamp(0.25 * guess.reach, 0.25, 1.0);
  const double base =
      std::clamp(0.4 * std::min(room_inside(guess), room_outside(guess)), 0.5, 2 * step);
  const double before = guess.bend * (1 - t * t);
  const auto grey = [&](double n) {
    const Point p = frame.at(t, before + n);
    return grey_at(image, static_cast<float>(p.x()), static_cast<float>(p.y()));
  };
  Steepest best{t, 0, 0};
  for (double n = -guess.reach; n <= guess.reach + 1e-9; n += step) {
    const auto in = grey(n - base);
    const auto out = grey(n + base);
    if (!in || !out) continue;
    const double change = static_cast<double>(*out - *in) * (guess.inverted ? -1 : 1);
    if (change > best.change) best = {t, n, change};
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

// Rows of bits as blur along the side leaves them.
template <std::size_t kRows>
class BlurredBits {
 public:
  void add(const std::vector<double>& cuts, const std::vector<float>& bits, double width,
           std::size_t row) {
    constexpr double kFar = 5;  // sigmas, from where a blurred edge is over
    for (std::size_t k = 0; k < cuts.size(); ++k) {
      const float before = k == 0 ? 0 : bits[k - 1];
      const float after = k < bits.size() ? bits[k] : 0;
      if (before == after) continue;
      const int over = sample_from(cuts[k] + kFar * width);
      for (int i = sample_from(cuts[k] - kFar * width); i < over; ++i) {
        const double t = 2.0 * i / (kSamples - 1) - 1;
        samples_[static_cast<std::size_t>(i)][row] +=
            (after - before) * static_cast<float>(step((t - cuts[k]) / width));
      }
      for (int i = over; i < kSamples; ++i) {
        samples_[static_cast<std::size_t>(i)][row] += after - before;
      }
    }
  }
  [[nodiscard]] std::array<float, kRows> at(float t) const {
    const float place = std::clamp(0.5F * (t + 1), 0.0F, 0.9999F) * (kSamples - 1);
    const auto i = static_cast<std::size_t>(place);
    const float share = place - static_cast<float>(i);
    const std::array<float, kRows>& before = samples_[i];
    const std::array<float, kRows>& after = samples_[i + 1];
    std::array<float, kRows> bits;
    for (std::size_t k = 0; k < kRows; ++k) bits[k] = before[k] + share * (after[k] - before[k]);
    return bits;
  }

 private:
  static constexpr int kSamples = 97;

  // The sample at a place t along the side, or the one after it.
  static int sample_from(double t) {
    return static_cast<int>(
        std::clamp(std::ceil(0.5 * (t + 1) * (kSamples - 1)), 0.0, static_cast<double>(kSamples)));
  }
  // A blurred edge at a distance in sigmas, within 3e-4: Abramowitz and Stegun, 7.1.27.
  static double step(double sigmas) {
    const double x = std::abs(0.70710678118654752 * sigmas);
    const double p = 1 + x * (0.278393 + x * (0.230389 + x * (0.000972 + x * 0.078108)));
    const double rest = 0.5 / (p * p * p * p);
    return sigmas > 0 ? 1 - rest : rest;
  }

  std::array<std::array<float, kRows>, kSamples> samples_{};
};

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
                 const SideCurve& curve, double inside, double outside, double end, double width,
                 SidePixels& pixels) {
  pixels.clear();
  const double lowest = std::min({curve.at(-1), curve.at(1), curve.at(0)}) - inside;
  const double highest = std::max({curve.at(-1), curve.at(1), curve.at(0)}) + outside;
  double top = frame.at(-end, lowest).y();
  double bottom = top;
  for (const Point& p : {frame.at(-end, highest), frame.at(end, lowest), frame.at(end, highest)}) {
    top = std::min(top, p.y());
    bottom = std::max(bottom, p.y());
  }
  const double blur = width / frame.half();
  BlurredBits<2> bits;
  bits.add(guess.cuts, guess.first, blur, 0);
  bits.add(guess.cuts, guess.behind, blur, 1);
  BlurredBits<1> outer;
  outer.add(guess.outer_cuts, guess.outer, blur, 0);
  const double t_step = frame.along().x() / frame.half();
  const double n_step = frame.outwards().x();
  const double last_row = std::min(image.height - 1.0, std::floor(bottom));
  for (int y = static_cast<int>(std::max(0.0, std::ceil(top))); y <= last_row; ++y) {
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
    int first = static_cast<int>(std::ceil(x.first));
    int last = static_cast<int>(std::floor(x.last));
    const auto is_near = [&](int u) { return off(u) >= -inside && off(u) <= outside; };
    while (first <= last && !is_near(first)) ++first;
    while (first <= last && !is_near(last)) --last;
    if (first > last) continue;
    const std::size_t at = pixels.append(last - first + 1);
    const std::uint8_t* row = image.data + y * image.stride + first;
    const auto t = static_cast<float>(t_start + first * t_step);
    const auto n = static_cast<float>(n_start + first * n_step);
    const auto by_t = static_cast<float>(t_step);
    const auto by_n = static_cast<float>(n_step);
    for (int i = 0; i <= last - first; ++i) {
      const std::size_t k = at + static_cast<std::size_t>(i);
      pixels.t[k] = t + static_cast<float>(i) * by_t;
      pixels.n[k] = n + static_cast<float>(i) * by_n;
      pixels.grey[k] = row[i];
      const auto [of_first, of_second] = bits.at(pixels.t[k]);
      pixels.first[k] = of_first;
      pixels.second[k] = of_second;
      if (guess.beyond) pixels.beyond[k] = 1;
      if (!guess.outer.empty()) pixels.beyond[k] = outer.at(pixels.t[k])[0];
    }
  }
  pixels.finish();
}

}  // namespace calvin::detect
