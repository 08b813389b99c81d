// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Prints what Google Benchmark measures as a table: every subject beside ours, with the ratio.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

namespace bench {

// benchmark::Initialize(), for subjects that take milliseconds: the medians of short runs of all of
// them in any order, since the speed of a machine may change from second to second. What the
// command line says comes last.
inline void initialize_interleaved(int argc, char** argv) {
  static std::array<std::string, 3> flags = {"--benchmark_repetitions=11",
                                             "--benchmark_enable_random_interleaving=true",
                                             "--benchmark_min_time=0.1"};
  std::vector<char*> all = {argv[0]};
  for (std::string& flag : flags) all.push_back(flag.data());
  all.insert(all.end(), argv + 1, argv + argc);
  auto count = static_cast<int>(all.size());
  benchmark::Initialize(&count, all.data());
}

// Benchmarks are named "case|subject"; the subject "calvin" is the one that others are divided by.
class RatioReporter : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context& /*context*/) override { return true; }

  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      const bool repeated = run.repetitions > 1;
      if (repeated && run.aggregate_name != "median") continue;
      const std::string name = run.run_name.function_name;
      const auto bar = name.find('|');
      if (bar == std::string::npos) continue;
      const std::string what = name.substr(0, bar);
      const double seconds =
          run.GetAdjustedCPUTime() / benchmark::GetTimeUnitMultiplier(run.time_unit);
      rows_.push_back({run.family_index, what, name.substr(bar + 1), seconds});
      if (rows_.back().subject == "calvin") ours_[what] = seconds;
    }
  }

  void Finalize() override {
    // As they were registered, in whichever order they ran.
    std::stable_sort(rows_.begin(), rows_.end(),
                     [](const Row& a, const Row& b) { return a.index < b.index; });
    std::printf("%-28s %-28s %12s %8s\n", "case", "subject", "CPU, ms", "ratio");
    for (const Row& row : rows_) {
      std::printf("%-28s %-28s %12.4f", row.what.c_str(), row.subject.c_str(), 1e3 * row.seconds);
      const auto ours = ours_.find(row.what);
      if (ours != ours_.end()) std::printf(" %8.1f", row.seconds / ours->second);
      std::printf("\n");
    }
  }

 private:
  struct Row {
    std::int64_t index;
    std::string what;
    std::string subject;
    double seconds;
  };
  std::vector<Row> rows_;
  std::map<std::string, double> ours_;
};

}  // namespace bench
