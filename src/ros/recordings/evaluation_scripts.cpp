#include "sightline/ros/recordings/evaluation_scripts.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <sys/wait.h>
#include <unistd.h>

#include <ros/package.h>

#include "sightline/report/output_file.h"
#include "sightline/ros/recordings/bags.h"
#include "sightline/ros/recordings/report_data.h"

namespace sightline_ros {
namespace {

namespace fs = std::filesystem;

const char* const kPlotScript = "plot_evaluation";
const char* const kReportScript = "report_evaluation";

/// An installed script beside this program, or that of the source folder.
std::string scriptNamed(const std::string& name) {
  const fs::path beside = fs::read_symlink("/proc/self/exe").parent_path() / name;
  if (fs::exists(beside)) return beside.string();
  const fs::path source = fs::path(ros::package::getPath("sightline")) / "scripts" / name;
  if (fs::exists(source)) return source.string();
  throw std::runtime_error(name +
                           ": the script that draws is neither beside this program nor in the package");
}

/// Whether the script ended well.
bool runScript(const std::string& name, const std::vector<std::string>& arguments) {
  const std::string script = scriptNamed(name);
  std::vector<char*> words{const_cast<char*>(script.c_str())};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  std::cout.flush();
  const pid_t child = fork();
  if (child == 0) {
    execv(script.c_str(), words.data());
    _exit(127);
  }
  int status = 0;
  return child > 0 && waitpid(child, &status, 0) > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/// A folder that is removed with all that is in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    path_ = (fs::temp_directory_path() / "sightline_report_XXXXXX").string();
    if (mkdtemp(path_.data()) == nullptr)
      throw std::runtime_error(path_ + ": the folder cannot be made: " + std::strerror(errno));
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string file(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

}  // namespace

void drawEvaluation(const std::string& folder) {
  if (!runScript(kPlotScript, {folder}))
    throw std::runtime_error(std::string(kPlotScript) + " failed; the files that it draws are in " + folder);
}

std::string writeReport(const ReportSettings& settings) {
  std::vector<std::string> inputs = settings.bags;
  inputs.push_back(settings.evaluation.truth);
  sightline::report::OutputFile page(settings.page, inputs);
  const auto require = [&](const std::vector<std::string>& arguments) {
    if (!runScript(kReportScript, arguments)) throw std::runtime_error(settings.page + ": not written");
  };
  require({"--check"});  // before much work is done

  const TemporaryFolder folder;
  std::vector<std::string> arguments{page.unfinished()};
  std::string tables;
  for (const std::string& bag : settings.bags) {
    BagEvaluationSettings evaluation = settings.evaluation;
    evaluation.csv = folder.file(std::to_string(arguments.size()));
    if (settings.finds_truth) evaluation.truth = truthTopicOf(*openBag(bag));
    if (settings.bags.size() > 1) tables += (tables.empty() ? "" : "\n") + bag + ":\n";
    tables += evaluateForReport(bag, evaluation);
    arguments.push_back(evaluation.csv);
  }
  require(arguments);
  page.finish();
  return tables + settings.page + "\n";
}

}  // namespace sightline_ros
