#include "sightline/ros/recordings/task_thread.h"

#include <future>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace {

using sightline_ros::TaskThread;

TEST(TaskThread, TasksAreDoneInTheirOrderInAnotherThread) {
  std::vector<int> order;
  std::thread::id id;
  TaskThread thread;
  for (int i = 0; i < 100; ++i) thread.add([&order, i] { order.push_back(i); });
  thread.add([&id] { id = std::this_thread::get_id(); }).get();
  ASSERT_EQ(order.size(), 100u);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(order[static_cast<std::size_t>(i)], i);
  EXPECT_NE(id, std::this_thread::get_id());
}

TEST(TaskThread, WhoWaitsIsToldWhatATaskThrewAndTheNextIsDone) {
  TaskThread thread;
  const auto failed = thread.add([] { throw std::runtime_error("the reason"); });
  bool is_done = false;
  const auto next = thread.add([&is_done] { is_done = true; });
  EXPECT_THROW(failed.get(), std::runtime_error);
  next.get();
  EXPECT_TRUE(is_done);
}

TEST(TaskThread, AtItsEndTasksThatHaveNotBegunAreDropped) {
  std::promise<void> begun, go;
  bool is_done = false, is_next_done = false;
  std::shared_future<void> first, next;
  {
    auto thread = std::make_unique<TaskThread>();
    first = thread->add([&] {
      begun.set_value();
      go.get_future().wait();
      is_done = true;
    });
    next = thread->add([&] { is_next_done = true; });
    begun.get_future().wait();
    std::thread end([&] { thread.reset(); });
    EXPECT_THROW(next.get(), std::future_error) << "it is dropped while the first is still being done";
    go.set_value();
    end.join();
  }
  first.get();
  EXPECT_TRUE(is_done);
  EXPECT_FALSE(is_next_done);
}

}  // namespace
