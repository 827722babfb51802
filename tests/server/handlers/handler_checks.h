// What the tests of handlers share: handlers alone, with mocks of the services.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "pleat/handlers/unary_handlers.h"
#include "support/mock_services.h"
#include "support/status_matchers.h"

namespace pleat {

inline const std::string kId(64, 'a');
inline const std::string kPathId = "../" + std::string(61, 'a');  // as long as an id

// The context of a handler; every call of a service that a test does not expect fails it.
struct MockContext {
  testing::StrictMock<MockSequenceService> sequences;
  testing::StrictMock<MockJobService> jobs;
  testing::StrictMock<MockModelService> models;
  testing::StrictMock<MockPoseService> poses;
  testing::StrictMock<MockCompressedSequenceService> compressed_sequences;
  HandlerContext context;

  MockContext() {
    context.sequences = &sequences;
    context.jobs = &jobs;
    context.models = &models;
    context.poses = &poses;
    context.compressed_sequences = &compressed_sequences;
  }
};

}  // namespace pleat
