#pragma once

#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace sightline_ros {

/// A command line that cannot be understood; the message says why.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The arguments of an offline tool: `--name VALUE` or `--name=VALUE` in any place, the rest in order.
class CommandLine {
 public:
  /// `options`: the names that are known, with their dashes; every one takes a value. `least` to `most` other
  /// arguments are expected. Throws UsageError.
  CommandLine(const std::vector<std::string>& words, const std::vector<std::string>& options,
              std::size_t least, std::size_t most);

  bool has(const std::string& option) const { return options_.count(option) > 0; }
  std::string option(const std::string& option, const std::string& fallback) const;

  /// Every value that was given for an option, in order.
  std::vector<std::string> all(const std::string& option) const;

  const std::vector<std::string>& arguments() const { return arguments_; }

 private:
  std::map<std::string, std::vector<std::string>> options_;
  std::vector<std::string> arguments_;
};

/// The main of an offline tool. Prints `usage` for --help or -h (exit code 0); a UsageError with the usage
/// below it (2); anything else that `tool` throws as one line (1).
int runTool(int argc, char** argv, const std::string& usage,
            const std::function<void(const std::vector<std::string>& words)>& tool);

}  // namespace sightline_ros
