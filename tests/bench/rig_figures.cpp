// The automatic rig of generated bodies, whose joints are known, and of animals, which have none:
// rig_figures [--all] [--split N] [--pictures FOLDER] [WORD]... Only bodies whose names hold a WORD
// are rigged. --split cuts each triangle in four, N times: meshes of a million vertices.
// Prints the rows that are not right (--all: every row) and how many of each kind are right,
// warned, refused, or wrong in silence. The table of docs/performance.md.
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "pleat/rigging/auto_rig.h"
#include "rig_picture.h"
#include "support/capsule_beasts.h"
#include "support/capsule_figure.h"

namespace pleat {
namespace {

// In shares of the height. A rig within both is right.
constexpr double kRightMean = .04, kRightLargest = .1;
constexpr double kFigureCell = .028;  // about 10,000 vertices for a figure of 1.7 m

struct Arguments {
  bool all = false;
  int num_splits = 0;
  std::string pictures;
  std::vector<std::string> words;
};

struct Figure {
  std::string kind, name;
  CapsuleFigureOptions options;
};

// Cuts each triangle in four at the middles of its edges.
TriangleMesh Split(const TriangleMesh& mesh) {
  const Eigen::Index num_old = mesh.positions.cols();
  std::unordered_map<int64_t, int> middles;
  std::vector<std::pair<int, int>> edges;
  TriangleMesh split{{}, Eigen::Matrix3Xi(3, 4 * mesh.triangles.cols())};
  for (Eigen::Index f = 0; f < mesh.triangles.cols(); ++f) {
    Eigen::Vector3i middle;
    const Eigen::Vector3i corner = mesh.triangles.col(f);
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(corner[k], corner[(k + 1) % 3]);
      const auto [entry, is_new] =
          middles.try_emplace(low * int64_t{num_old} + high, num_old + edges.size());
      if (is_new) edges.emplace_back(low, high);
      middle[k] = entry->second;
    }
    for (int k = 0; k < 3; ++k) {
      split.triangles.col(4 * f + k) << corner[k], middle[k], middle[(k + 2) % 3];
    }
    split.triangles.col(4 * f + 3) = middle;
  }
  split.positions.resize(3, num_old + static_cast<Eigen::Index>(edges.size()));
  split.positions.leftCols(num_old) = mesh.positions;
  for (size_t e = 0; e < edges.size(); ++e) {
    split.positions.col(num_old + static_cast<Eigen::Index>(e)) =
        .5 * (mesh.positions.col(edges[e].first) + mesh.positions.col(edges[e].second));
  }
  return split;
}

// The memory of the process, in MB.
int PeakMemory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<int>(usage.ru_maxrss / 1024);
}

std::vector<Figure> BuildsAndArms() {
  std::vector<Figure> figures;
  for (const double angle : {-20., 0., 20., 50., 75.}) {
    for (const double bend : {0., 45.}) {
      for (const bool fingers : {false, true}) {
        figures.push_back(
            {"arms out",
             absl::StrFormat("arms %g bend %g%s", angle, bend, fingers ? " fingers" : ""),
             {.arm_angle_degrees = angle, .elbow_degrees = bend, .fingers = fingers}});
      }
    }
  }
  for (const double girth : {1., 1.4, 1.8, 2.2}) {
    for (const double leg : {1., .8, .6, .5, .4, .3}) {
      for (const double angle : {15., 50.}) {
        figures.push_back({"fat, short",
                           absl::StrFormat("girth %g legs %g arms %g", girth, leg, angle),
                           {.arm_angle_degrees = angle, .leg_length = leg, .girth = girth}});
      }
    }
  }
  for (const double head : {1.5, 2., 2.5, 3.}) {
    for (const double leg : {1., .6, .4}) {
      figures.push_back({"cartoon",
                         absl::StrFormat("head %g legs %g", head, leg),
                         {.arm_angle_degrees = 35, .leg_length = leg, .head = head}});
    }
  }
  return figures;
}

std::vector<Figure> HiddenLimbs() {
  std::vector<Figure> figures;
  const std::pair<const char*, ArmPose> poses[] = {{"crossed", ArmPose::kCrossed},
                                                   {"folded", ArmPose::kFolded},
                                                   {"praying", ArmPose::kPraying},
                                                   {"on hips", ArmPose::kOnHips},
                                                   {"behind", ArmPose::kBehindBack}};
  for (const auto& [name, pose] : poses) {
    for (const double sleeve : {0., .045}) {
      for (const double girth : {1., 1.4}) {
        figures.push_back({"folded arms",
                           absl::StrFormat("%s sleeve %g girth %g", name, sleeve, girth),
                           {.arms = pose, .sleeve = sleeve, .girth = girth}});
      }
    }
  }
  for (const double hem : {.1, .13, .17, .22}) {
    for (const double angle : {10., 50., 70.}) {
      for (const bool hollow : {false, true}) {
        figures.push_back(
            {"robes",
             absl::StrFormat("robe %g arms %g%s", hem, angle, hollow ? " hollow" : ""),
             {.arm_angle_degrees = angle, .robe_hem = hem, .robe_is_hollow = hollow}});
      }
    }
  }
  for (const double angle : {20., 60.}) {
    figures.push_back({"skirts",
                       absl::StrFormat("skirt arms %g", angle),
                       {.arm_angle_degrees = angle, .skirt = true}});
  }
  return figures;
}

