// What handlers of one kind have in common, whatever they get, list or delete. The file of each
// handler names it:
//
//   using DeleteModelCase = HandlerCase<DeleteModel, &MockContext::models>;
//   INSTANTIATE_TYPED_TEST_SUITE_P(DeleteModel, DeleteHandlerTest, DeleteModelCase);
#pragma once

#include <string>
#include <type_traits>
#include <vector>

#include "server/handlers/handler_checks.h"

namespace pleat {

// A unary handler and the service that it uses. The cases of GetHandlerTest and ListHandlerTest
// derive from it and add Item and Items, which give what is in a response.
template <auto kHandler, auto kService>
struct HandlerCase;
template <typename RequestType, typename ResponseType, typename Service,
          absl::Status (*kHandler)(HandlerContext&, const RequestType&, ResponseType*),
          Service MockContext::*kService>
struct HandlerCase<kHandler, kService> {
  using Request = RequestType;
  using Response = ResponseType;
  static Service& ServiceOf(MockContext& mock) { return mock.*kService; }
  static absl::Status Handle(MockContext& mock, const Request& request, Response* response) {
    return kHandler(mock.context, request, response);
  }
};

template <typename Case>
class HandlerTest : public testing::Test {
 protected:
  auto& service() { return Case::ServiceOf(mock_); }
  absl::Status Handle(const std::string& id) {
    typename Case::Request request;
    request.set_id(id);
    return Case::Handle(mock_, request, &response_);
  }
  void ExpectIdsThatAreNoneAreRefused() {
    for (const std::string& id : {std::string(), std::string("abc"), kPathId}) {
      EXPECT_THAT(Handle(id),
                  HasStatus(absl::StatusCode::kInvalidArgument, testing::HasSubstr("id")));
    }
  }

