#include "pleat/service/file_limits.h"

#include <gtest/gtest.h>

namespace pleat {
namespace {

TEST(FileLimitsTest, AreThoseOfTheService) {
  ServiceLimits limits;
  limits.max_upload_bytes = 1000;
  limits.max_vertices = 70;
  limits.max_frames = 9;
  const MeshLimits files = FileLimits(limits);
  EXPECT_EQ(files.max_file_bytes, 1000u);
  EXPECT_EQ(files.max_sequence_bytes, 2000u);
  EXPECT_EQ(files.max_vertices, 70);
  EXPECT_EQ(files.max_faces, 140);
  EXPECT_EQ(files.max_frames, 9);
}

}  // namespace
}  // namespace pleat
