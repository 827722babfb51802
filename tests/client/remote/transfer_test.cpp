// Uploads and downloads that break, over servers that do what no honest one does.
#include "transfer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <string>
#include <vector>

#include "client/remote/scripted_server.h"
#include "pleat/base/random.h"
#include "pleat/wire/service_messages.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::HasSubstr;
using ::testing::Return;
using Reader = grpc::ServerReader<v1::UploadSequenceRequest>;
using Upload = v1::UploadCompressedSequenceResponse;
using ModelWriter = grpc::ServerWriter<v1::DownloadModelResponse>;

std::string SomeBytes(size_t count) {
  Random random(3);
  std::string bytes(count, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random.Uniform(0, 256));
  return bytes;
}

class UploadTest : public testing::Test {
 protected:
  // A script of one call: takes `num_parts` parts after the header (-1: all), then ends so.
  auto Take(int num_parts, grpc::Status end) {
    return [this, num_parts, end](grpc::ServerContext*, Reader* in, Upload* out) {
      v1::UploadSequenceRequest part;
      if (!in->Read(&part)) return grpc::Status::OK;
      EXPECT_EQ(part.header().id(), ToHex(ComputeSha256(file_)));
      EXPECT_EQ(part.header().size_bytes(), file_.size());
      offsets_.push_back(part.header().offset_bytes());
      stored_.resize(part.header().offset_bytes());
      for (int i = 0; i != num_parts && in->Read(&part); ++i) {
        EXPECT_LE(part.data().size(), kUploadChunkBytes);
        stored_ += part.data();
      }
      if (end.ok()) *out->mutable_compressed_sequence() = Info();
      return end;
    };
  }
  v1::CompressedSequence Info() const {
    CompressedSequenceInfo info;
    info.id = ToHex(ComputeSha256(file_));
    info.num_frames = info.num_vertices = 7;
    info.frame_rate = {30, 1};
    info.size_bytes = file_.size();
    return ToProto(info);
  }
  // What the server says it has when an upload begins or goes on.
  auto Has(uint64_t received_bytes) {
    return [received_bytes](grpc::ServerContext*, const v1::QueryUploadRequest*,
                            v1::QueryUploadResponse* out) {
      out->set_received_bytes(received_bytes);
      return grpc::Status::OK;
    };
  }
  auto HasWhatCame() {
    return
        [this](grpc::ServerContext*, const v1::QueryUploadRequest*, v1::QueryUploadResponse* out) {
          out->set_received_bytes(stored_.size());
          return grpc::Status::OK;
        };
  }
  absl::StatusOr<CompressedSequenceInfo> Run(int max_attempts = 5, const Progress& progress = {}) {
    return server_.Open({.max_attempts = max_attempts})
        ->compressed_sequences()
        .Upload(file_, progress);
  }

  const std::string file_ = SomeBytes(3 * kUploadChunkBytes + 17);
  std::string stored_;
  std::vector<uint64_t> offsets_;
  ScriptedServer server_;
};

TEST_F(UploadTest, GoesOnWhereABrokenCallStopped) {
  EXPECT_CALL(server_.sequences, QueryUpload).Times(3).WillRepeatedly(HasWhatCame());
  EXPECT_CALL(server_.compressed, UploadCompressedSequence)
      .WillOnce(Take(1, Unavailable()))
      .WillOnce(Take(2, Unavailable()))
      .WillOnce(Take(-1, grpc::Status::OK));
  double last = 0;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const CompressedSequenceInfo info,
      Run(2, Progress([&](const ProgressUpdate& update) { last = update.fraction; }, {})));
  EXPECT_EQ(info.size_bytes, file_.size());
  EXPECT_EQ(stored_, file_);
  EXPECT_THAT(offsets_, testing::ElementsAre(0u, kUploadChunkBytes, 3 * kUploadChunkBytes));
  EXPECT_EQ(last, 1);
}

TEST_F(UploadTest, BeginsAnewWhenTheServerClaimsMoreThanThereIs) {
  EXPECT_CALL(server_.sequences, QueryUpload).WillOnce(Has(file_.size() + 1));
  EXPECT_CALL(server_.compressed, UploadCompressedSequence).WillOnce(Take(-1, grpc::Status::OK));
  EXPECT_THAT(Run(), IsOk());
  EXPECT_EQ(stored_, file_);
}

TEST_F(UploadTest, AFileThatTheServerHasIsSentNoFurther) {
  EXPECT_CALL(server_.sequences, QueryUpload).WillOnce(Has(file_.size()));
  EXPECT_CALL(server_.compressed, UploadCompressedSequence).WillOnce(Take(0, grpc::Status::OK));
  EXPECT_THAT(Run(), IsOk());
  EXPECT_THAT(offsets_, testing::ElementsAre(file_.size()));
}

TEST_F(UploadTest, ARefusalEndsItAtOnceInTheWordsOfTheServer) {
  EXPECT_CALL(server_.sequences, QueryUpload).WillOnce(Has(0));
  EXPECT_CALL(server_.compressed, UploadCompressedSequence).WillOnce(Take(1, Refusal()));
  EXPECT_THAT(Run(), HasStatus(absl::StatusCode::kPermissionDenied, "not today"));
}

