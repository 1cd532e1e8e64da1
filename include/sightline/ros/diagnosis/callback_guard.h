#pragma once

#include <cstdint>
#include <exception>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <ros/time.h>

namespace sightline_ros {

/// Keeps what a callback throws from ending the process, and with it every nodelet of its manager: the
/// message is dropped, counted by its topic, said in the log (at most once in five seconds of the wall's
/// clock a topic) and in the diagnostics. What must be as it was before the message is the callback's
/// business.
///
/// Callbacks run one at a time. The guard outlives those that it made.
class CallbackGuard {
 public:
  /// `node`: whose name the log has.
  explicit CallbackGuard(std::string node) : node_(std::move(node)) {}

  CallbackGuard(const CallbackGuard&) = delete;
  CallbackGuard& operator=(const CallbackGuard&) = delete;

  /// The same callback, that does not throw. `what`: where its messages come from, a topic or "a timer".
  template <typename Callback>
  auto operator()(const std::string& what, Callback callback) {
    return [this, what, callback = std::move(callback)](const auto&... arguments) {
      try {
        callback(arguments...);
      } catch (const std::exception& problem) {
        note(what, problem.what());
      } catch (...) {
        note(what, "an exception of an unknown kind");
      }
    };
  }

  /// Adds a value for each topic of which a message was dropped, and a warning when there were new ones since
  /// the last call.
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  struct Failures {
    std::uint64_t count = 0;
    std::uint64_t count_before = 0;  // at the last diagnosis
    std::uint64_t count_warned = 0;  // at the last line of the log
    std::string latest;
    std::optional<ros::WallTime> last_line;
  };

  void note(const std::string& what, const std::string& problem);

  std::string node_;
  std::map<std::string, Failures> failures_;  // by topic
};

}  // namespace sightline_ros
