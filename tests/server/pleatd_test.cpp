// The program itself: start, serve, end by a signal, start again on the same folder.
#include <fcntl.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "listening_socket.h"
#include "pleat/remote/remote_character_service.h"
#include "pleat/v1/sequence_service.grpc.pb.h"
#include "server/daemon.h"
#include "server/grpc/sockets.h"
#include "server/watch_to_end.h"
#include "support/fake_training.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(PleatdTest, ServesEndsOnSigtermAndComesBack) {
  TemporaryFolder folder;
  std::string sequence_id, job_id;
  {
    Daemon daemon(DaemonFlags(folder));
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
  Daemon daemon(DaemonFlags(folder));
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
    Daemon daemon(DaemonFlags(folder));
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto client,
                               RemoteCharacterService::Connect(daemon.WaitForAddress()));
    sequence_id = client->sequences().Upload(MakeSwayingTube(40), {})->id;
    job_id =
        client->jobs().CreateTraining({.sequence_ids = {sequence_id}, .model_name = "tube"})->id;
    daemon.Signal(SIGKILL);
    EXPECT_EQ(daemon.Wait(), -SIGKILL);
  }
  Daemon daemon(DaemonFlags(folder));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto client,
                             RemoteCharacterService::Connect(daemon.WaitForAddress()));
  EXPECT_THAT(client->sequences().Get(sequence_id), IsOk());
  EXPECT_THAT(client->jobs().Get(job_id), IsOk());
}

TEST(PleatdTest, RefusesAFolderAndAPortInUse) {
  TemporaryFolder folder, other;
  Daemon first(DaemonFlags(folder));
  const std::string address = first.WaitForAddress();
  Daemon same_folder(DaemonFlags(folder));
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
  std::vector<std::string> flags = DaemonFlags(folder);
  flags.insert(flags.end(), {"--log-level", "chatty"});
  Daemon level(flags);
  EXPECT_EQ(level.Wait(), 2);
  EXPECT_THAT(level.output(), HasSubstr("unknown log level"));
  flags = DaemonFlags(folder);
  flags.insert(flags.end(), {"--tls-cert", "/no/such/file"});
  Daemon tls(flags);
  EXPECT_EQ(tls.Wait(), 2);
  EXPECT_THAT(tls.output(), HasSubstr("/no/such/file"));
}

// 14 MiB of gzip became 10.9 GB in version 0.1.0, before any limit was looked at.
TEST(PleatdTest, ACompressedMessageIsRefusedBeforeItGrows) {
  TemporaryFolder folder;
  Daemon daemon(DaemonFlags(folder));
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
  std::vector<std::string> flags = DaemonFlags(folder);
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
    Daemon daemon(DaemonFlags(folder));
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto client,
                               RemoteCharacterService::Connect(daemon.WaitForAddress()));
    id = client->sequences().Upload(MakeSwayingTube(4), {})->id;
    daemon.Signal(SIGTERM);
    EXPECT_EQ(daemon.Wait(), 0);
  }
  const std::string path = folder.File("blobs/" + id.substr(0, 2) + "/" + id);
  std::filesystem::create_directories(folder.File("blobs/aa"));
  std::filesystem::rename(path, folder.File("blobs/aa/" + std::string(64, 'a')));
  Daemon daemon(DaemonFlags(folder));
  daemon.WaitForAddress();
  EXPECT_THAT(daemon.output(), HasSubstr(absl::StrCat("the file of '", id, "' is gone")));
  EXPECT_THAT(daemon.output(), HasSubstr("files that no entry names: 1 moved to the quarantine"));
}

TEST(PleatdTest, NamesWhatRetentionRemoves) {
  TemporaryFolder folder;
  std::vector<std::string> jobs;
  {
    Daemon daemon(DaemonFlags(folder));
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto client,
                               RemoteCharacterService::Connect(daemon.WaitForAddress()));
    const std::string id = client->sequences().Upload(MakeSwayingTube(4, "tube"), {})->id;
    for (int i = 0; i < 2; ++i) {
      jobs.push_back(client->jobs().CreateCompression({.sequence_id = id})->id);
      EXPECT_EQ(WatchToEnd(client->jobs(), jobs.back()).state, JobState::kSucceeded);
    }
    daemon.Signal(SIGTERM);
    EXPECT_EQ(daemon.Wait(), 0);
  }
  std::vector<std::string> flags = DaemonFlags(folder);
  flags.insert(flags.end(), {"--keep-jobs", "1"});
  Daemon daemon(flags);
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto client,
                             RemoteCharacterService::Connect(daemon.WaitForAddress()));
  EXPECT_TRUE(daemon.WaitForOutput(
      absl::StrCat("retention removed the job '", jobs[0], "' ('tube'): only the newest 1 that ")));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto left, client->jobs().List());
  ASSERT_EQ(left.size(), 1u);
  EXPECT_EQ(left[0].id, jobs[1]);
  EXPECT_EQ(client->compressed_sequences().List()->size(), 1u);  // both jobs made the same
}

}  // namespace
}  // namespace pleat
