#include "support/mock_services.h"

namespace pleat {

template class MockUpload<SequenceInfo>;
template class MockUpload<CompressedSequenceInfo>;

MockDownload::MockDownload() = default;
MockDownload::~MockDownload() = default;
MockSequenceService::MockSequenceService() = default;
MockSequenceService::~MockSequenceService() = default;
MockJobSubscription::MockJobSubscription() = default;
MockJobSubscription::~MockJobSubscription() = default;
MockJobService::MockJobService() = default;
MockJobService::~MockJobService() = default;
MockModelService::MockModelService() = default;
MockModelService::~MockModelService() = default;
MockPoseSession::MockPoseSession() = default;
MockPoseSession::~MockPoseSession() = default;
MockClipSession::MockClipSession() = default;
MockClipSession::~MockClipSession() = default;
MockPoseStream::MockPoseStream() = default;
MockPoseStream::~MockPoseStream() = default;
MockPoseService::MockPoseService() = default;
MockPoseService::~MockPoseService() = default;
MockDecodeSession::MockDecodeSession() = default;
MockDecodeSession::~MockDecodeSession() = default;
MockCompressedSequenceService::MockCompressedSequenceService() = default;
MockCompressedSequenceService::~MockCompressedSequenceService() = default;

}  // namespace pleat

template class ::testing::StrictMock<pleat::MockSequenceService>;
template class ::testing::StrictMock<pleat::MockJobService>;
template class ::testing::StrictMock<pleat::MockModelService>;
template class ::testing::StrictMock<pleat::MockPoseService>;
template class ::testing::StrictMock<pleat::MockCompressedSequenceService>;
