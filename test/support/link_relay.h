#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <deque>
#include <fcntl.h>
#include <linux/ethtool.h>
#include <linux/if_packet.h>
#include <linux/sockios.h>
#include <net/ethernet.h>
#include <net/if.h>
#include <netinet/in.h>
#include <poll.h>
#include <random>
#include <sched.h>
#include <signal.h>
#include <string>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

/// Carries the frames between two ports of a network namespace in a process of its own, late and with losses:
/// what tc's netem does, for kernels that are built without it. It carries nothing before `impair`.
class LinkRelay {
 public:
  /// What happens to each frame, in both directions.
  struct Impairment {
    bool carries = false;
    double loss = 0.0;   ///< share of the frames, by a fixed seed, [0, 1]
    double delay = 0.0;  ///< [s]; frames stay in order
  };

  /// `holder`: a process in the namespace of the ports.
  LinkRelay(pid_t holder, const std::string& port_a, const std::string& port_b) {
    int ends[2];
    if (pipe(ends) != 0) return;
    process_ = fork();
    if (process_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      close(ends[1]);
      _exit(run(ends[0], holder, {port_a, port_b}));
    }
    close(ends[0]);
    commands_ = ends[1];
  }

  ~LinkRelay() {
    if (commands_ >= 0) close(commands_);
    if (process_ <= 0) return;
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }

  LinkRelay(const LinkRelay&) = delete;
  LinkRelay& operator=(const LinkRelay&) = delete;

  /// Whether the relay runs and has been told.
  bool impair(const Impairment& impairment) const {
    return waitpid(process_, nullptr, WNOHANG) == 0 &&
           write(commands_, &impairment, sizeof impairment) == sizeof impairment;
  }

  /// Frames of a device go out complete, with their checksums and none larger than the wire takes: who reads
  /// them as they are could not pass them on else. Returns whether that was done.
  static bool sendsWholeFrames(const std::string& device) {
    const int any = socket(AF_INET, SOCK_DGRAM, 0);
    bool done = any >= 0;
    for (const unsigned command : {ETHTOOL_STSO, ETHTOOL_SGSO, ETHTOOL_STXCSUM}) {
      ethtool_value value{command, 0};
      ifreq request{};
      std::strncpy(request.ifr_name, device.c_str(), IFNAMSIZ - 1);
      request.ifr_data = reinterpret_cast<char*>(&value);
      done = done && ioctl(any, SIOCETHTOOL, &request) == 0;
    }
    if (any >= 0) close(any);
    return done;
  }

 private:
  using Clock = std::chrono::steady_clock;
  struct Frame {
    Clock::time_point due;
    int to = -1;
    std::vector<char> bytes;
  };

  static int portOf(const std::string& name) {
    const int port = socket(AF_PACKET, SOCK_RAW | SOCK_NONBLOCK, htons(ETH_P_ALL));
    sockaddr_ll address{};
    address.sll_family = AF_PACKET;
    address.sll_protocol = htons(ETH_P_ALL);
    address.sll_ifindex = static_cast<int>(if_nametoindex(name.c_str()));
    if (address.sll_ifindex == 0) return -1;
    return bind(port, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0 ? port : -1;
  }

  /// Exit code; it ends when the pipe does.
  static int run(int commands, pid_t holder, const std::array<std::string, 2>& names) {
    const int space = open(("/proc/" + std::to_string(holder) + "/ns/net").c_str(), O_RDONLY | O_CLOEXEC);
    if (space < 0 || setns(space, CLONE_NEWNET) != 0) return 1;
    const std::array<int, 2> ports = {portOf(names[0]), portOf(names[1])};
    if (ports[0] < 0 || ports[1] < 0) return 2;
    Impairment now;
    std::deque<Frame> under_way;
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    std::vector<char> buffer(65536);
    while (true) {
      int wait = 1000;  // [ms]
      if (!under_way.empty()) {
        const auto left = under_way.front().due - Clock::now();
        wait = std::max(0, static_cast<int>(std::chrono::ceil<std::chrono::milliseconds>(left).count()));
      }
      std::array<pollfd, 3> waits = {pollfd{commands, POLLIN, 0}, pollfd{ports[0], POLLIN, 0},
                                     pollfd{ports[1], POLLIN, 0}};
      poll(waits.data(), waits.size(), wait);
      if (waits[0].revents != 0 && read(commands, &now, sizeof now) != sizeof now) return 0;
      for (std::size_t from = 0; from < 2; ++from) {
        sockaddr_ll source{};
        socklen_t length = sizeof source;
        ssize_t size = 0;
        while ((size = recvfrom(ports[from], buffer.data(), buffer.size(), 0,
                                reinterpret_cast<sockaddr*>(&source), &length)) > 0) {
          const bool is_own = source.sll_pkttype == PACKET_OUTGOING;
          length = sizeof source;
          if (is_own || !now.carries || uniform(random) < now.loss) continue;
          const auto due = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                              std::chrono::duration<double>(now.delay));
          under_way.push_back({due, ports[1 - from], {buffer.data(), buffer.data() + size}});
        }
      }
      // A delay that has become shorter does not let frames overtake.
      for (; !under_way.empty() && under_way.front().due <= Clock::now(); under_way.pop_front()) {
        const Frame& frame = under_way.front();
        if (send(frame.to, frame.bytes.data(), frame.bytes.size(), 0) < 0) continue;  // lost, as on any wire
      }
    }
  }

  pid_t process_ = -1;
  int commands_ = -1;
};
