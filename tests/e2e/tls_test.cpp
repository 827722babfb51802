// Encrypted connections between the real programs, with certificates of both sides.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "e2e/pleat_program.h"
#include "e2e/server_program.h"
#include "support/certificates.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class Tls : public testing::Test {
 protected:
  std::string Write(const std::string& name, const std::string& text) {
    EXPECT_THAT(WriteFile(pleat_.File(name), text), IsOk());
    return pleat_.File(name);
  }
  std::vector<std::string> ServerFlags() {
    const Certificate own = Certificate::SignedBy(authority_, "server");
    return {"--tls-cert", Write("server.pem", own.certificate_pem()), "--tls-key",
            Write("server.key", own.key_pem())};
  }
  // `pleat models` with the address of `server` and these flags.
  ProcessResult ListModels(ServerProgram& server, const std::vector<std::string>& flags) {
    std::vector<std::string> command = {"models", "--server", server.WaitForAddress()};
    command.insert(command.end(), flags.begin(), flags.end());
    return pleat_.Run(command);
  }

  PleatProgram pleat_;
  const Certificate authority_ = Certificate::Authority("studio");
  const std::string ca_ = Write("ca.pem", authority_.certificate_pem());
};

TEST_F(Tls, AClientThatTrustsTheAuthorityTrainsAndPoses) {
  ServerProgram server(pleat_.File("store"), ServerFlags());
  ASSERT_EQ(ListModels(server, {"--tls-ca", ca_}).exit_code, 0) << server.log();
  const std::string input = pleat_.GeneratePerformer(25, 800);
  const ProcessResult result =
      pleat_.Run({"train", input, "--server", server.WaitForAddress(), "--tls-ca", ca_, "-o",
                  pleat_.File("m.pleat"), "--learner", "gp", "--refine", "none"});
  EXPECT_EQ(result.exit_code, 0) << result.err << server.log();
  EXPECT_FALSE(Bytes(pleat_.File("m.pleat")).empty());
}

TEST_F(Tls, StrangersAndPlainTextAreRefused) {
  ServerProgram server(pleat_.File("store"), ServerFlags());
  const Certificate stranger = Certificate::Authority("stranger");
  const ProcessResult untrusted =
      ListModels(server, {"--tls-ca", Write("other.pem", stranger.certificate_pem())});
  EXPECT_NE(untrusted.exit_code, 0);
  EXPECT_THAT(untrusted.err, HasSubstr("certificate"));
  EXPECT_NE(ListModels(server, {"--tls"}).exit_code, 0);  // the system's authorities
  EXPECT_THAT(ListModels(server, {}).err, HasSubstr("--tls?"));
  EXPECT_EQ(ListModels(server, {"--tls-ca", ca_}).exit_code, 0) << server.log();
}

TEST_F(Tls, AServerMayAskForTheClientsCertificate) {
  std::vector<std::string> flags = ServerFlags();
  flags.insert(flags.end(), {"--tls-client-ca", ca_});
  ServerProgram server(pleat_.File("store"), flags);
  EXPECT_NE(ListModels(server, {"--tls-ca", ca_}).exit_code, 0);
  const auto as_client = [&](const Certificate& client) {
    return ListModels(server,
                      {"--tls-ca", ca_, "--tls-cert", Write("client.pem", client.certificate_pem()),
                       "--tls-key", Write("client.key", client.key_pem())});
  };
  EXPECT_EQ(as_client(Certificate::SignedBy(authority_, "artist")).exit_code, 0) << server.log();
  const Certificate stranger = Certificate::Authority("stranger");
  EXPECT_NE(as_client(Certificate::SignedBy(stranger, "artist")).exit_code, 0);
}

}  // namespace
}  // namespace pleat
