// The program itself: start, serve, end by a signal, start again on the same folder.
#include <fcntl.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "listening_socket.h"
#include "pleat/base/file.h"
#include "pleat/remote/remote_character_service.h"
#include "pleat/v1/sequence_service.grpc.pb.h"
#include "server/grpc/sockets.h"
#include "server/watch_to_end.h"
#include "support/certificates.h"
#include "support/fake_training.h"
#include "support/source_folder.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"
#include "support/token_files.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

// pleatd as a child process.
class Daemon {
 public:
  explicit Daemon(const std::vector<std::string>& flags) {
    int out[2];
    if (pipe(out) != 0) abort();
    child_ = fork();
    if (child_ == 0) {
      dup2(out[1], STDOUT_FILENO);
      dup2(out[1], STDERR_FILENO);
      close(out[0]);
      std::vector<std::string> words{PLEATD_PATH};
      words.insert(words.end(), flags.begin(), flags.end());
      std::vector<char*> argv;
      for (std::string& word : words) argv.push_back(word.data());
      argv.push_back(nullptr);
      execv(PLEATD_PATH, argv.data());
      _exit(127);
    }
    close(out[1]);
    output_fd_ = out[0];
  }
  ~Daemon() {
    if (child_ > 0) {
      kill(child_, SIGKILL);
      waitpid(child_, nullptr, 0);
    }
    close(output_fd_);
  }

  // The address that it says it listens on; empty when it ended before.
  std::string WaitForAddress() {
    const std::string mark = "listening on ";
    while (ReadMore()) {
      const size_t start = output_.find(mark);
      if (start == std::string::npos) continue;
      const size_t end = output_.find('\n', start);
      if (end != std::string::npos) {
        return output_.substr(start + mark.size(), end - start - mark.size());
      }
    }
    return "";
  }
  void Signal(int number) { kill(child_, number); }
  // The most memory that it has had, in bytes.
  uint64_t PeakBytes() const {
    std::ifstream status(absl::StrCat("/proc/", child_, "/status"));
    for (std::string word; status >> word;) {
      uint64_t kilobytes = 0;
      if (word == "VmHWM:" && status >> kilobytes) return kilobytes << 10;
    }
    return 0;
  }
  // Waits for the end; exit code, or -signal.
  int Wait() {
    while (ReadMore()) {
    }
    int status = 0;
    waitpid(child_, &status, 0);
    child_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  const std::string& output() const { return output_; }

 private:
  bool ReadMore() {
    char buffer[4096];
    const ssize_t count = read(output_fd_, buffer, sizeof buffer);
    if (count > 0) output_.append(buffer, static_cast<size_t>(count));
    return count > 0;
  }

  pid_t child_ = -1;
  int output_fd_ = -1;
  std::string output_;
};

std::vector<std::string> Flags(const TemporaryFolder& folder) {
  return {"--data-dir",      folder.path(), "--listen",       "127.0.0.1:0",
          "--reserve-bytes", "1MB",         "--job-priority", "normal"};
}

TEST(PleatdTest, ServesEndsOnSigtermAndComesBack) {
  TemporaryFolder folder;
  std::string sequence_id, job_id;
  {
    Daemon daemon(Flags(folder));
    const std::string address = daemon.WaitForAddress();
    ASSERT_THAT(address, HasSubstr("127.0.0.1:"));
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto client, RemoteCharacterService::Connect(address));
    sequence_id = client->sequences().Upload(MakeSwayingTube(40), {})->id;
    // A tube is no human: the job fails with a reason, whichever side of the restart it runs on.
    job_id =
        client->jobs().CreateTraining({.sequence_ids = {sequence_id}, .model_name = "tube"})->id;
    daemon.Signal(SIGTERM);
    EXPECT_EQ(daemon.Wait(), 0) << daemon.output();
    EXPECT_THAT(daemon.output(), HasSubstr("pleatd has ended"));
  }
  Daemon daemon(Flags(folder));
  const std::string address = daemon.WaitForAddress();
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto client, RemoteCharacterService::Connect(address));
  EXPECT_EQ(client->sequences().Get(sequence_id)->name, "tube");
  JobInfo job;
  EXPECT_THAT(WatchJob(client->jobs(), job_id,
                       [&](const JobInfo& info) {
                         job = info;
                         return true;
                       }),
              IsOk());
  EXPECT_EQ(job.state, JobState::kFailed);
  EXPECT_FALSE(job.error.message().empty());
}

