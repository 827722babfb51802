#include "alembic_builder.h"

#include <string>
#include <vector>

#include "formats/alembic_scene.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(AlembicBuilderTest, EqualSamplesShareTheirPlace) {
  AlembicBuilder builder;
  const std::vector<float> values = {1, 2, 3}, others = {1, 2, 4};
  const WrittenSample first = builder.AddSample(std::span<const float>(values));
  const WrittenSample again = builder.AddSample(std::span<const float>(values));
  const WrittenSample other = builder.AddSample(std::span<const float>(others));
  EXPECT_EQ(first.ref, again.ref);
  EXPECT_EQ(first.key, again.key);
  EXPECT_NE(first.ref, other.ref);
  EXPECT_EQ(first.num_bytes, 12u);
}

TEST(AlembicBuilderTest, EqualTimeSamplingsHaveOneNumber) {
  AlembicBuilder builder;
  EXPECT_EQ(builder.AddTimeSampling({1, {0}}), 0u);  // is always there
  EXPECT_EQ(builder.AddTimeSampling(Uniform(24)), 1u);
  EXPECT_EQ(builder.AddTimeSampling(Uniform(25)), 2u);
  EXPECT_EQ(builder.AddTimeSampling(Uniform(24)), 1u);
}

// The first four bytes of the only property of the only object.
uint32_t InfoOf(PropertyToWrite property, AlembicBuilder* builder) {
  const std::string name = property.name;
  const std::string bytes =
      builder->Finish({{.name = "o", .properties = {std::move(property)}}}, "");
  // Info, number of samples and length of the name stand before the name, in one byte each but the
  // first.
  uint32_t info;
  std::memcpy(&info, bytes.data() + bytes.find(name) - 6, sizeof(info));
  return info;
}

// The bits that the reference library wrote for such properties.
TEST(AlembicBuilderTest, HeadersAreThoseOfTheReferenceLibrary) {
  AlembicBuilder counts, box, one, uneven;
  EXPECT_EQ(
      InfoOf(ArrayProperty<int32_t>(&counts, "counts", AlembicType::kInt32, 1, {{3, 3}}), &counts),
      0x1c62u);
  EXPECT_EQ(InfoOf(ArrayProperty<double>(&box, "selfbnds", AlembicType::kFloat64, 6,
                                         {{0, 0, 0, 1, 1, 1}}, 0, AlembicKind::kScalar),
                   &box),
            0x6cb1u);
  EXPECT_EQ(InfoOf(ArrayProperty<int32_t>(&one, "single", AlembicType::kInt32, 1, {{4}}), &one),
            0x1c63u);
  EXPECT_EQ(InfoOf(ArrayProperty<float>(&uneven, "points", AlembicType::kFloat32, 3,
                                        {{1, 2, 3, 4, 5, 6}, {1, 2, 3}}),
                   &uneven),
            0x30a2u);
}

}  // namespace
}  // namespace pleat
