#include "pleat/mesh/mesh_report.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "absl/strings/str_cat.h"
#include "pleat/mesh/bounds.h"
#include "pleat/mesh/edge_sides.h"

namespace pleat {
namespace {

// Disjoint sets with path halving; nearly constant time for each call.
class DisjointSets {
 public:
  explicit DisjointSets(int count) : parents_(static_cast<size_t>(count)) {
    std::iota(parents_.begin(), parents_.end(), 0);
  }
  int Find(int item) {
    while (parents_[item] != item) {
      parents_[item] = parents_[parents_[item]];
      item = parents_[item];
    }
    return item;
  }
  void Join(int a, int b) { parents_[Find(a)] = Find(b); }

 private:
  std::vector<int> parents_;
};

void CountEdges(const Topology& topology, MeshReport* report) {
  const std::vector<EdgeSide> sides = SortedEdgeSides(topology);
  for (size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    end = EndOfEdge(sides, begin);
    const size_t num_faces = end - begin;
    report->num_boundary_edges += num_faces == 1;
    report->num_non_manifold_edges += num_faces > 2;
    report->num_inconsistent_edges +=
        num_faces == 2 && sides[begin].forward == sides[end - 1].forward;
  }
}

int CountComponents(DisjointSets* sets, const std::vector<bool>& referenced) {
  std::vector<bool> is_root(referenced.size(), false);
  int count = 0;
  for (size_t v = 0; v < referenced.size(); ++v) {
    if (!referenced[v]) continue;
    const auto root = static_cast<size_t>(sets->Find(static_cast<int>(v)));
    count += !is_root[root];
    is_root[root] = true;
  }
  return count;
}

// Counts components, unreferenced and doubled vertices. The sets of the first count are joined
// further for the second, with vertices at one place as one.
void CountParts(const Topology& topology, const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                MeshReport* report) {
  DisjointSets sets(topology.num_vertices());
  std::vector<bool> referenced(static_cast<size_t>(topology.num_vertices()), false);
  for (int f = 0; f < topology.num_faces(); ++f) {
    const std::span<const int32_t> corners = topology.face(f);
    for (const int32_t v : corners) {
      referenced[static_cast<size_t>(v)] = true;
      sets.Join(corners[0], v);
    }
  }
  report->num_unreferenced_vertices =
      static_cast<int>(std::count(referenced.begin(), referenced.end(), false));
  report->num_components = CountComponents(&sets, referenced);

  std::vector<int> order(referenced.size());
  std::iota(order.begin(), order.end(), 0);
  const auto place = [&](int v) {
    return std::array{positions(0, v), positions(1, v), positions(2, v)};
  };
  std::sort(order.begin(), order.end(), [&](int a, int b) { return place(a) < place(b); });
  for (size_t i = 1; i < order.size(); ++i) {
    if (place(order[i]) != place(order[i - 1])) continue;
    ++report->num_duplicate_vertices;
    sets.Join(order[i], order[i - 1]);
  }
  report->num_welded_components = CountComponents(&sets, referenced);
}

void MeasureFaces(const Topology& topology, const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                  MeshReport* report) {
  const double min_area = 1e-12 * report->bounds.diagonal().squaredNorm();
  const Eigen::Vector3d center = report->bounds.center();  // keeps the volume's terms small
  std::vector<int32_t> sorted;
  for (int f = 0; f < topology.num_faces(); ++f) {
    const std::span<const int32_t> corners = topology.face(f);
    sorted.assign(corners.begin(), corners.end());
    std::sort(sorted.begin(), sorted.end());
    const bool has_repeat = std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
    const Eigen::Vector3d a = positions.col(corners[0]) - center;
    Eigen::Vector3d twice_area = Eigen::Vector3d::Zero();
    for (size_t c = 2; c < corners.size(); ++c) {
      const Eigen::Vector3d b = positions.col(corners[c - 1]) - center;
      const Eigen::Vector3d d = positions.col(corners[c]) - center;
      twice_area += (b - a).cross(d - a);
      report->signed_volume_m3 += a.dot(b.cross(d)) / 6;
    }
    report->num_degenerate_faces += has_repeat || twice_area.norm() / 2 <= min_area;
  }
}

}  // namespace

MeshReport InspectMesh(const Topology& topology,
                       const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  assert(positions.cols() == topology.num_vertices());
  MeshReport report;
  report.num_vertices = topology.num_vertices();
  report.num_faces = topology.num_faces();
  report.num_triangles = topology.num_triangles();
  report.bounds = ComputeBounds(positions);
  CountEdges(topology, &report);
  CountParts(topology, positions, &report);
  MeasureFaces(topology, positions, &report);
  return report;
}

std::vector<std::string> DescribeFaults(const MeshReport& report) {
  std::vector<std::string> faults;
  const auto add = [&](int count, const char* what) {
    if (count > 0) faults.push_back(absl::StrCat(count, " ", what));
  };
  if (report.num_components > 1) {
    faults.push_back(absl::StrCat(report.num_components, " separate parts",
                                  report.num_welded_components == report.num_components
                                      ? ""
                                      : absl::StrCat(" (", report.num_welded_components,
                                                     " when vertices at one place are joined)")));
  }
  add(report.num_boundary_edges, "boundary edges: the surface is open");
  add(report.num_non_manifold_edges, "edges with three or more faces");
  add(report.num_inconsistent_edges, "edges whose faces are oriented against each other");
  add(report.num_unreferenced_vertices, "vertices that belong to no face");
  add(report.num_duplicate_vertices, "vertices at the exact place of another");
  add(report.num_degenerate_faces, "faces without area");
  if (report.closed() && report.signed_volume_m3 < 0) {
    faults.emplace_back("the faces point inwards (negative volume)");
  }
  return faults;
}

}  // namespace pleat
