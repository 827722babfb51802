#include "face_list_coder.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "free_numbers.h"
#include "integer_model.h"
#include "number_difference.h"
#include "open_edges.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

// How a corner is named: a vertex that no face had before, one of a few candidates, or any other.
enum FaceCornerKind {
  kNewFaceVertex = 0,
  kBetween = 1,   // the open edges from the corner before and to the first corner meet there
  kEdgeFrom = 2,  // +0..2: the ends of the newest open edges that leave the corner before
  kEdgeTo = 5,    // +0..2: the starts of the newest that arrive at the first corner (last corner)
  kPreviousFace = 8,  // +0..3: the corners of the face before
  kOtherFaceVertex = 12,
  kNumKinds = 13,
};
constexpr int kNewest = 3, kPreviousCorners = 4;
constexpr int kNumHashes = 4096;

uint32_t Hash(uint32_t a, uint32_t b, uint32_t c) {
  const uint32_t mixed = ((a * 0x9e3779b1u ^ b) * 0x85ebca6bu ^ c) * 0xc2b2ae35u;
  return (mixed ^ mixed >> 15) % kNumHashes;
}

// One pass over the list that codes or decodes; both directions see the same candidates.
class FaceListCoder {
 public:
  FaceListCoder(const Topology& known, BinaryCoder* encoder)
      : FaceListCoder(known.num_vertices(), known.num_faces(), known.num_corners(), &known,
                      encoder) {}
  FaceListCoder(int num_vertices, int num_faces, int num_corners, const Topology* known,
                BinaryCoder* coder)
      : num_faces_(num_faces),
        num_corners_(num_corners),
        known_(known),
        coder_(coder),
        edges_(num_vertices, num_corners),
        seen_(num_vertices, false),
        unused_(num_vertices),
        closed_(num_vertices) {}

  absl::Status Run() {
    for (int f = 0; f < num_faces_; ++f) {
      if (known_ == nullptr) PLEAT_RETURN_IF_ERROR(edges_.CheckEffort());
      std::vector<int32_t> face;
      if (known_ != nullptr) face.assign(known_->face(f).begin(), known_->face(f).end());
      const int size = sizes_.CodeUnsigned(coder_, static_cast<int>(face.size()) - 3, {0}, 0) + 3;
      num_corners_ -= size;
      if (num_corners_ < 0 || coder_->overrun()) return Damaged();
      face.resize(size);
      uint32_t shape = static_cast<uint32_t>(size);
      for (int i = 0; i < size; ++i) PLEAT_RETURN_IF_ERROR(CodeCorner(i, &face, &shape));
      Finish(face, shape);
    }
    return num_corners_ == 0 ? absl::OkStatus() : Damaged();
  }

  std::vector<int32_t> TakeCorners() { return std::move(corners_); }
  std::vector<int32_t> TakeSizes() { return std::move(face_sizes_); }

 private:
  using Candidates = std::array<int32_t, kNumKinds>;  // vertex of each kind, -1: none

  absl::Status Damaged() const { return absl::DataLossError("the list of faces is damaged"); }

  // Every candidate for corner `place` of `face` once, under its first kind.
  Candidates FindCandidates(int place, const std::vector<int32_t>& face) const {
    Candidates candidates;
    candidates.fill(-1);
    const auto add = [&](int kind, int32_t vertex) {
      if (std::find(face.begin(), face.begin() + place, vertex) != face.begin() + place) return;
      if (std::find(candidates.begin(), candidates.end(), vertex) != candidates.end()) return;
      candidates[kind] = vertex;
    };
    if (place > 0) {
      const std::vector<int32_t>& ends = edges_.EndsFrom(face[place - 1]);
      const bool is_last = place + 1 == static_cast<int>(face.size());
      const std::vector<int32_t> none;
      const std::vector<int32_t>& starts = is_last ? edges_.StartsTo(face[0]) : none;
      for (int i = 0; i < Newest(ends) && candidates[kBetween] < 0; ++i) {
        const auto newest = starts.end() - Newest(starts);
        const int32_t end = ends[ends.size() - 1 - i];
        if (std::find(newest, starts.end(), end) != starts.end()) add(kBetween, end);
      }
      for (int i = 0; i < Newest(ends); ++i) add(kEdgeFrom + i, ends[ends.size() - 1 - i]);
      for (int i = 0; i < Newest(starts); ++i) add(kEdgeTo + i, starts[starts.size() - 1 - i]);
    }
    const int num_previous = std::min(static_cast<int>(previous_.size()), kPreviousCorners);
    for (int i = 0; i < num_previous; ++i) add(kPreviousFace + i, previous_[i]);
    return candidates;
  }

  static int Newest(const std::vector<int32_t>& vertices) {
    return std::min(static_cast<int>(vertices.size()), kNewest);
  }

