#include "pleat/local/describe_file.h"

#include <gtest/gtest.h>

#include "pleat/base/sha256.h"
#include "pleat/formats/model_file.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/sequence_codec/compress_sequence.h"
#include "pleat/store/records.h"
#include "support/fake_training.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

absl::StatusOr<FileDescription> Describe(const std::string& bytes) {
  return DescribeStoredFile(ToHex(ComputeSha256(bytes)), bytes);
}

TEST(DescribeFileTest, ASequenceIsDescribedAsWhenItWasUploaded) {
  const MeshSequence tube = MakeSwayingTube(4);
  const std::string bytes = EncodeSequence(tube);
  PLEAT_ASSERT_OK_AND_ASSIGN(const FileDescription file, Describe(bytes));
  EXPECT_EQ(file.kind, EntryKind::kSequence);
  PLEAT_ASSERT_OK_AND_ASSIGN(const SequenceInfo info, DecodeSequenceRecord(file.record));
  EXPECT_EQ(info.id, SequenceId(bytes));
  EXPECT_EQ(info.name, tube.name());
  EXPECT_EQ(info.num_frames, 4);
  EXPECT_EQ(info.size_bytes, bytes.size());
}

TEST(DescribeFileTest, AModelKeepsItsRecord) {
  const auto model = MakeFakeModel(MakeSwayingTube(4), {});
  const std::string bytes = EncodeModel(*model);
  PLEAT_ASSERT_OK_AND_ASSIGN(const FileDescription file, Describe(bytes));
  EXPECT_EQ(file.kind, EntryKind::kModel);
  PLEAT_ASSERT_OK_AND_ASSIGN(const ModelInfo info, DecodeModelRecord(file.record));
  EXPECT_EQ(info.id, ModelId(bytes));
  EXPECT_EQ(info.record.num_frames, model->record().num_frames);
  EXPECT_EQ(info.memory_bytes, model->memory_bytes());
}

TEST(DescribeFileTest, ACompressedSequenceIsKnown) {
  const std::string bytes = CompressSequence(MakeSwayingTube(4), {}, nullptr).value();
  PLEAT_ASSERT_OK_AND_ASSIGN(const FileDescription file, Describe(bytes));
  EXPECT_EQ(file.kind, EntryKind::kCompressedSequence);
  PLEAT_ASSERT_OK_AND_ASSIGN(const CompressedSequenceInfo info,
                             DecodeCompressedSequenceRecord(file.record));
  EXPECT_EQ(info.num_frames, 4);
  EXPECT_FALSE(info.record.has_value());
}

TEST(DescribeFileTest, NothingElseIs) {
  for (const std::string& bytes : {std::string(), std::string("{}"), std::string(1000, '\0'),
                                   std::string("{\"joints\": []}")}) {
    EXPECT_FALSE(Describe(bytes).ok()) << bytes;
  }
}

}  // namespace
}  // namespace pleat
