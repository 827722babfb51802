// The two codes of a topology behind one face, for tests.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "connectivity_coder.h"
#include "face_list_coder.h"
#include "support/status_matchers.h"

namespace pleat {

template <auto kEncode, auto kDecode>
struct TopologyCode {
  static std::string Encode(const Topology& topology) {
    BinaryCoder coder = BinaryCoder::ForEncoding();
    kEncode(topology, &coder);
    return coder.Finish();
  }
  // shape: gives the counts.
  static absl::StatusOr<Topology> Decode(const std::string& bytes, const Topology& shape) {
    BinaryCoder coder = BinaryCoder::ForDecoding(bytes);
    return kDecode(shape.num_vertices(), shape.num_faces(), shape.num_corners(), &coder);
  }
  static void ExpectRoundTrip(const Topology& topology) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const Topology decoded, Decode(Encode(topology), topology));
    EXPECT_TRUE(decoded == topology);
  }
};

using SurfaceCode = TopologyCode<EncodeTopology, DecodeTopology>;
using FaceListCode = TopologyCode<EncodeFaceList, DecodeFaceList>;

}  // namespace pleat
