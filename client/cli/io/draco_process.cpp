// The parent of pleat-draco, which explains the limits (client/draco_child/main.cpp). The file is
// the child's standard input, so its bytes never come here. Its answer comes through one pipe and
// its error message through another one. The message is short enough for the buffer of a pipe: the
// child can write it although nobody reads it yet, and it is read when the child has closed its
// output.
//
// While output is awaited, the deadline and the cancellation are looked at every kPollMs. However a
// run ends, the child is gone and its exit status taken when the Child object is destroyed.
#include "cli/io/draco_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "cli/io/draco_process_protocol.h"
#include "cli/session.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

constexpr int kPollMs = 50;  // how soon a cancellation or the deadline is noticed
constexpr auto kEndPoll = std::chrono::milliseconds(1);
constexpr size_t kMaxMessageBytes = 2000;

// Returns the path of pleat-draco, which lies beside this program.
std::string ChildPath() {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  return (self.parent_path() / "pleat-draco").string();
}

// Owns a file descriptor.
class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  ~Descriptor() { Close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }
  void Reset(int fd) {
    Close();
    fd_ = fd;
  }
  void Close() {
    if (fd_ >= 0) close(fd_);
    fd_ = -1;
  }

 private:
  int fd_;
};

struct Pipe {
  Descriptor read_end, write_end;
  absl::Status Open() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) return ErrnoStatus(errno, "cannot make a pipe");
    read_end.Reset(ends[0]);
    write_end.Reset(ends[1]);
    return absl::OkStatus();
  }
};

// One run of pleat-draco. The destructor kills it when it still runs.
class Child {
 public:
  Child(const Progress& progress, const DracoProcessOptions& options)
      : progress_(progress),
        options_(options),
        deadline_seconds_(MonotonicSeconds() + options.wall_seconds) {}
  ~Child() {
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    int status = 0;
    TryWait(0, &status);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  absl::Status Start(int input_fd) {
    PLEAT_RETURN_IF_ERROR(output_.Open());
    PLEAT_RETURN_IF_ERROR(messages_.Open());
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, input_fd, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, output_.write_end.get(), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, messages_.write_end.get(), STDERR_FILENO);
    const std::string program = options_.program.empty() ? ChildPath() : options_.program;
    std::vector<std::string> words = {
        program, absl::StrCat(options_.memory_bytes), absl::StrCat(options_.cpu_seconds),
        absl::StrCat(options_.limits.max_vertices), absl::StrCat(options_.limits.max_faces)};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    char* no_environment[] = {nullptr};
    const int error =
        posix_spawn(&pid_, program.c_str(), &actions, nullptr, arguments.data(), no_environment);
    posix_spawn_file_actions_destroy(&actions);
    // Only the child may hold the write ends, or its end would not be seen as the end of its
    // output.
    output_.write_end.Close();
    messages_.write_end.Close();
    if (error == 0) return absl::OkStatus();
    pid_ = -1;
    return ErrnoStatus(error,
                       absl::StrCat("cannot start '", program, "', which reads Draco files"));
  }

  // Reads `size` bytes, or fewer when the child has closed its output.
  absl::StatusOr<size_t> Read(void* data, size_t size) {
    size_t done = 0;
    while (done < size) {
      PLEAT_RETURN_IF_ERROR(AwaitOutput());
      const ssize_t count =
          read(output_.read_end.get(), static_cast<char*>(data) + done, size - done);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) return ErrnoStatus(errno, "cannot read from pleat-draco");
      if (count == 0) break;
      done += static_cast<size_t>(count);
    }
    return done;
  }
  absl::Status ReadAll(void* data, size_t size) {
    PLEAT_ASSIGN_OR_RETURN(const size_t count, Read(data, size));
    return count == size ? absl::OkStatus() : Outcome();
  }

  // Waits for the end of a child that closed its output too early, and returns the reason. It is an
  // error in any case.
  absl::Status Outcome() {
    PLEAT_ASSIGN_OR_RETURN(const int status, AwaitEnd());
    char message[kMaxMessageBytes];
    struct pollfd entry = {messages_.read_end.get(), POLLIN, 0};
    const ssize_t length =
        poll(&entry, 1, 0) > 0 ? read(messages_.read_end.get(), message, sizeof message) : 0;
    if (WIFSIGNALED(status)) {
      if (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL) {
        return absl::ResourceExhaustedError(
            absl::StrCat("decoding takes more than ", options_.cpu_seconds, " s"));
      }
      return absl::DataLossError(
          absl::StrCat("Draco's decoder crashed on it (signal ", WTERMSIG(status), ")"));
    }
    const int code = WEXITSTATUS(status);
    const absl::string_view text(message, static_cast<size_t>(std::max<ssize_t>(length, 0)));
    if (code == 0) return absl::DataLossError("pleat-draco wrote too little");
    if (code > 16) return absl::InternalError(absl::StrCat("pleat-draco ended with ", code));
    return absl::Status(static_cast<absl::StatusCode>(code), text);
  }

  // Checks that the child ends well and wrote nothing more. Call it when all output has been read.
  absl::Status Finish() {
    char more = 0;
    PLEAT_ASSIGN_OR_RETURN(const size_t count, Read(&more, 1));
    if (count > 0) return absl::DataLossError("pleat-draco wrote too much");
    PLEAT_ASSIGN_OR_RETURN(const int status, AwaitEnd());
    return WIFEXITED(status) && WEXITSTATUS(status) == 0
               ? absl::OkStatus()
               : absl::DataLossError("Draco's decoder ended badly on it");
  }
  uint64_t peak_memory_bytes() const { return peak_memory_bytes_; }

 private:
  absl::Status AwaitOutput() {
    while (true) {
      PLEAT_RETURN_IF_ERROR(CheckTime());
      struct pollfd entry = {output_.read_end.get(), POLLIN, 0};
      const int ready = poll(&entry, 1, kPollMs);
      if (ready > 0) return absl::OkStatus();
      if (ready < 0 && errno != EINTR) return ErrnoStatus(errno, "cannot wait");
    }
  }

  // A child that always has a little to say must not go on for ever either.
  absl::Status CheckTime() const {
    if (progress_.cancelled()) return absl::CancelledError("reading was cancelled");
    if (MonotonicSeconds() <= deadline_seconds_) return absl::OkStatus();
    return absl::ResourceExhaustedError(
        absl::StrCat("decoding takes more than ", options_.wall_seconds, " s"));
  }

  // How the child has ended: one that closes its output need not end.
  absl::StatusOr<int> AwaitEnd() {
    int status = 0;
    while (!TryWait(WNOHANG, &status)) {
      PLEAT_RETURN_IF_ERROR(CheckTime());
      std::this_thread::sleep_for(kEndPoll);
    }
    return status;
  }

  // False while the child runs on.
  bool TryWait(int flags, int* status) {
    struct rusage usage = {};
    pid_t ended = 0;
    while ((ended = wait4(pid_, status, flags, &usage)) < 0 && errno == EINTR) {
    }
    if (ended == 0) return false;
    pid_ = -1;
    peak_memory_bytes_ = static_cast<uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts in KiB
    return true;
  }

  const Progress& progress_;
  const DracoProcessOptions& options_;
  const double deadline_seconds_;
  Pipe output_, messages_;
  pid_t pid_ = -1;
  uint64_t peak_memory_bytes_ = 0;
};

