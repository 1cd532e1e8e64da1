#pragma once

#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace sightline::report {

/// A command line with a mistake; the message names the option, its value and the remedy.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The numbers that an option accepts; all of them are finite.
enum class NumberRange { any, at_least_zero, above_zero };

/// The command line of an offline tool: options `--name VALUE` or `--name=VALUE` and flags `--name` in any
/// place, the other arguments in order.
class CommandLine {
 public:
  /// `options` and `flags`: the known names with their dashes; every option takes a value, no flag does.
  /// `least` to `most` other arguments are expected. Throws UsageError.
  CommandLine(const std::vector<std::string>& words, const std::vector<std::string>& options,
              std::size_t least, std::size_t most, const std::vector<std::string>& flags = {});

  /// Whether the option or flag is given.
  bool has(const std::string& option) const { return options_.count(option) > 0; }
  /// The last value of the option; `fallback` when it is not given.
  std::string option(const std::string& option, const std::string& fallback) const;

  /// The option as a number of the range. Throws UsageError.
  double number(const std::string& option, double fallback, NumberRange range = NumberRange::any) const;

  /// The option as a whole number from 0 to 2^31 - 1. Throws UsageError.
  int wholeNumber(const std::string& option, int fallback) const;

  /// The option as yes or no. Throws UsageError.
  bool yesOrNo(const std::string& option, bool fallback) const;

  /// All values of the option, in order.
  std::vector<std::string> all(const std::string& option) const;

  const std::vector<std::string>& arguments() const { return arguments_; }

 private:
  std::map<std::string, std::vector<std::string>> options_;
  std::vector<std::string> arguments_;
};

/// The main function of an offline tool; returns the exit code. --help or -h prints `usage` (0), a UsageError
/// is printed with the usage below it (2), any other exception of `tool` as one line (1).
int runTool(int argc, char** argv, const std::string& usage,
            const std::function<void(const std::vector<std::string>& words)>& tool);

}  // namespace sightline::report
