// pleat-draco: decodes one Draco file under limits, for `pleat`, which never runs Draco's decoder
// on foreign bytes in its own process.
//
//   pleat-draco MEMORY_BYTES CPU_SECONDS MAX_VERTICES MAX_TRIANGLES
//
// The Draco file comes on standard input. The geometry leaves on standard output, in the form of
// cli/io/draco_process_protocol.h; cli/io/draco_process.cpp reads it. When decoding fails, a
// message leaves on standard error and the exit code is that of the status.
//
// Why a process: Draco's decoder keeps to the bytes that it is given, but a few dozen of them can
// make it allocate gigabytes and work for a minute, in places that no check of ours reaches. A
// limit for a whole process is the one that always holds, and a crash ends this process only.
//
//   RLIMIT_AS      bounds the addresses, so that an allocation beyond it fails with std::bad_alloc.
//                  Running out of memory is then an ordinary error, kResourceExhausted, and not a
//                  matter for the kernel, which might end another process in its place.
//   RLIMIT_CPU     ends a decoder that does not come to an end. The parent counts elapsed time too.
//   RLIMIT_CORE    keeps a crash from leaving a core file of foreign bytes.
//   RLIMIT_FSIZE   lets the process write to pipes only. It has no other use for files.
//
// The limits are set before the first byte is read, and output begins when decoding has succeeded.
// The parent gives no environment, and it checks what comes back as if this process were hostile,
// since bytes that found a fault in Draco could have taken it over.
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <string>

#include "cli/io/draco_process_protocol.h"
#include "pleat/base/status.h"
#include "pleat/stream/draco_file.h"

namespace pleat {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kCanLimitMemory = false;  // sanitizers reserve terabytes of addresses for themselves
#else
constexpr bool kCanLimitMemory = true;
#endif

// Sets the soft and the hard limit, so that nothing in this process can raise it again.
bool Limit(int resource, rlim_t value) {
  const struct rlimit limit = {value, value};
  return setrlimit(resource, &limit) == 0;
}

// Hands the status to the parent and returns the exit code.
int Fail(const absl::Status& status) {
  std::fprintf(stderr, "%s", std::string(status.message()).c_str());
  return static_cast<int>(status.code());
}

absl::StatusOr<std::string> ReadInput() {
  std::string bytes;
  char buffer[1 << 16];
  while (true) {
    const ssize_t count = read(STDIN_FILENO, buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return ErrnoStatus(errno, "cannot read the Draco file");
    if (count == 0) return bytes;
    bytes.append(buffer, static_cast<size_t>(count));
  }
}

bool WriteOutput(const void* data, size_t size) {
  const char* bytes = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t count = write(STDOUT_FILENO, bytes, size);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes += count;
    size -= static_cast<size_t>(count);
  }
  return true;
}

int Run(char** argv) {
  const rlim_t memory_bytes = std::strtoull(argv[1], nullptr, 10);
  const rlim_t cpu_seconds = std::strtoull(argv[2], nullptr, 10);
  if ((kCanLimitMemory && !Limit(RLIMIT_AS, memory_bytes)) || !Limit(RLIMIT_CPU, cpu_seconds) ||
      !Limit(RLIMIT_CORE, 0) || !Limit(RLIMIT_FSIZE, 0)) {
    return Fail(absl::InternalError("cannot limit the process that decodes Draco"));
  }
  MeshLimits limits;
  limits.max_vertices = std::strtol(argv[3], nullptr, 10);
  limits.max_faces = std::strtol(argv[4], nullptr, 10);
  const absl::StatusOr<std::string> bytes = ReadInput();
  if (!bytes.ok()) return Fail(bytes.status());
  const absl::StatusOr<DracoGeometry> geometry = DecodeDracoFile(*bytes, limits);
  if (!geometry.ok()) return Fail(geometry.status());
  const DracoReplyHeader header = {kDracoReplyMagic,
                                   static_cast<uint32_t>(geometry->positions.cols()),
                                   static_cast<uint32_t>(geometry->triangles.cols()),
                                   geometry->vertex_numbers.empty() ? 0u : 1u};
  const bool written =
      WriteOutput(&header, sizeof header) &&
      WriteOutput(geometry->positions.data(), geometry->positions.size() * sizeof(float)) &&
      WriteOutput(geometry->triangles.data(), geometry->triangles.size() * sizeof(int)) &&
      WriteOutput(geometry->vertex_numbers.data(),
                  geometry->vertex_numbers.size() * sizeof(int32_t));
  return written ? 0 : Fail(absl::InternalError("cannot hand the mesh over"));
}

}  // namespace
}  // namespace pleat

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "pleat-draco is a part of pleat and not for use alone\n");
    return 2;
  }
  try {
    return pleat::Run(argv);
  } catch (const std::bad_alloc&) {  // while reading the file; decoding catches its own
    return pleat::Fail(
        absl::ResourceExhaustedError("the Draco file needs more memory than it is allowed"));
  }
}