absl::StatusOr<DracoGeometry> ReadGeometry(const MeshLimits& limits, Child* child) {
  DracoReplyHeader header;
  PLEAT_RETURN_IF_ERROR(child->ReadAll(&header, sizeof header));
  // Edgebreaker may split vertices, so there can be more positions than vertices. The limits are
  // those of DecodeDracoFile.
  if (header.magic != kDracoReplyMagic ||
      header.num_positions > 2 * static_cast<uint64_t>(limits.max_vertices) ||
      header.num_triangles > static_cast<uint64_t>(limits.max_faces) || header.has_numbers > 1) {
    return absl::DataLossError("pleat-draco says something impossible");
  }
  DracoGeometry geometry;
  geometry.positions.resize(3, header.num_positions);
  geometry.triangles.resize(3, header.num_triangles);
  geometry.vertex_numbers.resize(header.has_numbers ? header.num_positions : 0);
  PLEAT_RETURN_IF_ERROR(
      child->ReadAll(geometry.positions.data(), geometry.positions.size() * sizeof(float)));
  PLEAT_RETURN_IF_ERROR(
      child->ReadAll(geometry.triangles.data(), geometry.triangles.size() * sizeof(int)));
  PLEAT_RETURN_IF_ERROR(child->ReadAll(geometry.vertex_numbers.data(),
                                       geometry.vertex_numbers.size() * sizeof(int32_t)));
  PLEAT_RETURN_IF_ERROR(child->Finish());
  if (geometry.triangles.size() > 0 &&
      (geometry.triangles.minCoeff() < 0 ||
       geometry.triangles.maxCoeff() >= static_cast<int64_t>(header.num_positions))) {
    return absl::DataLossError("pleat-draco says something impossible");
  }
  return geometry;
}

}  // namespace

absl::StatusOr<DracoGeometry> DecodeDracoInChild(const std::string& path, const Progress& progress,
                                                 const DracoProcessOptions& options,
                                                 DracoProcessUsage* usage) {
  const Descriptor input(open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (input.get() < 0) return ErrnoStatus(errno, absl::StrCat("cannot open '", path, "'"));
  Child child(progress, options);
  absl::Status status = child.Start(input.get());
  if (status.ok()) {
    absl::StatusOr<DracoGeometry> geometry = ReadGeometry(options.limits, &child);
    if (usage != nullptr) usage->peak_memory_bytes = child.peak_memory_bytes();
    if (geometry.ok()) return geometry;
    status = geometry.status();
  }
  return absl::Status(status.code(), absl::StrCat(path, ": ", absl::string_view(status.message())));
}

absl::StatusOr<MeshFile> ReadDracoMesh(const std::string& path, const Progress& progress) {
  PLEAT_ASSIGN_OR_RETURN(DracoGeometry geometry, DecodeDracoInChild(path, progress));
  if (geometry.triangles.cols() == 0) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, ": a Draco point cloud; a sequence needs meshes"));
  }
  MeshFile mesh;
  PLEAT_ASSIGN_OR_RETURN(
      mesh.topology,
      Topology::FromTriangles(static_cast<int>(geometry.positions.cols()), geometry.triangles));
  mesh.positions = std::move(geometry.positions);
  return mesh;
}

}  // namespace pleat
