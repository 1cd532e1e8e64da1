#pragma once

#include <optional>
#include <signal.h>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "support/waiting.h"

/// A command under way; it is ended with the object.
class CommandUnderWay {
 public:
  explicit CommandUnderWay(std::vector<std::string> words) {
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    pid_ = fork();
    if (pid_ == 0) {
      execvp(argv[0], argv.data());
      _exit(127);
    }
  }

  ~CommandUnderWay() {
    if (exitCode()) return;
    kill(pid_, SIGINT);
    waitpid(pid_, nullptr, 0);
  }

  CommandUnderWay(const CommandUnderWay&) = delete;
  CommandUnderWay& operator=(const CommandUnderWay&) = delete;

  /// Serves callbacks until it has ended; false when it has not within `patience` [s].
  bool endsWithin(double patience) {
    return eventually([this] { return exitCode().has_value(); }, [] {}, ros::WallDuration(0.01), patience);
  }

  /// Its exit code, once it has ended.
  std::optional<int> exitCode() {
    int status = 0;
    if (!exit_code_ && waitpid(pid_, &status, WNOHANG) == pid_) {
      exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    return exit_code_;
  }

 private:
  pid_t pid_ = -1;
  std::optional<int> exit_code_;
};

/// roslaunch of one of the package's files under way; it is ended with the object.
class Launch : public CommandUnderWay {
 public:
  /// `prefix`: a command that runs roslaunch, with its arguments.
  Launch(const std::string& file, const std::vector<std::string>& arguments,
         const std::vector<std::string>& prefix = {})
      : CommandUnderWay(wordsOf(file, arguments, prefix)) {}

 private:
  static std::vector<std::string> wordsOf(const std::string& file, const std::vector<std::string>& arguments,
                                          std::vector<std::string> words) {
    words.insert(words.end(), {"roslaunch", "--no-summary", "sightline", file});
    words.insert(words.end(), arguments.begin(), arguments.end());
    return words;
  }
};
