#include "sightline/report/command_line.h"

#include <algorithm>
#include <exception>
#include <iostream>

namespace sightline_ros {

CommandLine::CommandLine(const std::vector<std::string>& words, const std::vector<std::string>& options,
                         std::size_t least, std::size_t most) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i].compare(0, 2, "--") != 0) {
      arguments_.push_back(words[i]);
      continue;
    }
    const std::size_t equals = words[i].find('=');
    const std::string name = words[i].substr(0, equals);
    if (std::find(options.begin(), options.end(), name) == options.end()) {
      throw UsageError("unknown option " + name);
    }
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
  try {
    tool(words);
  } catch (const UsageError& problem) {
    std::cerr << name << ": " << problem.what() << "\n" << usage;
    return 2;
  } catch (const std::exception& problem) {
    std::cerr << name << ": " << problem.what() << "\n";
    return 1;
  }
  return 0;
}

}  // namespace sightline_ros
