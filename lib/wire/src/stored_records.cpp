#include "pleat/wire/stored_records.h"

#include "absl/strings/str_cat.h"
#include "pleat/wire/service_messages.h"

namespace pleat {
namespace {

template <typename Info, typename Message>
absl::StatusOr<Info> Decode(const std::string& bytes, absl::string_view what) {
  Message message;
  if (!message.ParseFromString(bytes)) {
    return absl::DataLossError(absl::StrCat("a stored ", what, " record cannot be parsed"));
  }
  absl::StatusOr<Info> info = FromProto(message);
  if (!info.ok()) {
    return absl::DataLossError(absl::StrCat(
        "a stored ", what, " record is wrong: ", absl::string_view(info.status().message())));
  }
  return info;
}

}  // namespace

std::string EncodeRecord(const SequenceInfo& info) { return ToProto(info).SerializeAsString(); }
std::string EncodeRecord(const JobInfo& info) { return ToProto(info).SerializeAsString(); }
std::string EncodeRecord(const ModelInfo& info) { return ToProto(info).SerializeAsString(); }
std::string EncodeRecord(const CompressedSequenceInfo& info) {
  return ToProto(info).SerializeAsString();
}

absl::StatusOr<SequenceInfo> DecodeSequenceRecord(const std::string& bytes) {
  return Decode<SequenceInfo, v1::Sequence>(bytes, "sequence");
}
absl::StatusOr<JobInfo> DecodeJobRecord(const std::string& bytes) {
  return Decode<JobInfo, v1::Job>(bytes, "job");
}
absl::StatusOr<ModelInfo> DecodeModelRecord(const std::string& bytes) {
  return Decode<ModelInfo, v1::Model>(bytes, "model");
}
absl::StatusOr<CompressedSequenceInfo> DecodeCompressedSequenceRecord(const std::string& bytes) {
  return Decode<CompressedSequenceInfo, v1::CompressedSequence>(bytes, "compressed sequence");
}

}  // namespace pleat
