#include "pleat/v1/compressed_sequence_service.grpc.pb.h"
#include "server/handlers/mock_server.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::Return;

constexpr uint64_t kChunk = 512 << 10;

class DownloadCompressedSequenceTest : public testing::Test {
 protected:
  void ExpectInfo(uint64_t size_bytes) {
    CompressedSequenceInfo info;
    info.id = kId;
    info.size_bytes = size_bytes;
    EXPECT_CALL(mock_.service.mock_compressed_sequences, Get(kId)).WillOnce(Return(info));
  }
  grpc::Status Download(const std::string& id, uint64_t offset, std::string* bytes) {
    const auto stub = v1::CompressedSequenceService::NewStub(mock_.channel);
    v1::DownloadCompressedSequenceRequest request;
    request.set_id(id);
    request.set_offset_bytes(offset);
    const auto reader = stub->DownloadCompressedSequence(&mock_.call, request);
    v1::DownloadCompressedSequenceResponse part;
    while (reader->Read(&part)) {
      EXPECT_EQ(part.offset_bytes(), offset + bytes->size());
      EXPECT_EQ(part.size_bytes(), kChunk + 3);
      *bytes += part.data();
    }
    return reader->Finish();
  }

  MockServer mock_;
};

TEST_F(DownloadCompressedSequenceTest, SendsTheFileInPieces) {
  ExpectInfo(kChunk + 3);
  EXPECT_CALL(mock_.service.mock_compressed_sequences, ReadBytes(kId, 0, kChunk))
      .WillOnce(Return(std::string(kChunk, 'x')));
  EXPECT_CALL(mock_.service.mock_compressed_sequences, ReadBytes(kId, kChunk, kChunk))
      .WillOnce(Return("end"));
  std::string bytes;
  EXPECT_TRUE(Download(kId, 0, &bytes).ok());
  EXPECT_TRUE(bytes == std::string(kChunk, 'x') + "end");
}

TEST_F(DownloadCompressedSequenceTest, GoesOnWhereTheClientSays) {
  ExpectInfo(kChunk + 3);
  EXPECT_CALL(mock_.service.mock_compressed_sequences, ReadBytes(kId, kChunk, kChunk))
      .WillOnce(Return("end"));
  std::string bytes;
  EXPECT_TRUE(Download(kId, kChunk, &bytes).ok());
  EXPECT_EQ(bytes, "end");
}

TEST_F(DownloadCompressedSequenceTest, AnIdThatIsNoneNeverReachesTheService) {
  std::string bytes;
  EXPECT_THAT(Download(kPathId, 0, &bytes), HasGrpcStatus(grpc::StatusCode::INVALID_ARGUMENT, _));
}

TEST_F(DownloadCompressedSequenceTest, AFileThatIsCutOffIsNotTheWholeFile) {
  ExpectInfo(kChunk + 3);
  EXPECT_CALL(mock_.service.mock_compressed_sequences, ReadBytes).WillOnce(Return(""));
  std::string bytes;
  EXPECT_THAT(Download(kId, 0, &bytes),
              HasGrpcStatus(grpc::StatusCode::DATA_LOSS, testing::HasSubstr("cut off")));
}

}  // namespace
}  // namespace pleat
