// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Fits of discs, what is no disc among them, and control points out of the others.

#include "calvin/detect/circles/disc_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "calvin/detect/checkerboard/corners/grey_at.hpp"
#include "calvin/detect/circles/blob_shape.hpp"
#include "calvin/detect/circles/centre_bias.hpp"
#include "calvin/geometry/median.hpp"

namespace calvin::detect {

namespace {

float brighter(const Ellipse& e) { return std::max(e.inside, e.outside); }

// `usual`: a disc as those around let it be expected, where they do.
SeenMark mark_of(const ImageView& image, const DiscFit& fit, const Ellipse* usual) {
  constexpr double kLarger = 1.22;       // half way to a large disc's diameter
  constexpr double kHole = 0.5;          // of the radius
  constexpr double kLeastToldBy = 0.15;  // of the contrast
  const Ellipse& e = fit.ellipse;
  const auto middle = grey_at(image, static_cast<float>(e.x), static_cast<float>(e.y));
  if (!middle) return std::nullopt;
  // What blur leaves in the middle of a disc, of what is around it.
  const auto left_of = [&](double radius) {
    const double widths = radius / fit.width;
    return std::exp(-0.5 * widths * widths);
  };
  // A small ring is nowhere as dark as a disc.
  const Ellipse& levels = usual != nullptr ? *usual : e;
  const double shown =
      static_cast<double>((*middle - levels.inside) / (levels.outside - levels.inside));
  const double of_hole = 1 - left_of(kHole * e.radius());
  if (of_hole < kLeastToldBy) return std::nullopt;
  if (shown > left_of(e.radius()) + 0.5 * of_hole) return DiscMark::kRing;
  if (usual == nullptr) return std::nullopt;
  return e.radius() > kLarger * usual->radius() ? DiscMark::kLarge : DiscMark::kNone;
}

// Whether most of a disc's colour is where it is expected, in a ring between its rim and its
// middle: a fit takes longer.
bool is_there(const ImageView& image, const Ellipse& expected) {
  constexpr int kSamples = 8;
  constexpr double kRing = 0.75;  // of the radius
  const float half = 0.5F * (expected.inside + expected.outside);
  const double a = std::sqrt(expected.xx);
  const double b = expected.xy / a;
  const double c = std::sqrt(std::max(expected.yy - b * b, 0.0));
  int alike = 0;
  for (const Eigen::Vector2d& p : unit_circle<kSamples>()) {
    const double x = kRing * p.x();
    const double y = kRing * p.y();
    const auto grey = grey_at(image, static_cast<float>(expected.x + a * x),
                              static_cast<float>(expected.y + b * x + c * y));
    alike += grey && (*grey > half) == expected.is_light() ? 1 : 0;
  }
  return alike > kSamples / 2;
}

// Whether one of so many discs of a lattice is as round as a disc, in the median of those of which
// a rim is seen; where discs are large and clear these are not just a few. It costs less than fits.
bool may_have_rims(const ImageView& image, const DiscLattice& lattice, std::size_t one_of) {
  constexpr std::size_t kFewest = 5;
  constexpr double kMostSquare = 0.09;  // of the radius
  constexpr double kLarge = 5;          // px
  constexpr float kClear = 50;          // grey levels
  const std::vector<Cell> cells = lattice.cells();
  std::vector<double> squareness;
  std::size_t clear = 0;
  std::size_t clear_with_rim = 0;
  for (std::size_t i = one_of / 2; i < cells.size(); i += one_of) {
    const Ellipse& e = *lattice.at(cells[i]);
    const auto one = rim_squareness(image, e);
    if (one) squareness.push_back(*one);
    if (e.radius() < kLarge || std::abs(e.outside - e.inside) < kClear) continue;
    ++clear;
    clear_with_rim += one ? 1 : 0;
  }
  if (clear >= kFewest && 3 * clear_with_rim < clear) return false;
  return squareness.size() < kFewest || median_of(std::move(squareness)) <= kMostSquare;
}

// How far the rim leaves the ellipse four times around, px: a square's corners do by .14 radii, as
// far as the blur lets it be seen. Measured by the disc itself, a square seen at any angle is one.
double fourth_harmonic(const ImageView& image, const DiscFit& fit) {
  constexpr int kSamples = 32;
  const Ellipse& e = fit.ellipse;
  const double a = std::sqrt(e.xx);
  const double b = e.xy / a;
  const double c = std::sqrt(std::max(e.yy - b * b, 0.0));
  const float half = 0.5F * (e.inside + e.outside);
  const double slope = static_cast<double>(e.outside - e.inside) /
                       (std::sqrt(2 * std::numbers::pi) * fit.width);  // grey levels per px
  const auto& circle = unit_circle<kSamples>();
  double even = 0;
  double odd = 0;
  for (std::size_t k = 0; k < kSamples; ++k) {
    const double x = circle[k].x();
    const double y = circle[k].y();
    const auto grey =
        grey_at(image, static_cast<float>(e.x + a * x), static_cast<float>(e.y + b * x + c * y));
    if (!grey) return 0;  // at the border
    const double off = static_cast<double>(half - *grey) / slope;
    const Eigen::Vector2d& four_times = circle[4 * k % kSamples];
    even += off * four_times.x();
    odd += off * four_times.y();
  }
  return 2.0 / kSamples * std::hypot(even, odd);
}

}  // namespace

bool DiscSheet::fit(const ImageView& image, const DiscLattice& lattice, int least,
                    const MarkKinds& marks) {
  may_be_ = marks;
  lattice_ = lattice;
  discs_.clear();
  const std::vector<Cell> cells = lattice_.cells();
  for (const Cell c : cells) fit_one(image, c, *lattice_.at(c), false);
  drop_unlike();
  for (const Cell out : outliers_of(lattice_, image_center(image.size()))) {
    std::erase_if(discs_, [&](const Fitted& disc) { return disc.cell == out; });
    lattice_.remove(out);
  }
  add_missing(image, 0);
  return static_cast<int>(discs_.size()) >= least;
}

// Fits one disc, or takes it out.
void DiscSheet::fit_one(const ImageView& image, Cell cell, const Ellipse& start, bool is_ring) {
  constexpr int kSteps = 6;
  constexpr double kMoved = 0.5;  // of the radius
  constexpr double kMostLarger = 1.8;
  constexpr double kBeforeHole = 0.3;  // of the radius
  constexpr double kOff = 0.7;         // px, of a rim that was looked for
  DiscFit fit;
  fit.ellipse = start;
  fit.width = usual_width_;
  if (const auto closer = closer_ellipse(image, start)) {
    fit.ellipse = *closer;
    fit.off = kOff;
  }
  if (is_ring) fit.room = kBeforeHole;
  bool found = fit_disc(image, kSteps, fit);
  if (found && !is_ring && mark_of(image, fit, nullptr) == DiscMark::kRing) {
    fit.room = kBeforeHole;
    found = fit_disc(image, kSteps, fit);
  }
  const double radius = start.radius();
  const double moved = std::hypot(fit.ellipse.x - start.x, fit.ellipse.y - start.y);
  const double larger = fit.ellipse.radius() / radius;
  if (!found || moved > kMoved * radius || larger > kMostLarger || larger < 1 / kMostLarger ||
      fit.ellipse.is_light() != start.is_light()) {
    lattice_.remove(cell);
    return;
  }
  lattice_.put(cell, fit.ellipse);
  discs_.push_back({cell, fit});
  usual_width_ = fit.width;
}

// Discs that the search has overlooked, rings and large ones among them: where neighbours let them
// be expected.
void DiscSheet::add_missing(const ImageView& image, int around) {
  const CellRange range = lattice_.extent();
  for (int row = range.first.row - around; row <= range.last.row + around; ++row) {
    for (int col = range.first.col - around; col <= range.last.col + around; ++col) {
      const Cell cell{col, row};
      if (!lattice_.in_reach(cell) || lattice_.at(cell) != nullptr) continue;
      const auto expected = lattice_.expect(cell);
      if (!expected) continue;
      if (add_expected(image, cell, *expected, DiscMark::kNone)) continue;
      if (may_be_.rings && add_expected(image, cell, *expected, DiscMark::kRing)) continue;
      if (may_be_.large) static_cast<void>(add_expected(image, cell, *expected, DiscMark::kLarge));
    }
  }
}

void DiscSheet::complete(const ImageView& image, const CirclePattern& pattern, const CellMap& map) {
  std::size_t before = 0;
  do {
    before = discs_.size();
    for (const CirclePattern::Disc& disc : pattern.discs()) {
      const Cell cell = map.back(disc.cell);
      if (!lattice_.in_reach(cell) || lattice_.at(cell) != nullptr) continue;
      if (const auto expected = lattice_.expect(cell)) {
        static_cast<void>(add_expected(image, cell, *expected, disc.mark));
      }
    }
  } while (discs_.size() > before);
}

// Adds a disc with such a mark where it is expected.
bool DiscSheet::add_expected(const ImageView& image, Cell cell,
                             const DiscLattice::Expectation& expected, DiscMark mark) {
  constexpr double kOff = 0.15;           // of the spacing
  constexpr double kOtherSize = 1.35;     // the discs around are of one size
  constexpr float kLeastContrast = 0.7F;  // of theirs
  const bool is_large = mark == DiscMark::kLarge;
  if (!is_there(image, expected.disc)) return false;
  for (const double larger : {is_large ? 1.5 : 1.0, 2.2}) {
    if (larger > 2 && !is_large) break;
    Ellipse start = expected.disc;
    for (double* square : {&start.xx, &start.xy, &start.yy}) *square *= larger * larger;
    fit_one(image, cell, start, mark == DiscMark::kRing);
    const Ellipse* found = lattice_.at(cell);
    if (found == nullptr) continue;
    const float contrast = std::abs(found->outside - found->inside);
    const float usual = std::abs(expected.disc.outside - expected.disc.inside);
    const double off = std::hypot(found->x - expected.disc.x, found->y - expected.disc.y);
    const double size = found->radius() / start.radius();
    if (off < kOff * expected.spacing && contrast > kLeastContrast * usual && size < kOtherSize &&
        size > 1 / kOtherSize) {
      return true;
    }
    lattice_.remove(cell);
    discs_.pop_back();
  }
  return false;
}

bool DiscSheet::grow(const ImageView& image) {
  const std::size_t before = discs_.size();
  add_missing(image, 1);
  return discs_.size() > before;
}

// Takes out discs of which the fit is much worse than those of the others: something lies over
// them, or they are none.
void DiscSheet::drop_unlike() {
  constexpr double kMuchMore = 3;
  constexpr double kAlways = 3;      // grey levels
  constexpr double kMuchLooser = 6;  // of the median of the sigmas
  constexpr float kOtherLight = 0.4F;
  if (discs_.empty()) return;
  std::vector<double> residuals;
  std::vector<double> sigmas;
  for (const Fitted& disc : discs_) {
    residuals.push_back(disc.fit.residual);
    sigmas.push_back(disc.fit.sigma);
  }
  const double most = kMuchMore * median_of(std::move(residuals)) + kAlways;
  const double most_sigma = kMuchLooser * median_of(std::move(sigmas));
  std::erase_if(discs_, [&](const Fitted& disc) {
    const auto expected = lattice_.expect(disc.cell);
    const float light = brighter(disc.fit.ellipse);
    const bool other_light =
        expected && std::abs(light - brighter(expected->disc)) > kOtherLight * light;
    if (disc.fit.residual <= most && disc.fit.sigma <= most_sigma && !other_light) return false;
    lattice_.remove(disc.cell);
    return true;
  });
}

// A ring has the colour of the ground in its middle, as far as blur has left it; a large disc is
// larger than those around it.
std::vector<SeenMark> DiscSheet::marks(const ImageView& image) const {
  std::vector<SeenMark> all;
  for (const Cell cell : lattice_.cells()) {
    const auto disc = std::ranges::find(discs_, cell, &Fitted::cell);
    const auto expected = lattice_.expect(cell);
    all.push_back(mark_of(image, disc->fit, expected ? &expected->disc : nullptr));
  }
  return all;
}

bool DiscSheet::are_round(const ImageView& image) const { return squareness(image) < 1; }

bool DiscSheet::may_be_discs(const ImageView& image, const DiscLattice& lattice) {
  constexpr std::size_t kSome = 12;
  constexpr double kMost = 1.5;  // some alone are not as sure as all
  const std::vector<Cell> cells = lattice.cells();
  if (!may_have_rims(image, lattice, std::max<std::size_t>(cells.size() / kSome, 1))) return false;
  if (cells.size() < 2 * kSome) return true;
  DiscSheet some;
  some.lattice_ = lattice;
  const std::size_t step = cells.size() / kSome;
  std::size_t tried = 0;
  for (std::size_t i = step / 2; i < cells.size(); i += step, ++tried) {
    some.fit_one(image, cells[i], *lattice.at(cells[i]), false);
  }
  return 3 * some.discs_.size() >= tried && some.squareness(image) < kMost;
}

double DiscSheet::squareness(const ImageView& image) const {
  constexpr double kOfRadius = 0.06;  // half of a square's
  constexpr double kOfWidth = 0.6;    // of the blur: beyond it grey levels say no more how far
  std::vector<double> shares;
  for (const Fitted& disc : discs_) {
    const double most = std::min(kOfRadius * disc.fit.ellipse.radius(), kOfWidth * disc.fit.width);
    shares.push_back(fourth_harmonic(image, disc.fit) / most);
  }
  return shares.empty() ? 0 : median_of(std::move(shares));
}

void DiscSheet::set_slope(Fitted& disc) const {
  Eigen::Matrix2d m = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  const float own = brighter(disc.fit.ellipse);
  for (int row = -1; row <= 1; ++row) {
    for (int col = -1; col <= 1; ++col) {
      const Ellipse* near = lattice_.at(disc.cell + Cell{col, row});
      if (near == nullptr || (row == 0 && col == 0)) continue;
      const Eigen::Vector2d way(near->x - disc.fit.ellipse.x, near->y - disc.fit.ellipse.y);
      m += way * way.transpose();
      right += way * static_cast<double>(brighter(*near) - own);
    }
  }
  const double determinant = m.determinant();
  const double trace = m.trace();
  if (!(determinant > 1e-3 * trace * trace)) return;
  const Eigen::Vector2d slope = m.inverse() * right / static_cast<double>(own);
  disc.fit.slope_x = slope.x();
  disc.fit.slope_y = slope.y();
}

DiscSheet::Places DiscSheet::places(const CirclePattern& pattern, const CellMap& map) const {
  Places places;
  for (const Fitted& disc : discs_) {
    const Cell c = pattern.discs()[*pattern.disc_in(map(disc.cell))].cell;
    places.board.push_back({static_cast<double>(c.col), static_cast<double>(c.row)});
    places.image.push_back({disc.fit.ellipse.x, disc.fit.ellipse.y});
  }
  return places;
}

// Takes out discs that do not lie where all others let them be expected; false where there are
// none.
bool DiscSheet::drop_strays(const Places& at, const LensMap& lens) {
  constexpr double kOff = 6;        // of the median
  constexpr double kAlways = 0.02;  // of the radius
  std::vector<double> off;
  for (std::size_t i = 0; i < at.board.size(); ++i) {
    const Pixel there = lens.image_of(at.board[i]);
    off.push_back(std::hypot(at.image[i].u - there.u, at.image[i].v - there.v));
  }
  const double most = kOff * median_of(off);
  std::size_t i = 0;
  const auto dropped = std::erase_if(discs_, [&](const Fitted& disc) {
    const bool drops = off[i++] > most + kAlways * disc.fit.ellipse.radius();
    if (drops) lattice_.remove(disc.cell);
    return drops;
  });
  return dropped > 0;
}

// The images of the discs' centres; drops strays.
std::vector<Pixel> DiscSheet::centres(const CirclePattern& pattern, const CellMap& map,
                                      const Pixel& middle) {
  constexpr int kMostRounds = 3;
  constexpr int kDegree = 4;  // what the bias depends on are second derivatives of the map
  Places at = places(pattern, map);
  auto lens = LensMap::fit(at.board, at.image, middle, 0, kDegree);
  for (int round = 0; lens && round < kMostRounds && drop_strays(at, *lens); ++round) {
    at = places(pattern, map);
    lens = LensMap::fit(at.board, at.image, middle, 0, kDegree);
  }
  for (std::size_t i = 0; lens && i < at.board.size(); ++i) {
    const auto bias = centre_bias(*lens, at.board[i], discs_[i].fit.ellipse);
    if (!bias) continue;
    at.image[i].u -= bias->x();
    at.image[i].v -= bias->y();
  }
  return at.image;
}

Observation DiscSheet::observe(const ImageView& image, const CirclePattern& pattern,
                               const CellMap& map) {
  constexpr int kSteps = 3;
  Observation seen;
  complete(image, pattern, map);
  std::erase_if(discs_, [&](Fitted& disc) {
    set_slope(disc);
    if (fit_disc(image, kSteps, disc.fit)) return false;
    lattice_.remove(disc.cell);
    return true;
  });
  drop_unlike();
  std::ranges::sort(discs_, {}, [&](const Fitted& d) { return *pattern.disc_in(map(d.cell)); });
  seen.uv = centres(pattern, map, image_center(image.size()));
  const std::vector<int> ids = pattern.board().ids();
  std::vector<double> widths;
  for (const Fitted& disc : discs_) {
    seen.ids.push_back(ids[*pattern.disc_in(map(disc.cell))]);
    seen.sigma.push_back(disc.fit.sigma);
    widths.push_back(disc.fit.width);
  }
  if (!widths.empty()) seen.blur = median_of(std::move(widths));
  return seen;
}

}  // namespace calvin::detect
