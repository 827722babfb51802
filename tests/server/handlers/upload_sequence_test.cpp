#include "pleat/v1/sequence_service.grpc.pb.h"
#include "server/handlers/mock_server.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::HasSubstr;
using ::testing::Return;

class UploadSequenceTest : public testing::Test {
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
  static SequenceInfo Info() {
    SequenceInfo info;
    info.id = kId;
    return info;
  }
  void ExpectNothingStored() {
    EXPECT_CALL(mock_.service.mock_sequences, Get(kId))
        .WillOnce(Return(absl::NotFoundError("none")));
  }
  // What BeginUpload gives; the caller adds what is expected of it.
  MockUpload<SequenceInfo>* ExpectUpload(uint64_t offset) {
    auto upload = std::make_unique<testing::StrictMock<MockUpload<SequenceInfo>>>();
    MockUpload<SequenceInfo>* result = upload.get();
    EXPECT_CALL(mock_.service.mock_sequences, BeginUpload(kId, 6, offset))
        .WillOnce(Return(testing::ByMove(std::move(upload))));
    return result;
  }
  grpc::Status Send(const std::vector<v1::UploadSequenceRequest>& requests) {
    const auto stub = v1::SequenceService::NewStub(mock_.channel);
    const auto writer = stub->UploadSequence(&mock_.call, &response_);
    bool open = true;
    for (const auto& request : requests) open = open && writer->Write(request);
    writer->WritesDone();
    return writer->Finish();
  }

  MockServer mock_;
  v1::UploadSequenceResponse response_;
};

TEST_F(UploadSequenceTest, HandsOverThePiecesInOrder) {
  ExpectNothingStored();
  MockUpload<SequenceInfo>* upload = ExpectUpload(0);
  testing::InSequence in_order;
  EXPECT_CALL(*upload, Append("abc")).WillOnce(Return(absl::OkStatus()));
  EXPECT_CALL(*upload, Append("def")).WillOnce(Return(absl::OkStatus()));
  EXPECT_CALL(*upload, Finish).WillOnce(Return(Info()));
  EXPECT_TRUE(Send({Header(kId), Data("abc"), Data("def")}).ok());
  EXPECT_EQ(response_.sequence().id(), kId);
}

TEST_F(UploadSequenceTest, ContentThatIsStoredEndsTheCallEarly) {
  EXPECT_CALL(mock_.service.mock_sequences, Get(kId)).WillOnce(Return(Info()));
  EXPECT_TRUE(Send({Header(kId)}).ok());
  EXPECT_EQ(response_.sequence().id(), kId);
}

TEST_F(UploadSequenceTest, WhatIsWrongNeverReachesTheService) {
  EXPECT_THAT(Send({Data("abc")}),
              HasGrpcStatus(grpc::StatusCode::INVALID_ARGUMENT, HasSubstr("header")));
}

TEST_F(UploadSequenceTest, AnIdThatIsNoneNeverReachesTheService) {
  EXPECT_THAT(Send({Header(kPathId)}),
              HasGrpcStatus(grpc::StatusCode::INVALID_ARGUMENT, HasSubstr("header.id")));
}

TEST_F(UploadSequenceTest, NothingAtAllIsNoUpload) {
  EXPECT_THAT(Send({}), HasGrpcStatus(grpc::StatusCode::INVALID_ARGUMENT, _));
}

TEST_F(UploadSequenceTest, AnEmptyPieceIsRefused) {
  ExpectNothingStored();
  ExpectUpload(3);
  EXPECT_THAT(Send({Header(kId, 3), Data("")}),
              HasGrpcStatus(grpc::StatusCode::INVALID_ARGUMENT, HasSubstr("bytes of data")));
}

TEST_F(UploadSequenceTest, PassesOnThatAnotherWriterHoldsIt) {
  ExpectNothingStored();
  EXPECT_CALL(mock_.service.mock_sequences, BeginUpload(kId, 6, 0))
      .WillOnce(Return(testing::ByMove(absl::AbortedError("another writer"))));
  EXPECT_THAT(Send({Header(kId)}), HasGrpcStatus(grpc::StatusCode::ABORTED, "another writer"));
}

TEST_F(UploadSequenceTest, PassesOnThatTheFileIsBad) {
  ExpectNothingStored();
  MockUpload<SequenceInfo>* upload = ExpectUpload(0);
  EXPECT_CALL(*upload, Append("abcdef")).WillOnce(Return(absl::OkStatus()));
  EXPECT_CALL(*upload, Finish).WillOnce(Return(absl::InvalidArgumentError("no such file")));
  EXPECT_THAT(Send({Header(kId), Data("abcdef")}),
              HasGrpcStatus(grpc::StatusCode::INVALID_ARGUMENT, "no such file"));
}

}  // namespace
}  // namespace pleat
