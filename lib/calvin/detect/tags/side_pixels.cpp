// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Looks for the steepest places across a side, lays a line through most of them, and gathers the
// pixels near a curve.

#include "calvin/detect/tags/side_pixels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "calvin/detect/checkerboard/corners/grey_at.hpp"

namespace calvin::detect {

namespace {

constexpr int kProfiles = 10;              // across a side
constexpr int kFewestPlaces = 4;           // of a side that leaves the image
constexpr double kLastProfile = 0.85;      // |t|
constexpr std::size_t kMostSamples = 256;  // of a profile
constexpr float kNowhere = std::numeric_limits<float>::quiet_NaN();  // a grey level outside

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
  const int places =
      std::min(static_cast<int>(2 * guess.reach / step + 1e-9) + 1, int{kMostSamples - kApart});
  const int samples = places + int{kApart};
  const double before = guess.bend * (1 - t * t);
  const auto across = [&](int i) { return -guess.reach + (i - 0.5 * kApart) * step; };
  const Point first = frame.at(t, before + across(0));
  const Point by = step * frame.outwards();
  const bool is_whole = is_in(image, first) && is_in(image, first + (samples - 1) * by);
  const auto x0 = static_cast<float>(first.x()), y0 = static_cast<float>(first.y());
  const auto by_x = static_cast<float>(by.x()), by_y = static_cast<float>(by.y());
  std::array<float, kMostSamples> grey;
  for (int i = 0; i < samples; ++i) {
    const float x = x0 + static_cast<float>(i) * by_x;
    const float y = y0 + static_cast<float>(i) * by_y;
    grey[static_cast<std::size_t>(i)] =
        is_whole ? grey_inside(image, x, y) : grey_at(image, x, y).value_or(kNowhere);
  }
  const float sign = guess.inverted ? -1 : 1;
  int steepest = 0;
  float most = 0;
  for (int i = 0; i < places; ++i) {
    const auto at = static_cast<std::size_t>(i);
    // A change from or to nowhere is no number, and not larger.
    const float change = sign * (grey[at + kApart] - grey[at]);
    steepest = change > most ? i : steepest;
    most = change > most ? change : most;
  }
  const Steepest best{t, -guess.reach + steepest * step, static_cast<double>(most)};
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
};

// Clips to where offset + slope x is between two limits, for many offsets.
class Clip {
 public:
  explicit Clip(double slope) : is_flat_(std::abs(slope) < 1e-9), inverse_(1 / slope) {}

  void apply(double offset, double low, double high, Interval& x) const {
    if (is_flat_) {
      if (offset < low || offset > high) x.last = x.first - 1;
      return;
    }
    const double a = (low - offset) * inverse_;
    const double b = (high - offset) * inverse_;
    x.first = std::max(x.first, std::min(a, b));
    x.last = std::min(x.last, std::max(a, b));
  }