TEST(PleatdTest, AKillLosesNothing) {
  TemporaryFolder folder;
  std::string sequence_id, job_id;
  {
    Daemon daemon(Flags(folder));
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto client,
                               RemoteCharacterService::Connect(daemon.WaitForAddress()));
    sequence_id = client->sequences().Upload(MakeSwayingTube(40), {})->id;
    job_id =
        client->jobs().CreateTraining({.sequence_ids = {sequence_id}, .model_name = "tube"})->id;
    daemon.Signal(SIGKILL);
    EXPECT_EQ(daemon.Wait(), -SIGKILL);
  }
  Daemon daemon(Flags(folder));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto client,
                             RemoteCharacterService::Connect(daemon.WaitForAddress()));
  EXPECT_THAT(client->sequences().Get(sequence_id), IsOk());
  EXPECT_THAT(client->jobs().Get(job_id), IsOk());
}

TEST(PleatdTest, RefusesAFolderAndAPortInUse) {
  TemporaryFolder folder, other;
  Daemon first(Flags(folder));
  const std::string address = first.WaitForAddress();
  Daemon same_folder(Flags(folder));
  EXPECT_EQ(same_folder.Wait(), 1);
  EXPECT_THAT(same_folder.output(), HasSubstr("in use by another process"));
  Daemon same_port({"--data-dir", other.path(), "--listen", address, "--reserve-bytes", "1MB"});
  EXPECT_EQ(same_port.Wait(), 1);
  EXPECT_THAT(same_port.output(), HasSubstr("cannot listen on"));
}

TEST(PleatdTest, ExplainsItself) {
  Daemon help({"--help"});
  EXPECT_EQ(help.Wait(), 0);
  EXPECT_THAT(help.output(), HasSubstr("--data-dir"));
  Daemon version({"--version"});
  EXPECT_EQ(version.Wait(), 0);
  Daemon nothing({});
  EXPECT_EQ(nothing.Wait(), 2);
  EXPECT_THAT(nothing.output(), HasSubstr("--data-dir is required"));
  TemporaryFolder folder;
  std::vector<std::string> flags = Flags(folder);
  flags.insert(flags.end(), {"--log-level", "chatty"});
  Daemon level(flags);
  EXPECT_EQ(level.Wait(), 2);
  EXPECT_THAT(level.output(), HasSubstr("unknown log level"));
  flags = Flags(folder);
  flags.insert(flags.end(), {"--tls-cert", "/no/such/file"});
  Daemon tls(flags);
  EXPECT_EQ(tls.Wait(), 2);
  EXPECT_THAT(tls.output(), HasSubstr("/no/such/file"));
}

// 14 MiB of gzip became 10.9 GB in version 0.1.0, before any limit was looked at.
TEST(PleatdTest, ACompressedMessageIsRefusedBeforeItGrows) {
  TemporaryFolder folder;
  Daemon daemon(Flags(folder));
  const std::string address = daemon.WaitForAddress();
  grpc::ChannelArguments arguments;
  arguments.SetMaxSendMessageSize(-1);
  const auto stub = v1::SequenceService::NewStub(
      grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments));
  v1::GetSequenceRequest request;
  request.set_id("small");
  v1::GetSequenceResponse response;
  const auto code_of_call = [&](grpc_compression_algorithm algorithm) {
    grpc::ClientContext context;
    context.set_compression_algorithm(algorithm);
    return stub->GetSequence(&context, request, &response).error_code();
  };
  EXPECT_EQ(code_of_call(GRPC_COMPRESS_NONE), grpc::StatusCode::INVALID_ARGUMENT);
  const uint64_t before = daemon.PeakBytes();
  ASSERT_GT(before, 0u);
  request.set_id(std::string(200 << 20, 'x'));  // 200 kB of gzip
  for (const grpc_compression_algorithm algorithm : {GRPC_COMPRESS_GZIP, GRPC_COMPRESS_DEFLATE}) {
    EXPECT_EQ(code_of_call(algorithm), grpc::StatusCode::UNIMPLEMENTED);
  }
  EXPECT_LT(daemon.PeakBytes(), before + (64 << 20));
  request.set_id("small");
  EXPECT_EQ(code_of_call(GRPC_COMPRESS_NONE), grpc::StatusCode::INVALID_ARGUMENT);
}

