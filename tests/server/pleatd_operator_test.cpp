// What pleatd tells its operator: metrics, the log, and who may reach it.
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "listening_socket.h"
#include "pleat/base/file.h"
#include "pleat/remote/remote_character_service.h"
#include "pleat/v1/sequence_service.grpc.pb.h"
#include "server/daemon.h"
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

TEST(PleatdOperatorTest, AnswersPrometheus) {
  TemporaryFolder folder;
  // A port that is free now: the flag takes no 0, since Prometheus must know it.
  const int port = ListeningSocket::Open("127.0.0.1:0")->port();
  std::vector<std::string> flags = DaemonFlags(folder);
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

// The names of all metrics of an answer.
std::vector<std::string> NamesOf(const std::string& metrics) {
  constexpr absl::string_view kHelp = "# HELP pleat_";
  std::vector<std::string> names;
  for (const absl::string_view line : absl::StrSplit(metrics, '\n')) {
    if (!absl::StartsWith(line, kHelp)) continue;
    names.push_back(absl::StrCat(
        "pleat_", line.substr(kHelp.size(), line.find(' ', kHelp.size()) - kHelp.size())));
  }
  return names;
}

// Metrics that no panel shows, each with the reason.
const std::map<std::string, std::string>& MetricsWithoutPanel() {
  static const std::map<std::string, std::string> none;
  return none;
}

// A metric that nobody looks at is found when it is too late: each is on a panel, and in the table
// of the page for operators.
void ExpectOnDashboard(const std::string& metrics, const std::string& dashboard) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string page,
                             ReadFile(InSourceFolder("docs/reliability.md")));
  const std::vector<std::string> names = NamesOf(metrics);
  EXPECT_GE(names.size(), 19u);
  for (const std::string& name : names) {
    const bool is_shown = dashboard.find(name + "{") != std::string::npos ||
                          dashboard.find(name + "_bucket{") != std::string::npos;
    EXPECT_NE(is_shown, MetricsWithoutPanel().contains(name)) << name;
    EXPECT_THAT(page, HasSubstr("`" + name + "`"));
  }
}

// A panel that asks for a metric of another name shows nothing, and nobody notices.
TEST(PleatdOperatorTest, EveryQueryOfTheDashboardNamesAMetric) {
  TemporaryFolder folder;
  const Certificate authority = Certificate::Authority("studio");
  const Certificate own = Certificate::SignedBy(authority, "server");
  ASSERT_THAT(WriteFile(folder.File("server.pem"), own.certificate_pem()), IsOk());
  ASSERT_THAT(WriteFile(folder.File("server.key"), own.key_pem()), IsOk());
  const int port = ListeningSocket::Open("127.0.0.1:0")->port();
  std::vector<std::string> flags = DaemonFlags(folder);
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
  EXPECT_GE(num_names, 20);
  ExpectOnDashboard(metrics, dashboard);
}

TEST(PleatdOperatorTest, IsNotOpenToOtherMachinesByMistake) {
  TemporaryFolder folder;
  Daemon daemon({"--data-dir", folder.path(), "--listen", "0.0.0.0:0"});
  EXPECT_EQ(daemon.Wait(), 2);
  EXPECT_THAT(daemon.output(), HasSubstr("--allow-unencrypted"));
}

TEST(PleatdOperatorTest, IsOpenToOtherMachinesWhenItKnowsItsCallers) {
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

TEST(PleatdOperatorTest, AFailedJobLeavesItsReasonInTheLog) {
  TemporaryFolder folder;
  Daemon daemon(DaemonFlags(folder));
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

TEST(PleatdOperatorTest, LogsJson) {
  TemporaryFolder folder;
  std::vector<std::string> flags = DaemonFlags(folder);
  flags.push_back("--log-json");
  Daemon daemon(flags);
  daemon.WaitForAddress();
  daemon.Signal(SIGINT);
  EXPECT_EQ(daemon.Wait(), 0);
  EXPECT_THAT(daemon.output(), HasSubstr(R"("level":"info","thread":)"));
}

}  // namespace
}  // namespace pleat
