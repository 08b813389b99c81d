// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads rows of points line by line.

#include "calvin/io/point_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"
#include "calvin/io/file_text.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin {

namespace {

using Columns = std::vector<PointColumn>;

struct FieldName {
  std::string_view text;
  PointField field;
};
constexpr FieldName kFieldNames[] = {
    {"id", PointField::kId},  {"X", PointField::kX},
    {"Y", PointField::kY},    {"Z", PointField::kZ},
    {"x", PointField::kX},    {"y", PointField::kY},
    {"z", PointField::kZ},    {"diameter", PointField::kDiameter},
    {"u", PointField::kU},    {"v", PointField::kV},
    {"nx", PointField::kNx},  {"ny", PointField::kNy},
    {"nz", PointField::kNz},  {"sigma", PointField::kSigma},
    {"_", PointField::kSkip},
};

bool has(const Columns& columns, PointField field) {
  return std::ranges::count(columns, field, &PointColumn::field) > 0;
}

// Why columns are none of rows; empty where they are.
std::string why_not(const Columns& columns) {
  for (const FieldName& name : kFieldNames) {
    const auto count = std::ranges::count(columns, name.field, &PointColumn::field);
    if (name.field != PointField::kSkip && count > 1) {
      return fmt::format("{} is there twice", name.text);
    }
  }
  if (has(columns, PointField::kX) != has(columns, PointField::kY)) return "X needs Y";
  if (has(columns, PointField::kU) != has(columns, PointField::kV)) return "u needs v";
  if (has(columns, PointField::kZ) && !has(columns, PointField::kX)) return "Z needs X and Y";
  if (has(columns, PointField::kNx) != has(columns, PointField::kNy) ||
      has(columns, PointField::kNx) != has(columns, PointField::kNz)) {
    return "nx, ny and nz belong together";
  }
  if (!has(columns, PointField::kX) && !has(columns, PointField::kU)) {
    return "they have neither X Y nor u v";
  }
  return "";
}

bool is_axis(PointField field) {
  using F = PointField;
  return (field >= F::kX && field <= F::kZ) || (field >= F::kNx && field <= F::kNz);
}

Result<Columns> parse_columns(const std::vector<std::string_view>& words) {
  Columns columns;
  for (std::string_view word : words) {
    const bool negative = word.starts_with('-');
    if (negative) word.remove_prefix(1);
    const auto* const known = std::find_if(std::begin(kFieldNames), std::end(kFieldNames),
                                           [word](const auto& n) { return n.text == word; });
    if (known == std::end(kFieldNames) || (negative && !is_axis(known->field))) {
      return make_error(ErrorCode::kInvalidArgument,
                        fmt::format("'{}' is no column; there are id, X, Y, Z (or -X, -Y, -Z), "
                                    "diameter, nx, ny, nz, u, v, sigma, and _ for what does not "
                                    "count",
                                    shortened(word, 40)));
    }
    columns.push_back({known->field, negative ? -1.0 : 1.0});
  }
  if (std::string why = why_not(columns); !why.empty()) {
    return make_error(ErrorCode::kInvalidArgument, std::move(why));
  }
  return columns;
}

Columns by_count(std::size_t numbers) {
  using F = PointField;
  switch (numbers) {
    case 2:
      return {{F::kX}, {F::kY}};
    case 3:
      return {{F::kX}, {F::kY}, {F::kZ}};
    case 4:
      return {{F::kX}, {F::kY}, {F::kU}, {F::kV}};
    case 5:
      return {{F::kX}, {F::kY}, {F::kZ}, {F::kU}, {F::kV}};
    case 8:
      return {{F::kX}, {F::kY}, {F::kZ}, {F::kU}, {F::kV}, {F::kNx}, {F::kNy}, {F::kNz}};
    default:
      return {};
  }
}

// `unit` is that of places, m.
void put(PointField field, double value, double unit, PointRow& row) {
  switch (field) {
    case PointField::kSkip:
      break;
    case PointField::kId:
      row.id = static_cast<int>(value);
      break;
    case PointField::kX:
      row.point->x() = unit * value;
      break;
    case PointField::kY:
      row.point->y() = unit * value;
      break;
    case PointField::kZ:
      row.point->z() = unit * value;
      break;
    case PointField::kDiameter:
      row.diameter = unit * value;
      break;
    case PointField::kNx:
      row.normal[0] = value;
      break;
    case PointField::kNy:
      row.normal[1] = value;
      break;
    case PointField::kNz:
      row.normal[2] = value;
      break;
    case PointField::kU:
      row.seen->u = value;
      break;
    case PointField::kV:
      row.seen->v = value;
      break;
    case PointField::kSigma:
      row.sigma = value;
      break;
  }
}

class RowReader {
 public:
  explicit RowReader(const PointRowsFormat& format)
      : columns_(format.columns), unit_(format.unit), given_(!format.columns.empty()) {}

