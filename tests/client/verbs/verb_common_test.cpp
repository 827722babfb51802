// The flags that several verbs share, seen through the verbs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/run_pleat.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

// Nobody listens on this port: what gets so far has passed the parser.
constexpr char kNobody[] = "127.0.0.1:1";

void ExpectExcluded(const std::vector<std::string>& flags) {
  std::vector<std::string> arguments = {"sequences"};
  arguments.insert(arguments.end(), flags.begin(), flags.end());
  const Outcome outcome = RunPleat(arguments);
  EXPECT_EQ(outcome.code, ExitCode::kUsage) << testing::PrintToString(flags);
  EXPECT_THAT(outcome.err, HasSubstr("Try 'pleat sequences --help'."));
}

TEST(VerbCommonTest, FlagsOfAServerExcludeTheStoreOnThisMachine) {
  ExpectExcluded({"--local", "--server", kNobody});
  ExpectExcluded({"--local", "--tls"});
  ExpectExcluded({"--local", "--tls-ca", "ca.pem"});
  ExpectExcluded({"--local", "--tls-cert", "c.pem", "--tls-key", "k.pem"});
}

TEST(VerbCommonTest, CertificateAndKeyNeedEachOtherAndTheDataFolderNeedsLocal) {
  ExpectExcluded({"--tls-cert", "c.pem"});
  ExpectExcluded({"--tls-key", "k.pem"});
  ExpectExcluded({"--data-dir", "here"});
}

TEST(VerbCommonTest, AServerThatIsNotThereIsUnavailableAndNamed) {
  for (const char* verb : {"sequences", "jobs", "models", "compressed"}) {
    const Outcome outcome = RunPleat({verb, "--server", kNobody});
    EXPECT_EQ(outcome.code, ExitCode::kUnavailable) << verb << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(kNobody)) << verb;
  }
}

TEST(VerbCommonTest, CertificatesThatCannotBeReadAreNamed) {
  const Outcome outcome =
      RunPleat({"sequences", "--server", kNobody, "--tls-ca", "/nowhere/ca.pem"});
  EXPECT_EQ(outcome.code, ExitCode::kNotFound);
  EXPECT_THAT(outcome.err, HasSubstr("/nowhere/ca.pem"));
}

TEST(VerbCommonTest, EveryVerbHasJsonAndQuietAndSaysSo) {
  for (const char* verb : {"inspect", "rig", "train", "motion", "pose", "evaluate", "render",
                           "compare", "compress", "decompress", "generate", "upload", "sequences",
                           "jobs", "models", "compressed", "bench", "version"}) {
    const Outcome help = RunPleat({verb, "--help"});
    EXPECT_EQ(help.code, ExitCode::kOk) << verb;
    EXPECT_THAT(help.out, HasSubstr("--json")) << verb;
    EXPECT_THAT(help.out, HasSubstr("--quiet")) << verb;
  }
}

// Scripts say --local everywhere; verbs that never need a service take it.
TEST(VerbCommonTest, VerbsInThisProcessAcceptLocal) {
  for (const char* verb : {"inspect", "compare", "generate"}) {
    EXPECT_THAT(RunPleat({verb, "--help"}).out, HasSubstr("--local")) << verb;
  }
}

}  // namespace
}  // namespace pleat
