// Source: M. Botsch, L. Kobbelt, "A remeshing approach to multiresolution modeling", SGP 2004,
// section 4. Here wanted lengths vary over the surface, and relaxed vertices return to the implicit
// surface.
//
// Removed triangles stay in the list as holes (first entry -1) and removed vertices without
// triangles, so indices hold through a pass; Compact() drops both at the end. A pass goes over the
// edges as they were when it began, so each operation first checks that its edge is still there.
#include "remesh.h"

#include <algorithm>
#include <cmath>

#include "pleat/base/parallel.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

using Eigen::Vector3d;
using Triangle = std::array<int, 3>;

class Remesher {
 public:
  Remesher(TriangleSoup soup, const RemeshOptions& options)
      : options_(options),
        positions_(std::move(soup.positions)),
        triangles_(std::move(soup.triangles)),
        vertex_triangles_(positions_.size()) {
    for (int t = 0; t < static_cast<int>(triangles_.size()); ++t) {
      for (int v : triangles_[t]) vertex_triangles_[v].push_back(t);
    }
    for (const Vector3d& p : positions_) lengths_.push_back(options_.edge_length(p));
  }

  // An edge at one of these bounds, 4/3 and 4/5 of the wanted length, is as far from it before the
  // operation as after it, so an operation beyond the bound always brings lengths nearer (Botsch
  // and Kobbelt).
  void SplitLongEdges() {
    for (const auto& [a, b] : Edges()) {
      if (Length(a, b) > 4. / 3 * WantedLength(a, b)) Split(a, b);
    }
  }
  void CollapseShortEdges() {
    for (const auto& [a, b] : Edges()) {
      if (IsEdge(a, b) && Length(a, b) < 4. / 5 * WantedLength(a, b)) Collapse(a, b);
    }
  }
  void FlipEdges() {
    for (const auto& [a, b] : Edges()) Flip(a, b);
  }
  void RelaxAndProject();
  TriangleSoup Compact() const;

 private:
  struct Edge {
    int a, b;
  };

  std::vector<Edge> Edges() const {  // every edge once
    std::vector<Edge> edges;
    for (const Triangle& t : triangles_) {
      if (t[0] < 0) continue;
      for (int c = 0; c < 3; ++c) {
        if (t[c] < t[(c + 1) % 3]) edges.push_back({t[c], t[(c + 1) % 3]});
      }
    }
    return edges;
  }
  double Length(int a, int b) const { return (positions_[a] - positions_[b]).norm(); }
  double WantedLength(int a, int b) const { return (lengths_[a] + lengths_[b]) / 2; }
  static bool Has(const Triangle& t, int v) { return t[0] == v || t[1] == v || t[2] == v; }
  static int Opposite(const Triangle& t, int a, int b) {
    for (int v : t) {
      if (v != a && v != b) return v;
    }
    return -1;
  }
  bool IsEdge(int a, int b) const {
    return std::any_of(vertex_triangles_[a].begin(), vertex_triangles_[a].end(),
                       [&](int t) { return Has(triangles_[t], b); });
  }
  // Returns the two triangles on the edge a-b, the one that runs a -> b first; -1 where there is
  // none.
  std::array<int, 2> EdgeTriangles(int a, int b) const {
    std::array<int, 2> found{-1, -1};
    for (int t : vertex_triangles_[a]) {
      for (int c = 0; c < 3; ++c) {
        if (triangles_[t][c] == a && triangles_[t][(c + 1) % 3] == b) found[0] = t;
        if (triangles_[t][c] == b && triangles_[t][(c + 1) % 3] == a) found[1] = t;
      }
    }
    return found;
  }
  Vector3d AreaNormal(const Triangle& t) const {
    return (positions_[t[1]] - positions_[t[0]]).cross(positions_[t[2]] - positions_[t[0]]);
  }
  std::vector<int> Neighbors(int v) const {
    std::vector<int> ring;
    for (int t : vertex_triangles_[v]) {
      for (int u : triangles_[t]) {
        if (u != v) ring.push_back(u);
      }
    }
    std::sort(ring.begin(), ring.end());
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
    return ring;
  }
  int Valence(int v) const { return static_cast<int>(vertex_triangles_[v].size()); }
  static void Replace(Triangle* t, int from, int to) {
    std::replace(t->begin(), t->end(), from, to);
  }
  void Detach(int v, int t) { std::erase(vertex_triangles_[v], t); }

