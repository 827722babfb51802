// A walk that conquers the surface face by face, written once for both directions. The region of
// faces done so far is bounded by *open edges*: sides of done faces that no other face uses yet,
// kept as the directed edges that such a face would have (open_edges.h). The walk takes them first
// in, first out, as gates. At a gate from -> to it codes:
//
// 1. whether a face lies behind it at all (if not, the edge is a border of the surface, and
//    closes);
// 2. its number of corners; two of them are known, `from` and `to`;
// 3. for each further corner, how it is named: a new vertex, the end of an open edge that leaves
//    the corner before (kAfterTo), the start of one that arrives at `from` (kBeforeFrom, for the
//    last corner only), or any other vertex, by its difference to the corner before. The two middle
//    kinds close a gap in the border;
// 4. for a new vertex its number in the file, and for the face its number and the corner that the
//    file names first.
//
// Then the sides of the face either close open edges or become open ones and gates. A gate whose
// edge was closed meanwhile is skipped. When no gate is left, the free face with the lowest number
// starts the next component. The walk depends on nothing but the mesh, so VisitOrder() can tell a
// writer how to number faces such that step 4 costs nothing for them.
//
// Numbers are the larger part of the code. A number is coded as its rank among those that are still
// free (Fenwick trees, free_numbers.h): first as one of the free numbers next to those of its
// neighbors, and else as a difference to a guess.
//
// The decoder mirrors the encoder because there is only one walk. A model's Code...() returns the
// value in both directions; the encoder passes it in, the decoder ignores what it passes. What the
// encoder knows beforehand (`known_`, `edge_faces_`) is used only for the value that is coded next.
// Contexts, guesses and the order of the walk come from what has been coded: valences, open edges,
// free numbers, history. This is the invariant to keep in any change.
//
// Any soup is accepted. Edges are directed and may be open more than once, so a third face at an
// edge, or a face that is flipped against its neighbor, is simply not "behind" it: it is reached
// over another edge or starts a component, and the edge counts as border. Of several faces behind a
// gate the one with the lowest number comes first.
//
// Hostile bytes. The caller has checked the counts against limits and against the bytes that are
// there. The walk takes each face's size from the count of corners that are left before it
// allocates, checks each vertex and rank, and stops at a code that was read beyond its end. A loop
// either codes a face or uses up a gate, and there is at most one gate per corner. The one thing
// that could be quadratic is looking for an edge at a vertex that has very many, so a decoder
// counts the edges it looked at (OpenEdges::CheckEffort) and refuses beyond what any real mesh
// needs.

#include "connectivity_coder.h"

#include <algorithm>
#include <array>
#include <deque>
#include <unordered_map>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "free_numbers.h"
#include "integer_model.h"
#include "number_difference.h"
#include "open_edges.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

// A side that a neighboring face may still use, as the directed edge that this face would have.
struct Gate {
  int from = 0, to = 0;
  int opposite = 0;  // a corner of the face behind it
  int face = 0;      // its number
};

// How a corner is named. The values are part of the format.
enum CornerKind { kNewVertex = 0, kAfterTo = 1, kBeforeFrom = 2, kOtherVertex = 3 };

uint64_t EdgeKey(int from, int to) {
  return static_cast<uint64_t>(static_cast<uint32_t>(from)) << 32 | static_cast<uint32_t>(to);
}

// One walk over the surface that codes or decodes; both directions make the same choices.
class ConnectivityWalk {
 public:
  // Encodes `known`.
  ConnectivityWalk(const Topology& known, BinaryCoder* encoder)
      : ConnectivityWalk(known.num_vertices(), known.num_faces(), known.num_corners(), &known,
                         encoder) {}
  // known: the mesh to encode, or null to decode one of so many vertices, faces and corners.
  ConnectivityWalk(int num_vertices, int num_faces, int num_corners, const Topology* known,
                   BinaryCoder* coder)
      : num_faces_(num_faces),
        num_corners_(num_corners),
        known_(known),
        coder_(coder),
        open_edges_(num_vertices, num_corners),
        valence_(num_vertices, 0),
        seen_(num_vertices, false),
        face_sum_(num_vertices, 0),
        free_vertices_(num_vertices),
        free_faces_(num_faces),
        faces_(num_faces),
        done_(num_faces, false) {
    if (known_ == nullptr) return;
    for (int f = 0; f < num_faces; ++f) {
      const auto face = known_->face(f);
      for (size_t i = 0; i < face.size(); ++i) {
        edge_faces_.emplace(EdgeKey(face[i], face[(i + 1) % face.size()]), f);
      }
    }
  }

