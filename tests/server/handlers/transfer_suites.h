// What all uploads and all downloads have in common, whatever the files are. The file of each
// handler names its mock, its RPC and its messages in a case.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pleat/v1/sequence_service.pb.h"
#include "server/handlers/mock_server.h"

namespace pleat {

// Case: Info, Response, Mock (of a MockService), Upload (starts the call), Id (of a response).
template <typename Case>
class UploadHandlerTest : public testing::Test {
 protected:
  using Info = typename Case::Info;
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
  static Info Stored() {
    Info info;
    info.id = kId;
    return info;
  }
  auto& service() { return Case::Mock(mock_.service); }
  // What BeginUpload gives; the caller adds what is expected of it.
  MockUpload<Info>* ExpectUpload(uint64_t offset) {
    auto upload = std::make_unique<testing::StrictMock<MockUpload<Info>>>();
    MockUpload<Info>* result = upload.get();
    EXPECT_CALL(*upload, complete).WillRepeatedly(testing::Return(false));
    EXPECT_CALL(service(), BeginUpload(kId, 6, offset, kKeepForEver))
        .WillOnce(testing::Return(testing::ByMove(std::move(upload))));
    return result;
  }
  grpc::Status Send(const std::vector<v1::UploadSequenceRequest>& requests) {
    const auto writer = Case::Upload(mock_.channel, &mock_.call, &response_);
    bool open = true;
    for (const auto& request : requests) open = open && writer->Write(request);
    writer->WritesDone();
    return writer->Finish();
  }

  MockServer mock_;
  typename Case::Response response_;
};
TYPED_TEST_SUITE_P(UploadHandlerTest);

TYPED_TEST_P(UploadHandlerTest, HandsOverThePiecesInOrder) {
  auto* upload = this->ExpectUpload(0);
  testing::InSequence in_order;
  EXPECT_CALL(*upload, Append("abc")).WillOnce(testing::Return(absl::OkStatus()));
  EXPECT_CALL(*upload, Append("def")).WillOnce(testing::Return(absl::OkStatus()));
  EXPECT_CALL(*upload, Finish).WillOnce(testing::Return(this->Stored()));
  EXPECT_TRUE(this->Send({this->Header(kId), this->Data("abc"), this->Data("def")}).ok());
  EXPECT_EQ(TypeParam::Id(this->response_), kId);
}

TYPED_TEST_P(UploadHandlerTest, ContentThatIsStoredEndsTheCallEarly) {
  auto* upload = this->ExpectUpload(0);
  EXPECT_CALL(*upload, complete).WillOnce(testing::Return(true));
  EXPECT_CALL(*upload, Finish).WillOnce(testing::Return(this->Stored()));
  EXPECT_TRUE(this->Send({this->Header(kId)}).ok());
  EXPECT_EQ(TypeParam::Id(this->response_), kId);
}

TYPED_TEST_P(UploadHandlerTest, PassesOnHowLongItIsKept) {
  v1::UploadSequenceRequest header = this->Header(kId);
  header.mutable_header()->set_ttl_seconds(90);
  EXPECT_CALL(this->service(), BeginUpload(kId, 6, 0, absl::Seconds(90)))
      .WillOnce(testing::Return(testing::ByMove(absl::AbortedError("another writer"))));
  EXPECT_THAT(this->Send({header}), HasGrpcStatus(grpc::StatusCode::ABORTED, testing::_));
}

TYPED_TEST_P(UploadHandlerTest, ATimeToLiveThatIsNoneIsRefused) {
  v1::UploadSequenceRequest header = this->Header(kId);
  header.mutable_header()->set_ttl_seconds(-1);
  EXPECT_THAT(this->Send({header}),
              HasGrpcStatus(grpc::StatusCode::INVALID_ARGUMENT, testing::HasSubstr("ttl_seconds")));
}

TYPED_TEST_P(UploadHandlerTest, DataBeforeTheHeaderIsRefused) {
  EXPECT_THAT(this->Send({this->Data("abc")}),
              HasGrpcStatus(grpc::StatusCode::INVALID_ARGUMENT, testing::HasSubstr("header")));
}

TYPED_TEST_P(UploadHandlerTest, AnIdThatIsNoneNeverReachesTheService) {
  EXPECT_THAT(this->Send({this->Header(kPathId)}),
              HasGrpcStatus(grpc::StatusCode::INVALID_ARGUMENT, testing::HasSubstr("header.id")));
}

TYPED_TEST_P(UploadHandlerTest, NothingAtAllIsNoUpload) {
  EXPECT_THAT(this->Send({}), HasGrpcStatus(grpc::StatusCode::INVALID_ARGUMENT, testing::_));
}

TYPED_TEST_P(UploadHandlerTest, AnEmptyPieceIsRefused) {
  this->ExpectUpload(3);
  EXPECT_THAT(
      this->Send({this->Header(kId, 3), this->Data("")}),
      HasGrpcStatus(grpc::StatusCode::INVALID_ARGUMENT, testing::HasSubstr("bytes of data")));
}

TYPED_TEST_P(UploadHandlerTest, PassesOnThatAnotherWriterHoldsIt) {
  EXPECT_CALL(this->service(), BeginUpload(kId, 6, 0, kKeepForEver))
      .WillOnce(testing::Return(testing::ByMove(absl::AbortedError("another writer"))));
  EXPECT_THAT(this->Send({this->Header(kId)}),
              HasGrpcStatus(grpc::StatusCode::ABORTED, "another writer"));
}

TYPED_TEST_P(UploadHandlerTest, PassesOnThatTheFileIsBad) {
  auto* upload = this->ExpectUpload(0);
  EXPECT_CALL(*upload, Append("abcdef")).WillOnce(testing::Return(absl::OkStatus()));
  EXPECT_CALL(*upload, Finish)
      .WillOnce(testing::Return(absl::InvalidArgumentError("no such file")));
  EXPECT_THAT(this->Send({this->Header(kId), this->Data("abcdef")}),
              HasGrpcStatus(grpc::StatusCode::INVALID_ARGUMENT, "no such file"));
}

REGISTER_TYPED_TEST_SUITE_P(UploadHandlerTest, HandsOverThePiecesInOrder,
                            ContentThatIsStoredEndsTheCallEarly, PassesOnHowLongItIsKept,
                            ATimeToLiveThatIsNoneIsRefused, DataBeforeTheHeaderIsRefused,
                            AnIdThatIsNoneNeverReachesTheService, NothingAtAllIsNoUpload,
                            AnEmptyPieceIsRefused, PassesOnThatAnotherWriterHoldsIt,
                            PassesOnThatTheFileIsBad);

// Case: Request, Response, Mock (of a MockService), Download (starts the call).
template <typename Case>
class DownloadHandlerTest : public testing::Test {
 protected:
  static constexpr uint64_t kChunk = 512 << 10;
  static constexpr uint64_t kSize = kChunk + 3;

