// No request crashes the server: every method gets empty messages, messages of random fields and
// bytes that are no message, and the server still answers afterwards.
#include <google/protobuf/stubs/logging.h>
#include <grpcpp/channel.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/security/credentials.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pleat/base/random.h"
#include "pleat/sequence_codec/compress_sequence.h"
#include "pleat/v1/compressed_sequence_service.grpc.pb.h"
#include "pleat/v1/job_service.grpc.pb.h"
#include "pleat/v1/model_service.grpc.pb.h"
#include "pleat/v1/pose_service.grpc.pb.h"
#include "pleat/v1/sequence_service.grpc.pb.h"
#include "pleat/wire/skeleton_messages.h"
#include "server/running_service.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

std::vector<const google::protobuf::MethodDescriptor*> AllMethods() {
  std::vector<const google::protobuf::MethodDescriptor*> methods;
  for (const auto* file :
       {v1::UploadSequenceRequest::descriptor()->file(), v1::GetJobRequest::descriptor()->file(),
        v1::GetModelRequest::descriptor()->file(), v1::DecodeFramesRequest::descriptor()->file(),
        v1::Frame::descriptor()->file()}) {
    for (int s = 0; s < file->service_count(); ++s) {
      for (int m = 0; m < file->service(s)->method_count(); ++m) {
        methods.push_back(file->service(s)->method(m));
      }
    }
  }
  return methods;
}

// Sets random fields to random values, some of them ids that exist.
void Fill(google::protobuf::Message* message, const std::vector<std::string>& ids, Random* random,
          int depth) {
  const auto* reflection = message->GetReflection();
  const auto* descriptor = message->GetDescriptor();
  const double numbers[] = {0, 1, -1, 1e300, -1e300, .5, 1.0 / 0.0, 0.0 / 0.0, 8, 12, 25};
  using Field = google::protobuf::FieldDescriptor;
  for (int f = 0; f < descriptor->field_count(); ++f) {
    const Field* field = descriptor->field(f);
    if (random->UniformInt(5) == 0) continue;
    const int count = field->is_repeated() ? random->UniformInt(5) : 1;
    for (int i = 0; i < count; ++i) {
      const auto bits = static_cast<int64_t>(random->NextBits());
      const int small = random->UniformInt(20) - 4;
      const bool use_small = random->UniformInt(2) == 0;
      const double number = numbers[random->UniformInt(11)];
      const std::string text = random->UniformInt(3) == 0
                                   ? std::string(random->UniformInt(70), 'a')
                                   : ids[random->UniformInt(static_cast<int>(ids.size()))];
#define PLEAT_SET(kind, value)                                        \
  field->is_repeated() ? reflection->Add##kind(message, field, value) \
                       : reflection->Set##kind(message, field, value)
      switch (field->cpp_type()) {
        case Field::CPPTYPE_INT32:
          PLEAT_SET(Int32, use_small ? small : static_cast<int32_t>(bits));
          break;
        case Field::CPPTYPE_INT64:
          PLEAT_SET(Int64, use_small ? small : bits);
          break;
        case Field::CPPTYPE_UINT64:
          PLEAT_SET(UInt64,
                    use_small ? static_cast<uint64_t>(small + 4) : static_cast<uint64_t>(bits));
          break;
        case Field::CPPTYPE_DOUBLE:
          PLEAT_SET(Double, number);
          break;
        case Field::CPPTYPE_FLOAT:
          PLEAT_SET(Float, static_cast<float>(number));
          break;
        case Field::CPPTYPE_BOOL:
          PLEAT_SET(Bool, use_small);
          break;
        case Field::CPPTYPE_ENUM:
          PLEAT_SET(EnumValue, small);
          break;
        case Field::CPPTYPE_STRING:
          PLEAT_SET(String, text);
          break;
        case Field::CPPTYPE_MESSAGE:
          if (depth < 6) {
            Fill(field->is_repeated() ? reflection->AddMessage(message, field)
                                      : reflection->MutableMessage(message, field),
                 ids, random, depth + 1);
          }
          break;
        default:
          break;
      }
#undef PLEAT_SET
    }
  }
}

class HostileRequestsTest : public testing::Test {
 protected:
  HostileRequestsTest()
      : channel_(grpc::CreateChannel(running_.address(), grpc::InsecureChannelCredentials())),
        stub_(channel_) {
    model_id_ = running_.TrainModel();
    ids_ = {model_id_,
            running_.service().sequences().List()->at(0).id,
            running_.service().jobs().List()->at(0).id,
            running_.service()
                .compressed_sequences()
                .Upload(CompressSequence(MakeSwayingTube(20), {}, nullptr).value(), {})
                ->id,
            "",
            std::string(64, '0'),
            "gp",
            "sgplvm"};
  }

