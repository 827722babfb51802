#include "pleat/formats/sequence_file.h"
#include "pleat/v1/compressed_sequence_service.grpc.pb.h"
#include "server/handlers/mock_server.h"
#include "support/fake_training.h"

namespace pleat {
namespace {

using ::testing::Return;

class DecodeFramesTest : public testing::Test {
 protected:
  grpc::Status Decode(const std::string& id, std::string* shape, std::string* positions) {
    const auto stub = v1::CompressedSequenceService::NewStub(mock_.channel);
    v1::DecodeFramesRequest request;
    request.set_id(id);
    request.set_begin_frame(3);
    request.set_end_frame(5);
    const auto reader = stub->DecodeFrames(&mock_.call, request);
    v1::DecodeFramesResponse part;
    while (reader->Read(&part)) {
      *shape += part.shape();
      if (!part.has_positions()) continue;
      frames_.push_back(part.positions().frame());
      *positions += part.positions().xyz();
    }
    return reader->Finish();
  }
  void ExpectSession(std::unique_ptr<MockDecodeSession> session) {
    using ::testing::AllOf;
    using ::testing::Field;
    EXPECT_CALL(mock_.service.mock_compressed_sequences,
                OpenDecode(kId, AllOf(Field(&FrameRange::begin, 3), Field(&FrameRange::end, 5))))
        .WillOnce(Return(testing::ByMove(std::move(session))));
  }

  MockServer mock_;
  const MeshSequence tube_ = MakeSwayingTube(2, "large", 500, 100);  // 600 kB per frame
  std::vector<int> frames_;
};

TEST_F(DecodeFramesTest, SendsShapeAndFramesInPieces) {
  auto session = std::make_unique<testing::StrictMock<MockDecodeSession>>();
  EXPECT_CALL(*session, Shape).WillOnce(Return(MakeSwayingTube(1, "large", 500, 100)));
  EXPECT_CALL(*session, Next)
      .WillOnce(Return(&tube_.frame(0)))
      .WillOnce(Return(&tube_.frame(1)))
      .WillOnce(Return(nullptr));
  ExpectSession(std::move(session));
  std::string shape, positions;
  EXPECT_TRUE(Decode(kId, &shape, &positions).ok());
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence first, DecodeSequence(shape));
  EXPECT_TRUE(first.topology() == tube_.topology());
  EXPECT_THAT(frames_, testing::ElementsAre(3, 3, 4, 4));
  ASSERT_EQ(positions.size(), 2u * 3 * 4 * tube_.num_vertices());
  for (int t = 0; t < 2; ++t) {
    const Eigen::Map<const Eigen::Matrix3Xf> frame(
        reinterpret_cast<const float*>(positions.data()) + t * 3 * tube_.num_vertices(), 3,
        tube_.num_vertices());
    EXPECT_TRUE(frame == tube_.frame(t));
  }
}

TEST_F(DecodeFramesTest, AnIdThatIsNoneNeverReachesTheService) {
  std::string shape, positions;
  EXPECT_THAT(Decode(kPathId, &shape, &positions),
              HasGrpcStatus(grpc::StatusCode::INVALID_ARGUMENT, testing::HasSubstr("id")));
}

TEST_F(DecodeFramesTest, PassesOnThatAFrameIsDamaged) {
  auto session = std::make_unique<testing::StrictMock<MockDecodeSession>>();
  EXPECT_CALL(*session, Shape).WillOnce(Return(MakeSwayingTube(1)));
  EXPECT_CALL(*session, Next).WillOnce(Return(absl::DataLossError("frame 3 is damaged")));
  ExpectSession(std::move(session));
  std::string shape, positions;
  EXPECT_THAT(Decode(kId, &shape, &positions),
              HasGrpcStatus(grpc::StatusCode::DATA_LOSS, "frame 3 is damaged"));
  EXPECT_TRUE(positions.empty());
}

}  // namespace
}  // namespace pleat
