#include "pleat/reactors/upload_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <new>
#include <optional>
#include <string>

#include "server/reactors/fake_call.h"
#include "support/checkpoint.h"
#include "support/held_executor.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

// A file is what was sent; the response of an upload is the same text.
class TextUpload final : public ContentUpload<std::string> {
 public:
  TextUpload(std::function<void()> on_append, bool* is_held)
      : on_append_(std::move(on_append)), is_held_(is_held) {
    *is_held_ = true;
  }
  ~TextUpload() override { *is_held_ = false; }
  absl::Status Append(std::string_view bytes) override {
    on_append_();
    text_ += bytes;
    return absl::OkStatus();
  }
  uint64_t received_bytes() const override { return text_.size(); }
  absl::StatusOr<std::string> Finish() override {
    if (text_.size() < 6) return absl::FailedPreconditionError("bytes are missing");
    return text_;
  }

 private:
  const std::function<void()> on_append_;
  bool* const is_held_;
  std::string text_;
};

class UploadStreamTest : public testing::Test {
 protected:
  UploadStreamTest() {
    spdlog::set_level(spdlog::level::off);
    context_.transfer_executor = executor_.get();
    context_.calls->max_open_streams = 1;
    executor_.Release();
  }
  void Start() {
    UploadTarget<std::string, std::string> target{
        .rpc = "Test",
        .begin = [this](const v1::UploadSequenceRequest::Header&)
            -> absl::StatusOr<std::unique_ptr<ContentUpload<std::string>>> {
          ++num_begun_;
          return std::make_unique<TextUpload>(on_append_, &is_held_);
        },
        .reply = [](const std::string& info, std::string* response) { *response = info; }};
    call_.emplace(
        StartReactor<UploadStream<std::string, std::string>>(&context_, &response_, target));
  }
  static v1::UploadSequenceRequest Header() {
    v1::UploadSequenceRequest request;
    request.mutable_header()->set_id(std::string(64, 'a'));
    request.mutable_header()->set_size_bytes(6);
    return request;
  }
  static v1::UploadSequenceRequest Data(const std::string& bytes) {
    v1::UploadSequenceRequest request;
    request.set_data(bytes);
    return request;
  }
  void ExpectEnd(grpc::StatusCode code, const std::string& word) {
    const grpc::Status status = call_->WaitForFinish();
    EXPECT_EQ(status.error_code(), code) << status.error_message();
    EXPECT_THAT(status.error_message(), HasSubstr(word));
    EXPECT_FALSE(is_held_) << "the right to write goes before the status";
    call_->WaitForEnd();
    context_.calls->open_calls.WaitUntilNone();
    EXPECT_EQ(context_.calls->num_open_streams, 0);
  }

  HandlerContext context_;
  std::string response_;
  std::function<void()> on_append_ = [] {};
  bool is_held_ = false;
  int num_begun_ = 0;
  HeldExecutor executor_;
  std::optional<FakeReadCall<v1::UploadSequenceRequest>> call_;
};

TEST_F(UploadStreamTest, TakesThePartsOneByOne) {
  Start();
  for (const auto& request : {Header(), Data("abc"), Data("def")}) call_->Send(request);
  call_->EndReads();
  ExpectEnd(grpc::StatusCode::OK, "");
  EXPECT_EQ(response_, "abcdef");
}

TEST_F(UploadStreamTest, AClientThatIsGoneBeforeTheFirstMessageBeginsNothing) {
  Start();
  call_->WaitForRead();
  call_->Cancel();
  call_->EndReads();
  ExpectEnd(grpc::StatusCode::INVALID_ARGUMENT, "before its header");
  EXPECT_EQ(num_begun_, 0);
}

TEST_F(UploadStreamTest, AClientThatIsGoneInTheMiddleStoresNothing) {
  Start();
  call_->Send(Header());
  call_->Send(Data("abc"));
  call_->WaitForRead();
  call_->Cancel();
  call_->EndReads();
  ExpectEnd(grpc::StatusCode::FAILED_PRECONDITION, "missing");
  EXPECT_EQ(response_, "");
}

TEST_F(UploadStreamTest, CancelledWhileAPartIsStoredItEndsAfterIt) {
  Checkpoint storing;
  on_append_ = [&] { storing.Pass(); };
  Start();
  call_->Send(Header());
  call_->Send(Data("abc"));
  storing.WaitUntilReached();
  call_->Cancel();
  EXPECT_FALSE(call_->reading() || call_->finished()) << "the part is still being stored";
  storing.Release();
  call_->EndReads();
  ExpectEnd(grpc::StatusCode::FAILED_PRECONDITION, "missing");
}

TEST_F(UploadStreamTest, AServerThatDrainsWhileItReadsLetsItGoOnToItsEnd) {
  Start();
  call_->Send(Header());
  call_->WaitForRead();
  context_.calls->draining = true;
  EXPECT_FALSE(context_.calls->open_calls.WaitUntilNone({}));
  call_->Send(Data("abcdef"));
  call_->EndReads();
  ExpectEnd(grpc::StatusCode::OK, "");
  EXPECT_EQ(response_, "abcdef");
}

TEST_F(UploadStreamTest, AServerThatDrainsRefusesTheOneThatHasNotBegun) {
  Start();
  call_->WaitForRead();
  context_.calls->draining = true;
  call_->Send(Header());
  ExpectEnd(grpc::StatusCode::UNAVAILABLE, "shutting down");
  EXPECT_EQ(num_begun_, 0);
}

TEST_F(UploadStreamTest, NoMemoryForAPartEndsIt) {
  on_append_ = [] { throw std::bad_alloc(); };
  Start();
  call_->Send(Header());
  call_->Send(Data("abc"));
  ExpectEnd(grpc::StatusCode::RESOURCE_EXHAUSTED, "memory");
}

}  // namespace
}  // namespace pleat