  void Split(int a, int b);
  void Collapse(int a, int b);
  bool CollapseKeepsShape(int a, int b, const Vector3d& merged) const;
  void Flip(int a, int b);

  const RemeshOptions& options_;
  std::vector<Vector3d> positions_;
  std::vector<Triangle> triangles_;  // first entry -1: removed
  std::vector<std::vector<int>> vertex_triangles_;
  std::vector<double> lengths_;  // wanted at each vertex
};

// Each of the two triangles keeps one half and hands the other to a new triangle.
void Remesher::Split(int a, int b) {
  const std::array<int, 2> sides = EdgeTriangles(a, b);
  if (sides[0] < 0 || sides[1] < 0) return;
  const int middle = static_cast<int>(positions_.size());
  positions_.push_back((positions_[a] + positions_[b]) / 2);
  lengths_.push_back(WantedLength(a, b));
  vertex_triangles_.emplace_back();
  for (int t : sides) {
    const int c = Opposite(triangles_[t], a, b);
    const int added = static_cast<int>(triangles_.size());
    Triangle other = triangles_[t];
    Replace(&other, a, middle);
    triangles_.push_back(other);
    Replace(&triangles_[t], b, middle);
    Detach(b, t);
    vertex_triangles_[b].push_back(added);
    vertex_triangles_[c].push_back(added);
    vertex_triangles_[middle].push_back(t);
    vertex_triangles_[middle].push_back(added);
  }
}

// Refuses a collapse that would make an edge so long that it is split again, or turn a triangle by
// more than 60 degrees.
bool Remesher::CollapseKeepsShape(int a, int b, const Vector3d& merged) const {
  for (int v : {a, b}) {
    const int other = v == a ? b : a;
    for (int t : vertex_triangles_[v]) {
      const Triangle& triangle = triangles_[t];
      if (Has(triangle, other)) continue;
      std::array<Vector3d, 3> corners;
      for (int c = 0; c < 3; ++c) {
        corners[c] = triangle[c] == v ? merged : positions_[triangle[c]];
        if (triangle[c] != v &&
            (corners[c] - merged).norm() > 4. / 3 * WantedLength(v, triangle[c])) {
          return false;  // would be split again
        }
      }
      const Vector3d before = AreaNormal(triangle);
      const Vector3d after = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
      if (before.dot(after) < .5 * before.norm() * after.norm()) return false;
    }
  }
  return true;
}

void Remesher::Collapse(int a, int b) {
  const std::array<int, 2> sides = EdgeTriangles(a, b);
  if (sides[0] < 0 || sides[1] < 0) return;
  // Link condition (Dey et al. 1999): the ends share exactly the two opposite vertices.
  const std::vector<int> ring_a = Neighbors(a), ring_b = Neighbors(b);
  std::vector<int> common;
  std::set_intersection(ring_a.begin(), ring_a.end(), ring_b.begin(), ring_b.end(),
                        std::back_inserter(common));
  if (common.size() != 2) return;
  // A vertex of valence 3 would be a spike of three triangles, which later collapses could fold
  // flat.
  for (int v : common) {
    if (Valence(v) <= 4) return;
  }
  const Vector3d merged = (positions_[a] + positions_[b]) / 2;
  if (!CollapseKeepsShape(a, b, merged)) return;
  for (int t : sides) {
    for (int v : Triangle(triangles_[t])) Detach(v, t);
    triangles_[t] = {-1, -1, -1};
  }
  for (int t : vertex_triangles_[b]) {
    Replace(&triangles_[t], b, a);
    vertex_triangles_[a].push_back(t);
  }
  vertex_triangles_[b].clear();
  positions_[a] = merged;
}