  // Why the line is refused; empty where it is not.
  std::string line(std::string_view text) {
    const auto comment = text.find('#');
    if (comment != std::string_view::npos) {
      (void)header(text.substr(comment + 1));
      text = text.substr(0, comment);
    }
    const auto fields = fields_of(text);
    if (fields.empty() || header(text)) return "";
    std::vector<double> numbers;
    for (const std::string_view field : fields) {
      const auto number = parse_double(field);
      if (!number) return fmt::format("has '{}', which is no number", shortened(field, 40));
      numbers.push_back(*number);
    }
    if (columns_.empty()) columns_ = by_count(numbers.size());
    if (columns_.empty()) {
      return fmt::format(
          "has {} numbers, and nothing says what they are: give the columns, as a line 'u v X Y Z'",
          numbers.size());
    }
    return rows(numbers);
  }

  [[nodiscard]] std::vector<PointRow> take() { return std::move(rows_); }

 private:
  // Whether the text names columns, or the unit.
  bool header(std::string_view text) {
    const auto words = fields_of(text);
    if (words.size() == 2 && (words[0] == "unit:" || words[0] == "unit")) {
      const auto unit = parse_length(fmt::format("1{}", words[1]));
      if (unit && !unit_) unit_ = *unit;
      return unit.has_value();
    }
    if (words.size() < 2) return false;
    auto columns = parse_columns(words);
    if (!columns) return false;
    if (!given_) columns_ = *std::move(columns);
    return true;
  }

  std::string rows(std::span<const double> numbers) {
    if (numbers.size() % columns_.size() != 0) {
      return fmt::format("has {} numbers, where a row has {}", numbers.size(), columns_.size());
    }
    if (has(columns_, PointField::kX) && !unit_) {
      return "has points without a unit: say it, as in a line '# unit: mm'";
    }
    for (; !numbers.empty(); numbers = numbers.subspan(columns_.size())) {
      if (std::string why = row(numbers.first(columns_.size())); !why.empty()) return why;
    }
    return "";
  }

  std::string row(std::span<const double> numbers) {
    PointRow row;
    if (has(columns_, PointField::kX)) row.point = Eigen::Vector3d::Zero();
    if (has(columns_, PointField::kU)) row.seen = Pixel{};
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const double value = numbers[i];
      if (columns_[i].field == PointField::kId &&
          (!(value >= 0) || value > 1e9 || value != std::floor(value))) {
        return fmt::format("has the id {}, where ids are whole numbers from 0 on", value);
      }
      put(columns_[i].field, columns_[i].sign * value, unit_.value_or(1), row);
    }
    rows_.push_back(row);
    return "";
  }

  Columns columns_;
  std::optional<double> unit_;
  bool given_;
  std::vector<PointRow> rows_;
};

Result<std::vector<PointRow>> parse_lines(std::string_view content, const PointRowsFormat& format,
                                          std::string_view name) {
  const std::string file =
      name.empty() ? std::string("The text of points") : fmt::format("'{}'", shortened(name, 400));
  RowReader reader(format);
  std::size_t number = 0;
  for (const std::string_view line : io::lines_of(content)) {
    ++number;
    if (const std::string why = reader.line(line); !why.empty()) {
      return make_error(ErrorCode::kMalformed,
                        fmt::format("{} cannot be used: line {} {}.", file, number, why));
    }
  }
  std::vector<PointRow> rows = reader.take();
  if (rows.empty()) {
    return make_error(ErrorCode::kMalformed, fmt::format("{} has no row of numbers.", file));
  }
  return rows;
}

}  // namespace

Result<std::vector<PointColumn>> parse_point_columns(std::string_view text) {
  auto columns = parse_columns(fields_of(text));
  if (columns) return columns;
  return make_error(columns.error().code,
                    fmt::format("The columns '{}' are wrong: {}. A right text is X,Y,Z,u,v.",
                                shortened(text, 100), columns.error().message));
}

Result<std::vector<PointRow>> parse_point_rows(std::string_view content,
                                               const PointRowsFormat& format,
                                               std::string_view name) {
  try {
    return parse_lines(content, format, name);
  } catch (const std::exception&) {
    return make_error(ErrorCode::kMalformed, "There is no memory for so many points.");
  }
}

Result<std::vector<PointRow>> read_point_rows(const std::filesystem::path& path,
                                              const PointRowsFormat& format) {
  const auto content = read_file(path.string());
  if (!content) return tl::unexpected<Error>(content.error());
  return parse_point_rows(*content, format, path.string());
}

Result<Board> board_of_rows(const std::vector<PointRow>& rows, std::string name) {
  std::vector<PointBoard::Dot> dots;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!rows[i].point) {
      return make_error(ErrorCode::kMalformed,
                        fmt::format("'{}' has no points: its rows need X and Y.", name));
    }
    const Eigen::Vector3d& p = *rows[i].point;
    dots.push_back({rows[i].id.value_or(static_cast<int>(i)), p.x(), p.y(), rows[i].diameter, p.z(),
                    rows[i].normal});
  }
  auto board = PointBoard::make(std::move(name), std::move(dots));
  if (!board) return tl::unexpected<Error>(board.error());
  return Board(*std::move(board));
}

}  // namespace calvin
