#include "pleat/observe/logging.h"

#include <google/protobuf/stubs/logging.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/utf8.h"
#include "pleat/observe/request_scope.h"

namespace pleat {
namespace {

// The message on one line, whatever is in it: an id from outside must not forge a line.
class TextMessage final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&,
              spdlog::memory_buf_t& out) override {
    const std::string text = EscapeControls({message.payload.data(), message.payload.size()});
    out.append(text.data(), text.data() + text.size());
    const RequestTag& request = CurrentRequest();
    if (request.id.empty()) return;
    const std::string mark =
        absl::StrCat(" [request ", request.id, request.project.empty() ? "" : ", project ",
                     request.project, "]");
    out.append(mark.data(), mark.data() + mark.size());
  }
  std::unique_ptr<custom_flag_formatter> clone() const override {
    return std::make_unique<TextMessage>();
  }
};

// Members of a JSON object, with commas before them, when the thread works for a request. Ids and
// names of projects have no character that JSON escapes (RequestIdOr, CheckProjectName).
class JsonRequest final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg&, const std::tm&, spdlog::memory_buf_t& out) override {
    const RequestTag& request = CurrentRequest();
    if (request.id.empty()) return;
    std::string member = absl::StrCat(",\"request\":\"", request.id, "\"");
    if (!request.project.empty()) {
      absl::StrAppend(&member, ",\"project\":\"", request.project, "\"");
    }
    out.append(member.data(), member.data() + member.size());
  }
  std::unique_ptr<custom_flag_formatter> clone() const override {
    return std::make_unique<JsonRequest>();
  }
};

// The message with everything escaped that JSON does not allow in a string (RFC 8259, section 7).
class JsonMessage final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&,
              spdlog::memory_buf_t& out) override {
    for (const char c : ToValidUtf8({message.payload.data(), message.payload.size()})) {
      const auto byte = static_cast<unsigned char>(c);
      if (c == '"' || c == '\\') {
        out.push_back('\\');
        out.push_back(c);
      } else if (byte < 0x20) {
        constexpr char kDigits[] = "0123456789abcdef";
        for (const char part : {'\\', 'u', '0', '0', kDigits[byte >> 4], kDigits[byte & 15]}) {
          out.push_back(part);
        }
      } else {
        out.push_back(c);
      }
    }
  }
  std::unique_ptr<custom_flag_formatter> clone() const override {
    return std::make_unique<JsonMessage>();
  }
};

void LogForProtobuf(google::protobuf::LogLevel, const char*, int, const std::string& message) {
  spdlog::debug("protobuf: {}", message);
}

}  // namespace

absl::Status ConfigureLogging(const LoggingOptions& options) {
  const spdlog::level::level_enum level = spdlog::level::from_str(options.level);
  if (level == spdlog::level::off && options.level != "off") {
    return absl::InvalidArgumentError(
        absl::StrCat("unknown log level '", options.level,
                     "'; choose trace, debug, info, warning, error or off"));
  }
  auto logger =
      std::make_shared<spdlog::logger>("pleat", std::make_shared<spdlog::sinks::stderr_sink_mt>());
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  if (options.json) {
    formatter->add_flag<JsonMessage>('*').add_flag<JsonRequest>('&').set_pattern(
        R"({"time":"%Y-%m-%dT%H:%M:%S.%e%z","level":"%l","thread":%t,"message":"%*"%&})");
  } else {
    formatter->add_flag<TextMessage>('*').set_pattern("%Y-%m-%d %H:%M:%S.%e %L %*");
  }
  logger->set_formatter(std::move(formatter));
  logger->set_level(level);
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
  google::protobuf::SetLogHandler(&LogForProtobuf);
  return absl::OkStatus();
}

}  // namespace pleat
