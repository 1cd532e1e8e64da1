#pragma once

#include <array>
#include <cstdio>
#include <string>
#include <sys/wait.h>
#include <utility>

/// Runs a command to its end: exit code (-1 when it did not exit by itself), and everything that it printed.
inline std::pair<int, std::string> outcomeOf(const std::string& command) {
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return {-1, "cannot start " + command};
  std::string printed;
  std::array<char, 512> buffer;
  while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) printed += buffer.data();
  const int status = pclose(pipe);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, printed};
}

/// Whether `evaluate --html` can make pages.
inline bool hasPlotly() {
  return outcomeOf("/usr/bin/python3 -c 'import plotly, numpy'").first == 0;
}
