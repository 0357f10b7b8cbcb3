// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>

#include <sys/wait.h>
#include <unistd.h>

#include "sdk/host/base/temporary_folder.hpp"
#include "sdk/tools/benchmarks/bench_store.hpp"
#include "sdk/tools/console/console.hpp"

namespace odograph {
namespace {

namespace fs = std::filesystem;

/// Calls that run in processes of their own, and what they say in a file each.
class Children {
 public:
  using Call = std::function<Result<Json>()>;

  bool start(size_t number, const Call& call) {
    std::fflush(nullptr);
    const pid_t child = fork();
    if (child == 0) {
      const Result<Json> said = call();
      std::ofstream(file(number)) << (said ? Json{{"row", *said}}
                                           : Json{{"status", said.failure().status}, {"text", said.failure().text}})
                                         .dump(-1, ' ', false, Json::error_handler_t::replace);
      std::fflush(nullptr);
      _exit(0);
    }
    if (child > 0) running_[child] = number;
    return child > 0;
  }

  size_t running() const { return running_.size(); }

  /// Waits for one of them.
  std::pair<size_t, Result<Json>> wait() {
    int status = 0;
    pid_t child = 0;
    while (running_.count(child) == 0 && child >= 0) child = waitpid(-1, &status, 0);
    if (child < 0) child = running_.begin()->first, status = -1;
    const size_t number = running_[child];
    running_.erase(child);
    std::ifstream in(file(number));
    const Json said = in ? Json::parse(in, nullptr, false) : Json();
    if (said.is_object() && said.contains("row")) return {number, said["row"]};
    if (said.is_object() && said.contains("text")) return {number, Failure{said["status"], said["text"]}};
    const std::string how = WIFSIGNALED(status) ? text("signal %d", WTERMSIG(status)) : text("status %d", status);
    return {number, Failure{ODO_E_ERROR, "the process of a run ended by " + how}};
  }

 private:
  fs::path file(size_t number) const { return folder_ / std::to_string(number); }

  TemporaryFolder folder_;
  std::map<pid_t, size_t> running_;
};

std::string name_of(const BenchCase& one) {
  std::string name;
  for (const auto& label : one.labels)
    name += (name.empty() ? "" : " ") + (label.is_string() ? stem_of(label.get<std::string>()) : label.dump());
  return name;
}

Result<Json> measured(const Benchmark& benchmark, const BenchCase& one, bool shown) {
  if (!shown) return benchmark.measure(one, {});
  Progress progress(name_of(one));
  return benchmark.measure(one, [&](size_t i, size_t n) { progress.show(i, n); });
}

/// A row's labels, then what was measured.
Json labelled(const BenchCase& one, const Json& figures) {
  Json row = one.labels;
  for (const auto& label : one.labels.items()) row["_labels"].push_back(label.key());
  row.update(figures);
  return row;
}

}  // namespace

std::string stem_of(const fs::path& path) {
  return (path.has_filename() ? path : path.parent_path()).stem().string();  // FOLDER/
}

Result<Json> in_child(const std::function<Result<Json>()>& call) {
  Children children;
  if (!children.start(0, call)) return call();
  return children.wait().second;
}

Result<Rows> rows_of(const Benchmark& benchmark, const std::vector<BenchCase>& cases) {
  const BenchOptions& options = benchmark.options;
  RowStore store(fs::path(options.keep) / "rows");
  Rows rows(cases.size()), keys(cases.size());
  std::vector<size_t> missing;
  for (size_t i = 0; i < cases.size(); ++i) {
    auto key = store.key_of(benchmark, cases[i]);
    if (!key) return key.failure();
    keys[i] = std::move(*key);
    const auto kept = options.fresh ? std::nullopt : store.find(keys[i]);
    if (kept)
      rows[i] = labelled(cases[i], *kept);
    else
      missing.push_back(i);
  }
  if (missing.size() < cases.size())
    std::fprintf(stderr, "%zu of %zu rows are of an earlier run (%s/rows; --fresh measures them again)\n",
                 cases.size() - missing.size(), cases.size(), options.keep.c_str());
  const size_t jobs = std::min(std::max<size_t>(1, options.jobs), std::max<size_t>(1, missing.size()));
  Progress progress("bench " + benchmark.name);
  Children children;
  std::map<size_t, Failure> failures;
  for (size_t next = 0, done = 0; done < missing.size(); ++done) {
    for (; next < missing.size() && children.running() < jobs && failures.empty(); ++next) {
      const BenchCase& one = cases[missing[next]];
      if (!children.start(missing[next], [&] { return measured(benchmark, one, jobs == 1); }))
        return Failure{ODO_E_ERROR, "no process can be started"};
    }
    if (children.running() == 0) break;
    const auto [number, row] = children.wait();
    if (row)
      store.keep(keys[number], *row), rows[number] = labelled(cases[number], *row);
    else
      failures.emplace(number, row.failure());
    if (jobs > 1) progress.show(done + 1, missing.size());
  }
  if (!failures.empty()) return failures.begin()->second;
  return rows;
}

}  // namespace odograph