// After a flood the server answers as before; 0.1.0 was deaf until it was restarted.
TEST(PleatdTest, AFloodOfConnectionsEndsWhenItEnds) {
  TemporaryFolder folder;
  std::vector<std::string> flags = Flags(folder);
  flags.insert(flags.end(), {"--max-connections-per-peer", "50"});
  Daemon daemon(flags);
  const std::string address = daemon.WaitForAddress();
  const int port = std::stoi(address.substr(address.rfind(':') + 1));
  {
    std::vector<TcpClient> flood;
    for (int i = 0; i < 300; ++i) flood.emplace_back(port, "127.0.0.2");
    EXPECT_TRUE(flood.back().WaitForEnd());
    // Other peers are served meanwhile.
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto client, RemoteCharacterService::Connect(address));
    EXPECT_THAT(client->sequences().List(), IsOk());
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto client, RemoteCharacterService::Connect(address));
  EXPECT_THAT(client->sequences().List(), IsOk());
  daemon.Signal(SIGTERM);
  EXPECT_EQ(daemon.Wait(), 0);
  EXPECT_THAT(daemon.output(), HasSubstr("connections refused, the last from 127.0.0.2"));
}

TEST(PleatdTest, TellsTheOperatorWhatAStartFound) {
  TemporaryFolder folder;
  std::string id;
  {
    Daemon daemon(Flags(folder));
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto client,
                               RemoteCharacterService::Connect(daemon.WaitForAddress()));
    id = client->sequences().Upload(MakeSwayingTube(4), {})->id;
    daemon.Signal(SIGTERM);
    EXPECT_EQ(daemon.Wait(), 0);
  }
  const std::string path = folder.File("blobs/" + id.substr(0, 2) + "/" + id);
  std::filesystem::create_directories(folder.File("blobs/aa"));
  std::filesystem::rename(path, folder.File("blobs/aa/" + std::string(64, 'a')));
  Daemon daemon(Flags(folder));
  daemon.WaitForAddress();
  EXPECT_THAT(daemon.output(), HasSubstr(absl::StrCat("the file of '", id, "' is gone")));
  EXPECT_THAT(daemon.output(), HasSubstr("files that no entry names: 1 moved to the quarantine"));
}

// The answer of an HTTP server to GET /metrics.
std::string GetMetrics(int port) {
  const TcpClient client(port);
  const std::string request = "GET /metrics HTTP/1.0\r\n\r\n";
  if (send(client.fd(), request.data(), request.size(), MSG_NOSIGNAL) < 0) return "";
  std::string answer;
  char buffer[4096];
  for (ssize_t count; (count = recv(client.fd(), buffer, sizeof buffer, 0)) > 0;) {
    answer.append(buffer, static_cast<size_t>(count));
  }
  return answer;
}

TEST(PleatdTest, AnswersPrometheus) {
  TemporaryFolder folder;
  // A port that is free now: the flag takes no 0, since Prometheus must know it.
  const int port = ListeningSocket::Open("127.0.0.1:0")->port();
  std::vector<std::string> flags = Flags(folder);
  flags.insert(flags.end(), {"--metrics-listen", absl::StrCat("127.0.0.1:", port)});
  Daemon daemon(flags);
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto client,
                             RemoteCharacterService::Connect(daemon.WaitForAddress()));
  EXPECT_THAT(client->sequences().Get(std::string(64, 'a')), testing::Not(IsOk()));
  for (const char* line :
       {"pleat_jobs{state=\"queued\"} 0", "pleat_memory_bytes{owner=\"models\"} 0",
        "pleat_quarantined_files 0", "pleat_connections 1", "pleat_refused_connections 0",
        "pleat_rpcs_total{method=\"/pleat.v1.SequenceService/GetSequence\",status=\"NOT_FOUND\"} "
        "1"}) {
    std::string metrics;  // a call is counted soon after its client has the answer
    while (metrics.find(line) == std::string::npos) metrics = GetMetrics(port);
  }
}