  auto& service() { return Case::Mock(mock_.service); }
  // The file is opened at `offset` and gives `pieces`.
  void ExpectDownload(uint64_t offset, const std::vector<std::string>& pieces) {
    auto download = std::make_unique<testing::NiceMock<MockDownload>>();
    ON_CALL(*download, size_bytes).WillByDefault(testing::Return(kSize));
    auto& next = EXPECT_CALL(*download, Next).Times(static_cast<int>(pieces.size()));
    for (const std::string& piece : pieces) next.WillOnce(testing::Return(piece));
    EXPECT_CALL(service(), OpenDownload(kId, offset))
        .WillOnce(testing::Return(testing::ByMove(std::move(download))));
  }
  grpc::Status Download(const std::string& id, uint64_t offset) {
    typename Case::Request request;
    request.set_id(id);
    request.set_offset_bytes(offset);
    const auto reader = Case::Download(mock_.channel, &mock_.call, request);
    typename Case::Response part;
    while (reader->Read(&part)) {
      EXPECT_EQ(part.offset_bytes(), offset + bytes_.size());
      EXPECT_EQ(part.size_bytes(), kSize);
      bytes_ += part.data();
    }
    return reader->Finish();
  }

  MockServer mock_;
  std::string bytes_;  // that have arrived
};
TYPED_TEST_SUITE_P(DownloadHandlerTest);

TYPED_TEST_P(DownloadHandlerTest, SendsTheFileInPieces) {
  const std::string first(this->kChunk, 'x');
  this->ExpectDownload(0, {first, "end"});
  EXPECT_TRUE(this->Download(kId, 0).ok());
  EXPECT_TRUE(this->bytes_ == first + "end");
}

TYPED_TEST_P(DownloadHandlerTest, GoesOnWhereTheClientSays) {
  this->ExpectDownload(this->kChunk, {"end"});
  EXPECT_TRUE(this->Download(kId, this->kChunk).ok());
  EXPECT_EQ(this->bytes_, "end");
}

TYPED_TEST_P(DownloadHandlerTest, AnIdThatIsNoneNeverReachesTheService) {
  EXPECT_THAT(this->Download(kPathId, 0),
              HasGrpcStatus(grpc::StatusCode::INVALID_ARGUMENT, testing::_));
}

TYPED_TEST_P(DownloadHandlerTest, AFileThatIsCutOffIsNotTheWholeFile) {
  this->ExpectDownload(0, {""});
  EXPECT_THAT(this->Download(kId, 0),
              HasGrpcStatus(grpc::StatusCode::DATA_LOSS, testing::HasSubstr("cut off")));
}

TYPED_TEST_P(DownloadHandlerTest, PassesOnThatThereIsNone) {
  EXPECT_CALL(this->service(), OpenDownload(kId, 0))
      .WillOnce(testing::Return(testing::ByMove(absl::NotFoundError("none"))));
  EXPECT_THAT(this->Download(kId, 0), HasGrpcStatus(grpc::StatusCode::NOT_FOUND, "none"));
}

REGISTER_TYPED_TEST_SUITE_P(DownloadHandlerTest, SendsTheFileInPieces, GoesOnWhereTheClientSays,
                            AnIdThatIsNoneNeverReachesTheService,
                            AFileThatIsCutOffIsNotTheWholeFile, PassesOnThatThereIsNone);

}  // namespace pleat
