#include "cli/show/json_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "client/run_pleat.h"
#include "client/test_sequence.h"
#include "pleat/formats/sequence_file.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

TEST(JsonTextTest, MembersKeepTheirOrderOnLinesOfTheirOwn) {
  EXPECT_EQ(JsonText({{"b", 1}, {"a", {2, 3}}}),
            "{\n  \"b\": 1,\n  \"a\": [\n    2,\n    3\n  ]\n}\n");
}

TEST(JsonTextTest, TextThatIsNoUtf8IsReplacedAndTheRestStays) {
  const std::string text = JsonText({{"name", "caf\xe9 \xc3\xa9\n\x01"}});
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json["name"], "caf\xef\xbf\xbd \xc3\xa9\n\x01");
}

// A name in Latin-1, as file names of older disks have it.
TEST(JsonTextTest, EveryNameOfASequenceCanBePrinted) {
  const TemporaryFolder folder;
  const MeshSequence clip = MovingTetrahedron(2);
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const MeshSequence named,
      MeshSequence::Create(clip.topology(), {clip.frame(0)}, {.name = "caf\xe9"}));
  const std::string path = folder.File("caf\xe9.pseq");
  ASSERT_THAT(WriteSequenceFile(path, named), IsOk());
  const Outcome outcome = RunPleat({"inspect", path, "--json"});
  EXPECT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["name"], "caf\xef\xbf\xbd");
}

}  // namespace
}  // namespace pleat
