#include "sightline/report/command_line.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>
#include <limits>
#include <optional>

#include "sightline/report/output_file.h"
#include "sightline/report/value_text.h"

namespace sightline::report {
namespace {

bool isIn(NumberRange range, double value) {
  switch (range) {
    case NumberRange::at_least_zero:
      return value >= 0.0;
    case NumberRange::above_zero:
      return value > 0.0;
    default:
      return true;
  }
}

const char* textOf(NumberRange range) {
  switch (range) {
    case NumberRange::at_least_zero:
      return "a number of at least 0";
    case NumberRange::above_zero:
      return "a number above 0";
    default:
      return "a number";
  }
}

UsageError mistakenValue(const std::string& option, const std::string& expected, const std::string& value,
                         const std::string& example) {
  return UsageError(option + ": expected " + expected + ", got \"" + value + "\" (write for instance " +
                    option + " " + example + ")");
}

}  // namespace

CommandLine::CommandLine(const std::vector<std::string>& words, const std::vector<std::string>& options,
                         std::size_t least, std::size_t most, const std::vector<std::string>& flags) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i].compare(0, 2, "--") != 0) {
      arguments_.push_back(words[i]);
      continue;
    }
    if (isAmong(flags, words[i])) {
      options_[words[i]];  // given, without a value
      continue;
    }
    const std::size_t equals = words[i].find('=');
    const std::string name = words[i].substr(0, equals);
    if (isAmong(flags, name))
      throw UsageError("option " + name + " takes no value: write " + name + " alone");
    if (!isAmong(options, name)) throw UsageError("unknown option " + name);
    if (equals != std::string::npos) {
      options_[name].push_back(words[i].substr(equals + 1));
    } else if (i + 1 < words.size()) {
      options_[name].push_back(words[++i]);
    } else {
      throw UsageError("option " + name + " needs a value");
    }
  }
  if (arguments_.size() < least) throw UsageError("too few arguments");
  if (arguments_.size() > most) throw UsageError("too many arguments: " + arguments_[most]);
}

std::string CommandLine::option(const std::string& option, const std::string& fallback) const {
  const auto found = options_.find(option);
  return found != options_.end() ? found->second.back() : fallback;
}

double CommandLine::number(const std::string& option, double fallback, NumberRange range) const {
  if (!has(option)) return fallback;
  const std::string text = this->option(option, "");
  const std::optional<double> value = numberFrom(text);
  if (!value || !isIn(range, *value)) throw mistakenValue(option, textOf(range), text, "1");
  return *value;
}

int CommandLine::wholeNumber(const std::string& option, int fallback) const {
  if (!has(option)) return fallback;
  const std::string text = this->option(option, "");
  const std::optional<double> value = numberFrom(text);
  const double largest = std::numeric_limits<int>::max();
  if (!value || *value < 0.0 || *value > largest || *value != std::floor(*value))
    throw mistakenValue(option, "a whole number of at least 0", text, "1");
  return static_cast<int>(*value);
}

bool CommandLine::yesOrNo(const std::string& option, bool fallback) const {
  if (!has(option)) return fallback;
  const std::string text = this->option(option, "");
  if (text != "yes" && text != "no") throw mistakenValue(option, "yes or no", text, "yes");
  return text == "yes";
}

std::vector<std::string> CommandLine::all(const std::string& option) const {
  const auto found = options_.find(option);
  return found != options_.end() ? found->second : std::vector<std::string>{};
}

int runTool(int argc, char** argv, const std::string& usage,
            const std::function<void(const std::vector<std::string>& words)>& tool) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (std::count(words.begin(), words.end(), "--help") + std::count(words.begin(), words.end(), "-h") > 0) {
    std::cout << usage;
    return 0;
  }
  const std::string path = argv[0];
  const std::string name = path.substr(path.rfind('/') + 1);
  std::signal(SIGXFSZ, SIG_IGN);  // a file at its limit of size is an error of the write
  try {
    tool(words);
    errno = 0;
    if (!std::cout.flush() || std::fflush(stdout) != 0) throw outputError("standard output");
  } catch (const UsageError& problem) {
    std::cerr << name << ": " << problem.what() << "\n" << usage;
    return 2;
  } catch (const std::exception& problem) {
    std::cerr << name << ": " << problem.what() << "\n";
    return 1;
  }
  return 0;
}

}  // namespace sightline::report
