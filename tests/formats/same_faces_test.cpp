#include "same_faces.h"

#include <algorithm>

#include "pleat/base/random.h"
#include "support/status_matchers.h"
#include "support/test_meshes.h"

namespace pleat {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

Topology WithFaces(int num_vertices, const std::vector<std::vector<int32_t>>& faces) {
  std::vector<int32_t> corners, sizes;
  for (const std::vector<int32_t>& face : faces) {
    corners.insert(corners.end(), face.begin(), face.end());
    sizes.push_back(static_cast<int32_t>(face.size()));
  }
  return Topology::Create(num_vertices, corners, sizes).value();
}

std::vector<std::vector<int32_t>> FacesOf(const Topology& topology) {
  std::vector<std::vector<int32_t>> faces;
  for (int f = 0; f < topology.num_faces(); ++f) {
    faces.emplace_back(topology.face(f).begin(), topology.face(f).end());
  }
  return faces;
}

TEST(SameFacesTest, EveryWayToListTheSameFacesIsRecognized) {
  const Topology first = MakeTorus(12, 8, 3).topology;
  const FaceComparison comparison(first, "a.obj");
  Random random(5);
  for (int round = 0; round < 20; ++round) {
    std::vector<std::vector<int32_t>> faces = FacesOf(first);
    for (std::vector<int32_t>& face : faces) {
      std::rotate(face.begin(), face.begin() + random.UniformInt(4), face.end());
      if (random.UniformInt(2) == 1) std::reverse(face.begin(), face.end());
    }
    for (size_t i = faces.size(); i-- > 1;)
      std::swap(faces[i], faces[random.UniformInt(static_cast<int>(i) + 1)]);
    std::vector<InputNote> notes;
    EXPECT_THAT(comparison.Check(WithFaces(first.num_vertices(), faces), &notes), IsOk());
    EXPECT_EQ(notes.size(), 3u);
    // One corner that names another vertex is another mesh.
    int32_t& corner = faces[random.UniformInt(static_cast<int>(faces.size()))][2];
    corner = (corner + 1) % first.num_vertices();
    EXPECT_THAT(comparison.Check(WithFaces(first.num_vertices(), faces), &notes),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("one connectivity")));
  }
}

TEST(SameFacesTest, TheSameListHasNoNotes) {
  const Topology first = MakeTorus(5, 4, 3).topology;
  std::vector<InputNote> notes;
  EXPECT_THAT(FaceComparison(first, "a.obj").Check(MakeTorus(5, 4, 3).topology, &notes), IsOk());
  EXPECT_THAT(notes, IsEmpty());
}

TEST(SameFacesTest, FacesCountAsOftenAsTheyAreListed) {
  const Topology first = WithFaces(4, {{0, 1, 2}, {0, 1, 2}, {0, 2, 3}});
  const FaceComparison comparison(first, "a.obj");
  std::vector<InputNote> notes;
  EXPECT_THAT(comparison.Check(WithFaces(4, {{0, 2, 3}, {1, 2, 0}, {2, 1, 0}}), &notes), IsOk());
  EXPECT_FALSE(comparison.Check(WithFaces(4, {{0, 1, 2}, {0, 2, 3}, {0, 2, 3}}), &notes).ok());
  EXPECT_FALSE(comparison.Check(WithFaces(4, {{0, 1, 2}, {0, 2, 3}}), &notes).ok());
  EXPECT_FALSE(comparison.Check(WithFaces(5, {{0, 1, 2}, {0, 1, 2}, {0, 2, 3}}), &notes).ok());
}

// A face may be as large as its file: time must not grow with the square of its corners.
TEST(SameFacesTest, HugeFacesOfOneVertexAreComparedInTime) {
  std::vector<int32_t> huge(3'000'000, 1), other = huge;
  huge[7] = 0;
  other[2'000'000] = 0;
  const Topology first = WithFaces(2, {huge});
  std::vector<InputNote> notes;
  EXPECT_THAT(FaceComparison(first, "a.obj").Check(WithFaces(2, {other}), &notes), IsOk());
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0].kind, "face_corners");
}

}  // namespace
}  // namespace pleat
