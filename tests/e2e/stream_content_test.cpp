// `pleat pose --content` against a real server process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "absl/strings/str_format.h"
#include "e2e/pleat_program.h"
#include "e2e/report_checks.h"
#include "e2e/sequence_difference.h"
#include "e2e/server_program.h"
#include "pleat/formats/sequence_reader.h"
#include "pleat/stream/draco_file.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(StreamContent, StreamsHoldLessThanAMeshWhereAskedTo) {
  PleatProgram pleat;
  const std::string input = pleat.GeneratePerformer(25, 800);
  ServerProgram server(pleat.File("store"));
  const std::string address = server.WaitForAddress();
  ASSERT_NE(address, "") << server.log();
  const std::string model = pleat.File("m.pleat"), motion = pleat.File("motion.json");
  ASSERT_EQ(pleat
                .Run({"train", input, "--server", address, "-o", model, "--learner", "gp",
                      "--report", pleat.File("train.json")})
                .exit_code,
            0)
      << server.log();
  const std::string id = ParseJson(Bytes(pleat.File("train.json")))["model_id"];
  const auto pose = [&](const std::string& which, const std::string& out,
                        const std::string& content) {
    return pleat.Run({"pose", which, "--server", address, "--motion", motion, "-o", pleat.File(out),
                      "--content", content});
  };
  ASSERT_EQ(pleat.Run({"motion", model, input, "-o", motion}).exit_code, 0);
  ASSERT_EQ(
      pleat.Run({"pose", model, "--motion", motion, "-o", pleat.File("exact.pseq")}).exit_code, 0);

  ProcessResult result = pose(id, "shown.pseq", "parameters");
  ASSERT_EQ(result.exit_code, 0) << result.err << server.log();
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence exact, ReadSequence(pleat.File("exact.pseq")));
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence shown, ReadSequence(pleat.File("shown.pseq")));
  EXPECT_LT(LargestDifference(exact, shown), 2e-6);  // meters: the rounding of rotations

  result = pose(id, "control", "control");
  ASSERT_EQ(result.exit_code, 0) << result.err << server.log();
  const nlohmann::json header = ParseJson(Bytes(pleat.File("control/stream.json")));
  EXPECT_EQ(header["content"], "control");
  const std::vector<int> vertices = header["control_vertices"];
  EXPECT_NEAR(vertices.size(), exact.num_vertices() / 20, 4);
  const double half_step_m = 0.501 * header["box"]["step_m"].get<double>();
  for (const int t : {0, exact.num_frames() - 1}) {
    const std::string bytes = Bytes(pleat.File(absl::StrFormat("control/frame_%04d.drc", t)));
    PLEAT_ASSERT_OK_AND_ASSIGN(const DracoGeometry frame, DecodeDracoFile(bytes));
    EXPECT_EQ(frame.triangles.cols(), header["num_triangles"]);
    for (Eigen::Index i = 0; i < frame.positions.cols(); ++i) {
      const auto truth = exact.frame(t).col(vertices[frame.vertex_numbers[i]]);
      EXPECT_LE((frame.positions.col(i) - truth).cwiseAbs().maxCoeff(), half_step_m);
    }
  }

  EXPECT_THAT(pose(id, "x.pc2", "control").err, HasSubstr("--format drc"));
  EXPECT_THAT(pose(id, "folder", "parameters").err, HasSubstr("no Draco frames"));
  EXPECT_THAT(pose(model, "x.pc2", "parameters").err, HasSubstr("evaluated here"));
  EXPECT_EQ(server.Stop().exit_code, 0) << server.log();
}

}  // namespace
}  // namespace pleat
