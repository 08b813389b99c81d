// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The scalar kernel: interpolates one sample at a time, for every memory layout, at every border.

#include "calvin/remap/kernels/scalar/scalar_kernel.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>

namespace calvin::remap {

namespace {

constexpr int kBits = 11;  // of bilinear weights; with more, sums of 8-bit samples need 64
constexpr int kOne = 1 << kBits;

// Loads and stores 8-bit samples. Sum holds kOne^2 times the largest sample.
struct Byte {
  using Sum = std::int32_t;
  explicit Byte(const PlaneLayout& /*layout*/) {}

  [[nodiscard]] static Sum load(const std::uint8_t* at) noexcept { return *at; }
  static void store(std::uint8_t* at, Sum value) noexcept {
    *at = static_cast<std::uint8_t>(value);
  }
  static constexpr Sum largest = 255;
};

// Loads and stores 16-bit samples.
template <std::endian kOrder>
struct Word {
  using Sum = std::int64_t;
  explicit Word(const PlaneLayout& layout)
      : shift(layout.shift),
        largest((1 << (layout.bits > 0 ? layout.bits : 16 - layout.shift)) - 1) {}

  [[nodiscard]] Sum load(const std::uint8_t* at) const noexcept {
    return static_cast<std::uint16_t>(at[kHigh] << 8 | at[1 - kHigh]) >> shift;
  }
  void store(std::uint8_t* at, Sum value) const noexcept {
    const auto word = static_cast<std::uint16_t>(value << shift);
    at[kHigh] = static_cast<std::uint8_t>(word >> 8);
    at[1 - kHigh] = static_cast<std::uint8_t>(word);
  }

  static constexpr int kHigh = kOrder == std::endian::little ? 1 : 0;
  int shift;
  Sum largest;
};

constexpr int kTableSteps = 1024;  // from a sample to the next, in tables of filter weights

// The weights of a filter of `kTaps` taps at a coordinate between the middle two of them; they add
// up to 1.
template <int kTaps>
using Weights = std::array<float, kTaps>;

template <int kTaps, typename Kernel>
std::array<Weights<kTaps>, kTableSteps + 1> make_table(Kernel kernel) {
  constexpr int kBefore = kTaps / 2 - 1;
  std::array<Weights<kTaps>, kTableSteps + 1> table;
  for (std::size_t i = 0; i < table.size(); ++i) {
    std::array<double, kTaps> exact;
    double sum = 0;
    for (int k = 0; k < kTaps; ++k) {
      sum += exact[k] = kernel(static_cast<double>(i) / kTableSteps - k + kBefore);
    }
    for (int k = 0; k < kTaps; ++k) table[i][k] = static_cast<float>(exact[k] / sum);
  }
  return table;
}

// Catmull-Rom's spline (Keys 1981, a = -1/2).
double catmull_rom(double t) {
  t = std::abs(t);
  if (t >= 2) return 0;
  return t < 1 ? 1 + t * t * (1.5 * t - 2.5) : 2 + t * (-4 + t * (2.5 - 0.5 * t));
}

// sinc(t) sinc(t / 3).
double lanczos3(double t) {
  const double a = std::numbers::pi * t;
  if (std::abs(t) < 1e-9) return 1;
  if (std::abs(t) >= 3) return 0;
  return 3 * std::sin(a) * std::sin(a / 3) / (a * a);
}

const auto kBicubic = make_table<4>(catmull_rom);
const auto kLanczos = make_table<6>(lanczos3);

// Reflects a coordinate at 0 and at `last` until it lies between them.
double mirrored(double coord, double last) {
  if (!(last > 0)) return 0;
  const double folded = std::fmod(std::abs(coord), 2 * last);
  return folded > last ? 2 * last - folded : folded;
}

int mirrored(int coord, int last) {
  if (last <= 0) return 0;
  const int folded = std::abs(coord) % (2 * last);
  return folded > last ? 2 * last - folded : folded;
}

// One axis of the source, and what lies outside of it. A linear coordinate counts samples as if all
// of them were equally far apart; an uneven last sample is not where its linear coordinate is.
struct AxisRule {
  const SampleAxis& axis;
  double last_pixel;
  Outside outside;