TEST_F(UploadTest, AnotherWritersBytesAreAskedForAgain) {
  const grpc::Status behind(grpc::StatusCode::OUT_OF_RANGE, "another call was faster");
  EXPECT_CALL(server_.sequences, QueryUpload).WillOnce(Has(0)).WillOnce(Has(100));
  EXPECT_CALL(server_.compressed, UploadCompressedSequence)
      .WillOnce(Take(0, behind))
      .WillOnce(Take(-1, grpc::Status::OK));
  EXPECT_THAT(Run(), IsOk());
  EXPECT_THAT(offsets_, testing::ElementsAre(0u, 100u));
}

TEST_F(UploadTest, GivesUpWhereNothingMoves) {
  EXPECT_CALL(server_.sequences, QueryUpload).Times(2).WillRepeatedly(Has(0));
  EXPECT_CALL(server_.compressed, UploadCompressedSequence)
      .Times(2)
      .WillRepeatedly(Take(0, Unavailable()));
  EXPECT_THAT(Run(2), HasStatus(absl::StatusCode::kUnavailable, "the server restarts"));
}

TEST_F(UploadTest, AnAnswerThatIsNoSequenceIsAnError) {
  EXPECT_CALL(server_.sequences, QueryUpload).WillOnce(Has(0));
  EXPECT_CALL(server_.compressed, UploadCompressedSequence)
      .WillOnce([](grpc::ServerContext*, Reader* in, Upload*) {
        for (v1::UploadSequenceRequest part; in->Read(&part);) {
        }
        return grpc::Status::OK;
      });
  EXPECT_EQ(Run().status().code(), absl::StatusCode::kInvalidArgument);
}

TEST_F(UploadTest, CancellationWinsOverEveryAnswer) {
  ON_CALL(server_.sequences, QueryUpload).WillByDefault(Has(0));
  ON_CALL(server_.compressed, UploadCompressedSequence).WillByDefault(Take(-1, Unavailable()));
  EXPECT_EQ(Run(5, Progress({}, [] { return true; })).status().code(),
            absl::StatusCode::kCancelled);
}

TEST_F(UploadTest, WhatIsAppendedAfterTheEndGoesNowhere) {
  EXPECT_CALL(server_.sequences, UploadSequence)
      .WillOnce(
          [](grpc::ServerContext*, Reader*, v1::UploadSequenceResponse*) { return Refusal(); });
  const auto client = server_.Open();
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto upload,
                             client->sequences().BeginUpload("id", file_.size(), 5));
  EXPECT_EQ(upload->received_bytes(), 5u);
  const auto refused = HasStatus(absl::StatusCode::kPermissionDenied, "not today");
  absl::Status status;
  while (status.ok()) status = upload->Append(file_);
  EXPECT_THAT(status, refused);
  EXPECT_THAT(upload->Append("more"), refused);
  EXPECT_THAT(upload->Finish(), refused);
}

struct Part {
  uint64_t size_bytes, offset_bytes;
  std::string data;
};

class DownloadTest : public testing::Test {
 protected:
  // A script of one call: sends `parts`, then ends so.
  auto Send(std::vector<Part> parts, grpc::Status end = grpc::Status::OK) {
    return [this, parts, end](grpc::ServerContext*, const v1::DownloadModelRequest* request,
                              ModelWriter* out) {
      offsets_.push_back(request->offset_bytes());
      for (const Part& part : parts) {
        v1::DownloadModelResponse response;
        response.set_size_bytes(part.size_bytes);
        response.set_offset_bytes(part.offset_bytes);
        response.set_data(part.data);
        if (!out->Write(response)) break;
      }
      return end;
    };
  }
  absl::StatusOr<std::string> Download(const std::string& id, int max_attempts = 2,
                                       const Progress& progress = {}) {
    return server_.Open({.max_attempts = max_attempts})->models().Download(id, progress);
  }

  const std::string file_ = "a small model", id_ = ToHex(ComputeSha256(file_));
  std::vector<uint64_t> offsets_;
  ScriptedServer server_;
};

TEST_F(DownloadTest, GoesOnBehindTheLastByteThatCame) {
  std::vector<double> fractions;
  EXPECT_CALL(server_.models, DownloadModel)
      .WillOnce(Send({{13, 0, "a sma"}}, Unavailable()))
      .WillOnce(Send({{13, 5, "ll"}, {13, 7, " mod"}}, Unavailable()))
      .WillOnce(Send({{13, 11, "el"}}));
  const Progress progress(
      [&](const ProgressUpdate& update) { fractions.push_back(update.fraction); }, {});
  EXPECT_EQ(Download(id_, 2, progress).value_or(""), file_);
  EXPECT_THAT(offsets_, testing::ElementsAre(0u, 5u, 11u));
  EXPECT_EQ(fractions.back(), 1);
}

