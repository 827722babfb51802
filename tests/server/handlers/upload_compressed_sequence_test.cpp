#include "pleat/v1/compressed_sequence_service.grpc.pb.h"
#include "server/handlers/mock_server.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::HasSubstr;
using ::testing::Return;

class UploadCompressedSequenceTest : public testing::Test {
 protected:
  static v1::UploadSequenceRequest Header(const std::string& id, uint64_t offset = 0) {
    v1::UploadSequenceRequest request;
    request.mutable_header()->set_id(id);
    request.mutable_header()->set_size_bytes(6);
    request.mutable_header()->set_offset_bytes(offset);
    return request;
  }
  static v1::UploadSequenceRequest Data(const std::string& bytes) {
    v1::UploadSequenceRequest request;
    request.set_data(bytes);
    return request;
  }
  static CompressedSequenceInfo Info() {
    CompressedSequenceInfo info;
    info.id = kId;
    return info;
  }
  void ExpectNothingStored() {
    EXPECT_CALL(mock_.service.mock_compressed_sequences, Get(kId))
        .WillOnce(Return(absl::NotFoundError("none")));
  }
  // What BeginUpload gives; the caller adds what is expected of it.
  MockUpload<CompressedSequenceInfo>* ExpectUpload(uint64_t offset) {
    auto upload = std::make_unique<testing::StrictMock<MockUpload<CompressedSequenceInfo>>>();
    MockUpload<CompressedSequenceInfo>* result = upload.get();
    EXPECT_CALL(mock_.service.mock_compressed_sequences, BeginUpload(kId, 6, offset))
        .WillOnce(Return(testing::ByMove(std::move(upload))));
    return result;
  }
  grpc::Status Send(const std::vector<v1::UploadSequenceRequest>& requests) {
    const auto stub = v1::CompressedSequenceService::NewStub(mock_.channel);
    const auto writer = stub->UploadCompressedSequence(&mock_.call, &response_);
    bool open = true;
    for (const auto& request : requests) open = open && writer->Write(request);
    writer->WritesDone();
    return writer->Finish();
  }

  MockServer mock_;
  v1::UploadCompressedSequenceResponse response_;
};

TEST_F(UploadCompressedSequenceTest, HandsOverThePiecesInOrder) {
  ExpectNothingStored();
  MockUpload<CompressedSequenceInfo>* upload = ExpectUpload(0);
  testing::InSequence in_order;
  EXPECT_CALL(*upload, Append("abc")).WillOnce(Return(absl::OkStatus()));
  EXPECT_CALL(*upload, Append("def")).WillOnce(Return(absl::OkStatus()));
  EXPECT_CALL(*upload, Finish).WillOnce(Return(Info()));
  EXPECT_TRUE(Send({Header(kId), Data("abc"), Data("def")}).ok());
  EXPECT_EQ(response_.compressed_sequence().id(), kId);
}

TEST_F(UploadCompressedSequenceTest, ContentThatIsStoredEndsTheCallEarly) {
  EXPECT_CALL(mock_.service.mock_compressed_sequences, Get(kId)).WillOnce(Return(Info()));
  EXPECT_TRUE(Send({Header(kId)}).ok());
  EXPECT_EQ(response_.compressed_sequence().id(), kId);
}

TEST_F(UploadCompressedSequenceTest, WhatIsWrongNeverReachesTheService) {
  EXPECT_THAT(Send({Data("abc")}),
              HasGrpcStatus(grpc::StatusCode::INVALID_ARGUMENT, HasSubstr("header")));
}

TEST_F(UploadCompressedSequenceTest, AnIdThatIsNoneNeverReachesTheService) {
  EXPECT_THAT(Send({Header(kPathId)}),
              HasGrpcStatus(grpc::StatusCode::INVALID_ARGUMENT, HasSubstr("header.id")));
}

TEST_F(UploadCompressedSequenceTest, NothingAtAllIsNoUpload) {
  EXPECT_THAT(Send({}), HasGrpcStatus(grpc::StatusCode::INVALID_ARGUMENT, _));
}

TEST_F(UploadCompressedSequenceTest, AnEmptyPieceIsRefused) {
  ExpectNothingStored();
  ExpectUpload(3);
  EXPECT_THAT(Send({Header(kId, 3), Data("")}),
              HasGrpcStatus(grpc::StatusCode::INVALID_ARGUMENT, HasSubstr("bytes of data")));
}

TEST_F(UploadCompressedSequenceTest, PassesOnThatAnotherWriterHoldsIt) {
  ExpectNothingStored();
  EXPECT_CALL(mock_.service.mock_compressed_sequences, BeginUpload(kId, 6, 0))
      .WillOnce(Return(testing::ByMove(absl::AbortedError("another writer"))));
  EXPECT_THAT(Send({Header(kId)}), HasGrpcStatus(grpc::StatusCode::ABORTED, "another writer"));
}

TEST_F(UploadCompressedSequenceTest, PassesOnThatTheFileIsBad) {
  ExpectNothingStored();
  MockUpload<CompressedSequenceInfo>* upload = ExpectUpload(0);
  EXPECT_CALL(*upload, Append("abcdef")).WillOnce(Return(absl::OkStatus()));
  EXPECT_CALL(*upload, Finish).WillOnce(Return(absl::InvalidArgumentError("no such file")));
  EXPECT_THAT(Send({Header(kId), Data("abcdef")}),
              HasGrpcStatus(grpc::StatusCode::INVALID_ARGUMENT, "no such file"));
}

}  // namespace
}  // namespace pleat
