#include "cli/show/input_notes_json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace pleat {
namespace {

TEST(InputNotesJsonTest, EveryFieldIsThereAndTheFrameWhereThereIsOne) {
  const auto json =
      InputNotesJson({{.severity = NoteSeverity::kWarning, .kind = "a", .text = "\xff", .frame = 3},
                      {.kind = "b", .text = "two"}});
  EXPECT_EQ(json.dump(),
            "[{\"severity\":\"warning\",\"kind\":\"a\",\"text\":\"\xef\xbf\xbd\",\"frame\":3},"
            "{\"severity\":\"note\",\"kind\":\"b\",\"text\":\"two\"}]");
  EXPECT_EQ(InputNotesJson({}).dump(), "[]");
}

}  // namespace
}  // namespace pleat
