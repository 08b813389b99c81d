// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Builds the tree from the events of a parser, with bounds on its depth and on the number of
// values; checked access to nodes.

#include "calvin/io/document.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "calvin/core/text.hpp"

namespace calvin::io {

namespace {

constexpr int kMaxValues = 2'000'000;

const Node kNothing;

// The first key that occurs twice, or nullptr.
const std::string* repeated(const std::vector<std::string>& keys) {
  std::vector<const std::string*> sorted;
  for (const std::string& key : keys) sorted.push_back(&key);
  std::sort(sorted.begin(), sorted.end(), [](auto* a, auto* b) { return *a < *b; });
  const auto it =
      std::adjacent_find(sorted.begin(), sorted.end(), [](auto* a, auto* b) { return *a == *b; });
  return it == sorted.end() ? nullptr : *it;
}

}  // namespace

const Node* Node::find(std::string_view key) const noexcept {
  const auto it = std::find(keys.begin(), keys.end(), key);
  return it == keys.end() ? nullptr : &items[static_cast<std::size_t>(it - keys.begin())];
}

void Node::erase(std::string_view key) {
  const auto it = std::find(keys.begin(), keys.end(), key);
  if (kind != Kind::kMap || it == keys.end()) return;
  items.erase(items.begin() + (it - keys.begin()));
  keys.erase(it);
}

Node* Node::find(std::string_view key) noexcept {
  return const_cast<Node*>(std::as_const(*this).find(key));
}

bool DocumentBuilder::refuse(std::string why) {
  if (refusal_.empty()) refusal_ = std::move(why);
  return false;
}

bool DocumentBuilder::wants_key() const noexcept {
  return !open_.empty() && open_.back().kind == Node::Kind::kMap &&
         open_.back().keys.size() == open_.back().items.size();
}

std::string DocumentBuilder::path() const {
  std::string path;
  for (const Node& node : open_) {
    if (node.kind == Node::Kind::kList) {
      path += fmt::format("[{}]", node.items.size());
    } else if (!node.keys.empty()) {
      path += (path.empty() ? "" : ".") + node.keys.back();
    }
  }
  return path;
}

bool DocumentBuilder::key(std::string text) {
  if (!wants_key()) return refuse("a key stands where a value is expected");
  open_.back().keys.push_back(std::move(text));
  return true;
}

bool DocumentBuilder::add(Node node) {
  if (open_.empty()) {
    root_ = std::move(node);
    return true;
  }
  if (wants_key()) return refuse("a value has no key");
  open_.back().items.push_back(std::move(node));
  return true;
}

bool DocumentBuilder::scalar(Node::Kind kind, std::string text) {
  if (++values_ > kMaxValues) return refuse(fmt::format("there are over {} values", kMaxValues));
  return add({kind, std::move(text), {}, {}});
}

bool DocumentBuilder::begin(Node::Kind kind) {
  if (++values_ > kMaxValues) return refuse(fmt::format("there are over {} values", kMaxValues));
  if (open_.size() >= kMaxDepth) {
    return refuse(fmt::format("values are nested more than {} deep", kMaxDepth));
  }
  if (wants_key()) return refuse("a key is not a plain word");
  open_.push_back({kind, {}, {}, {}});
  return true;
}

bool DocumentBuilder::end() {
  if (open_.empty()) return refuse("a closing bracket is too many");
  Node node = std::move(open_.back());
  open_.pop_back();
  if (node.keys.size() > node.items.size()) return refuse("a key has no value");
  if (const std::string* key = repeated(node.keys)) {
    return refuse(fmt::format("'{}' occurs twice", *key));
  }
  return add(std::move(node));
}

Result<Node> DocumentBuilder::take() {
  if (!refusal_.empty()) return make_error(ErrorCode::kMalformed, refusal_);
  if (!open_.empty() || !root_) return make_error(ErrorCode::kMalformed, "the text ends too early");
  return std::move(*root_);
}

std::string place(std::string_view content, std::size_t offset) {
  if (offset >= content.size()) return "at its end: it may have been cut off";
  const auto newlines =
      std::count(content.begin(), content.begin() + static_cast<std::ptrdiff_t>(offset), '\n');
  return fmt::format("in line {}", newlines + 1);
}

Fields::Fields(const Node& node, std::string path, std::optional<Error>& error)
    : node_(node), path_(std::move(path)), error_(error) {}

void Fields::complain(std::string_view key, std::string_view why, ErrorCode code) {
  if (!error_) error_ = Error{code, fmt::format("'{}{}' {}", path_, key, why)};
}

const Node* Fields::required(std::string_view key) {
  const Node* node = find(key);
  if (node == nullptr) complain(key, "is missing");
  return node;
}

double Fields::to_number(std::string_view key, const Node& node) {
  const auto value =
      node.kind == Node::Kind::kPlain ? parse_double(node.text) : std::optional<double>();
  if (!value) complain(key, "is not a finite number");
  return value.value_or(0);
}

double Fields::number(std::string_view key) {
  const Node* node = required(key);
  return node == nullptr ? 0 : to_number(key, *node);
}

std::optional<double> Fields::optional_number(std::string_view key) {
  const Node* node = find(key);
  if (node == nullptr) return std::nullopt;
  return to_number(key, *node);
}

int Fields::integer(std::string_view key) {
  const double value = number(key);
  if (std::abs(value) <= 1e9 && value == static_cast<int>(value)) return static_cast<int>(value);
  complain(key, "is not a whole number in range");
  return 0;
}

std::optional<std::uint64_t> Fields::optional_time(std::string_view key) {
  const Node* node = find(key);
  if (node == nullptr) return std::nullopt;
  std::uint64_t value = 0;
  const char* last = node->text.data() + node->text.size();
  const auto [end, error] = std::from_chars(node->text.data(), last, value);
  if (node->kind != Node::Kind::kPlain || error != std::errc() || end != last) {
    complain(key, "is not a time in whole nanoseconds");
  }
  return value;
}

bool Fields::flag(std::string_view key) {
  const Node* node = find(key);
  if (node == nullptr) return false;
  const bool plain = node->kind == Node::Kind::kPlain;
  if (!plain || (node->text != "true" && node->text != "false")) {
    complain(key, "is neither true nor false");
  }
  return node->text == "true";
}

std::string Fields::string(std::string_view key) {
  required(key);
  return optional_string(key);
}

std::string Fields::optional_string(std::string_view key) {
  const Node* node = find(key);
  if (node == nullptr) return {};
  if (node->kind != Node::Kind::kString) complain(key, "is not a text in quotes");
  return node->text;
}

std::string Fields::word(std::string_view key) {
  const Node* node = find(key);
  return node == nullptr ? std::string() : node->text;
}

std::vector<double> Fields::to_numbers(std::string_view key, const Node& node, std::size_t count) {
  std::vector<double> values;
  if (node.kind == Node::Kind::kPlain) {
    values.push_back(to_number(key, node));
  } else if (node.kind != Node::Kind::kList) {
    complain(key, "is not a list of numbers");
  } else {
    for (const Node& item : node.items) values.push_back(to_number(key, item));
  }
  if (count == 0) return values;
  if (values.size() != count) complain(key, fmt::format("is not a list of {} numbers", count));
  values.resize(count);
  return values;
}

std::vector<double> Fields::numbers(std::string_view key, std::size_t count) {
  const Node* node = required(key);
  return node == nullptr ? std::vector<double>(count) : to_numbers(key, *node, count);
}

std::vector<std::vector<double>> Fields::rows(std::string_view key, std::size_t count) {
  std::vector<std::vector<double>> rows;
  for (const Node& row : list(key)) rows.push_back(to_numbers(key, row, count));
  return rows;
}

Fields Fields::map(std::string_view key) {
  const Node* node = required(key);
  if (node != nullptr && node->kind != Node::Kind::kMap) complain(key, "is not a group of fields");
  return {node == nullptr ? kNothing : *node, fmt::format("{}{}.", path_, key), error_};
}

const std::vector<Node>& Fields::list(std::string_view key) {
  const Node* node = find(key);
  if (node == nullptr) return kNothing.items;
  if (node->kind != Node::Kind::kList) complain(key, "is not a list");
  return node->items;
}

}  // namespace calvin::io