  // A linear coordinate -> samples, in 0..count-1; negative where nothing but the fill is shown.
  [[nodiscard]] double resolve(double linear) const noexcept {
    const double pixel = axis.offset() + axis.scale() * linear;
    if (pixel >= -kBorderSlack && pixel <= last_pixel + kBorderSlack) return axis.sample(pixel);
    switch (outside) {
      case Outside::kReplicate:
        return axis.sample(std::clamp(pixel, 0.0, last_pixel));
      case Outside::kMirror:
        return axis.sample(mirrored(pixel, last_pixel));
      default:
        return -1;
    }
  }
  // The first linear coordinate that needs no resolve(): not before the picture.
  [[nodiscard]] double first_linear() const noexcept {
    return std::max(0.0, -axis.offset() / axis.scale());
  }
  // The last linear coordinate that needs no resolve(): before an uneven end.
  [[nodiscard]] double last_linear() const noexcept {
    return axis.count() - (axis.is_even() ? 1 : 2);
  }
  [[nodiscard]] int tap(int sample) const noexcept {
    const int last = axis.count() - 1;
    return outside == Outside::kMirror ? mirrored(sample, last) : std::clamp(sample, 0, last);
  }
};

struct SourceCoord {
  double x;  // source coordinates, samples
  double y;
};

template <typename Sample>
void fill_pixel(const Sample& sample, const PlaneLayout& layout, std::uint8_t* out) noexcept {
  for (int c = 0; c < layout.components; ++c) {
    sample.store(out + c * layout.component_step, layout.fill[static_cast<std::size_t>(c)]);
  }
}

// Whether there are no gaps between the components of a pixel, nor between pixels.
bool is_dense(const PlaneLayout& layout) noexcept {
  const std::ptrdiff_t bytes = layout.sample == SampleType::kU8 ? 1 : 2;
  return layout.pixel_step == layout.components * bytes &&
         (layout.components == 1 || layout.component_step == bytes);
}

template <typename Sample>
void fill_pixels(const Sample& sample, const PlaneLayout& layout, std::uint8_t* out,
                 int count) noexcept {
  if (layout.components == 1 && layout.pixel_step == 1) {
    std::memset(out, layout.fill[0], static_cast<std::size_t>(count));
    return;
  }
  if (count > 0 && is_dense(layout)) {
    fill_pixel(sample, layout, out);
    const std::ptrdiff_t all = count * layout.pixel_step;
    for (std::ptrdiff_t done = layout.pixel_step; done < all; done *= 2) {
      std::memcpy(out + done, out, static_cast<std::size_t>(std::min(done, all - done)));
    }
    return;
  }
  for (int i = 0; i < count; ++i, out += layout.pixel_step) fill_pixel(sample, layout, out);
}

template <typename Sample>
class Sampler {
 public:
  Sampler(const PlaneMap& map, const PlaneLayout& layout, PlaneMemory<const std::uint8_t> source,
          const Sampling& sampling)
      : sample_(layout),
        layout_(layout),
        source_(source),
        interpolation_(sampling.interpolation),
        x_{map.source_x(), map.source_last().u, sampling.outside},
        y_{map.source_y(), map.source_last().v, sampling.outside},
        first_{x_.first_linear(), y_.first_linear()},
        last_{x_.last_linear(), y_.last_linear()} {}

  void fill(std::uint8_t* out) const noexcept { fill_pixel(sample_, layout_, out); }
  void fill(std::uint8_t* out, int count) const noexcept {
    fill_pixels(sample_, layout_, out, count);
  }

  void write(SourceCoord linear, std::uint8_t* out) const noexcept {
    // Most coordinates are inside the picture and need no resolve().
    if (linear.x >= first_.x && linear.y >= first_.y && linear.x <= last_.x &&
        linear.y <= last_.y) {
      return write_sample(linear.x, linear.y, out);
    }
    const double x = x_.resolve(linear.x);
    const double y = y_.resolve(linear.y);
    if (!(x >= 0 && y >= 0)) return fill(out);
    write_sample(x, y, out);
  }

