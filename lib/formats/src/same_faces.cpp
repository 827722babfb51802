#include "same_faces.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace pleat {
namespace {

// The start of the rotation of `corners` that is least in lexicographic order; takes linear time,
// as files may be hostile.
size_t LeastRotation(std::span<const int32_t> corners) {
  const size_t n = corners.size();
  size_t i = 0, j = 1, k = 0;
  while (i < n && j < n && k < n) {
    const int32_t a = corners[(i + k) % n], b = corners[(j + k) % n];
    if (a == b) {
      ++k;
      continue;
    }
    (a > b ? i : j) += k + 1;
    j += i == j;
    k = 0;
  }
  return std::min(i, j);
}

void TurnToLeast(std::vector<int32_t>* corners) {
  const auto start = static_cast<std::ptrdiff_t>(LeastRotation(*corners));
  std::rotate(corners->begin(), corners->begin() + start, corners->end());
}

std::span<const int32_t> FaceOf(const Topology& topology, const std::vector<int32_t>& corners,
                                int f) {
  return std::span(corners).subspan(static_cast<size_t>(topology.face_start(f)),
                                    topology.face(f).size());
}

absl::Status FirstDifference(const Topology& first, const Topology& other,
                             const std::string& where) {
  const int num_common = std::min(first.num_faces(), other.num_faces());
  for (int f = 0; f < num_common; ++f) {
    const std::span<const int32_t> a = first.face(f), b = other.face(f);
    if (std::equal(a.begin(), a.end(), b.begin(), b.end())) continue;
    return absl::InvalidArgumentError(absl::StrCat(
        where, "face ", f, " joins vertices ", absl::StrJoin(b, " "), ", in the first frame ",
        absl::StrJoin(a, " "), " (all counted from 0); all frames need one connectivity"));
  }
  return absl::InvalidArgumentError(absl::StrCat(
      where, other.num_faces(), " faces, the first frame has ", first.num_faces(), "; face ",
      num_common, " is the first without a counterpart; all frames need one connectivity"));
}

}  // namespace

FaceComparison::FaceComparison(const Topology& first, std::string first_name)
    : first_(first), first_name_(std::move(first_name)) {}

FaceComparison::CanonicalFaces FaceComparison::MakeCanonical(const Topology& topology) {
  CanonicalFaces faces;
  faces.corners.reserve(topology.corner_vertices().size());
  std::vector<int32_t> forward, backward;
  for (int f = 0; f < topology.num_faces(); ++f) {
    forward.assign(topology.face(f).begin(), topology.face(f).end());
    backward.assign(forward.rbegin(), forward.rend());
    TurnToLeast(&forward);
    TurnToLeast(&backward);
    faces.is_reversed.push_back(backward < forward);
    const std::vector<int32_t>& least = faces.is_reversed.back() ? backward : forward;
    faces.corners.insert(faces.corners.end(), least.begin(), least.end());
  }
  faces.order.resize(static_cast<size_t>(topology.num_faces()));
  std::iota(faces.order.begin(), faces.order.end(), 0);
  std::ranges::stable_sort(faces.order, [&](int a, int b) {
    const std::span<const int32_t> x = FaceOf(topology, faces.corners, a),
                                   y = FaceOf(topology, faces.corners, b);
    return std::lexicographical_compare(x.begin(), x.end(), y.begin(), y.end());
  });
  return faces;
}

bool FaceComparison::HasSameFaces(const Topology& other, std::vector<InputNote>* notes) const {
  if (other.num_faces() != first_.num_faces() || other.num_corners() != first_.num_corners()) {
    return false;
  }
  std::call_once(once_, [this] { canonical_ = MakeCanonical(first_); });
  const CanonicalFaces faces = MakeCanonical(other);
  int num_moved = 0, num_turned = 0, num_reversed = 0;
  for (size_t i = 0; i < faces.order.size(); ++i) {
    const int a = canonical_.order[i], b = faces.order[i];
    const std::span<const int32_t> x = FaceOf(first_, canonical_.corners, a),
                                   y = FaceOf(other, faces.corners, b);
    if (!std::equal(x.begin(), x.end(), y.begin(), y.end())) return false;
    num_moved += a != b;
    if (canonical_.is_reversed[static_cast<size_t>(a)] !=
        faces.is_reversed[static_cast<size_t>(b)]) {
      ++num_reversed;
    } else {
      const std::span<const int32_t> p = first_.face(a), q = other.face(b);
      num_turned += !std::equal(p.begin(), p.end(), q.begin(), q.end());
    }
  }
  const auto add = [&](int count, const char* kind, const char* what) {
    if (count == 0) return;
    notes->push_back(
        {.kind = kind,
         .text = absl::StrCat(count, " of ", first_.num_faces(), " faces ", what,
                              " in the first frame (", first_name_, "), whose faces are taken")});
  };
  add(num_moved, "face_order", "come in another order than");
  add(num_turned, "face_corners", "begin at another corner than");
  add(num_reversed, "face_winding", "are wound the other way than");
  return true;
}

absl::Status FaceComparison::Check(const Topology& other, std::vector<InputNote>* notes) const {
  if (first_ == other) return absl::OkStatus();
  const std::string where = absl::StrCat("differs from the first ('", first_name_, "'): ");
  if (other.num_vertices() != first_.num_vertices()) {
    return absl::InvalidArgumentError(absl::StrCat(
        where, other.num_vertices(), " vertices, the first frame has ", first_.num_vertices()));
  }
  if (HasSameFaces(other, notes)) return absl::OkStatus();
  return FirstDifference(first_, other, where);
}

}  // namespace pleat