 private:
  bool is_flat_;
  double inverse_;
};

// The least multiple of a step that is not less than x >= 0.
int multiple_from(double x, int step) {
  const int below = static_cast<int>(x);
  const int from = below + (below < x ? 1 : 0);
  return step == 1 ? from : (from + step - 1) / step * step;
}

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

// The rows of the image from the first to the last that a band about a curve reaches.
std::pair<int, int> rows_near(const ImageView& image, const SideFrame& frame,
                              const SideCurve& curve, const SideBand& band) {
  const double lowest = std::min({curve.at(-1), curve.at(1), curve.at(0)}) - band.inside;
  const double highest = std::max({curve.at(-1), curve.at(1), curve.at(0)}) + band.outside;
  const double corners[] = {frame.at(-band.end, lowest).y(), frame.at(-band.end, highest).y(),
                            frame.at(band.end, lowest).y(), frame.at(band.end, highest).y()};
  const auto [top, bottom] = std::ranges::minmax(corners);
  const double end = image.height;
  return {static_cast<int>(std::clamp(std::ceil(top), 0.0, end)),
          static_cast<int>(std::clamp(std::floor(bottom), -1.0, end - 1))};
}

// The pixels of the rows near a curve.
void find_lines(const ImageView& image, const SideFrame& frame, const SideCurve& curve,
                const SideBand& band, SideLines& lines) {
  const Point origin(0, 0);
  const Point t_by(frame.along() / frame.half());  // by x and by y
  const Point& n_by = frame.outwards();
  // Lines across the side are rows where it is steep, and else columns.
  const bool is_steep = std::abs(frame.along().y()) > std::abs(frame.along().x());
  const int row_step = is_steep ? band.every : 1;
  const int step = is_steep ? 1 : band.every;
  lines.all.clear();
  lines.step = step;
  lines.by_t = static_cast<float>(step * t_by.x());
  lines.by_n = static_cast<float>(step * n_by.x());
  const Clip along(t_by.x());
  const Clip across(n_by.x() - curve.slope * t_by.x());
  const auto [top, bottom] = rows_near(image, frame, curve, band);
  for (int y = top; y <= bottom; y += row_step) {
    const double t = frame.along(origin) + y * t_by.y();
    const double n = frame.across(origin) + y * n_by.y();
    Interval x{0, static_cast<double>(image.width - 1)};
    along.apply(t, -band.end, band.end, x);
    // By the straight line first, as far as the bend moves it.
    across.apply(n - curve.offset - curve.slope * t, std::min(curve.bend, 0.0) - band.inside,
                 std::max(curve.bend, 0.0) + band.outside, x);
    if (!(x.first <= x.last)) continue;
    int first = multiple_from(x.first, step);
    int last = static_cast<int>(x.last);
    const auto is_near = [&](int u) {
      const double off = n + u * n_by.x() - curve.at(t + u * t_by.x());
      return off >= -band.inside && off <= band.outside;
    };
    while (first <= last && !is_near(first)) first += step;
    while (first <= last && !is_near(last)) --last;
    if (first > last) continue;
    lines.all.push_back({image.data + y * image.stride + first, (last - first) / step + 1,
                         image.width - first, static_cast<float>(t + first * t_by.x()),
                         static_cast<float>(n + first * n_by.x())});
  }
}

// What is beside a side so near to the pixels of a band that blur takes it there.
class Reach {
 public:
  Reach(const SideCurve& curve, const SideBand& band)
      : innermost_(std::min({curve.at(-1), curve.at(0), curve.at(1)}) - band.inside),
        outermost_(std::max({curve.at(-1), curve.at(0), curve.at(1)}) + band.outside),
        far_(kFar * band.blur) {}

  // Rows of bits.
  [[nodiscard]] int rows(const SideGuess& guess) const {
    const auto reaches = [&](const NextEdge& edge) {
      return innermost_ - edge.at - std::abs(edge.slope) < far_;
    };
    return reaches(guess.second) ? 2 : reaches(guess.border) ? 1 : 0;
  }
  [[nodiscard]] bool is_gap_crossed(const SideGuess& guess) const {
    return guess.gap.at - std::abs(guess.gap.slope) - outermost_ < far_;
  }

 private:
  static constexpr double kFar = 6;  // widths, of which a fit may find a fifth more

  double innermost_;  // px
  double outermost_;
  double far_;
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
                 const SideCurve& curve, const SideBand& band, SidePixels& pixels) {
  thread_local SideLines lines;  // memory: sides are fitted by the hundred in a picture
  find_lines(image, frame, curve, band, lines);
  const double blur = band.blur / frame.half();
  SideBits bits;
  const Reach reach(curve, band);
  bits.rows = reach.rows(guess);
  if (bits.rows > 0) bits.first = blurred(guess.cuts, guess.first, blur);
  if (bits.rows > 1) bits.second = blurred(guess.cuts, guess.behind, blur);
  if (reach.is_gap_crossed(guess)) {
    if (!guess.outer.empty()) {
      bits.behind_gap = BehindGap::kBits;
      bits.beyond = blurred(guess.outer_cuts, guess.outer, blur);
    } else if (guess.beyond) {
      bits.behind_gap = BehindGap::kTag;
    }
  }
  take_lines(lines, bits, pixels);
}

}  // namespace calvin::detect
