// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Prints what Google Benchmark measures as a table: every subject beside ours, with the ratio.
#pragma once

#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

namespace bench {

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
      if (rows_.find(what) == rows_.end()) order_.push_back(what);
      const double seconds =
          run.GetAdjustedCPUTime() / benchmark::GetTimeUnitMultiplier(run.time_unit);
      rows_[what].emplace_back(name.substr(bar + 1), seconds);
    }
  }

  void Finalize() override {
    std::printf("%-28s %-28s %12s %8s\n", "case", "subject", "CPU, ms", "ratio");
    for (const std::string& what : order_) {
      double ours = 0;
      for (const auto& [subject, seconds] : rows_[what]) {
        if (subject == "calvin") ours = seconds;
      }
      for (const auto& [subject, seconds] : rows_[what]) {
        std::printf("%-28s %-28s %12.4f", what.c_str(), subject.c_str(), 1e3 * seconds);
        if (ours > 0) std::printf(" %8.1f", seconds / ours);
        std::printf("\n");
      }
    }
  }

 private:
  std::map<std::string, std::vector<std::pair<std::string, double>>> rows_;
  std::vector<std::string> order_;
};

}  // namespace bench
