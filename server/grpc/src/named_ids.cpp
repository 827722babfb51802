#include "named_ids.h"

#include <google/protobuf/descriptor.h>

#include "absl/strings/match.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

constexpr size_t kMaxIds = 8, kMaxIdBytes = 64;
constexpr int kMaxDepth = 2;  // ids stand in the request, in its header, or in its character

void AddId(const std::string& id, std::vector<std::string>* ids) {
  if (id.empty() || ids->size() == kMaxIds) return;
  ids->emplace_back(Utf8Prefix(id, kMaxIdBytes));
}

void Collect(const Message& message, int depth, std::vector<std::string>* ids) {
  const Reflection& reflection = *message.GetReflection();
  std::vector<const FieldDescriptor*> fields;
  reflection.ListFields(message, &fields);
  for (const FieldDescriptor* field : fields) {
    if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      if (!field->is_repeated() && depth < kMaxDepth) {
        Collect(reflection.GetMessage(message, field), depth + 1, ids);
      }
    } else if (field->cpp_type() != FieldDescriptor::CPPTYPE_STRING) {
      continue;
    } else if (field->is_repeated() && absl::EndsWith(field->name(), "_ids")) {
      for (int i = 0; i < reflection.FieldSize(message, field) && ids->size() < kMaxIds; ++i) {
        AddId(reflection.GetRepeatedString(message, field, i), ids);
      }
    } else if (!field->is_repeated() &&
               (field->name() == "id" || absl::EndsWith(field->name(), "_id"))) {
      AddId(reflection.GetString(message, field), ids);
    }
  }
}

}  // namespace

std::vector<std::string> NamedIds(const Message& message) {
  std::vector<std::string> ids;
  Collect(message, 0, &ids);
  return ids;
}

}  // namespace pleat