  MockContext mock_;
  typename Case::Response response_;
};

template <typename Case>
class DeleteHandlerTest : public HandlerTest<Case> {};
TYPED_TEST_SUITE_P(DeleteHandlerTest);

TYPED_TEST_P(DeleteHandlerTest, PassesOnHowItEnded) {
  EXPECT_CALL(this->service(), Delete(kId))
      .WillOnce(testing::Return(absl::OkStatus()))
      .WillOnce(testing::Return(absl::NotFoundError("none")));
  EXPECT_THAT(this->Handle(kId), IsOk());
  EXPECT_THAT(this->Handle(kId), HasStatus(absl::StatusCode::kNotFound, "none"));
}

TYPED_TEST_P(DeleteHandlerTest, AnIdThatIsNoneNeverReachesTheService) {
  this->ExpectIdsThatAreNoneAreRefused();
}

REGISTER_TYPED_TEST_SUITE_P(DeleteHandlerTest, PassesOnHowItEnded,
                            AnIdThatIsNoneNeverReachesTheService);

template <typename Case>
class GetHandlerTest : public HandlerTest<Case> {};
TYPED_TEST_SUITE_P(GetHandlerTest);

TYPED_TEST_P(GetHandlerTest, SaysWhatTheServiceKnows) {
  typename std::decay_t<decltype(this->service().Get(kId))>::value_type info;
  info.id = kId;
  info.name = "tube";
  info.size_bytes = 123;
  EXPECT_CALL(this->service(), Get(kId)).WillOnce(testing::Return(info));
  ASSERT_THAT(this->Handle(kId), IsOk());
  const auto& item = TypeParam::Item(this->response_);
  EXPECT_EQ(item.id(), kId);
  EXPECT_EQ(item.name(), "tube");
  EXPECT_EQ(item.size_bytes(), 123u);
}

TYPED_TEST_P(GetHandlerTest, AnIdThatIsNoneNeverReachesTheService) {
  this->ExpectIdsThatAreNoneAreRefused();
}

TYPED_TEST_P(GetHandlerTest, PassesOnThatThereIsNone) {
  EXPECT_CALL(this->service(), Get(kId)).WillOnce(testing::Return(absl::NotFoundError("none")));
  EXPECT_THAT(this->Handle(kId), HasStatus(absl::StatusCode::kNotFound, "none"));
}

REGISTER_TYPED_TEST_SUITE_P(GetHandlerTest, SaysWhatTheServiceKnows,
                            AnIdThatIsNoneNeverReachesTheService, PassesOnThatThereIsNone);

template <typename Case>
class PinHandlerTest : public HandlerTest<Case> {};
TYPED_TEST_SUITE_P(PinHandlerTest);

TYPED_TEST_P(PinHandlerTest, PassesOnWhatIsAskedAndHowItEnded) {
  typename TypeParam::Request request;
  request.set_id(kId);
  for (const bool pinned : {true, false}) {
    request.set_pinned(pinned);
    EXPECT_CALL(this->service(), SetPinned(kId, pinned))
        .WillOnce(testing::Return(absl::OkStatus()))
        .WillOnce(testing::Return(absl::NotFoundError("none")));
    EXPECT_THAT(TypeParam::Handle(this->mock_, request, &this->response_), IsOk());
    EXPECT_THAT(TypeParam::Handle(this->mock_, request, &this->response_),
                HasStatus(absl::StatusCode::kNotFound, "none"));
  }
}

TYPED_TEST_P(PinHandlerTest, AnIdThatIsNoneNeverReachesTheService) {
  this->ExpectIdsThatAreNoneAreRefused();
}

REGISTER_TYPED_TEST_SUITE_P(PinHandlerTest, PassesOnWhatIsAskedAndHowItEnded,
                            AnIdThatIsNoneNeverReachesTheService);

template <typename Case>
class ListHandlerTest : public HandlerTest<Case> {
 protected:
  absl::Status List(int page_size, const std::string& page_token) {
    typename Case::Request request;
    request.set_page_size(page_size);
    request.set_page_token(page_token);
    this->response_.Clear();
    return Case::Handle(this->mock_, request, &this->response_);
  }
  std::vector<std::string> Ids() const {
    std::vector<std::string> ids;
    for (const auto& item : Case::Items(this->response_)) ids.push_back(item.id());
    return ids;
  }
  static std::string Id(char letter) { return std::string(64, letter); }
};
TYPED_TEST_SUITE_P(ListHandlerTest);

TYPED_TEST_P(ListHandlerTest, GivesThePageOfTheService) {
  typename std::decay_t<decltype(this->service().ListPage({}))>::value_type page;
  page.items.resize(2);
  page.items[0].id = this->Id('a');
  page.items[1].id = this->Id('b');
  page.next_token = "the next";
  EXPECT_CALL(this->service(), ListPage(testing::AllOf(testing::Field(&PageRequest::size, 2),
                                                       testing::Field(&PageRequest::token, "one"))))
      .WillOnce(testing::Return(page));
  ASSERT_THAT(this->List(2, "one"), IsOk());
  EXPECT_THAT(this->Ids(), testing::ElementsAre(this->Id('a'), this->Id('b')));
  EXPECT_EQ(this->response_.next_page_token(), "the next");
}

TYPED_TEST_P(ListHandlerTest, TheLastPageHasNoToken) {
  typename std::decay_t<decltype(this->service().ListPage({}))>::value_type page;
  EXPECT_CALL(this->service(), ListPage(testing::Field(&PageRequest::token, "")))
      .WillOnce(testing::Return(page));
  ASSERT_THAT(this->List(0, ""), IsOk());
  EXPECT_THAT(this->Ids(), testing::IsEmpty());
  EXPECT_EQ(this->response_.next_page_token(), "");
}

TYPED_TEST_P(ListHandlerTest, PassesOnWhyItCannot) {
  EXPECT_CALL(this->service(), ListPage)
      .WillOnce(testing::Return(absl::InvalidArgumentError("page_token is no token")));
  EXPECT_THAT(this->List(2, "no such page"),
              HasStatus(absl::StatusCode::kInvalidArgument, "page_token is no token"));
}

REGISTER_TYPED_TEST_SUITE_P(ListHandlerTest, GivesThePageOfTheService, TheLastPageHasNoToken,
                            PassesOnWhyItCannot);

}  // namespace pleat