 private:
  void write_sample(double x, double y, std::uint8_t* out) const noexcept {
    switch (interpolation_) {
      case Interpolation::kNearest:
        return nearest(x, y, out);
      case Interpolation::kBilinear:
        return bilinear(x, y, out);
      case Interpolation::kBicubic:
        return filtered(x, y, kBicubic, out);
      case Interpolation::kLanczos:
        return filtered(x, y, kLanczos, out);
    }
  }

  using Sum = typename Sample::Sum;

  [[nodiscard]] const std::uint8_t* at(int x, int y) const noexcept {
    return source_.data + y * source_.stride + x * layout_.pixel_step;
  }

  void nearest(double x, double y, std::uint8_t* out) const noexcept {
    const std::uint8_t* from = at(static_cast<int>(std::lrint(x)), static_cast<int>(std::lrint(y)));
    for (int c = 0; c < layout_.components; ++c) {
      const std::ptrdiff_t step = c * layout_.component_step;
      sample_.store(out + step, sample_.load(from + step));
    }
  }

  void bilinear(double x, double y, std::uint8_t* out) const noexcept {
    // Coordinates are not negative here: the conversion rounds down.
    const double up_x = x * kOne + 0.5;
    const double up_y = y * kOne + 0.5;
    const auto fixed_x = static_cast<std::int32_t>(up_x);
    const auto fixed_y = static_cast<std::int32_t>(up_y);
    const int fx = fixed_x & (kOne - 1);
    const int fy = fixed_y & (kOne - 1);
    const std::uint8_t* top = at(fixed_x >> kBits, fixed_y >> kBits);
    // The last row and column have no neighbour, and with a weight of zero need none.
    const std::ptrdiff_t right = fx != 0 ? layout_.pixel_step : 0;
    const std::uint8_t* bottom = top + (fy != 0 ? source_.stride : 0);
    for (int c = 0; c < layout_.components; ++c) {
      const std::ptrdiff_t step = c * layout_.component_step;
      const Sum upper =
          sample_.load(top + step) * (kOne - fx) + sample_.load(top + step + right) * fx;
      const Sum lower =
          sample_.load(bottom + step) * (kOne - fx) + sample_.load(bottom + step + right) * fx;
      const Sum sum = upper * (kOne - fy) + lower * fy;
      sample_.store(out + step, (sum + (Sum{1} << (2 * kBits - 1))) >> (2 * kBits));
    }
  }

  template <std::size_t kTaps>
  void filtered(double x, double y,
                const std::array<std::array<float, kTaps>, kTableSteps + 1>& table,
                std::uint8_t* out) const noexcept {
    const int column = static_cast<int>(std::floor(x));
    const int row = static_cast<int>(std::floor(y));
    const auto& across = table[static_cast<std::size_t>(std::lrint((x - column) * kTableSteps))];
    const auto& down = table[static_cast<std::size_t>(std::lrint((y - row) * kTableSteps))];
    const int before = static_cast<int>(kTaps) / 2 - 1;
    std::array<int, kTaps> columns;
    for (std::size_t k = 0; k < kTaps; ++k) {
      columns[k] = x_.tap(column - before + static_cast<int>(k));
    }
    std::array<float, 4> sums{};
    for (std::size_t r = 0; r < kTaps; ++r) {
      const int from = y_.tap(row - before + static_cast<int>(r));
      for (std::size_t k = 0; k < kTaps; ++k) {
        const std::uint8_t* pixel = at(columns[k], from);
        const float weight = across[k] * down[r];
        for (int c = 0; c < layout_.components; ++c) {
          sums[static_cast<std::size_t>(c)] +=
              weight * static_cast<float>(sample_.load(pixel + c * layout_.component_step));
        }
      }
    }
    for (int c = 0; c < layout_.components; ++c) {
      const auto value = static_cast<Sum>(std::lrint(sums[static_cast<std::size_t>(c)]));
      sample_.store(out + c * layout_.component_step,
                    std::clamp(value, Sum{0}, Sum{sample_.largest}));
    }
  }