  // Sends `messages` to `method` and waits for the end; every reply that comes is read.
  grpc::Status Call(const google::protobuf::MethodDescriptor& method,
                    const std::vector<std::string>& messages) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(20));
    grpc::CompletionQueue queue;
    const std::string path = "/" + method.service()->full_name() + "/" + method.name();
    const auto call = stub_.PrepareCall(&context, path, &queue);
    const auto wait = [&] {
      void* tag = nullptr;
      bool ok = false;
      return queue.Next(&tag, &ok) && ok;
    };
    call->StartCall(nullptr);
    bool open = wait();
    for (const std::string& message : messages) {
      if (!open) break;
      const grpc::Slice slice(message);
      call->Write(grpc::ByteBuffer(&slice, 1), nullptr);
      open = wait();
    }
    if (open) {
      call->WritesDone(nullptr);
      open = wait();
    }
    grpc::ByteBuffer reply;
    for (int i = 0; open && i < 1000; ++i) {
      call->Read(&reply, nullptr);
      open = wait();
    }
    grpc::Status status;
    call->Finish(&status, nullptr);
    wait();
    return status;
  }

  void ExpectAlive() {
    EXPECT_THAT(running_.service().models().Get(model_id_), IsOk());
    EXPECT_EQ(running_.TrainModel(), model_id_);
  }

  RunningService running_{Reach::kSocket};
  std::shared_ptr<grpc::Channel> channel_;
  grpc::GenericStub stub_;
  std::string model_id_;
  std::vector<std::string> ids_;
};

TEST_F(HostileRequestsTest, EmptyMessages) {
  ASSERT_EQ(AllMethods().size(), 31u);
  for (const auto* method : AllMethods()) {
    if (method->name().starts_with("List")) {
      continue;  // asking for everything is no mistake
    }
    const grpc::Status status = Call(*method, {""});
    EXPECT_TRUE(status.error_code() == grpc::StatusCode::INVALID_ARGUMENT ||
                status.error_code() == grpc::StatusCode::NOT_FOUND)
        << method->full_name() << ": " << status.error_code() << " " << status.error_message();
    EXPECT_FALSE(status.error_message().empty()) << method->full_name();
  }
  for (const auto* method : AllMethods()) {
    if (method->client_streaming()) Call(*method, {});
  }
  ExpectAlive();
}

TEST_F(HostileRequestsTest, BytesThatAreNoMessage) {
  const google::protobuf::LogSilencer quiet;
  Random random(3);
  for (const auto* method : AllMethods()) {
    for (int round = 0; round < 20; ++round) {
      std::string bytes(1 + random.UniformInt(200), '\0');
      for (char& byte : bytes) byte = static_cast<char>(random.NextBits());
      Call(*method, {bytes});
      if (method->client_streaming()) Call(*method, {"", bytes, bytes});
    }
  }
  ExpectAlive();
}

TEST_F(HostileRequestsTest, MessagesOfRandomFields) {
  Random random(5);
  google::protobuf::MessageFactory* factory = google::protobuf::MessageFactory::generated_factory();
  for (const auto* method : AllMethods()) {
    if (method->name().starts_with("Delete")) continue;  // the test needs its model
    const std::unique_ptr<google::protobuf::Message> message(
        factory->GetPrototype(method->input_type())->New());
    for (int round = 0; round < 60; ++round) {
      std::vector<std::string> messages;
      for (int i = 0; i < (method->client_streaming() ? 3 : 1); ++i) {
        message->Clear();
        Fill(message.get(), ids_, &random, 0);
        messages.push_back(message->SerializeAsString());
      }
      Call(*method, messages);
    }
  }
  ExpectAlive();
}

// The right shape with numbers that no skeleton, box or codec can take.
TEST_F(HostileRequestsTest, PosesFarOutsideEverything) {
  const auto stub = v1::PoseService::NewStub(channel_);
  for (const double x : {1e6, 1e12, 1e30, 1e300, 1.0 / 0.0, 0.0 / 0.0}) {
    grpc::ClientContext context;
    v1::EvaluatePoseRequest request;
    request.mutable_character()->set_model_id(model_id_);
    *request.add_poses() =
        ToProto(Pose::Rest(running_.local().models().Acquire(model_id_).value()->skeleton()));
    request.mutable_poses(0)->mutable_root_position()->set_x(x);
    v1::EvaluatePoseResponse response;
    const grpc::Status status = stub->EvaluatePose(&context, request, &response);
    EXPECT_TRUE(status.error_code() == grpc::StatusCode::OUT_OF_RANGE ||
                status.error_code() == grpc::StatusCode::INVALID_ARGUMENT)
        << x << ": " << status.error_code() << " " << status.error_message();
  }
  ExpectAlive();
}

}  // namespace
}  // namespace pleat