  absl::Status Run() {
    while (num_done_ < num_faces_) {
      if (known_ == nullptr) PLEAT_RETURN_IF_ERROR(open_edges_.CheckEffort());
      if (gates_.empty()) {
        PLEAT_RETURN_IF_ERROR(CodeSeed());
        continue;
      }
      const Gate gate = gates_.front();
      gates_.pop_front();
      if (!open_edges_.Contains(gate.from, gate.to)) continue;
      PLEAT_RETURN_IF_ERROR(CodeBehind(gate));
    }
    return absl::OkStatus();
  }

  const std::vector<std::vector<int32_t>>& faces() const { return faces_; }
  const std::vector<FaceVisit>& visits() const { return visits_; }

 private:
  absl::Status Damaged() const { return absl::DataLossError("the connectivity is damaged"); }

  // For the encoder: a face that has the directed edge and is not coded yet, or -1. The lowest
  // number is taken, as the order inside of a hash table is not the same everywhere.
  int FindFace(const Gate& gate) const {
    const auto [begin, end] = edge_faces_.equal_range(EdgeKey(gate.from, gate.to));
    int found = -1;
    for (auto it = begin; it != end; ++it) {
      if (!done_[it->second] && (found < 0 || it->second < found)) found = it->second;
    }
    return found;
  }

  // Codes the number of corners of a face and takes them off what is left, before anything of that
  // size is allocated.
  absl::Status CodeSize(int* size) {
    *size = sizes_.CodeUnsigned(coder_, *size - 3, {0}, 0) + 3;
    num_corners_ -= *size;
    return num_corners_ < 0 || coder_->overrun() ? Damaged() : absl::OkStatus();
  }

  // Codes the first face of a component: the free one with the lowest number, which therefore need
  // not be coded. Its rotation is that of the file.
  absl::Status CodeSeed() {
    std::vector<int32_t> corners;
    if (known_ != nullptr) {
      const auto face = known_->face(free_faces_.Select(0));
      corners.assign(face.begin(), face.end());
    }
    int size = static_cast<int>(corners.size());
    PLEAT_RETURN_IF_ERROR(CodeSize(&size));
    corners.resize(size);
    for (int i = 0; i < size; ++i) {
      PLEAT_RETURN_IF_ERROR(
          CodeCorner(i == 0 ? last_vertex_ : corners[i - 1], -1, last_vertex_, &corners[i]));
    }
    visits_.push_back({free_faces_.Select(0), 0});
    return Finish(free_faces_.Select(0), 0, std::move(corners));
  }

  // Codes what lies behind a gate.
  absl::Status CodeBehind(const Gate& gate) {
    const int face = known_ != nullptr ? FindFace(gate) : -1;
    const int present = borders_.CodeUnsigned(
        coder_, face < 0, {std::min<int>(valence_[gate.from], 9), last_border_}, 0);
    last_border_ = present;
    if (present > 1) return Damaged();
    if (present == 1) {  // a border of the surface
      open_edges_.Remove(gate.from, gate.to);
      return absl::OkStatus();
    }
    std::vector<int32_t> corners;
    int rotation = 0;
    if (known_ != nullptr) {
      const auto named = known_->face(face);
      const int size = static_cast<int>(named.size());
      while (named[rotation] != gate.from || named[(rotation + 1) % size] != gate.to) ++rotation;
      for (int i = 0; i < size; ++i) corners.push_back(named[(rotation + i) % size]);
    }
    int size = static_cast<int>(corners.size());
    PLEAT_RETURN_IF_ERROR(CodeSize(&size));
    corners.resize(size);
    corners[0] = gate.from;
    corners[1] = gate.to;
    for (int i = 2; i < size; ++i) {
      PLEAT_RETURN_IF_ERROR(
          CodeCorner(corners[i - 1], i + 1 == size ? gate.from : -1, gate.opposite, &corners[i]));
    }
    return CodeNumber(gate.face, face, rotation, std::move(corners));
  }

  static int Newest(const std::vector<int32_t>& vertices) {
    return vertices.empty() ? -1 : vertices.back();
  }

