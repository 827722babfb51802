// Token files, which anybody with the rights to the data folder may have edited, and the text that
// a caller shows as its token.
#include <cstddef>
#include <cstdint>
#include <string>

#include "pleat/identity/token.h"
#include "pleat/identity/token_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  pleat::ParseTokenText(bytes);
  const auto tokens = pleat::ParseTokens(bytes);
  if (!tokens.ok()) return 0;
  // What reads, writes to a file that reads back to the same.
  const std::string written = pleat::FormatTokens(*tokens);
  const auto again = pleat::ParseTokens(written);
  if (!again.ok() || pleat::FormatTokens(*again) != written) __builtin_trap();
  return 0;
}
