#include "alembic_properties.h"

#include <cstring>
#include <string>
#include <vector>

#include "formats/alembic_scene.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::HasSubstr;

// An archive with one object that has these properties.
std::string PropertyArchive(AlembicBuilder* builder, std::vector<PropertyToWrite> properties) {
  return builder->Finish({{.name = "o", .properties = std::move(properties)}}, "");
}

absl::StatusOr<AlembicProperties> ReadTop(AlembicArchive* archive) {
  return AlembicProperties::Read(archive->objects()[1].properties, archive);
}

TEST(AlembicPropertiesTest, HeadersSayWhatWasWritten) {
  AlembicBuilder builder;
  const uint32_t sampling = builder.AddTimeSampling(Uniform(24));
  PropertyToWrite compound = {.name = "group", .metadata = "a=b"};
  compound.properties.push_back(
      ArrayProperty<float>(&builder, "inner", AlembicType::kFloat32, 2, {{1, 2}}));
  const std::string bytes = PropertyArchive(
      &builder, {ArrayProperty<double>(&builder, "box", AlembicType::kFloat64, 6,
                                       {{1, 2, 3, 4, 5, 6}}, sampling, AlembicKind::kScalar),
                 compound});
  PLEAT_ASSERT_OK_AND_ASSIGN(AlembicArchive archive, AlembicArchive::Open(bytes));
  PLEAT_ASSERT_OK_AND_ASSIGN(const AlembicProperties properties, ReadTop(&archive));
  ASSERT_EQ(properties.all().size(), 2u);
  const AlembicProperty* box = properties.Find("box");
  ASSERT_NE(box, nullptr);
  EXPECT_TRUE(box->Is(AlembicKind::kScalar, AlembicType::kFloat64, 6));
  EXPECT_EQ(box->time_sampling, sampling);
  EXPECT_FALSE(box->changes());
  EXPECT_EQ(properties.Find("group")->metadata, "a=b");
  EXPECT_EQ(properties.Find("none"), nullptr);
  PLEAT_ASSERT_OK_AND_ASSIGN(const AlembicProperties inner, properties.Compound("group", &archive));
  ASSERT_EQ(inner.all().size(), 1u);
  EXPECT_TRUE(inner.all()[0].Is(AlembicKind::kArray, AlembicType::kFloat32, 2));
  PLEAT_ASSERT_OK_AND_ASSIGN(const AlembicProperties none, properties.Compound("box", &archive));
  EXPECT_TRUE(none.all().empty());
}

// Reads back every sample of an array of one number each, and of a scalar.
void ExpectSamples(const std::vector<int32_t>& values) {
  AlembicBuilder builder;
  std::vector<std::vector<int32_t>> samples;
  for (const int32_t value : values) samples.push_back({value});
  const std::string bytes =
      PropertyArchive(&builder, {ArrayProperty(&builder, "array", AlembicType::kInt32, 1, samples),
                                 ArrayProperty(&builder, "scalar", AlembicType::kInt32, 1, samples,
                                               0, AlembicKind::kScalar)});
  PLEAT_ASSERT_OK_AND_ASSIGN(AlembicArchive archive, AlembicArchive::Open(bytes));
  PLEAT_ASSERT_OK_AND_ASSIGN(const AlembicProperties properties, ReadTop(&archive));
  for (const AlembicProperty& property : properties.all()) {
    ASSERT_EQ(property.num_samples, values.size());
    for (size_t i = 0; i < values.size() + 3; ++i) {
      PLEAT_ASSERT_OK_AND_ASSIGN(const std::string_view read,
                                 ReadSampleValues(property, static_cast<uint32_t>(i), &archive));
      int32_t value;
      ASSERT_EQ(read.size(), sizeof(value));
      std::memcpy(&value, read.data(), sizeof(value));
      EXPECT_EQ(value, values[std::min(i, values.size() - 1)]) << i;
    }
  }
}

TEST(AlembicPropertiesTest, SamplesThatRepeatAreFound) {
  ExpectSamples({7});
  ExpectSamples({7, 7, 7});
  ExpectSamples({1, 2, 3});
  ExpectSamples({1, 1, 1, 2, 1, 1});
  ExpectSamples({1, 1, 2, 2, 2});
  ExpectSamples({1, 2, 1, 2, 2});
  std::vector<int32_t> many(300);  // the numbers of the header take two bytes
  for (int i = 0; i < 300; ++i) many[i] = i / 7;
  ExpectSamples(many);
  many.resize(70'000, 42);  // and four
  ExpectSamples(many);
}

TEST(AlembicPropertiesTest, LongMetadataIsWrittenInPlace) {
  AlembicBuilder builder;
  PropertyToWrite property =
      ArrayProperty<float>(&builder, std::string(400, 'n'), AlembicType::kFloat32, 1, {{1}});
  property.metadata = std::string(1000, 'm');
  const std::string bytes = PropertyArchive(&builder, {property});
  PLEAT_ASSERT_OK_AND_ASSIGN(AlembicArchive archive, AlembicArchive::Open(bytes));
  PLEAT_ASSERT_OK_AND_ASSIGN(const AlembicProperties properties, ReadTop(&archive));
  EXPECT_EQ(properties.all()[0].name, std::string(400, 'n'));
  EXPECT_EQ(properties.all()[0].metadata, std::string(1000, 'm'));
}

TEST(AlembicPropertiesTest, SamplesMustBeWhole) {
  AlembicBuilder builder;
  // Written as one float each, read as three.
  PropertyToWrite property =
      ArrayProperty<float>(&builder, "P", AlembicType::kFloat32, 3, {{1, 2, 3, 4}});
  const std::string bytes = PropertyArchive(&builder, {property});
  PLEAT_ASSERT_OK_AND_ASSIGN(AlembicArchive archive, AlembicArchive::Open(bytes));
  PLEAT_ASSERT_OK_AND_ASSIGN(const AlembicProperties properties, ReadTop(&archive));
  EXPECT_THAT(ReadSampleValues(properties.all()[0], 0, &archive),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("whole number of 12")));
}

TEST(AlembicPropertiesTest, SamplesThatAreNotThereAreNamed) {
  AlembicBuilder builder;
  const std::string bytes = PropertyArchive(
      &builder, {ArrayProperty<float>(&builder, "P", AlembicType::kFloat32, 1, {{1}, {2}, {3}})});
  PLEAT_ASSERT_OK_AND_ASSIGN(AlembicArchive archive, AlembicArchive::Open(bytes));
  PLEAT_ASSERT_OK_AND_ASSIGN(const AlembicProperties properties, ReadTop(&archive));
  AlembicProperty property = properties.all()[0];
  property.num_samples = 10;
  property.last_changed = 9;
  EXPECT_TRUE(FindSample(property, 2, archive).ok());
  EXPECT_THAT(FindSample(property, 3, archive),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("sample 3 of the property 'P'")));
  property.first_changed = 0;  // the largest numbers must not overflow
  property.last_changed = ~0u;
  EXPECT_FALSE(FindSample(property, ~0u, archive).ok());
}

}  // namespace
}  // namespace pleat