TEST_F(DownloadTest, PartsThatDoNotFollowAreRefused) {
  const uint64_t most = std::numeric_limits<uint64_t>::max();
  for (const std::vector<Part>& parts : std::vector<std::vector<Part>>{
           {{13, 1, "a small mode"}},                 // begins too late
           {{13, 0, "a small"}, {13, 0, "a small"}},  // comes twice
           {{13, 0, "a small"}, {13, 8, "odel"}},     // leaves one out
           {{5, 0, "a small model"}},                 // is longer than the file
           {{13, 0, "a small"}, {8, 7, " model"}},    // the same, behind another
           {{0, 0, "x"}},
           {{13, most, "x"}},
           {{most, most - 1, "xyz"}}}) {
    EXPECT_CALL(server_.models, DownloadModel).WillOnce(Send(parts));
    EXPECT_THAT(Download(id_), HasStatus(absl::StatusCode::kDataLoss, HasSubstr("not follow")))
        << parts.back().offset_bytes;
  }
}

TEST_F(DownloadTest, OnlyTheBytesOfTheIdAreAccepted) {
  for (const std::string& data : {file_.substr(0, 12), std::string("a small modem")}) {
    EXPECT_CALL(server_.models, DownloadModel).WillOnce(Send({{13, 0, data}}));
    EXPECT_THAT(Download(id_), HasStatus(absl::StatusCode::kDataLoss,
                                         testing::AllOf(HasSubstr(id_), HasSubstr("again"))));
  }
  EXPECT_CALL(server_.models, DownloadModel).WillOnce(Send({}));
  EXPECT_EQ(Download(id_).status().code(), absl::StatusCode::kDataLoss);
}

TEST_F(DownloadTest, EmptyPartsAreNoProgressForWhichToTryAgainForEver) {
  EXPECT_CALL(server_.models, DownloadModel)
      .Times(2)
      .WillRepeatedly(Send({{13, 0, ""}, {13, 0, ""}}, Unavailable()));
  EXPECT_THAT(Download(id_, 2), HasStatus(absl::StatusCode::kUnavailable, "the server restarts"));
}

TEST_F(DownloadTest, ARefusalIsNotTriedAgain) {
  EXPECT_CALL(server_.models, DownloadModel).WillOnce(Send({{13, 0, "a"}}, Refusal()));
  EXPECT_THAT(Download(id_), HasStatus(absl::StatusCode::kPermissionDenied, "not today"));
}

TEST_F(DownloadTest, CancellationEndsTheCall) {
  std::atomic<bool> cancelled = false;
  EXPECT_CALL(server_.models, DownloadModel).WillOnce(Send({{13, 0, "a"}, {13, 1, " "}}));
  const Progress progress([&](const ProgressUpdate&) { cancelled = true; },
                          [&] { return cancelled.load(); });
  EXPECT_EQ(Download(id_, 2, progress).status().code(), absl::StatusCode::kCancelled);
}

TEST_F(DownloadTest, SomeBytesAreReadAndTheRestIsNotSent) {
  EXPECT_CALL(server_.models, DownloadModel)
      .WillOnce(
          [](grpc::ServerContext*, const v1::DownloadModelRequest* request, ModelWriter* out) {
            v1::DownloadModelResponse part;
            part.set_size_bytes(uint64_t{1} << 40);
            part.set_data(std::string(1000, 'x'));
            part.set_offset_bytes(request->offset_bytes());
            while (out->Write(part)) part.set_offset_bytes(part.offset_bytes() + 1000);
            return grpc::Status::OK;
          });
  const auto client = server_.Open();
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto download, client->models().OpenDownload("m", 10));
  EXPECT_EQ(download->size_bytes(), uint64_t{1} << 40);
  for (int i = 0; i < 2; ++i) EXPECT_EQ(download->Next().value_or(""), std::string(1000, 'x'));
}

TEST_F(DownloadTest, InPiecesItEndsWithAnEmptyOneOrWithTheErrorOfTheCall) {
  EXPECT_CALL(server_.models, DownloadModel)
      .WillOnce(Send({{13, 0, ""}, {13, 0, "a small"}, {13, 7, " model"}}))
      .WillOnce(Send({{13, 0, "a small"}}, Refusal()))
      .WillOnce(Send({{13, 13, ""}}))  // nothing is left
      .WillOnce(Send({}, Refusal()));
  const auto client = server_.Open();
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto whole, client->models().OpenDownload(id_, 0));
  EXPECT_EQ(whole->Next().value_or(""), "a small");
  EXPECT_EQ(whole->Next().value_or(""), " model");
  for (int i = 0; i < 2; ++i) EXPECT_EQ(whole->Next().value_or("error"), "");
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto broken, client->models().OpenDownload(id_, 0));
  EXPECT_EQ(broken->Next().value_or(""), "a small");
  for (int i = 0; i < 2; ++i) {
    EXPECT_THAT(broken->Next(), HasStatus(absl::StatusCode::kPermissionDenied, "not today"));
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto nothing, client->models().OpenDownload(id_, 13));
  EXPECT_EQ(nothing->size_bytes(), 13u);
  EXPECT_EQ(nothing->Next().value_or("error"), "");
  EXPECT_THAT(client->models().OpenDownload(id_, 0),
              HasStatus(absl::StatusCode::kPermissionDenied, "not today"));
}

}  // namespace
}  // namespace pleat
