// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Prints what Google Benchmark measures as a table: every subject beside ours, with the ratio, and
// from which to which both went from run to run.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "spread.hpp"

namespace bench {

// benchmark::Initialize() for several runs of all subjects in any order, since the speed of a
// machine may change from second to second. What the command line says comes last.
inline void initialize_interleaved(int argc, char** argv, int runs = 11) {
  static std::array<std::string, 3> flags = {"--benchmark_repetitions=" + std::to_string(runs),
                                             "--benchmark_enable_random_interleaving=true",
                                             "--benchmark_min_time=0.1"};
  std::vector<char*> all = {argv[0]};
  for (std::string& flag : flags) all.push_back(flag.data());
  all.insert(all.end(), argv + 1, argv + argc);
  auto count = static_cast<int>(all.size());
  benchmark::Initialize(&count, all.data());
}

// Benchmarks are named "case|subject"; the subject "calvin" is the one that others are divided by,
// each run by the run of the same number.
class RatioReporter : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context& /*context*/) override { return true; }

  void ReportRuns(const std::vector<Run>& runs) override {
    Row row;
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration || !(run.GetAdjustedCPUTime() > 0)) continue;
      const std::string& name = run.run_name.function_name;
      const auto bar = name.find('|');
      if (bar == std::string::npos) continue;
      row.index = run.family_index;
      row.what = name.substr(0, bar);
      row.subject = name.substr(bar + 1);
      row.ms.push_back(1e3 * run.GetAdjustedCPUTime() /
                       benchmark::GetTimeUnitMultiplier(run.time_unit));
    }
    if (row.ms.empty()) return;
    if (row.subject == "calvin") ours_[row.what] = row.ms;
    rows_.push_back(std::move(row));
  }

  void Finalize() override {
    // As they were registered, in whichever order they ran.
    std::stable_sort(rows_.begin(), rows_.end(),
                     [](const Row& a, const Row& b) { return a.index < b.index; });
    std::printf("%-28s %-28s %32s   %26s\n", "case", "subject", "CPU, ms: median (from .. to)",
                "ratio (from .. to)");
    for (const Row& row : rows_) {
      const Spread ms = spread_of(row.ms);
      std::printf("%-28s %-28s %10.4f (%9.4f ..%9.4f)", row.what.c_str(), row.subject.c_str(),
                  ms.median, ms.least, ms.most);
      const auto ours = ours_.find(row.what);
      if (ours != ours_.end()) {
        const Spread ratio = spread_of(ratios(row.ms, ours->second));
        std::printf("   %8.2f (%7.2f ..%7.2f)", ratio.median, ratio.least, ratio.most);
      }
      std::printf("\n");
    }
  }

 protected:
  // Of ours, ms; not a number where the case was not run.
  [[nodiscard]] double our_median(const std::string& what) const {
    const auto ours = ours_.find(what);
    return ours == ours_.end() ? NAN : spread_of(ours->second).median;
  }

  // The times of a subject over those of another one in the same case; not numbers where one of
  // them was not run.
  [[nodiscard]] Spread ratio_of(const std::string& what, const std::string& subject,
                                const std::string& over) const {
    return spread_of(ratios(times_of(what, subject), times_of(what, over)));
  }

 private:
  struct Row {
    std::int64_t index = 0;
    std::string what;
    std::string subject;
    std::vector<double> ms;  // of each run
  };

  [[nodiscard]] std::vector<double> times_of(const std::string& what,
                                             const std::string& subject) const {
    const auto row = std::find_if(rows_.begin(), rows_.end(), [&](const Row& r) {
      return r.what == what && r.subject == subject;
    });
    return row == rows_.end() ? std::vector<double>() : row->ms;
  }

  std::vector<Row> rows_;
  std::map<std::string, std::vector<double>> ours_;
};

}  // namespace bench