  Sample sample_;
  const PlaneLayout& layout_;
  PlaneMemory<const std::uint8_t> source_;
  Interpolation interpolation_;
  AxisRule x_;
  AxisRule y_;
  SourceCoord first_;  // linear coordinates from here
  SourceCoord last_;   // to here need no resolve()
};

bool is_valid(const PlaneMap::Row& limits, int sample) {
  return std::any_of(limits.valid.begin(), limits.valid.end(), [sample](const auto& span) {
    return sample >= span.begin && sample < span.end;
  });
}

// Whether three middles tell that a run is far outside: quicker than RunParabola::misses().
inline bool is_far(const std::int32_t* middles, int length) {
  const std::int64_t low = std::min(middles[1], std::min(middles[2], middles[3]));
  const std::int64_t high = std::max(middles[1], std::max(middles[2], middles[3]));
  const std::int64_t reach = high - low + (1 << kCoordBits);
  return high + reach < 0 || low - reach > std::int64_t{length} << kCoordBits;
}

template <typename Sample>
void sample(const PlaneMap& map, const PlaneLayout& layout, PlaneMemory<const std::uint8_t> source,
            PlaneMemory<std::uint8_t> output, const Sampling& sampling,
            const RowSpan& span) noexcept {
  const Sampler<Sample> sampler(map, layout, source, sampling);
  const int pixels = map.run_pixels();
  const SampleAxis& axis = map.output_x();
  const bool even = axis.is_even();
  const bool fills = sampling.outside == Outside::kFill;
  const ImageSize source_size = map.source_size();
  const auto far = [&](int run) {
    return fills && run * pixels < span.end &&
           (is_far(span.row.x + run, source_size.width) ||
            is_far(span.row.y + run, source_size.height));
  };
  for (int run = span.begin / pixels; run * pixels < span.end; ++run) {
    int last = run;
    const bool is_empty = far(run);
    while (is_empty && far(last + 1)) ++last;
    const int first = span.first + run * pixels;
    const int begin = std::max(first, span.first + span.begin);
    const int end = std::min(first + (last + 1 - run) * pixels, span.first + span.end);
    std::uint8_t* out = output.data + begin * layout.pixel_step;
    if (is_empty) {
      sampler.fill(out, end - begin);
      run = last;
      continue;
    }
    const RunParabola x(span.row.x + run, pixels);
    const RunParabola y(span.row.y + run, pixels);
    if (fills && (x.misses(pixels, source_size.width) || y.misses(pixels, source_size.height))) {
      sampler.fill(out, end - begin);
      continue;
    }
    const double middle = first + (pixels - 1) / 2.0;
    for (int i = begin; i < end; ++i, out += layout.pixel_step) {
      if (span.limits != nullptr && !is_valid(*span.limits, i)) {
        sampler.fill(out);
        continue;
      }
      const double at = even ? i : (axis.site(i) - axis.offset()) / axis.scale();
      sampler.write({x.at(at - middle), y.at(at - middle)}, out);
    }
  }
}

template <typename Sample>
void fill(const PlaneLayout& layout, PlaneMemory<std::uint8_t> output,
          const RowSpan& span) noexcept {
  const int begin = span.first + span.begin;
  fill_pixels(Sample(layout), layout, output.data + begin * layout.pixel_step,
              span.end - span.begin);
}

}  // namespace

void fill_span(const PlaneLayout& layout, PlaneMemory<std::uint8_t> output,
               const RowSpan& span) noexcept {
  switch (layout.sample) {
    case SampleType::kU8:
      return fill<Byte>(layout, output, span);
    case SampleType::kU16Little:
      return fill<Word<std::endian::little>>(layout, output, span);
    case SampleType::kU16Big:
      return fill<Word<std::endian::big>>(layout, output, span);
  }
}

void sample_span(const PlaneMap& map, const PlaneLayout& layout,
                 PlaneMemory<const std::uint8_t> source, PlaneMemory<std::uint8_t> output,
                 const Sampling& sampling, const RowSpan& span) noexcept {
  static_assert(255LL * kOne * kOne + (1LL << (2 * kBits - 1)) <= INT32_MAX);
  switch (layout.sample) {
    case SampleType::kU8:
      return sample<Byte>(map, layout, source, output, sampling, span);
    case SampleType::kU16Little:
      return sample<Word<std::endian::little>>(map, layout, source, output, sampling, span);
    case SampleType::kU16Big:
      return sample<Word<std::endian::big>>(map, layout, source, output, sampling, span);
  }
}

}  // namespace calvin::remap
