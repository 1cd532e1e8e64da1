#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <mutex>
#include <thread>

namespace sightline_ros {

/// Does tasks one after the other, in the order in which they were given, in a thread of its own.
class TaskThread {
 public:
  TaskThread();
  TaskThread(const TaskThread&) = delete;
  TaskThread& operator=(const TaskThread&) = delete;

  /// Ends the task that is being done and drops the others: who waits for one of those gets a
  /// std::future_error.
  ~TaskThread();

  /// Is ready when the task is done, with what it threw.
  std::shared_future<void> add(std::function<void()> task);

 private:
  void run();

  std::mutex mutex_;
  std::condition_variable has_work_;
  std::deque<std::packaged_task<void()>> tasks_;
  bool is_ending_ = false;
  std::thread thread_;  // the last: it uses the others
};

}  // namespace sightline_ros