// Flips the edge when that brings the valences of the four vertices nearer to six, unless it would
// bend the surface by more than about 45 degrees or double an edge.
void Remesher::Flip(int a, int b) {
  const std::array<int, 2> sides = EdgeTriangles(a, b);
  if (sides[0] < 0 || sides[1] < 0) return;
  const int c = Opposite(triangles_[sides[0]], a, b);
  const int d = Opposite(triangles_[sides[1]], a, b);
  const auto excess = [](int valence) { return (valence - 6) * (valence - 6); };
  const int before =
      excess(Valence(a)) + excess(Valence(b)) + excess(Valence(c)) + excess(Valence(d));
  const int after = excess(Valence(a) - 1) + excess(Valence(b) - 1) + excess(Valence(c) + 1) +
                    excess(Valence(d) + 1);
  if (after >= before || Valence(a) <= 4 || Valence(b) <= 4 || IsEdge(c, d)) return;
  const Triangle first = {c, a, d}, second = {d, b, c};  // were {a, b, c} and {b, a, d}
  const Vector3d normal =
      AreaNormal(triangles_[sides[0]]).normalized() + AreaNormal(triangles_[sides[1]]).normalized();
  for (const Triangle& t : {first, second}) {
    const Vector3d area = AreaNormal(t);
    if (area.dot(normal) < .7 * area.norm() * normal.norm()) return;
  }
  triangles_[sides[0]] = first;
  triangles_[sides[1]] = second;
  Detach(b, sides[0]);
  Detach(a, sides[1]);
  vertex_triangles_[d].push_back(sides[0]);
  vertex_triangles_[c].push_back(sides[1]);
}

// Moves every vertex towards the centroid of its triangles within the tangent plane, then back onto
// the implicit surface. All vertices move at once, from the old positions, so the order and the
// number of threads do not show.
void Remesher::RelaxAndProject() {
  constexpr int kBlock = 256;
  const int num_vertices = static_cast<int>(positions_.size());
  std::vector<Vector3d> moved = positions_;
  ParallelFor((num_vertices + kBlock - 1) / kBlock, 0, [&](int block) {
    for (int v = block * kBlock; v < std::min(num_vertices, (block + 1) * kBlock); ++v) {
      if (vertex_triangles_[v].empty()) continue;
      Vector3d centroid = Vector3d::Zero(), normal = Vector3d::Zero();
      double total_area = 0;
      for (int t : vertex_triangles_[v]) {
        const Triangle& triangle = triangles_[t];
        const Vector3d area = AreaNormal(triangle);
        centroid += area.norm() / 3 *
                    (positions_[triangle[0]] + positions_[triangle[1]] + positions_[triangle[2]]);
        total_area += area.norm();
        normal += area;
      }
      if (total_area <= 0 || normal.norm() <= 0) continue;
      normal.normalize();
      const Vector3d step = centroid / total_area - positions_[v];
      Vector3d p = positions_[v] + .7 * (step - normal.dot(step) * normal);
      // Newton steps along the normal, with a one-sided derivative.
      for (int iteration = 0; iteration < 2; ++iteration) {
        constexpr double kStep = 1e-4;
        const double value = options_.distance(p);
        const double slope = (options_.distance(p + kStep * normal) - value) / kStep;
        const double limit = .3 * lengths_[v];
        p -= std::clamp(value / std::max(slope, .3), -limit, limit) * normal;
      }
      moved[v] = p;
    }
  });
  positions_ = std::move(moved);
  for (int v = 0; v < num_vertices; ++v) lengths_[v] = options_.edge_length(positions_[v]);
}

TriangleSoup Remesher::Compact() const {
  TriangleSoup soup;
  std::vector<int> renamed(positions_.size(), -1);
  for (size_t v = 0; v < positions_.size(); ++v) {
    if (vertex_triangles_[v].empty()) continue;
    renamed[v] = static_cast<int>(soup.positions.size());
    soup.positions.push_back(positions_[v]);
  }
  for (const Triangle& t : triangles_) {
    if (t[0] >= 0) soup.triangles.push_back({renamed[t[0]], renamed[t[1]], renamed[t[2]]});
  }
  return soup;
}

}  // namespace

absl::StatusOr<TriangleSoup> RemeshIsotropic(TriangleSoup soup, const RemeshOptions& options,
                                             const Progress& progress) {
  Remesher remesher(std::move(soup), options);
  for (int i = 0; i < options.num_iterations; ++i) {
    remesher.SplitLongEdges();
    remesher.CollapseShortEdges();
    remesher.FlipEdges();
    remesher.RelaxAndProject();
    PLEAT_RETURN_IF_ERROR(progress.Report((i + 1.) / options.num_iterations));
  }
  return remesher.Compact();
}

}  // namespace pleat
