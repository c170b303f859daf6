#include "io/mesh/cad/read_in_child.h"

#include <fcntl.h>
#include <sdm/error.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <mutex>
#include <utility>

#include "core/cancellation.h"
#include "io/mesh/cad/load_module.h"

namespace sdm::io::cad {
namespace {

/// What the child sends. It waits for the distance of a point only.
enum class CadMessage : std::uint8_t { shape, point, end };

/// The other process is gone, or what it sent cannot be true.
struct BrokenChannel {};

/// Values between two processes of one program, through a socket. All functions may throw BrokenChannel.
class Channel {
 public:
  explicit Channel(int socket) : socket_(socket) {}

  template <class Value>
  void send(const Value& value) {
    send_bytes(&value, sizeof value);
  }

  template <class Items>
  void send_items(const Items& items) {
    send(items.size());
    send_bytes(items.data(), items.size() * sizeof(typename Items::value_type));
  }

  template <class Value>
  [[nodiscard]] Value receive() {
    Value value;
    receive_bytes(&value, sizeof value);
    return value;
  }

  /// Never allocates much more than was sent, whatever the number of items.
  template <class Items>
  void receive_items(Items& items) {
    constexpr std::size_t kStep = 65536;
    const auto count = receive<std::size_t>();
    for (std::size_t first = 0; first < count; first = items.size()) {
      items.resize(first + std::min(kStep, count - first));
      receive_bytes(items.data() + first, (items.size() - first) * sizeof(typename Items::value_type));
    }
  }

 private:
  void send_bytes(const void* data, std::size_t size) {
    for (auto at = static_cast<const char*>(data); size > 0;) {
      const ssize_t sent = ::send(socket_, at, size, MSG_NOSIGNAL);
      if (sent < 0 && errno == EINTR) continue;
      if (sent <= 0) throw BrokenChannel();
      at += sent;
      size -= static_cast<std::size_t>(sent);
    }
  }

  // The timeout of the socket lets it poll.
  void receive_bytes(void* data, std::size_t size) {
    for (auto at = static_cast<char*>(data); size > 0;) {
      const ssize_t received = recv(socket_, at, size, 0);
      if (received < 0 && (errno == EINTR || errno == EAGAIN || errno == EWOULDBLOCK)) {
        poll();
        continue;
      }
      if (received <= 0) throw BrokenChannel();
      at += received;
      size -= static_cast<std::size_t>(received);
    }
  }

  int socket_;
};

void send_strings(Channel& channel, const std::vector<std::string>& strings) {
  channel.send(strings.size());
  for (const std::string& string : strings) channel.send_items(string);
}

void receive_strings(Channel& channel, std::vector<std::string>& strings) {
  for (auto left = channel.receive<std::size_t>(); left > 0; --left)
    channel.receive_items(strings.emplace_back());
}

void send_shape(Channel& channel, const CadShape& shape) {
  channel.send_items(shape.positions);
  channel.send_items(shape.triangles);
  channel.send(shape.faces.size());
  for (const CadShape::Face& face : shape.faces) {
    channel.send_items(face.name);
    channel.send_items(face.color);
    channel.send(face.object);
    channel.send(face.first_triangle);
  }
  send_strings(channel, shape.objects);
  channel.send_items(shape.unit);
  send_strings(channel, shape.parts);
  send_strings(channel, shape.documents);
  channel.send(shape.deflection);
  channel.send(shape.omitted_faces);
}

/// Whether all numbers of other things are in their ranges: the child may have written anywhere before.
bool is_consistent(const CadShape& shape) {
  if (shape.faces.empty() || shape.faces.front().first_triangle != 0) return false;
  std::size_t first = 0;
  for (const CadShape::Face& face : shape.faces) {
    if (face.object >= shape.objects.size() || face.first_triangle < first) return false;
    first = face.first_triangle;
  }
  return first <= shape.triangles.size() && shape.omitted_faces <= shape.faces.size() &&
         std::isfinite(shape.deflection) &&
         std::ranges::all_of(shape.triangles, [&](const std::array<std::uint32_t, 3>& triangle) {
           return std::ranges::max(triangle) < shape.positions.size();
         });
}

void receive_shape(Channel& channel, CadShape& shape) {
  channel.receive_items(shape.positions);
  channel.receive_items(shape.triangles);
  for (auto left = channel.receive<std::size_t>(); left > 0; --left) {
    CadShape::Face& face = shape.faces.emplace_back();
    channel.receive_items(face.name);
    channel.receive_items(face.color);
    face.object = channel.receive<std::uint32_t>();
    face.first_triangle = channel.receive<std::size_t>();
  }
  receive_strings(channel, shape.objects);
  channel.receive_items(shape.unit);
  receive_strings(channel, shape.parts);
  receive_strings(channel, shape.documents);
  shape.deflection = channel.receive<double>();
  shape.omitted_faces = channel.receive<std::size_t>();
  if (!is_consistent(shape)) throw BrokenChannel();
}

/// The client as the child has it.
class DistantClient final : public CadClient {
 public:
  explicit DistantClient(Channel& channel) : channel_(channel) {}

  void tessellated(const CadShape& shape) override {
    channel_.send(CadMessage::shape);
    send_shape(channel_, shape);
  }

  double distance(const Vec3& point) override {
    channel_.send(CadMessage::point);
    channel_.send(point);
    return channel_.receive<double>();
  }

