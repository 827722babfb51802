// Writes a character, poses and the frames that our own evaluator shows for them, which tests in
// other languages compare with:  write_character FOLDER [RINGS SIDES]
//
//   character.pleat   the model
//   poses.f64         T x (3 + 4 J): the root, then x, y, z, w of each joint
//   frames.f32        T x V x 3: frame t shows pose t with the poses before it as history
//   confidence.f64    T
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/character/pose_evaluator.h"
#include "pleat/formats/model_file.h"
#include "support/fake_training.h"

namespace pleat {
namespace {

constexpr int kNumFrames = 40;

template <typename Value>
absl::Status WriteValues(const std::filesystem::path& path, const std::vector<Value>& values) {
  return WriteFile(path.string(), std::string_view(reinterpret_cast<const char*>(values.data()),
                                                   values.size() * sizeof(Value)));
}

absl::Status WriteCharacter(const std::filesystem::path& folder, int rings, int sides) {
  const auto model = MakeFakeModel(MakeSwayingTube(2, "tube", rings, sides), {.history = 2});
  const PoseTrack track = MakeMotion(model->skeleton(), kNumFrames);
  PoseEvaluator evaluator(model);
  std::vector<double> poses, confidence;
  std::vector<float> frames;
  for (int t = 0; t < kNumFrames; ++t) {
    const Pose& pose = track.pose(t);
    poses.insert(poses.end(), pose.root_position.begin(), pose.root_position.end());
    for (const Eigen::Quaterniond& q : pose.rotations) {
      poses.insert(poses.end(), q.coeffs().begin(), q.coeffs().end());
    }
    std::vector<const Pose*> history = {&pose};
    if (t > 0) history.push_back(&track.pose(t - 1));
    EvaluatedFrame frame;
    PLEAT_RETURN_IF_ERROR(evaluator.Evaluate(history, {}, &frame));
    frames.insert(frames.end(), frame.positions.data(),
                  frame.positions.data() + frame.positions.size());
    confidence.push_back(frame.confidence);
  }
  PLEAT_RETURN_IF_ERROR(WriteFile((folder / "character.pleat").string(), EncodeModel(*model)));
  PLEAT_RETURN_IF_ERROR(WriteValues(folder / "poses.f64", poses));
  PLEAT_RETURN_IF_ERROR(WriteValues(folder / "frames.f32", frames));
  return WriteValues(folder / "confidence.f64", confidence);
}

}  // namespace
}  // namespace pleat

int main(int argc, char** argv) {
  if (argc != 2 && argc != 4) {
    std::fputs("usage: write_character FOLDER [RINGS SIDES]\n", stderr);
    return 2;
  }
  std::filesystem::create_directories(argv[1]);
  const int rings = argc == 4 ? std::atoi(argv[2]) : 20,
            sides = argc == 4 ? std::atoi(argv[3]) : 15;
  const absl::Status status = pleat::WriteCharacter(argv[1], rings, sides);
  if (!status.ok()) std::fprintf(stderr, "%s\n", status.ToString().c_str());
  return status.ok() ? 0 : 1;
}
