// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Replays the corpus of a target and deterministic mutations of it, without a fuzzing engine.
//   driver TARGET FOLDER [COUNT]    CALVIN_FULL=1: fifty times COUNT
// An input that breaks a promise is left in TARGET.crash in the working folder.

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include <gst/gst.h>

#include "targets.hpp"

namespace {

using Random = std::mt19937;
using Corpus = std::vector<std::string>;

// What parsers stumble over, whatever the format.
const char* const kWords[] = {
    "nan",
    "inf",
    "-inf",
    "1e308",
    "1e-320",
    "-0",
    "0x1p3",
    "99999999999999999999",
    "{",
    "}",
    "[",
    "]",
    "\"",
    ":",
    ",",
    ";",
    "#",
    "\n",
    "\t",
    "\\u0",
    "\xff",
    "\xef",
    "&a",
    "*a",
    "<!--",
    "<![CDATA[",
    "%YAML:1.0\n",
    "---\n",
    "!!opencv-matrix",
    "null",
    "true",
    "-1",
};

std::size_t place(Random& random, const std::string& text) {
  return text.empty() ? 0 : random() % (text.size() + 1);
}

void mutate_once(std::string& text, const Corpus& corpus, Random& random) {
  const std::size_t at = place(random, text);
  const std::size_t length = std::min<std::size_t>(random() % 24, text.size() - at);
  switch (random() % 8) {
    case 0:
      if (at < text.size()) text[at] = static_cast<char>(text[at] ^ (1 << random() % 8));
      break;
    case 1:
      text.erase(at, length);
      break;
    case 2:
      text.insert(at, kWords[random() % std::size(kWords)]);
      break;
    case 3:
      text.replace(at, length, kWords[random() % std::size(kWords)]);
      break;
    case 4:
      text.resize(at);
      break;
    case 5: {
      const std::string part = text.substr(at, length);
      const std::size_t times = 1 + random() % (random() % 16 == 0 ? 4000 : 4);
      for (std::size_t i = 0; i < times; ++i) text.insert(at, part);
      break;
    }
    case 6: {
      const std::string& other = corpus[random() % corpus.size()];
      text.replace(at, std::string::npos, other, std::min(at, other.size()), std::string::npos);
      break;
    }
    default:
      if (at < text.size()) text[at] = static_cast<char>('0' + random() % 10);
  }
}

Corpus read_corpus(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  Corpus corpus;
  for (const auto& path : paths) {
    std::ifstream file(path, std::ios::binary);
    corpus.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return corpus;
}

std::string crash_file;
const std::string* running = nullptr;

// Keeps the input that ended the process. Nothing here but what a signal handler may call.
void on_crash(int signal) {
  const int file = open(crash_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (file >= 0 && running != nullptr) {
    const auto written = write(file, running->data(), running->size());
    static_cast<void>(written);
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void run(const calvin::fuzz::Target& target, const std::string& input) {
  running = &input;
  target.run(input);
  running = nullptr;
}

}  // namespace

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  const auto* target = argc > 2 ? calvin::fuzz::find_target(argv[1]) : nullptr;
  if (target == nullptr) {
    std::fprintf(stderr, "usage: driver TARGET FOLDER [COUNT]; the targets are:\n");
    for (const auto& t : calvin::fuzz::targets()) std::fprintf(stderr, "  %s\n", t.name.data());
    return 2;
  }
  const Corpus corpus = read_corpus(argv[2]);
  if (corpus.empty()) {
    std::fprintf(stderr, "%s is empty\n", argv[2]);
    return 1;
  }
  crash_file = std::string(target->name) + ".crash";
  for (const int signal : {SIGABRT, SIGSEGV, SIGFPE, SIGILL}) std::signal(signal, on_crash);
  for (const std::string& input : corpus) run(*target, input);
  run(*target, "");

  long count = argc > 3 ? std::atol(argv[3]) : 1000;
  if (std::getenv("CALVIN_FULL") != nullptr) count *= 50;
  Random random(1);
  for (long i = 0; i < count; ++i) {
    std::string input = corpus[random() % corpus.size()];
    const std::size_t steps = 1 + random() % 6;
    for (std::size_t k = 0; k < steps; ++k) mutate_once(input, corpus, random);
    run(*target, input);
  }
  std::printf("%s: %zu files and %ld mutations\n", target->name.data(), corpus.size(), count);
  return 0;
}
