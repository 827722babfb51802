// The five services as gMock classes, and the sessions that they hand out. Constructors and
// destructors are compiled in one place: they instantiate the whole of gMock for every method.
#pragma once

#include <gmock/gmock.h>

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "pleat/service/compressed_sequence_service.h"
#include "pleat/service/job_service.h"
#include "pleat/service/model_service.h"
#include "pleat/service/pose_service.h"
#include "pleat/service/sequence_service.h"

namespace pleat {

template <typename Info>
class MockUpload : public ContentUpload<Info> {
 public:
  MOCK_METHOD(bool, complete, (), (const, override));
  MOCK_METHOD(absl::Status, Append, (std::string_view bytes), (override));
  MOCK_METHOD(uint64_t, received_bytes, (), (const, override));
  MOCK_METHOD(absl::StatusOr<Info>, Finish, (), (override));
};
extern template class MockUpload<SequenceInfo>;
extern template class MockUpload<CompressedSequenceInfo>;

class MockDownload : public ContentDownload {
 public:
  MockDownload();
  ~MockDownload() override;
  MOCK_METHOD(uint64_t, size_bytes, (), (const, override));
  MOCK_METHOD(absl::StatusOr<std::string>, Next, (), (override));
};

class MockSequenceService : public SequenceService {
 public:
  MockSequenceService();
  ~MockSequenceService() override;
  MOCK_METHOD(absl::StatusOr<SequenceInfo>, Upload,
              (const MeshSequence&, const Progress&, absl::Duration ttl), (override));
  MOCK_METHOD(absl::StatusOr<SequenceInfo>, Get, (const std::string& id), (override));
  MOCK_METHOD(absl::StatusOr<Page<SequenceInfo>>, ListPage, (const PageRequest& request),
              (override));
  MOCK_METHOD(absl::Status, Delete, (const std::string& id), (override));
  MOCK_METHOD(absl::Status, SetPinned, (const std::string& id, bool pinned), (override));
  MOCK_METHOD(absl::Status, DeleteUpload, (const std::string& id), (override));
  MOCK_METHOD(absl::StatusOr<std::unique_ptr<ContentDownload>>, OpenDownload,
              (const std::string& id, uint64_t offset_bytes), (override));
  MOCK_METHOD(absl::StatusOr<UploadStatus>, QueryUpload, (const std::string& id), (override));
  MOCK_METHOD(absl::StatusOr<std::unique_ptr<SequenceUpload>>, BeginUpload,
              (const std::string& id, uint64_t size_bytes, uint64_t offset_bytes,
               absl::Duration ttl),
              (override));
};

class MockJobSubscription : public JobSubscription {
 public:
  MockJobSubscription();
  ~MockJobSubscription() override;
  MOCK_METHOD(JobUpdate, current, (), (const, override));
  MOCK_METHOD(absl::Status, status, (), (const, override));
};

class MockJobService : public JobService {
 public:
  MockJobService();
  ~MockJobService() override;
  MOCK_METHOD(absl::StatusOr<JobInfo>, CreateTraining, (const TrainingRequest& request),
              (override));
  MOCK_METHOD(absl::StatusOr<JobInfo>, CreateCompression, (const CompressionRequest& request),
              (override));
  MOCK_METHOD(absl::StatusOr<JobInfo>, Get, (const std::string& id), (override));
  MOCK_METHOD(absl::StatusOr<Page<JobInfo>>, ListPage, (const PageRequest& request), (override));
  MOCK_METHOD(absl::Status, Cancel, (const std::string& id), (override));
  MOCK_METHOD(absl::Status, Delete, (const std::string& id), (override));
  MOCK_METHOD(absl::StatusOr<std::unique_ptr<JobSubscription>>, Subscribe,
              (const std::string& id, std::function<void()> listener), (override));
};

class MockModelService : public ModelService {
 public:
  MockModelService();
  ~MockModelService() override;
  MOCK_METHOD(absl::StatusOr<ModelInfo>, Get, (const std::string& id), (override));
  MOCK_METHOD(absl::StatusOr<Page<ModelInfo>>, ListPage, (const PageRequest& request), (override));
  MOCK_METHOD(absl::Status, Delete, (const std::string& id), (override));
  MOCK_METHOD(absl::Status, SetPinned, (const std::string& id, bool pinned), (override));
  MOCK_METHOD(absl::StatusOr<std::string>, Download, (const std::string& id, const Progress&),
              (override));
  MOCK_METHOD(absl::StatusOr<std::unique_ptr<ContentDownload>>, OpenDownload,
              (const std::string& id, uint64_t offset_bytes), (override));
};

class MockPoseSession : public PoseSession {
 public:
  MockPoseSession();
  ~MockPoseSession() override;
  MOCK_METHOD(const StreamHeader&, header, (), (const, override));
  MOCK_METHOD(absl::StatusOr<EncodedFrame>, Show, (const std::vector<const Pose*>& poses),
              (override));
};

class MockClipSession : public ClipSession {
 public:
  MockClipSession();
  ~MockClipSession() override;
  MOCK_METHOD(const StreamHeader&, header, (), (const, override));
  MOCK_METHOD(bool, done, (), (const, override));
  MOCK_METHOD(int, next_frame, (), (const, override));
  MOCK_METHOD(absl::StatusOr<EncodedFrame>, Next, (), (override));
};

class MockPoseStream : public PoseStream {
 public:
  MockPoseStream();
  ~MockPoseStream() override;
  MOCK_METHOD(const StreamHeader&, header, (), (const, override));
  MOCK_METHOD(bool, HasRoom, (), (const, override));
  MOCK_METHOD(void, Push, (const LivePose& pose), (override));
  MOCK_METHOD(absl::Status, Acknowledge, (uint64_t num_replies), (override));
  MOCK_METHOD(bool, empty, (), (const, override));
  MOCK_METHOD(bool, ready, (), (const, override));
  MOCK_METHOD(void, Answer, (), (override));
};

class MockPoseService : public PoseService {
 public:
  MockPoseService();
  ~MockPoseService() override;
  using Consume = std::function<absl::Status(int frame_index, const EvaluatedFrame&)>;
  MOCK_METHOD(absl::Status, EvaluateClip, (const ClipQuery& query, const Consume& consume),
              (override));
  MOCK_METHOD(absl::StatusOr<std::unique_ptr<PoseSession>>, OpenSession,
              (const std::string& model_id, PoseSessionOptions options), (override));
  MOCK_METHOD(absl::StatusOr<std::unique_ptr<ClipSession>>, OpenClip,
              (const std::string& model_id, PoseTrack track, PoseSessionOptions options),
              (override));
  MOCK_METHOD(absl::StatusOr<std::unique_ptr<PoseStream>>, OpenStream,
              (const std::string& model_id, PoseSessionOptions options, LiveRules rules,
               LiveListener* listener),
              (override));
};

class MockDecodeSession : public DecodeSession {
 public:
  MockDecodeSession();
  ~MockDecodeSession() override;
  MOCK_METHOD(absl::StatusOr<MeshSequence>, Shape, (), (override));
  MOCK_METHOD(absl::StatusOr<const Eigen::Matrix3Xf*>, Next, (), (override));
};

class MockCompressedSequenceService : public CompressedSequenceService {
 public:
  MockCompressedSequenceService();
  ~MockCompressedSequenceService() override;
  MOCK_METHOD(absl::StatusOr<CompressedSequenceInfo>, Upload,
              (const std::string& file, const Progress&, absl::Duration ttl), (override));
  MOCK_METHOD(absl::StatusOr<CompressedSequenceInfo>, Get, (const std::string& id), (override));
  MOCK_METHOD(absl::StatusOr<Page<CompressedSequenceInfo>>, ListPage, (const PageRequest& request),
              (override));
  MOCK_METHOD(absl::Status, Delete, (const std::string& id), (override));
  MOCK_METHOD(absl::Status, SetPinned, (const std::string& id, bool pinned), (override));
  MOCK_METHOD(absl::StatusOr<std::string>, Download, (const std::string& id, const Progress&),
              (override));
  MOCK_METHOD(absl::StatusOr<std::unique_ptr<ContentDownload>>, OpenDownload,
              (const std::string& id, uint64_t offset_bytes), (override));
  MOCK_METHOD(absl::StatusOr<std::unique_ptr<CompressedSequenceUpload>>, BeginUpload,
              (const std::string& id, uint64_t size_bytes, uint64_t offset_bytes,
               absl::Duration ttl),
              (override));
  MOCK_METHOD(absl::StatusOr<std::unique_ptr<DecodeSession>>, OpenDecode,
              (const std::string& id, FrameRange range), (override));
};

}  // namespace pleat

extern template class ::testing::StrictMock<pleat::MockSequenceService>;
extern template class ::testing::StrictMock<pleat::MockJobService>;
extern template class ::testing::StrictMock<pleat::MockModelService>;
extern template class ::testing::StrictMock<pleat::MockPoseService>;
extern template class ::testing::StrictMock<pleat::MockCompressedSequenceService>;
