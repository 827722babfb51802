#include "stored_infos.h"

#include "page_token.h"

namespace pleat {

EntryLife LifeOf(const CatalogEntry& entry) {
  EntryLife life;
  if (entry.created_unix_ms > 0) life.created = absl::FromUnixMillis(entry.created_unix_ms);
  if (entry.expires_unix_ms > 0) life.expires = absl::FromUnixMillis(entry.expires_unix_ms);
  life.pinned = entry.pinned;
  return life;
}

absl::StatusOr<EntryPage> ReadEntryPage(StoredFiles* files, EntryKind kind,
                                        const PageRequest& request) {
  PLEAT_ASSIGN_OR_RETURN(const std::string secret, files->store().catalog().Secret());
  const PageTokens tokens(secret, files->project());
  PLEAT_ASSIGN_OR_RETURN(const int max_items, MaxItemsOf(request));
  PLEAT_ASSIGN_OR_RETURN(const int64_t after, tokens.Parse(kind, request.token));
  EntryPage page;
  // One more, which says whether there is a next page.
  PLEAT_ASSIGN_OR_RETURN(page.entries, files->catalog().ListPage(kind, after, max_items + 1));
  if (page.entries.size() > static_cast<size_t>(max_items)) {
    page.entries.pop_back();
    page.next_token = tokens.Make(kind, page.entries.back().position);
  }
  return page;
}

}  // namespace pleat