  // Codes the corner that follows `before`. `after` is the corner behind it where that is known, or
  // -1; `opposite` is a vertex of the face at the gate, for the guess of a new number.
  absl::Status CodeCorner(int before, int after, int opposite, int32_t* vertex) {
    const bool any = num_done_ > 0;
    const int next = any ? Newest(open_edges_.EndsFrom(before)) : -1;
    const int previous = any && after >= 0 ? Newest(open_edges_.StartsTo(after)) : -1;
    int kind = kOtherVertex;
    if (known_ != nullptr) {
      kind = !seen_[*vertex]       ? kNewVertex
             : *vertex == next     ? kAfterTo
             : *vertex == previous ? kBeforeFrom
                                   : kOtherVertex;
    }
    // What the two border guesses are like: which exist, and whether they meet in one vertex, where
    // the gap is about to close.
    const int situation = (next >= 0) + 2 * (previous >= 0) + 4 * (next >= 0 && next == previous);
    const int valence_before = std::min<int>(valence_[before], 9);
    const int valence_after = after < 0 ? 10 : std::min<int>(valence_[after], 9);
    kind = kinds_.CodeUnsigned(coder_, kind,
                               {situation * 11 + valence_before, situation * 11 + valence_after,
                                valence_before * 11 + valence_after, situation * 16 + history_},
                               situation);
    history_ = (history_ << 2 | std::min(kind, 3)) & 15;
    if (kind > kOtherVertex || (kind == kAfterTo && next < 0) ||
        (kind == kBeforeFrom && previous < 0)) {
      return Damaged();
    }
    if (kind == kAfterTo) *vertex = next;
    if (kind == kBeforeFrom) *vertex = previous;
    if (kind == kOtherVertex) {
      const int delta = others_.CodeSigned(coder_, *vertex - before, {0}, 0);
      const int64_t value = int64_t{before} + delta;
      if (value < 0 || value >= static_cast<int64_t>(seen_.size()) || !seen_[value]) {
        return Damaged();
      }
      *vertex = static_cast<int32_t>(value);
    }
    return kind == kNewVertex ? CodeNewVertex(before, after, opposite, vertex) : absl::OkStatus();
  }

  // Codes the number of a vertex that the walk meets for the first time.
  absl::Status CodeNewVertex(int before, int after, int opposite, int32_t* vertex) {
    if (free_vertices_.num_free() == 0) return Damaged();
    if (after < 0) after = before;
    // The file's numbers of neighbors are near each other, so the guess is the middle one of three.
    const int guess =
        std::max(std::min(before, after), std::min(std::max(before, after), opposite));
    const int spread =
        BitLengthClass(std::max({before, after, opposite}) - std::min({before, after, opposite}));
    const int base = free_vertices_.Rank(guess);
    const int rank = vertices_.Code(coder_, free_vertices_, {before, opposite, after}, base, spread,
                                    free_vertices_.Rank(*vertex));
    if (rank < 0 || rank >= free_vertices_.num_free() || coder_->overrun()) return Damaged();
    *vertex = free_vertices_.Select(rank);
    free_vertices_.Take(*vertex);
    seen_[*vertex] = true;
    last_vertex_ = *vertex;
    return absl::OkStatus();
  }

  // Codes the face's own number in the file and which of its corners the file names first. The
  // guess is the mean number of the faces around its corners.
  absl::Status CodeNumber(int behind, int face, int rotation, std::vector<int32_t> corners) {
    int64_t sum = 0, count = 0;
    for (const int32_t v : corners) {
      sum += face_sum_[v];
      count += valence_[v];
    }
    const int guess = count > 0 ? static_cast<int>(sum / count) : 0;
    const int base = free_faces_.Rank(guess);
    const int class_ = std::min<int>(static_cast<int>(count), 15);
    const int rank = numbers_.Code(coder_, free_faces_, {behind, behind, behind}, base, class_,
                                   known_ ? free_faces_.Rank(face) : 0);
    if (rank < 0 || rank >= free_faces_.num_free() || coder_->overrun()) return Damaged();
    face = free_faces_.Select(rank);
    const int size = static_cast<int>(corners.size());
    const int lowest =
        static_cast<int>(std::min_element(corners.begin(), corners.end()) - corners.begin());
    // Coded as the place of the file's first corner among `corners`.
    const int first = rotations_.CodeUnsigned(coder_, (size - rotation) % size,
                                              {std::min(lowest, 7), last_first_}, 0);
    if (first >= size) return Damaged();
    last_first_ = std::min(first, 7);
    visits_.push_back({face, (size - first) % size});
    return Finish(face, first, std::move(corners));
  }

