#pragma once

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <signal.h>
#include <string>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "support/command.h"
#include "support/link_relay.h"

/// A network of two machines and a switch between them, of which the cable can be drawn, or be made a bad
/// one: three network namespaces that end with this test. This process is in the near one; neither machine
/// notices when the link is cut.
class CutLink {
 public:
  static constexpr const char* kNear = "10.77.0.1";
  static constexpr const char* kFar = "10.77.0.2";

  /// Moves this program into a namespace of its own, by starting it again; call it first. Returns where that
  /// is done, or where it may not be done (no root rights, no namespaces for users).
  static void enter(char** argv) {
    if (std::getenv(kEntered) != nullptr) return;
    std::vector<std::string> words = {"unshare", "--net"};
    if (geteuid() != 0) words.push_back("--map-root-user");
    std::string trial;
    for (const std::string& word : words) trial += word + " ";
    if (outcomeOf(trial + "true").first != 0) return;
    words.push_back(std::filesystem::read_symlink("/proc/self/exe"));
    for (char** word = argv + 1; *word != nullptr; ++word) words.push_back(*word);
    std::vector<char*> command;
    for (std::string& word : words) command.push_back(word.data());
    command.push_back(nullptr);
    setenv(kEntered, "yes", 1);
    execvp(command[0], command.data());
  }

  CutLink() {
    if (std::getenv(kEntered) == nullptr) {
      why_not_ = "making network namespaces needs root rights, or namespaces that users may make";
      return;
    }
    switch_ = holdNamespace();
    far_ = holdNamespace();
    run("ip link set lo up");
    for (const std::string end : {"near", "far"}) {
      run("ip link add " + end + " type veth peer name " + end + "_port");
      if (!LinkRelay::sendsWholeFrames(end)) fail("no whole frames from the device " + end);
      run("ip link set " + end + "_port netns " + std::to_string(switch_));
    }
    run("ip link set far netns " + std::to_string(far_));
    run(inSwitch("ip link add switch type bridge"));
    for (const char* link : {"near_port", "far_port"})
      run(inSwitch(std::string("ip link set ") + link + " master switch up"));
    run(inSwitch("ip link set switch up"));
    run(std::string("ip address add ") + kNear + "/24 dev near");
    run("ip link set near up");
    run(inFar(std::string("ip address add ") + kFar + "/24 dev far"));
    run(inFar("ip link set lo up"));
    run(inFar("ip link set far up"));
    relay_ = std::make_unique<LinkRelay>(switch_, "near_port", "far_port");
  }

  ~CutLink() {
    for (const pid_t process : {far_, switch_}) {
      if (process <= 0) continue;
      kill(process, SIGKILL);
      waitpid(process, nullptr, 0);
    }
  }
  CutLink(const CutLink&) = delete;
  CutLink& operator=(const CutLink&) = delete;

  /// This process and those that it starts use a master on the near machine. It has a port of its own, so
  /// that other tests' processes, which the kernel shows beside ours, are not taken for ours.
  static void useMasterOnNear() {
    const int port = 20000 + getpid() % 10000;  // below the kernel's own choice of ports
    setenv("ROS_MASTER_URI", (std::string("http://") + kNear + ":" + std::to_string(port)).c_str(), 1);
    setenv("ROS_IP", kNear, 1);
    unsetenv("ROS_HOSTNAME");
  }

  /// Why there is no such network; empty: there is.
  const std::string& whyNot() const { return why_not_; }

  void cut() { run(inSwitch("ip link set far_port nomaster")); }
  void join() {
    if (!relay_->impair({})) fail("the relay has ended");
    for (const char* port : {"near_port", "far_port"})
      run(inSwitch(std::string("ip link set ") + port + " master switch"));
  }

  /// Until `join` frames are lost with that probability and come so much later [s], in both directions.
  void impair(double loss, double delay) {
    for (const char* port : {"near_port", "far_port"})
      run(inSwitch(std::string("ip link set ") + port + " nomaster"));
    if (!relay_->impair({true, loss, delay})) fail("the relay has ended");
  }

  /// Sets a variable of both machines' networks, "net/ipv4/..."; whether the kernel has it.
  bool set(const std::string& variable, int value) const {
    const std::string command = "sh -c 'echo " + std::to_string(value) + " > /proc/sys/" + variable + "'";
    return outcomeOf(command).first == 0 && outcomeOf(inFar(command)).first == 0;
  }

  /// Runs what follows on the far machine.
  std::vector<std::string> onFar() const {
    return {"nsenter", "--target", std::to_string(far_), "--net", "env", std::string("ROS_IP=") + kFar};
  }

 private:
  static constexpr const char* kEntered = "SIGHTLINE_TEST_IN_NAMESPACE";

  static std::string namespaceOf(const std::string& process) {
    std::error_code none;
    return std::filesystem::read_symlink("/proc/" + process + "/ns/net", none);
  }

  /// A process that does nothing but keep a namespace.
  pid_t holdNamespace() {
    const pid_t process = fork();
    if (process == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      execlp("unshare", "unshare", "--net", "sleep", "infinity", nullptr);
      _exit(127);
    }
    for (int i = 0; i < 1000 && namespaceOf(std::to_string(process)) == namespaceOf("self"); ++i)
      usleep(10000);
    return process;
  }

  std::string inSwitch(const std::string& command) const {
    return "nsenter --target " + std::to_string(switch_) + " --net " + command;
  }
  std::string inFar(const std::string& command) const {
    return "nsenter --target " + std::to_string(far_) + " --net " + command;
  }

  /// Nothing after the first failure.
  void run(const std::string& command) {
    if (!why_not_.empty()) return;
    const auto [code, printed] = outcomeOf(command);
    if (code != 0) why_not_ = command + ": " + printed;
  }

  void fail(const std::string& what) {
    if (why_not_.empty()) why_not_ = what;
  }

  std::string why_not_;
  std::unique_ptr<LinkRelay> relay_;
  pid_t switch_ = -1, far_ = -1;
};