  // shape: what is known of the face so far, for the contexts.
  absl::Status CodeCorner(int place, std::vector<int32_t>* face, uint32_t* shape) {
    int32_t* vertex = &(*face)[place];
    const Candidates candidates = FindCandidates(place, *face);
    uint32_t available = 0;
    int kind = kOtherFaceVertex;
    for (int k = 0; k < kNumKinds; ++k) {
      if (candidates[k] < 0) continue;
      available |= 1u << k;
      if (known_ != nullptr && candidates[k] == *vertex) kind = k;
    }
    if (known_ != nullptr && !seen_[*vertex]) kind = kNewFaceVertex;
    const uint32_t known_so_far = *shape * 16 + static_cast<uint32_t>(std::min(place, 15));
    kind = kinds_.CodeUnsigned(coder_, kind,
                               {static_cast<int>(Hash(known_so_far, available, 0)),
                                static_cast<int>(Hash(known_so_far, shapes_[0], 1)),
                                static_cast<int>(Hash(available, shapes_[0], shapes_[1]))},
                               std::min(place, 3));
    *shape = *shape * 16 + static_cast<uint32_t>(kind);
    if (kind == kNewFaceVertex) return CodeNewVertex(place, vertex);
    if (kind == kOtherFaceVertex) return CodeOtherVertex(place, *face, vertex);
    if (kind > kOtherFaceVertex || candidates[kind] < 0) return Damaged();
    *vertex = candidates[kind];
    return absl::OkStatus();
  }

  // By rank among the numbers not used yet, against the number after the last new one.
  absl::Status CodeNewVertex(int place, int32_t* vertex) {
    const int base = unused_.Rank(last_new_ + 1);
    const int rank =
        base + new_vertices_.Code(coder_, unused_.Rank(*vertex) - base, std::min(place, 15));
    if (rank < 0 || rank >= unused_.num_free() || coder_->overrun()) return Damaged();
    *vertex = unused_.Select(rank);
    unused_.Take(*vertex);
    seen_[*vertex] = true;
    last_new_ = *vertex;
    return absl::OkStatus();
  }

  // By rank among the vertices with open edges, else by number; against the corner before, or the
  // first corner of the last face.
  absl::Status CodeOtherVertex(int place, const std::vector<int32_t>& face, int32_t* vertex) {
    const int near = place > 0 ? face[place - 1] : previous_.empty() ? 0 : previous_[0];
    const int context = std::min(place, 3);
    const int is_open =
        has_edges_.CodeUnsigned(coder_, known_ != nullptr && HasEdges(*vertex), {context}, 0);
    if (is_open > 1) return Damaged();
    if (is_open == 1) {
      const int base = OpenRank(near);
      const int rank = base + open_vertices_.Code(coder_, OpenRank(*vertex) - base, context);
      if (rank < 0 || rank >= closed_.num_taken() || coder_->overrun()) return Damaged();
      *vertex = closed_.SelectTaken(rank);
      return absl::OkStatus();
    }
    const int64_t number = int64_t{near} + other_vertices_.Code(coder_, *vertex - near, context);
    if (number < 0 || number >= static_cast<int64_t>(seen_.size()) || !seen_[number]) {
      return Damaged();
    }
    *vertex = static_cast<int32_t>(number);
    return absl::OkStatus();
  }

  // Vertices with open edges below `vertex`.
  int OpenRank(int vertex) const { return vertex - closed_.Rank(vertex); }

  void Finish(const std::vector<int32_t>& face, uint32_t shape) {
    const size_t size = face.size();
    for (size_t i = 0; i < size; ++i) {
      const int from = face[i], to = face[(i + 1) % size];
      const bool from_was_open = HasEdges(from), to_was_open = HasEdges(to);
      // Else the face on the other side will need the edge.
      if (!edges_.Remove(from, to)) edges_.Add(to, from);
      NoteEdges(from, from_was_open);
      if (to != from) NoteEdges(to, to_was_open);
    }
    corners_.insert(corners_.end(), face.begin(), face.end());
    face_sizes_.push_back(static_cast<int32_t>(size));
    previous_ = face;
    shapes_ = {shape, shapes_[0]};
  }

  bool HasEdges(int vertex) const {
    return !edges_.EndsFrom(vertex).empty() || !edges_.StartsTo(vertex).empty();
  }
  // After a change of the edges at `vertex`.
  void NoteEdges(int vertex, bool was_open) {
    if (HasEdges(vertex) == was_open) return;
    if (was_open) {
      closed_.Return(vertex);
    } else {
      closed_.Take(vertex);
    }
  }

  const int num_faces_;
  int num_corners_;
  const Topology* known_;
  BinaryCoder* coder_;
  OpenEdges edges_;
  std::vector<bool> seen_;
  FreeNumbers unused_, closed_;  // vertices without a face; without open edges
  std::vector<int32_t> corners_, face_sizes_, previous_;
  std::array<uint32_t, 2> shapes_{};  // of the last two faces
  int last_new_ = -1;

  IntegerModel<1> sizes_{{1}, 1}, has_edges_{{4}, 1};
  IntegerModel<3> kinds_{{kNumHashes, kNumHashes, kNumHashes}, 4};
  NumberDifference new_vertices_, open_vertices_, other_vertices_;
};

}  // namespace

void EncodeFaceList(const Topology& topology, BinaryCoder* coder) {
  FaceListCoder(topology, coder).Run().IgnoreError();  // only damaged code fails
}

absl::StatusOr<Topology> DecodeFaceList(int num_vertices, int num_faces, int num_corners,
                                        BinaryCoder* coder) {
  FaceListCoder list(num_vertices, num_faces, num_corners, nullptr, coder);
  PLEAT_RETURN_IF_ERROR(list.Run());
  return Topology::Create(num_vertices, list.TakeCorners(), list.TakeSizes());
}

}  // namespace pleat
