// The sides of coded faces that no other face uses yet, as the directed edges that such a face
// would have.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "absl/status/status.h"

namespace pleat {

class OpenEdges {
 public:
  // num_corners: of all faces that will be coded.
  OpenEdges(int num_vertices, int num_corners)
      : ends_(num_vertices),
        starts_(num_vertices),
        max_looked_at_((uint64_t{1} << 28) + 64 * static_cast<uint64_t>(num_corners)) {}

  // Ends of the edges that leave `vertex`, starts of those that arrive there, the newest last.
  const std::vector<int32_t>& EndsFrom(int vertex) const { return ends_[vertex]; }
  const std::vector<int32_t>& StartsTo(int vertex) const { return starts_[vertex]; }

  bool Contains(int from, int to) {
    const auto& ends = ends_[from];
    num_looked_at_ += ends.size();
    return std::find(ends.begin(), ends.end(), to) != ends.end();
  }
  void Add(int from, int to) {
    ends_[from].push_back(to);
    starts_[to].push_back(from);
  }
  // False when there is no such edge.
  bool Remove(int from, int to) {
    auto& ends = ends_[from];
    num_looked_at_ += ends.size();
    const auto end = std::find(ends.begin(), ends.end(), to);
    if (end == ends.end()) return false;
    ends.erase(end);
    auto& starts = starts_[to];
    starts.erase(std::find(starts.begin(), starts.end(), from));
    return true;
  }

  // kResourceExhausted when a decoder has looked through more edges than any real mesh needs: about
  // a second for bytes that let one vertex have them all.
  absl::Status CheckEffort() const {
    if (num_looked_at_ <= max_looked_at_) return absl::OkStatus();
    return absl::ResourceExhaustedError("too many open edges meet at one vertex");
  }

 private:
  std::vector<std::vector<int32_t>> ends_, starts_;
  uint64_t num_looked_at_ = 0, max_looked_at_;
};

}  // namespace pleat
