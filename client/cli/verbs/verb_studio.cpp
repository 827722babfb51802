// studio [INPUT]: Pleat in a browser, for one machine. It starts a server of its own, stores INPUT
// there, says where the page is, and ends the server with itself.
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "cli/interrupt.h"
#include "cli/io/input.h"
#include "cli/service.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

constexpr int kPollMs = 100;  // how soon Ctrl-C is noticed

struct StudioVerbOptions {
  std::string input, fps, shared_model, address = "127.0.0.1:7321";
  bool open = false;
};

// The program that lies beside this one.
std::string ServerProgram() {
  std::error_code error;
  return (std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / "pleatd").string();
}

// A pleatd of this process. It is asked to end when the object is destroyed.
class OwnServer {
 public:
  ~OwnServer() {
    if (output_ >= 0) close(output_);
    if (pid_ <= 0) return;
    kill(pid_, SIGTERM);
    while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }

  absl::Status Start(const std::string& data_dir, const StudioVerbOptions& options) {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) return ErrnoStatus(errno, "cannot make a pipe");
    output_ = ends[0];
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    const std::string program = ServerProgram();
    std::vector<std::string> words{program,         "--data-dir",  data_dir,
                                   "--listen",      "127.0.0.1:0", "--http",
                                   options.address, "--log-level", "warning"};
    if (!options.shared_model.empty()) {
      words.insert(words.end(), {"--share", options.shared_model});
    }
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const int error =
        posix_spawn(&pid_, program.c_str(), &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    if (error != 0) {
      pid_ = -1;
      return ErrnoStatus(error, absl::StrCat("cannot start ", program));
    }
    return ReadAddresses();
  }

  const std::string& grpc_address() const { return grpc_address_; }
  const std::string& page() const { return page_; }
  // Returns when the server has ended, or on Ctrl-C.
  void Wait() {
    pollfd ready{.fd = output_, .events = POLLIN, .revents = 0};
    std::string line;
    while (!Interrupted()) {
      if (poll(&ready, 1, kPollMs) > 0 && !ReadLine(&line)) return;
    }
  }

 private:
  absl::Status ReadAddresses() {
    std::string line;
    while (grpc_address_.empty() && ReadLine(&line)) {
      constexpr std::string_view kPage = "studio at ", kGrpc = "listening on ";
      if (line.starts_with(kPage)) page_ = line.substr(kPage.size());
      if (line.starts_with(kGrpc)) grpc_address_ = line.substr(kGrpc.size());
    }
    if (!grpc_address_.empty() && !page_.empty()) return absl::OkStatus();
    return absl::UnavailableError(
        "the server has ended before it listened; its reason is above. Another server may use the "
        "data folder or the port: choose others with --data-dir and --http");
  }
  bool ReadLine(std::string* line) {
    line->clear();
    char c = 0;
    ssize_t count = 0;
    while ((count = read(output_, &c, 1)) > 0 || (count < 0 && errno == EINTR)) {
      if (count <= 0) continue;
      if (c == '\n') return true;
      line->push_back(c);
    }
    return false;
  }

  pid_t pid_ = -1;
  int output_ = -1;
  std::string grpc_address_, page_;
};

// Opens the address with the program that the desktop has for it.
void OpenBrowser(const std::string& address) {
  std::string program = "xdg-open", argument = address;
  char* arguments[] = {program.data(), argument.data(), nullptr};
  pid_t pid = -1;
  if (posix_spawnp(&pid, program.c_str(), nullptr, nullptr, arguments, environ) == 0) {
    waitpid(pid, nullptr, 0);
  }
}

absl::Status RunStudio(const StudioVerbOptions& options, Session session) {
  OwnServer server;
  PLEAT_RETURN_IF_ERROR(server.Start(session.DataFolder(), options));
  if (!options.input.empty()) {
    PLEAT_ASSIGN_OR_RETURN(const MeshSequence sequence,
                           ReadInput(session, options.input, options.fps));
    session.server = server.grpc_address();
    PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<CharacterService> service, OpenService(session));
    PLEAT_RETURN_IF_ERROR(
        UploadWithProgress(service->sequences(), sequence, session, kKeepForEver).status());
  }
  *session.out << server.page() << "\n";
  session.out->flush();
  if (session.talkative()) *session.err << "the studio runs until Ctrl-C\n";
  if (options.open) OpenBrowser(server.page());
  server.Wait();
  return absl::OkStatus();
}

}  // namespace

void AddStudioVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<StudioVerbOptions>();
  CLI::App* verb = AddVerb(app, session, "studio", "Pleat in a browser, on this machine",
                           [options, &session] { return RunStudio(*options, session); });
  verb->add_option("INPUT", options->input, "an animation that is there when the page opens");
  verb->add_option("--http", options->address, "HOST:PORT of the page; port 0 = any free one")
      ->capture_default_str();
  verb->add_option("--share", options->shared_model,
                   "id of a model: the page shows it alone, and nobody can change anything");
  verb->add_flag("--open", options->open, "open the page in the browser of the desktop");
  verb->add_option("--fps", options->fps, "frames per second, where the input does not say");
  verb->add_option(
      "--data-dir", session.data_dir,
      "folder that keeps takes, jobs and models [PLEAT_DATA, else ~/.local/share/pleat]");
  AddObjectFlag(verb, session);
}

}  // namespace pleat