 private:
  Channel& channel_;
};

/// Takes what the process had from its parent that a crash must not reach: handlers of signals, core files,
/// and the streams. An interrupt is the parent's to obey.
void isolate(pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  for (int number = 1; number < NSIG; ++number)
    (void)std::signal(number, number == SIGINT ? SIG_IGN : SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  pthread_sigmask(SIG_SETMASK, &none, nullptr);
  prctl(PR_SET_DUMPABLE, 0);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  const int nothing = open("/dev/null", O_RDWR);
  if (nothing < 0) _exit(1);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nothing, stream);
}

/// The child, from its start to its end. The threads of the parent are not there, so that nothing here may
/// wait for any: it is the only thread, which ends without destructors of static variables.
[[noreturn]] void be_child(const CadRequest& request, const char* format, int socket, pid_t parent) noexcept {
  isolate(parent);
  try {
    Channel channel(socket);
    DistantClient client(channel);
    CadShape shape;
    try {
      load_module(format)(request, shape, client);
    } catch (const Error& error) {
      shape.fault = error.what();
    }
    channel.send(CadMessage::end);
    channel.send_items(shape.fault);
    channel.send(static_cast<std::uint8_t>(shape.is_exception));
    channel.send(shape.measured_points);
    channel.send(shape.largest_deviation);
  } catch (...) {  // the parent has gone, and sees that this process has too
  }
  _exit(0);
}

/// A child, which is ended with this object.
class ChildProcess {
 public:
  ChildProcess(const CadRequest& request, const char* format) {
    // One at a time: another child must not inherit the end that is this child's, and keep it open.
    static std::mutex one;
    const std::scoped_lock lock(one);
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) throw failure();
    constexpr timeval kBetweenPolls{.tv_sec = 0, .tv_usec = 50'000};
    setsockopt(ends[0], SOL_SOCKET, SO_RCVTIMEO, &kBetweenPolls, sizeof kBetweenPolls);
    const pid_t parent = getpid();
    id_ = fork();
    if (id_ == 0) {
      close(ends[0]);
      be_child(request, format, ends[1], parent);
    }
    close(ends[1]);
    socket_ = ends[0];
    if (id_ < 0) {
      close(socket_);
      throw failure();
    }
  }
  ~ChildProcess() {
    close(socket_);
    if (!reaped_) {
      kill(id_, SIGKILL);
      reap();
    }
  }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  [[nodiscard]] int socket() const { return socket_; }

  /// Sets the fault by how it ended, or sent what cannot be true; waits for the former.
  void explain_death(CadShape& shape) {
    const int status = (shutdown(socket_, SHUT_RDWR), reap());
    const bool killed = WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
    shape.is_exception = !killed;
    shape.fault = killed ? "OpenCASCADE, which reads it, was killed, perhaps for lack of memory"
                         : "OpenCASCADE cannot read it; it is damaged";
  }

 private:
  static Error failure() { return Error("no process could be started to read it by OpenCASCADE"); }

  // 0 if others wait for the children of this process.
  int reap() {
    int status = 0;
    pid_t ended = 0;
    do ended = waitpid(id_, &status, 0);
    while (ended < 0 && errno == EINTR);
    reaped_ = true;
    return ended < 0 ? 0 : status;
  }

  pid_t id_ = -1;
  int socket_ = -1;
  bool reaped_ = false;
};

void receive_results(Channel& channel, CadClient& client, CadShape& shape) {
  for (bool has_shape = false;;) {
    const auto message = channel.receive<CadMessage>();
    if (message == CadMessage::shape && !has_shape) {
      receive_shape(channel, shape);
      client.tessellated(shape);
      has_shape = true;
    } else if (message == CadMessage::point && has_shape) {
      channel.send(client.distance(channel.receive<Vec3>()));
    } else if (message == CadMessage::end) {
      channel.receive_items(shape.fault);
      shape.is_exception = channel.receive<std::uint8_t>() != 0;
      shape.measured_points = channel.receive<std::size_t>();
      shape.largest_deviation = channel.receive<double>();
      if (shape.fault.empty() && !has_shape) throw BrokenChannel();
      return;
    } else {
      throw BrokenChannel();
    }
  }
}

/// Sets the fault where the child dies, and leaves what was received before.
void read_once(const CadRequest& request, const char* format, CadClient& client, CadShape& shape) {
  poll();
  ChildProcess child(request, format);
  try {
    Channel channel(child.socket());
    receive_results(channel, client, shape);
  } catch (const BrokenChannel&) {
    poll();
    child.explain_death(shape);
  }
}

}  // namespace

CadShape read_in_child(const CadRequest& request, const char* format, CadClient& client) {
  CadShape shape;
  read_once(request, format, client, shape);
  // OpenCASCADE fails, or crashes, on some names and colours of files whose shapes it reads.
  if (shape.is_exception && shape.triangles.empty()) {
    CadRequest plain = request;
    plain.labels = false;
    CadShape unlabelled;
    read_once(plain, format, client, unlabelled);
    unlabelled.has_labels = false;
    if (!unlabelled.is_exception) shape = std::move(unlabelled);
  }
  if (!shape.fault.empty()) throw Error(shape.fault);
  return shape;
}

}  // namespace sdm::io::cad
