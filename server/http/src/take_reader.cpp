#include "take_reader.h"

#include <Eigen/Core>
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "json_calls.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/formats/sequence_reader.h"
#include "pleat/mesh/bounds.h"
#include "pleat/mesh/frame_jumps.h"
#include "pleat/mesh/mesh_report.h"
#include "pleat/performer/performer.h"
#include "pleat/v1/sequence_service.pb.h"

namespace pleat {
namespace {

constexpr size_t kChunkBytes = 512 << 10;
// Bytes of memory for each byte of a file: text becomes smaller numbers, and beside the sequence
// there are its file and a part of the input.
constexpr uint64_t kReadFactor = 4;

// Sends the file as UploadSequence does; a file that is there already ends the call early.
absl::Status Upload(CallGateway* gateway, const ForeignCaller& caller, const std::string& id,
                    const std::string& bytes, std::string* info_json) {
  PLEAT_ASSIGN_OR_RETURN(const auto* method, FindMethod("SequenceService", "UploadSequence"));
  const std::unique_ptr<GatewayCall> call = gateway->Start(FullName(*method), caller);
  v1::UploadSequenceRequest request;
  request.mutable_header()->set_id(id);
  request.mutable_header()->set_size_bytes(bytes.size());
  bool open = call->Send(request.SerializeAsString());
  for (size_t sent = 0; open && sent < bytes.size(); sent += kChunkBytes) {
    request.set_data(bytes.substr(sent, kChunkBytes));
    open = call->Send(request.SerializeAsString());
  }
  call->SendNoMore();
  std::string message;
  GatewayCall::Got got = GatewayCall::Got::kNothingYet;
  while (got == GatewayCall::Got::kNothingYet) got = call->Receive(&message, 1);
  if (got == GatewayCall::Got::kMessage) {
    PLEAT_ASSIGN_OR_RETURN(*info_json, ResponseToJson(*method, message));
  }
  return call->Finish();
}

nlohmann::json NotesJson(const std::vector<InputNote>& notes) {
  nlohmann::json list = nlohmann::json::array();
  for (const InputNote& note : notes) {
    nlohmann::json json{{"severity", SeverityName(note.severity)},
                        {"kind", note.kind},
                        {"text", ToValidUtf8(note.text)}};
    if (note.frame) json["frame"] = *note.frame;
    list.push_back(std::move(json));
  }
  return list;
}

absl::StatusOr<std::string> Store(CallGateway* gateway, const ForeignCaller& caller,
                                  const MeshSequence& sequence,
                                  const std::vector<InputNote>& notes) {
  const MeshReport mesh = InspectMesh(sequence.topology(), sequence.FrameAsDouble(0));
  const std::string bytes = EncodeSequence(sequence);
  std::string info;
  PLEAT_RETURN_IF_ERROR(Upload(gateway, caller, SequenceId(bytes), bytes, &info));
  nlohmann::json json = nlohmann::json::parse(info);
  json["notes"] = NotesJson(notes);
  json["faults"] = DescribeFaults(mesh);
  json["closed"] = mesh.closed();
  json["numComponents"] = mesh.num_components;
  json["diagonalM"] = BoundsDiagonal(sequence.FrameAsDouble(0));
  return json.dump();
}

// Paths of the server are nothing to a person who dropped files.
absl::Status WithoutFolder(const absl::Status& status, const std::string& folder) {
  std::string message(status.message());
  for (size_t at = message.find(folder); at != std::string::npos; at = message.find(folder)) {
    message.erase(at, std::min(folder.size() + 1, message.size() - at));
  }
  return absl::Status(status.code(), message);
}

}  // namespace

absl::StatusOr<std::string> StoreTake(CallGateway* gateway, const ForeignCaller& caller,
                                      const UploadFolders::Folder& folder, const std::string& name,
                                      const MeshLimits& limits, MemoryBudget* memory) {
  Reservation room;
  if (memory != nullptr) {
    PLEAT_ASSIGN_OR_RETURN(room, memory->Reserve(kReadFactor * folder.bytes, "reading the take"));
  }
  PLEAT_ASSIGN_OR_RETURN(const std::string input, ChooseInput(folder.path));
  InputReport report;
  absl::StatusOr<MeshSequence> sequence =
      ReadSequence(input, {.limits = limits, .num_threads = 1}, {}, &report);
  if (!sequence.ok()) return WithoutFolder(sequence.status(), folder.path);
  for (InputNote& jump : DescribeJumps(FindFrameJumps(*sequence), report.frame_names)) {
    report.notes.push_back(std::move(jump));
  }
  if (!name.empty()) {
    std::vector<Eigen::Matrix3Xf> frames;
    for (int t = 0; t < sequence->num_frames(); ++t) frames.push_back(sequence->frame(t));
    sequence = MeshSequence::Create(
        sequence->topology(), std::move(frames),
        {.name = name, .frame_rate = sequence->frame_rate(), .appearance = sequence->appearance()});
    if (!sequence.ok()) return sequence.status();
  }
  return Store(gateway, caller, *sequence, report.notes);
}

absl::StatusOr<std::string> StoreExample(CallGateway* gateway, const ForeignCaller& caller) {
  PLEAT_ASSIGN_OR_RETURN(const Performer performer,
                         GeneratePerformer({.num_frames = 120, .num_vertices = 4000}));
  return Store(gateway, caller, performer.sequence, {});
}

}  // namespace pleat
