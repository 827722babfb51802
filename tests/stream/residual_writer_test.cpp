#include "residual_writer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "draco/compression/decode.h"
#include "draco_bytes.h"
#include "draco_decode.h"
#include "draco_encode.h"
#include "pleat/base/random.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

// What Draco's own encoder makes of them.
std::string BytesOfDraco(const Eigen::Matrix3Xi& residuals) {
  const auto cloud = MakeDracoResidualCloud(static_cast<int>(residuals.cols()));
  SetDracoResiduals(residuals, cloud.get());
  return DracoBytes(EncodeDracoResiduals, *cloud, 5).value();
}

// Draco's own decoder and ours give the residuals back.
void ExpectReadable(const std::string& bytes, const Eigen::Matrix3Xi& residuals) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::Decoder decoder;
  const auto cloud = decoder.DecodePointCloudFromBuffer(&buffer);
  ASSERT_TRUE(cloud.ok()) << cloud.status().error_msg_string();
  ASSERT_EQ(cloud.value()->num_points(), residuals.cols());
  ASSERT_EQ(cloud.value()->num_attributes(), 3);
  EXPECT_EQ(buffer.remaining_size(), 0);
  for (int c = 0; c < 3; ++c) {
    const draco::PointAttribute& attribute = *cloud.value()->attribute(c);
    for (int i = 0; i < residuals.cols(); ++i) {
      int32_t value = 0;
      attribute.GetValue(attribute.mapped_index(draco::PointIndex(i)), &value);
      ASSERT_EQ(value, residuals(c, i)) << c << " " << i;
    }
  }
  Eigen::Matrix3Xi decoded;
  ASSERT_THAT(DecodeDracoResiduals(bytes, static_cast<int>(residuals.cols()), &decoded), IsOk());
  EXPECT_EQ(decoded, residuals);
}

TEST(ResidualWriterTest, DracoReadsEverySpreadAndSizesAreDracos) {
  ResidualWriter writer;  // one for all: nothing is left over from the frame before
  Random random(1);
  std::string bytes;
  for (const int count : {1, 2, 3, 100, 10'000}) {
    for (const double spread : {0.0, .2, 1.0, 3.0, 20.0, 200.0, 1500.0}) {
      Eigen::Matrix3Xi residuals(3, count);
      for (int& r : residuals.reshaped()) r = static_cast<int>(random.Normal() * spread);
      residuals.row(1) *= 2;
      const bool written = writer.Write(residuals, &bytes);
      EXPECT_TRUE(written || count < 100 * (spread + 1)) << count << " " << spread;
      if (!written) continue;
      ExpectReadable(bytes, residuals);
      EXPECT_LE(bytes.size(), BytesOfDraco(residuals).size() * 1.01 + 24) << count << " " << spread;
    }
  }
}

TEST(ResidualWriterTest, ExtremeDistributions) {
  ResidualWriter writer;
  std::string bytes;
  Eigen::Matrix3Xi residuals = Eigen::Matrix3Xi::Zero(3, 10'000);
  residuals(0, 17) = 8192;  // one far symbol after a long run of unused ones
  residuals(1, 9999) = -8192;
  ASSERT_TRUE(writer.Write(residuals, &bytes));
  ExpectReadable(bytes, residuals);
  EXPECT_LT(bytes.size(), 700u);
  for (int i = 0; i < residuals.cols(); ++i) residuals.col(i) << i % 625, i % 2, -(i % 5) - 4000;
  ASSERT_TRUE(writer.Write(residuals, &bytes));
  ExpectReadable(bytes, residuals);
  residuals.row(0).setConstant(-1);  // one symbol, which is not 0
  ASSERT_TRUE(writer.Write(residuals, &bytes));
  ExpectReadable(bytes, residuals);
  // Many rare symbols beside a frequent one.
  Random random(2);
  for (int& r : residuals.reshaped()) {
    r = random.UniformInt(20) == 0 ? random.UniformInt(600) - 300 : 3;
  }
  ASSERT_TRUE(writer.Write(residuals, &bytes));
  ExpectReadable(bytes, residuals);
  EXPECT_LE(bytes.size(), BytesOfDraco(residuals).size() * 1.01);
}

TEST(ResidualWriterTest, RefusesWhatItsTablesCannotHold) {
  ResidualWriter writer;
  std::string bytes;
  for (const int large : {8193, -8194, 1 << 28, std::numeric_limits<int>::min()}) {
    Eigen::Matrix3Xi residuals = Eigen::Matrix3Xi::Zero(3, 100);
    residuals(2, 4) = large;
    EXPECT_FALSE(writer.Write(residuals, &bytes)) << large;
  }
  Eigen::Matrix3Xi residuals(3, 10'000);  // every symbol once
  for (int i = 0; i < residuals.cols(); ++i) residuals.col(i).setConstant(i - 5000);
  EXPECT_FALSE(writer.Write(residuals, &bytes));
}

TEST(ResidualWriterTest, WritesTheSameBytesEveryTime) {
  Random random(3);
  Eigen::Matrix3Xi residuals(3, 500);
  for (int& r : residuals.reshaped()) r = random.UniformInt(9) - 4;
  ResidualWriter first, second;
  std::string bytes, again;
  ASSERT_TRUE(first.Write(residuals, &bytes));
  ASSERT_TRUE(second.Write(Eigen::Matrix3Xi::Constant(3, 70, 5), &again));
  ASSERT_TRUE(second.Write(residuals, &again));
  EXPECT_EQ(bytes, again);
}

}  // namespace
}  // namespace pleat
