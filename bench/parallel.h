#pragma once

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace sightline::bench {

/// Calls work(run) for run = 0 .. runs - 1 on several threads, in any order; work writes to places of its
/// own. The first exception is thrown on.
template <typename Work>
void forEachRun(int runs, int threads, const Work& work) {
  std::atomic<int> next{0};
  std::exception_ptr failure;
  std::mutex failing;
  const auto loop = [&] {
    for (int run = next++; run < runs; run = next++) {
      try {
        work(run);
      } catch (...) {
        const std::lock_guard<std::mutex> lock(failing);
        if (!failure) failure = std::current_exception();
        next = runs;
      }
    }
  };
  std::vector<std::thread> others;
  for (int k = 1; k < threads; ++k) others.emplace_back(loop);
  loop();
  for (std::thread& other : others) other.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace sightline::bench
