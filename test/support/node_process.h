#pragma once

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <signal.h>
#include <string>
#include <sys/types.h>
#include <utility>
#include <vector>

#include <ros/master.h>

/// Letter of a process's state (proc(5)): R, S, D run or wait, T is stopped, Z has ended; nullopt: there is
/// no such process.
inline std::optional<char> stateOf(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  const std::string line{std::istreambuf_iterator<char>(file), {}};
  const std::size_t end_of_name = line.rfind(')');
  if (end_of_name == std::string::npos || end_of_name + 2 >= line.size()) return std::nullopt;
  return line[end_of_name + 2];
}

/// Process of the node of that full name, which roslaunch started on this machine under this test's master;
/// nullopt when there is none. Asks the kernel, not the node: one that is stopped answers nothing.
inline std::optional<pid_t> processOf(const std::string& node) {
  const auto words = [](const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::vector<std::string> found;
    for (std::string word; std::getline(stream, word, '\0');) found.push_back(word);
    return found;
  };
  const auto has = [](const std::vector<std::string>& all, const std::string& word) {
    return std::find(all.begin(), all.end(), word) != all.end();
  };
  const std::size_t slash = node.rfind('/');
  const std::string space = slash == 0 ? "/" : node.substr(0, slash);
  std::error_code ignored;  // processes come and go meanwhile
  for (const auto& entry : std::filesystem::directory_iterator("/proc", ignored)) {
    const std::string name = entry.path().filename();
    if (!std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isdigit(c) != 0; }))
      continue;
    if (!has(words(entry.path() / "cmdline"), "__name:=" + node.substr(slash + 1))) continue;
    const auto environment = words(entry.path() / "environ");
    if (!has(environment, "ROS_NAMESPACE=" + space)) continue;
    if (!has(environment, "ROS_MASTER_URI=" + ros::master::getURI())) continue;
    const pid_t process = std::stoi(name);
    if (stateOf(process).value_or('Z') != 'Z') return process;
  }
  return std::nullopt;
}

/// A process that is stopped (SIGSTOP) as long as this object lives, however the test ends.
class Stopped {
 public:
  explicit Stopped(pid_t process) : process_(process) { kill(process_, SIGSTOP); }
  ~Stopped() { kill(process_, SIGCONT); }
  Stopped(const Stopped&) = delete;
  Stopped& operator=(const Stopped&) = delete;

  bool standsStill() const { return stateOf(process_) == 'T'; }

 private:
  pid_t process_;
};