  // Closes or opens the sides of a face and gives it to the result, turned so that the file's first
  // corner comes first.
  absl::Status Finish(int face, int first, std::vector<int32_t> corners) {
    const size_t size = corners.size();
    for (size_t i = 0; i < size; ++i) {
      const int from = corners[i], to = corners[(i + 1) % size];
      if (!open_edges_.Remove(from, to)) {
        open_edges_.Add(to, from);
        gates_.push_back({to, from, corners[(i + 2) % size], face});
      }
      ++valence_[from];
      face_sum_[from] += face;
    }
    free_faces_.Take(face);
    done_[face] = true;
    ++num_done_;
    std::rotate(corners.begin(), corners.begin() + first, corners.end());
    faces_[face] = std::move(corners);
    return absl::OkStatus();
  }

  // Codes the rank of a free number: as one of the free numbers next to the first two of `near`, or
  // as a signed difference to `base`. `history` holds the last hits and misses, since files are
  // numbered regularly over long stretches.
  struct RankModel {
    IntegerModel<2> hits{{256, 16 * 4}, 1};
    int history = 0;
    NumberDifference differences;

    int Code(BinaryCoder* coder, const FreeNumbers& free, const std::array<int, 3>& near, int base,
             int context, int rank) {
      for (int i = 0; i < 4; ++i) {
        const int candidate = free.Rank(near[i / 2]) - i % 2;  // the next free number, or the last
        const int hit = hits.CodeUnsigned(coder, rank == candidate,
                                          {(history & 63) * 4 + i, context * 4 + i}, 0);
        history = (history << 1 | (hit != 0)) & 255;
        if (hit == 1) return candidate;
      }
      return base + differences.Code(coder, rank - base, context);
    }
  };

  const int num_faces_;
  int num_corners_;
  const Topology* known_;
  BinaryCoder* coder_;
  std::unordered_multimap<uint64_t, int> edge_faces_;  // encoder only: faces by directed edge
  OpenEdges open_edges_;
  std::vector<int32_t> valence_;  // faces so far
  std::vector<bool> seen_;
  std::vector<int64_t> face_sum_;  // the sum of the numbers of those faces
  FreeNumbers free_vertices_, free_faces_;
  std::vector<std::vector<int32_t>> faces_;  // by number
  std::vector<bool> done_;
  std::deque<Gate> gates_;
  std::vector<FaceVisit> visits_;
  int num_done_ = 0, last_vertex_ = 0, last_border_ = 0, last_first_ = 0, history_ = 0;

  IntegerModel<1> sizes_{{1}, 1}, others_{{1}, 1};
  IntegerModel<2> borders_{{10, 2}, 1}, rotations_{{8, 8}, 1};
  IntegerModel<4> kinds_{{88, 88, 121, 128}, 8};
  RankModel vertices_, numbers_;
};

}  // namespace

std::vector<FaceVisit> VisitOrder(const Topology& topology) {
  BinaryCoder ignored = BinaryCoder::ForEncoding();
  ConnectivityWalk walk(topology, &ignored);
  walk.Run().IgnoreError();  // only damaged code fails
  return walk.visits();
}

void EncodeTopology(const Topology& topology, BinaryCoder* coder) {
  ConnectivityWalk(topology, coder).Run().IgnoreError();  // only damaged code fails
}

absl::StatusOr<Topology> DecodeTopology(int num_vertices, int num_faces, int num_corners,
                                        BinaryCoder* coder) {
  ConnectivityWalk walk(num_vertices, num_faces, num_corners, nullptr, coder);
  PLEAT_RETURN_IF_ERROR(walk.Run());
  std::vector<int32_t> corners, sizes;
  for (const std::vector<int32_t>& face : walk.faces()) {
    corners.insert(corners.end(), face.begin(), face.end());
    sizes.push_back(static_cast<int32_t>(face.size()));
  }
  if (static_cast<int>(corners.size()) != num_corners) {
    return absl::DataLossError("the connectivity is damaged");
  }
  return Topology::Create(num_vertices, std::move(corners), std::move(sizes));
}

}  // namespace pleat
