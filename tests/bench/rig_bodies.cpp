// The automatic rig of many bodies, one row each: rig_bodies [--joints] [--orientations]
// [--repeat N] [--pictures FOLDER] INPUT[=TRUTH.json]... The input `performer` is generated. The
// truth is found beside an input, as <stem>_truth.json. Times are the least of N. The table of
// docs/performance.md.
#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/formats/sequence_reader.h"
#include "pleat/mesh/bounds.h"
#include "pleat/performer/performer.h"
#include "pleat/rigging/auto_rig.h"
#include "pleat/skeleton/human_template.h"
#include "rig_picture.h"

namespace pleat {
namespace {

constexpr uint64_t kMaxTruthBytes = uint64_t{1} << 20;

// A known joint of the first frame.
struct KnownJoint {
  int joint;  // HumanJoint
  Eigen::Vector3d position;
};

struct Body {
  std::string name;
  MeshSequence sequence;
  std::vector<KnownJoint> truth;  // may be empty
};

AutoRigOptions OneThread() {
  AutoRigOptions options;
  options.num_threads = 1;
  return options;
}

struct Arguments {
  bool joints = false, orientations = false;
  int repeat = 1;
  std::string pictures;
  std::vector<std::string> inputs;
};

double CpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

std::vector<KnownJoint> ReadTruth(const std::string& path) {
  const absl::StatusOr<std::string> text = ReadFile(path, kMaxTruthBytes);
  if (!text.ok()) return {};
  const nlohmann::json root = nlohmann::json::parse(*text, nullptr, false);
  std::vector<KnownJoint> truth;
  for (const nlohmann::json& joint : root.at("joints")) {
    const int index = HumanTemplate().FindJoint(joint.at("name").get<std::string>());
    const nlohmann::json& at = joint.at("position_m");
    if (index < 0) continue;
    truth.push_back(
        {index, Eigen::Vector3d(at[0].get<double>(), at[1].get<double>(), at[2].get<double>())});
  }
  return truth;
}

absl::StatusOr<Body> LoadBody(const std::string& input) {
  if (input == "performer") {
    PLEAT_ASSIGN_OR_RETURN(Performer performer,
                           GeneratePerformer({.num_frames = 48, .num_vertices = 10000}));
    Body body{input, std::move(performer.sequence), {}};
    for (int j = 0; j < kNumHumanJoints; ++j) {
      if (j == kSpine || j == kChest || j == kHead) continue;  // no anatomical points
      body.truth.push_back({j, performer.truth.rig.skeleton.rest_position(j)});
    }
    return body;
  }
  const size_t equals = input.find('=');
  const std::filesystem::path path = input.substr(0, equals);
  PLEAT_ASSIGN_OR_RETURN(MeshSequence sequence, ReadSequence(path.string()));
  const std::string truth =
      equals != std::string::npos
          ? input.substr(equals + 1)
          : (path.parent_path() / (path.stem().string() + "_truth.json")).string();
  return Body{path.stem().string(), std::move(sequence), ReadTruth(truth)};
}

// Prints where each joint is off, in % of the height: to the character's outside (right joints are
// mirrored; middle ones count to the left), up and to the front.
void PrintJoints(const Body& body, const Eigen::Matrix3Xd& joints, double height) {
  Eigen::Vector3d left = Eigen::Vector3d::Zero();
  for (const KnownJoint& known : body.truth) {
    if (known.joint == kLeftUpperLeg || known.joint == kLeftUpperArm) left += known.position;
    if (known.joint == kRightUpperLeg || known.joint == kRightUpperArm) left -= known.position;
  }
  left.y() = 0;
  left.normalize();
  const Eigen::Vector3d front = left.cross(Eigen::Vector3d::UnitY());
  for (const KnownJoint& known : body.truth) {
    const Eigen::Vector3d offset = 100 / height * (joints.col(known.joint) - known.position);
    const bool is_right = HumanMirror()[known.joint] < known.joint;
    std::printf("    %-14s %5.1f: out %5.1f up %5.1f front %5.1f\n",
                HumanTemplate().joint(known.joint).name.c_str(), offset.norm(),
                (is_right ? -1 : 1) * offset.dot(left), offset.y(), offset.dot(front));
  }
}

MeshSequence Turned(const MeshSequence& sequence, const Eigen::Matrix3d& turn) {
  return *MeshSequence::Create(sequence.topology(),
                               {(turn * sequence.FrameAsDouble(0)).cast<float>()},
                               {.name = sequence.name()});
}

// Rigs the first frame in twelve orientations and says how far the skeletons are from `expected`.
void PrintOrientations(const Body& body, const Eigen::Matrix3Xd& expected, double height) {
  const Eigen::Vector3d axes[] = {{1, 0, 0}, {0, 0, 1}, {1, 1, 0}, {1, -2, 3}};
  for (const Eigen::Vector3d& axis : axes) {
    for (const double degrees : {90., 180., 245.}) {
      const Eigen::Matrix3d turn =
          Eigen::AngleAxisd(degrees * EIGEN_PI / 180, axis.normalized()).toRotationMatrix();
      AutoRigSummary summary;
      const double start = CpuSeconds();
      const absl::StatusOr<Rig> rig = AutoRig(Turned(body.sequence, turn), OneThread(), &summary);
      const double seconds = CpuSeconds() - start;
      if (!rig.ok()) {
        std::printf("    turned %3.0f about (%g %g %g): refused, %.2f s\n", degrees, axis.x(),
                    axis.y(), axis.z(), seconds);
        continue;
      }
      const Eigen::RowVectorXd errors =
          (turn.transpose() * rig->skeleton.RestPositions() - expected).colwise().norm() * 100 /
          height;
      std::printf(
          "    turned %3.0f about (%g %g %g): residual %.4f, joints off %.2f %% (max %.2f), %.2f "
          "s\n",
          degrees, axis.x(), axis.y(), axis.z(), summary.residual, errors.mean(), errors.maxCoeff(),
          seconds);
    }
  }
}

// Returns the mean joint error in % of the height where it is known.
std::optional<double> PrintBody(const Body& body, const Arguments& arguments) {
  AutoRigSummary summary;
  absl::StatusOr<Rig> rig;
  double seconds = std::numeric_limits<double>::infinity();
  for (int k = 0; k < arguments.repeat; ++k) {
    const double start = CpuSeconds();
    rig = AutoRig(body.sequence, OneThread(), &summary);
    seconds = std::min(seconds, CpuSeconds() - start);
  }
  std::printf("%-24s %7d ", body.name.c_str(), body.sequence.num_vertices());
  if (!rig.ok()) {
    std::printf("refused %34.2f s  %s\n", seconds, std::string(rig.status().message()).c_str());
    return std::nullopt;
  }
  const Eigen::Matrix3Xd joints = rig->skeleton.RestPositions();
  const double height = ComputeBounds(body.sequence.FrameAsDouble(0)).sizes().y();
  std::printf("%-7s %.4f yaw %4.0f feet %5.2f %5.2f s",
              summary.residual < AutoRigOptions().trusted_residual ? "trusted" : "warned",
              summary.residual, summary.yaw_degrees, summary.evidence.feet, seconds);
  std::optional<double> mean;
  if (!body.truth.empty() && summary.rest_frame == 0) {
    double sum = 0, largest = 0;
    int worst = 0;
    for (const KnownJoint& known : body.truth) {
      const double error = 100 / height * (joints.col(known.joint) - known.position).norm();
      sum += error;
      if (error > largest) worst = known.joint;
      largest = std::max(largest, error);
    }
    mean = sum / static_cast<double>(body.truth.size());
    std::printf("  joints %.2f %%, %s %.1f %%", *mean, HumanTemplate().joint(worst).name.c_str(),
                largest);
  }
  std::printf("\n");
  if (arguments.joints) {
    for (const std::string& warning : summary.warnings) std::printf("    %s\n", warning.c_str());
    PrintJoints(body, joints, height);
  }
  if (arguments.orientations) PrintOrientations(body, joints, height);
  if (!arguments.pictures.empty()) {
    DrawRig(body.name, body.sequence.topology().triangles(), *rig, summary, arguments.pictures);
  }
  return mean;
}

int Main(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--joints") {
      arguments.joints = true;
    } else if (word == "--orientations") {
      arguments.orientations = true;
    } else if (word == "--repeat" && i + 1 < argc) {
      arguments.repeat = std::max(1, std::atoi(argv[++i]));
    } else if (word == "--pictures" && i + 1 < argc) {
      arguments.pictures = argv[++i];
    } else {
      arguments.inputs.push_back(word);
    }
  }
  double sum = 0, worst = 0;
  int count = 0;
  for (const std::string& input : arguments.inputs) {
    const absl::StatusOr<Body> body = LoadBody(input);
    if (!body.ok()) {
      std::printf("%s: %s\n", input.c_str(), std::string(body.status().message()).c_str());
      continue;
    }
    const std::optional<double> mean = PrintBody(*body, arguments);
    if (!mean) continue;
    sum += *mean;
    worst = std::max(worst, *mean);
    ++count;
  }
  if (count > 0)
    std::printf("%d with known joints: mean %.2f %%, worst %.2f %%\n", count, sum / count, worst);
  return 0;
}

}  // namespace
}  // namespace pleat

int main(int argc, char** argv) { return pleat::Main(argc, argv); }
