// Whether two frames have the same faces, however they are listed.
#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "pleat/mesh/input_note.h"
#include "pleat/mesh/topology.h"

namespace pleat {

// Compares frames with the first one of their sequence. Positions correspond by vertex number, so
// the first frame's faces can stand for those of every frame that joins the same vertices. Safe to
// use from several threads.
class FaceComparison {
 public:
  // first_name: for messages. `first` must outlive this object.
  FaceComparison(const Topology& first, std::string first_name);

  // OK when `other` has the same faces; notes then say that their order, their first corners or
  // their winding differ. Else kInvalidArgument names the first face without a counterpart in its
  // place.
  absl::Status Check(const Topology& other, std::vector<InputNote>* notes) const;

 private:
  // A face turned so that equal faces are equal lists.
  struct CanonicalFaces {
    std::vector<int32_t> corners;   // as in the topology, each face in its canonical form
    std::vector<bool> is_reversed;  // for which it is read backwards
    std::vector<int> order;         // faces, sorted by their canonical form
  };
  static CanonicalFaces MakeCanonical(const Topology& topology);
  bool HasSameFaces(const Topology& other, std::vector<InputNote>* notes) const;

  const Topology& first_;
  const std::string first_name_;
  mutable std::once_flag once_;  // guards canonical_, which only frames that differ need
  mutable CanonicalFaces canonical_;
};

}  // namespace pleat