// A panel that asks for a metric of another name shows nothing, and nobody notices.
TEST(PleatdTest, EveryQueryOfTheDashboardNamesAMetric) {
  TemporaryFolder folder;
  const Certificate authority = Certificate::Authority("studio");
  const Certificate own = Certificate::SignedBy(authority, "server");
  ASSERT_THAT(WriteFile(folder.File("server.pem"), own.certificate_pem()), IsOk());
  ASSERT_THAT(WriteFile(folder.File("server.key"), own.key_pem()), IsOk());
  const int port = ListeningSocket::Open("127.0.0.1:0")->port();
  std::vector<std::string> flags = Flags(folder);
  flags.insert(flags.end(), {"--metrics-listen", absl::StrCat("127.0.0.1:", port), "--tls-cert",
                             folder.File("server.pem"), "--tls-key", folder.File("server.key")});
  Daemon daemon(flags);
  const std::string address = daemon.WaitForAddress();
  ASSERT_NE(address, "") << daemon.output();
  grpc::SslCredentialsOptions tls;
  tls.pem_root_certs = authority.certificate_pem();
  const auto channel = grpc::CreateChannel(address, grpc::SslCredentials(tls));
  grpc::ClientContext context;
  v1::GetSequenceResponse response;
  v1::SequenceService::NewStub(channel)->GetSequence(&context, {}, &response);  // counted, whatever
  std::string metrics;
  while (metrics.find("pleat_rpcs_total{") == std::string::npos) metrics = GetMetrics(port);

  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string dashboard,
                             ReadFile(InSourceFolder("server/grafana/pleat.json")));
  int num_names = 0;
  for (size_t at = dashboard.find("pleat_"); at != std::string::npos;
       at = dashboard.find("pleat_", at + 1)) {
    const std::string name =
        dashboard.substr(at, dashboard.find_first_not_of("abcdefghijklmnopqrstuvwxyz_", at) - at);
    EXPECT_THAT(metrics, testing::ContainsRegex("\n" + name + "[{ ]")) << name;
    ++num_names;
  }
  EXPECT_GE(num_names, 11);
}

TEST(PleatdTest, IsNotOpenToOtherMachinesByMistake) {
  TemporaryFolder folder;
  Daemon daemon({"--data-dir", folder.path(), "--listen", "0.0.0.0:0"});
  EXPECT_EQ(daemon.Wait(), 2);
  EXPECT_THAT(daemon.output(), HasSubstr("--allow-unencrypted"));
}

TEST(PleatdTest, IsOpenToOtherMachinesWhenItKnowsItsCallers) {
  TestTokens tokens;  // in a data folder
  const std::vector<std::string> flags = {"--data-dir",          tokens.folder(),   "--listen",
                                          "0.0.0.0:0",           "--reserve-bytes", "1MB",
                                          "--allow-unencrypted", "--allow-root"};
  Daemon anonymous(flags);
  EXPECT_EQ(anonymous.Wait(), 2);
  EXPECT_THAT(anonymous.output(), HasSubstr("pleat token create"));
  tokens.Add("Ada", "admin");
  Daemon known(flags);
  EXPECT_NE(known.WaitForAddress(), "") << known.output();
}

TEST(PleatdTest, AFailedJobLeavesItsReasonInTheLog) {
  TemporaryFolder folder;
  Daemon daemon(Flags(folder));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto client,
                             RemoteCharacterService::Connect(daemon.WaitForAddress()));
  PLEAT_ASSERT_OK_AND_ASSIGN(const SequenceInfo tube,
                             client->sequences().Upload(MakeSwayingTube(4), {}));
  PLEAT_ASSERT_OK_AND_ASSIGN(const JobInfo created,
                             client->jobs().CreateTraining({.sequence_ids = {tube.id}}));
  const JobInfo job = WatchToEnd(client->jobs(), created.id);
  EXPECT_EQ(job.state, JobState::kFailed) << "a tube is no human";
  daemon.Signal(SIGTERM);
  EXPECT_EQ(daemon.Wait(), 0);
  for (const char* state : {"running", "failed: "}) {
    EXPECT_THAT(daemon.output(), HasSubstr(absl::StrCat(job.id, " '", job.name, "' is ", state)));
  }
}

TEST(PleatdTest, LogsJson) {
  TemporaryFolder folder;
  std::vector<std::string> flags = Flags(folder);
  flags.push_back("--log-json");
  Daemon daemon(flags);
  daemon.WaitForAddress();
  daemon.Signal(SIGINT);
  EXPECT_EQ(daemon.Wait(), 0);
  EXPECT_THAT(daemon.output(), HasSubstr(R"("level":"info","thread":)"));
}

}  // namespace
}  // namespace pleat
