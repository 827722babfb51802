#include "json_calls.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/dynamic_message.h>
#include <google/protobuf/util/json_util.h>

#include <memory>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

namespace protobuf = google::protobuf;

std::unique_ptr<protobuf::Message> Make(const protobuf::Descriptor* type) {
  return std::unique_ptr<protobuf::Message>(
      protobuf::MessageFactory::generated_factory()->GetPrototype(type)->New());
}

absl::StatusOr<std::unique_ptr<protobuf::Message>> ParseResponse(
    const protobuf::MethodDescriptor& method, std::string_view bytes) {
  std::unique_ptr<protobuf::Message> message = Make(method.output_type());
  if (!message->ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    return absl::InternalError(absl::StrCat("the answer of ", method.full_name(), " is damaged"));
  }
  return message;
}

}  // namespace

absl::StatusOr<const protobuf::MethodDescriptor*> FindMethod(const std::string& service,
                                                             const std::string& method) {
  const protobuf::ServiceDescriptor* found =
      protobuf::DescriptorPool::generated_pool()->FindServiceByName("pleat.v1." + service);
  const protobuf::MethodDescriptor* result =
      found == nullptr ? nullptr : found->FindMethodByName(method);
  if (result == nullptr) {
    return absl::NotFoundError(absl::StrCat("there is no call ", EscapeControls(service), "/",
                                            EscapeControls(method),
                                            "; proto/pleat/v1 has those that are"));
  }
  return result;
}

std::string FullName(const protobuf::MethodDescriptor& method) {
  return absl::StrCat("/", method.service()->full_name(), "/", method.name());
}

absl::StatusOr<std::string> RequestFromJson(const protobuf::MethodDescriptor& method,
                                            std::string_view json) {
  const std::unique_ptr<protobuf::Message> message = Make(method.input_type());
  const auto status =
      protobuf::util::JsonStringToMessage({json.data(), json.size()}, message.get());
  if (!status.ok()) {
    return absl::InvalidArgumentError(absl::StrCat("the body is no JSON of ",
                                                   method.input_type()->name(), ": ",
                                                   ToValidUtf8(std::string(status.message()))));
  }
  return message->SerializeAsString();
}

absl::StatusOr<std::string> ResponseToJson(const protobuf::MethodDescriptor& method,
                                           std::string_view bytes) {
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<protobuf::Message> message,
                         ParseResponse(method, bytes));
  protobuf::util::JsonPrintOptions options;
  options.always_print_primitive_fields = true;
  std::string json;
  const auto status = protobuf::util::MessageToJsonString(*message, &json, options);
  if (!status.ok()) return absl::InternalError(std::string(status.message()));
  return json;
}

bool IsDownload(const protobuf::MethodDescriptor& method) {
  const protobuf::Descriptor* type = method.output_type();
  return method.server_streaming() && type->FindFieldByName("data") != nullptr &&
         type->FindFieldByName("size_bytes") != nullptr;
}

absl::StatusOr<FilePiece> PieceOf(const protobuf::MethodDescriptor& method,
                                  std::string_view bytes) {
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<protobuf::Message> message,
                         ParseResponse(method, bytes));
  const protobuf::Reflection* fields = message->GetReflection();
  const protobuf::Descriptor* type = method.output_type();
  return FilePiece{.data = fields->GetString(*message, type->FindFieldByName("data")),
                   .size_bytes = fields->GetUInt64(*message, type->FindFieldByName("size_bytes"))};
}

}  // namespace pleat