struct Counts {
  int right = 0, warned_right = 0, warned_wrong = 0, refused = 0, silently_wrong = 0;
  double slowest = 0;
};

class Table {
 public:
  explicit Table(Arguments arguments) : arguments_(std::move(arguments)) {}

  bool IsWanted(const std::string& kind, const std::string& name) const {
    const std::string text = absl::StrCat(kind, ": ", name);
    return arguments_.words.empty() || std::ranges::any_of(arguments_.words, [&](const auto& word) {
             return absl::StrContains(text, word);
           });
  }

  // joints: 3 x 18, or none for an animal, which any rig is wrong for.
  void Add(const std::string& kind, const std::string& name, TriangleMesh mesh,
           const std::optional<Eigen::Matrix3Xd>& joints) {
    for (int k = 0; k < arguments_.num_splits; ++k) mesh = Split(mesh);
    const int memory_before = PeakMemory();
    AutoRigOptions options;
    options.num_threads = 1;
    AutoRigSummary summary;
    const MeshSequence sequence = MakeStillSequence(mesh);
    const std::clock_t start = std::clock();
    const absl::StatusOr<Rig> rig = AutoRig(sequence, options, &summary);
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    Counts& counts = counts_[kind];
    counts.slowest = std::max(counts.slowest, seconds);
    std::string verdict = "refused", numbers;
    if (!rig.ok()) {
      ++counts.refused;
      numbers = std::string(rig.status().message());
    } else {
      verdict = Judge(*rig, summary, mesh, joints, &counts, &numbers);
      if (!arguments_.pictures.empty()) {
        DrawRig(absl::StrCat(kind, " ", name), sequence.topology().triangles(), *rig, summary,
                arguments_.pictures);
      }
    }
    if (verdict == "right" && !arguments_.all) return;
    if (arguments_.num_splits > 0) {
      absl::StrAppendFormat(&numbers, "; peak memory %d MB, %d before", PeakMemory(),
                            memory_before);
    }
    std::printf("%-12s %-26s %6d %5.2f s  %-14s %s\n", kind.c_str(), name.c_str(),
                static_cast<int>(mesh.positions.cols()), seconds, verdict.c_str(), numbers.c_str());
    std::fflush(stdout);
  }

  void PrintCounts() const {
    std::printf("%-12s right  right, warned  wrong, warned  refused  wrong in silence  slowest\n",
                "");
    for (const auto& [kind, counts] : counts_) {
      std::printf("%-12s %5d %14d %14d %8d %17d %6.2f s\n", kind.c_str(), counts.right,
                  counts.warned_right, counts.warned_wrong, counts.refused, counts.silently_wrong,
                  counts.slowest);
    }
  }

 private:
  static std::string Judge(const Rig& rig, const AutoRigSummary& summary, const TriangleMesh& mesh,
                           const std::optional<Eigen::Matrix3Xd>& joints, Counts* counts,
                           std::string* numbers) {
    // Remarks about the surface or about what is up say nothing about the joints.
    const bool is_warned = std::ranges::any_of(summary.warnings, [](const std::string& warning) {
      return absl::StrContains(warning, "--at") || absl::StrContains(warning, "set the yaw");
    });
    bool is_right = false;
    *numbers = absl::StrFormat("residual %.4f", summary.residual);
    if (joints) {
      const Eigen::RowVectorXd y = mesh.positions.row(1);
      const Eigen::RowVectorXd errors =
          (rig.skeleton.RestPositions() - *joints).colwise().norm() / (y.maxCoeff() - y.minCoeff());
      Eigen::Index worst;
      const double largest = errors.maxCoeff(&worst);
      is_right = errors.mean() < kRightMean && largest < kRightLargest;
      absl::StrAppendFormat(numbers, " joints %.2f %%, %s %.1f %%", 100 * errors.mean(),
                            HumanTemplate().joint(static_cast<int>(worst)).name, 100 * largest);
    }
    int& count = is_right ? (is_warned ? counts->warned_right : counts->right)
                          : (is_warned ? counts->warned_wrong : counts->silently_wrong);
    ++count;
    return is_right ? (is_warned ? "right, warned" : "right")
                    : (is_warned ? "wrong, warned" : "WRONG");
  }

  Arguments arguments_;
  std::map<std::string, Counts> counts_;
};

int Main(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--all") {
      arguments.all = true;
    } else if (word == "--split" && i + 1 < argc) {
      arguments.num_splits = std::atoi(argv[++i]);
    } else if (word == "--pictures" && i + 1 < argc) {
      arguments.pictures = argv[++i];
    } else {
      arguments.words.push_back(word);
    }
  }
  Table table(arguments);
  std::vector<Figure> figures = BuildsAndArms();
  for (Figure& figure : HiddenLimbs()) figures.push_back(std::move(figure));
  for (Figure& figure : figures) {
    if (!table.IsWanted(figure.kind, figure.name)) continue;
    figure.options.cell_m = kFigureCell;
    const CapsuleFigure made = MakeCapsuleFigure(figure.options);
    table.Add(figure.kind, figure.name, made.mesh, made.joints);
  }
  for (const Beast& beast : CapsuleBeasts()) {
    if (!table.IsWanted("animals", beast.name)) continue;
    table.Add("animals", beast.name, MakeCapsuleBody(beast.parts, beast.cell_m), {});
  }
  table.PrintCounts();
  return 0;
}

}  // namespace
}  // namespace pleat

int main(int argc, char** argv) { return pleat::Main(argc, argv); }
