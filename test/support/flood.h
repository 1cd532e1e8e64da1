#pragma once

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <signal.h>
#include <string>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include <ros/ros.h>
#include <sightline/SightingArray.h>

#include "support/scans.h"

/// A sensor's driver that runs wild: a process of its own, with a connection of its own, that sends scans of
/// false sightings as fast as it is told to. It is this test's program again: its main calls `floodIfTold`
/// first.
class Flood {
 public:
  /// `count` scans at `rate` [1/s] of `sensor` to `topic`, once that has as many subscribers.
  Flood(const std::string& topic, const std::string& sensor, std::size_t subscribers, int count,
        double rate) {
    std::vector<std::string> words = {"flood",
                                      kWord,
                                      topic,
                                      sensor,
                                      std::to_string(subscribers),
                                      std::to_string(count),
                                      std::to_string(rate)};
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    int ends[2] = {-1, -1};
    if (pipe2(ends, O_CLOEXEC) != 0) return;
    fcntl(ends[0], F_SETFL, O_NONBLOCK);
    process_ = fork();
    if (process_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      dup2(ends[1], STDOUT_FILENO);
      execv("/proc/self/exe", argv.data());
      _exit(127);
    }
    close(ends[1]);
    said_ = ends[0];
  }

  ~Flood() {
    if (process_ > 0) {
      kill(process_, SIGKILL);
      waitpid(process_, nullptr, 0);
    }
    close(said_);
  }
  Flood(const Flood&) = delete;
  Flood& operator=(const Flood&) = delete;

  /// Whether all has been sent. What waits in its queue then is still delivered while this object lives.
  bool isOver() {
    char letter = 0;
    while (read(said_, &letter, 1) == 1) line_ += letter;
    return line_.find('\n') != std::string::npos;
  }

  /// How long it took [s], once it is over.
  double duration() const { return std::atof(line_.c_str()); }

  static int floodIfTold(int argc, char** argv) {
    if (argc != 7 || std::string(argv[1]) != kWord) return -1;
    const int count = std::atoi(argv[5]);
    const double rate = std::atof(argv[6]);
    ros::init(argc, argv, "flood", ros::init_options::AnonymousName | ros::init_options::NoRosout);
    ros::NodeHandle nh;
    const auto publisher = nh.advertise<sightline::SightingArray>(argv[2], static_cast<std::uint32_t>(count));
    while (ros::ok() && publisher.getNumSubscribers() < std::strtoul(argv[4], nullptr, 10))
      ros::WallDuration(0.01).sleep();
    std::mt19937_64 random(2);
    std::normal_distribution<double> normal;
    const ros::WallTime begin = ros::WallTime::now();
    for (int i = 0; i < count && ros::ok(); ++i) {
      const ros::WallTime due = begin + ros::WallDuration(i / rate);
      if (due > ros::WallTime::now()) ros::WallTime::sleepUntil(due);
      auto scan = scanOf(argv[3], 0.0, {{2.0 + 0.3 * normal(random), 0.2 * normal(random)}});
      scan.header.stamp = ros::Time::now();
      publisher.publish(scan);
    }
    std::printf("%.3f\n", (ros::WallTime::now() - begin).toSec());
    std::fflush(stdout);
    ros::waitForShutdown();
    return 0;
  }

 private:
  static constexpr const char* kWord = "--flood";

  pid_t process_ = -1;
  int said_ = -1;
  std::string line_;
};
