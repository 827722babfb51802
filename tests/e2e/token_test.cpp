// Tokens between the real programs, and what the audit log says of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "e2e/pleat_program.h"
#include "e2e/server_program.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class TokenProgramTest : public testing::Test {
 protected:
  // A file that holds a token with these scopes.
  std::string Create(const std::string& name, const std::string& scopes,
                     const std::string& project = "default") {
    const ProcessResult made = pleat_.Run(
        {"token", "create", store_, "--name", name, "--scopes", scopes, "--project", project});
    EXPECT_EQ(made.exit_code, 0) << made.err;
    EXPECT_THAT(WriteFile(pleat_.File(name), made.out), IsOk());
    return pleat_.File(name);
  }
  ProcessResult Run(const std::string& address, std::vector<std::string> arguments,
                    const std::string& token_file = "") {
    arguments.insert(arguments.end(), {"--server", address});
    if (!token_file.empty()) arguments.insert(arguments.end(), {"--token-file", token_file});
    return pleat_.Run(arguments);
  }

  PleatProgram pleat_;
  const std::string store_ = pleat_.File("store"), audit_log_ = pleat_.File("audit.jsonl");
};

TEST_F(TokenProgramTest, LetsInWhoMayAndWritesDownWhatTheyDid) {
  ServerProgram server(store_, {"--audit-log", audit_log_});
  const std::string address = server.WaitForAddress();
  ASSERT_NE(address, "") << server.log();
  const std::string input = pleat_.GeneratePerformer(10, 800);
  EXPECT_EQ(Run(address, {"sequences"}).exit_code, 0) << "nobody has a token yet";

  const std::string maker = Create("maker", "read,train"), admin = Create("admin", "read,admin");
  const ProcessResult stranger = Run(address, {"sequences"});
  EXPECT_EQ(stranger.exit_code, 5);
  EXPECT_THAT(stranger.err, HasSubstr("token"));
  EXPECT_EQ(Run(address, {"status", "--can-store"}).exit_code, 0) << "health needs no token";
  ASSERT_EQ(Run(address, {"upload", input}, maker).exit_code, 0) << server.log();
  const nlohmann::json list = ParseJson(Run(address, {"sequences", "--json"}, maker).out);
  const std::string id = list[0]["id"];
  const ProcessResult refused = Run(address, {"sequences", "delete", id}, maker);
  EXPECT_EQ(refused.exit_code, 5);
  EXPECT_THAT(refused.err, HasSubstr("needs admin"));
  EXPECT_EQ(Run(address, {"sequences", "delete", id}, admin).exit_code, 0) << server.log();
  EXPECT_EQ(server.Stop().exit_code, 0);

  std::vector<std::string> said;
  for (const auto& text : absl::StrSplit(Bytes(audit_log_), '\n', absl::SkipEmpty())) {
    const nlohmann::json line = ParseJson(std::string(text));
    said.push_back(line["rpc"].get<std::string>() + " " + line.value("name", "nobody") + " " +
                   line["status"].get<std::string>());
    EXPECT_THAT(line["peer"], HasSubstr("127.0.0.1"));
  }
  EXPECT_THAT(said, testing::ElementsAre(
                        "ListSequences nobody UNAUTHENTICATED", "UploadSequence maker OK",
                        "DeleteSequence maker PERMISSION_DENIED", "DeleteSequence admin OK"));
  for (const std::string& file : {maker, admin}) {
    const std::string secret = Bytes(file).substr(23, 64);
    EXPECT_THAT(server.log() + Bytes(audit_log_) + Bytes(store_ + "/tokens.json"),
                Not(HasSubstr(secret)));
  }
}

TEST_F(TokenProgramTest, ProjectsDoNotSeeEachOther) {
  const std::string robots = Create("robots", "read,train,admin", "robots");
  const std::string ghosts = Create("ghosts", "read,train,admin", "ghosts");
  const std::string input = pleat_.GeneratePerformer(10, 800);
  std::string id;
  {
    ServerProgram server(store_, {});
    const std::string address = server.WaitForAddress();
    ASSERT_NE(address, "") << server.log();
    ASSERT_EQ(Run(address, {"upload", input}, robots).exit_code, 0) << server.log();
    id = ParseJson(Run(address, {"sequences", "--json"}, robots).out)[0]["id"];
    EXPECT_EQ(Run(address, {"sequences", "--json"}, ghosts).out, "[]\n");
    const ProcessResult foreign = Run(address, {"sequences", "delete", id}, ghosts);
    EXPECT_EQ(foreign.exit_code, 4);  // as for an id of nobody
    ASSERT_EQ(Run(address, {"upload", input}, ghosts).exit_code, 0) << server.log();
    EXPECT_EQ(Run(address, {"sequences", "delete", id}, robots).exit_code, 0) << server.log();
    EXPECT_EQ(server.Stop().exit_code, 0);
  }
  EXPECT_EQ(pleat_.Run({"store", "check", store_}).exit_code, 0);
  ServerProgram server(store_, {});  // whose is what is remembered
  const std::string address = server.WaitForAddress();
  EXPECT_EQ(Run(address, {"sequences", "--json"}, robots).out, "[]\n");
  EXPECT_EQ(ParseJson(Run(address, {"sequences", "--json"}, ghosts).out)[0]["id"], id);
  EXPECT_EQ(server.Stop().exit_code, 0);
}

}  // namespace
}  // namespace pleat
