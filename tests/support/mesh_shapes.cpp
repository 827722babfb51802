#include "support/mesh_shapes.h"

#include <cassert>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

namespace pleat {
namespace {

constexpr double kPi = std::numbers::pi;

// Collects vertices and polygons. What it is given must be valid, as Build() does not check.
class ShapeBuilder {
 public:
  int AddVertex(const Eigen::Vector3d& position) {
    positions_.push_back(position);
    return static_cast<int>(positions_.size()) - 1;
  }
  void AddFace(std::initializer_list<int32_t> corners) {
    corners_.insert(corners_.end(), corners);
    sizes_.push_back(static_cast<int32_t>(corners.size()));
  }
  MeshShape Build() {
    MeshShape shape;
    shape.positions.resize(3, static_cast<Eigen::Index>(positions_.size()));
    for (size_t v = 0; v < positions_.size(); ++v) {
      shape.positions.col(static_cast<Eigen::Index>(v)) = positions_[v];
    }
    shape.topology = *Topology::Create(static_cast<int>(positions_.size()), std::move(corners_),
                                       std::move(sizes_));
    return shape;
  }

 private:
  std::vector<Eigen::Vector3d> positions_;
  std::vector<int32_t> corners_, sizes_;
};

struct ProfilePoint {
  double radius, y;
};

// Turns a profile, given from bottom to top, about the y axis; `poles` (bottom, top) close it.
MeshShape Revolve(const std::vector<ProfilePoint>& profile, int num_segments,
                  const std::optional<std::pair<double, double>>& poles) {
  assert(num_segments >= 3 && !profile.empty());
  ShapeBuilder builder;
  for (const ProfilePoint& point : profile) {
    for (int s = 0; s < num_segments; ++s) {
      const double angle = 2 * kPi * s / num_segments;
      builder.AddVertex({point.radius * std::sin(angle), point.y, point.radius * std::cos(angle)});
    }
  }
  const int num_rings = static_cast<int>(profile.size());
  const auto vertex = [&](int ring, int s) { return ring * num_segments + s % num_segments; };
  for (int ring = 0; ring + 1 < num_rings; ++ring) {
    for (int s = 0; s < num_segments; ++s) {
      builder.AddFace(
          {vertex(ring, s), vertex(ring, s + 1), vertex(ring + 1, s + 1), vertex(ring + 1, s)});
    }
  }
  if (poles) {
    const int bottom = builder.AddVertex({0, poles->first, 0});
    const int top = builder.AddVertex({0, poles->second, 0});
    for (int s = 0; s < num_segments; ++s) {
      builder.AddFace({bottom, vertex(0, s + 1), vertex(0, s)});
      builder.AddFace({top, vertex(num_rings - 1, s), vertex(num_rings - 1, s + 1)});
    }
  }
  return builder.Build();
}

}  // namespace

MeshShape MakeGrid(int num_x, int num_z, double size_x, double size_z) {
  assert(num_x >= 1 && num_z >= 1);
  ShapeBuilder builder;
  for (int z = 0; z <= num_z; ++z) {
    for (int x = 0; x <= num_x; ++x) {
      builder.AddVertex({size_x * (static_cast<double>(x) / num_x - 0.5), 0,
                         size_z * (static_cast<double>(z) / num_z - 0.5)});
    }
  }
  const auto vertex = [&](int x, int z) { return z * (num_x + 1) + x; };
  for (int z = 0; z < num_z; ++z) {
    for (int x = 0; x < num_x; ++x) {
      builder.AddFace({vertex(x, z), vertex(x, z + 1), vertex(x + 1, z + 1), vertex(x + 1, z)});
    }
  }
  return builder.Build();
}

MeshShape MakeBox(const Eigen::Vector3d& size) {
  ShapeBuilder builder;
  for (int v = 0; v < 8; ++v) {  // bit 0: x, bit 1: y, bit 2: z
    const Eigen::Vector3d sign((v & 1) ? 1 : -1, (v & 2) ? 1 : -1, (v & 4) ? 1 : -1);
    builder.AddVertex(sign.cwiseProduct(size) / 2);
  }
  builder.AddFace({0, 4, 6, 2});  // -x
  builder.AddFace({1, 3, 7, 5});  // +x
  builder.AddFace({0, 1, 5, 4});  // -y
  builder.AddFace({2, 6, 7, 3});  // +y
  builder.AddFace({0, 2, 3, 1});  // -z
  builder.AddFace({4, 5, 7, 6});  // +z
  return builder.Build();
}

MeshShape MakeUvSphere(double radius, int num_rings, int num_segments) {
  assert(num_rings >= 1);
  std::vector<ProfilePoint> profile;
  for (int ring = 1; ring <= num_rings; ++ring) {
    const double angle = kPi * ring / (num_rings + 1);  // from the bottom pole
    profile.push_back({radius * std::sin(angle), -radius * std::cos(angle)});
  }
  return Revolve(profile, num_segments, std::pair(-radius, radius));
}

MeshShape MakeTube(double radius, double length, int num_rings, int num_segments) {
  assert(num_rings >= 2);
  std::vector<ProfilePoint> profile;
  for (int ring = 0; ring < num_rings; ++ring) {
    profile.push_back({radius, length * (static_cast<double>(ring) / (num_rings - 1) - 0.5)});
  }
  return Revolve(profile, num_segments, std::nullopt);
}

MeshShape MakeCapsule(double radius, double length, int num_rings, int num_cap_rings,
                      int num_segments) {
  assert(num_rings >= 2 && num_cap_rings >= 0);
  std::vector<ProfilePoint> profile;
  for (int ring = 1; ring <= num_cap_rings; ++ring) {
    const double angle = kPi / 2 * ring / (num_cap_rings + 1);
    profile.push_back({radius * std::sin(angle), -length / 2 - radius * std::cos(angle)});
  }
  for (int ring = 0; ring < num_rings; ++ring) {
    profile.push_back({radius, length * (static_cast<double>(ring) / (num_rings - 1) - 0.5)});
  }
  for (int ring = num_cap_rings; ring >= 1; --ring) {
    const double angle = kPi / 2 * ring / (num_cap_rings + 1);
    profile.push_back({radius * std::sin(angle), length / 2 + radius * std::cos(angle)});
  }
  return Revolve(profile, num_segments, std::pair(-length / 2 - radius, length / 2 + radius));
}

}  // namespace pleat
