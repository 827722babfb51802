#include "cli/show/sheet.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "cli/exit_code.h"
#include "pleat/base/status.h"
#include "pleat/render/contact_sheet.h"

namespace pleat {
namespace {

constexpr int kMaxColumns = 200;

absl::Status CheckFrames(const std::vector<SheetRow>& rows, const std::vector<int>& frames) {
  for (const SheetRow& row : rows) {
    for (const int t : frames) {
      if (t >= 0 && t < row.sequence.num_frames()) continue;
      return absl::InvalidArgumentError(absl::StrCat("'", row.label, "' has no frame ", t,
                                                     ": it has ", row.sequence.num_frames(),
                                                     " frames, from 0"));
    }
  }
  return absl::OkStatus();
}

}  // namespace

std::vector<int> SpacedFrames(int num_frames, int count) {
  count = std::clamp(count, 1, num_frames);
  std::vector<int> frames;
  for (int i = 0; i < count; ++i) {
    frames.push_back(count == 1 ? 0
                                : static_cast<int>(std::lround(static_cast<double>(i) *
                                                               (num_frames - 1) / (count - 1))));
  }
  return frames;
}

absl::StatusOr<std::vector<int>> ParseFrameList(const std::string& text) {
  std::vector<int> frames;
  for (const absl::string_view part : absl::StrSplit(text, ',')) {
    int frame;
    if (!absl::SimpleAtoi(part, &frame) || frame < 0) {
      return UsageError(absl::StrCat("'", text, "' is not a list of frames such as 0,10,20"));
    }
    frames.push_back(frame);
  }
  if (frames.size() > kMaxColumns) {
    return UsageError(absl::StrCat(frames.size(), " frames are too many for one sheet (at most ",
                                   kMaxColumns, ")"));
  }
  return frames;
}

absl::StatusOr<std::string> RenderSheet(const std::vector<SheetRow>& rows,
                                        const SheetOptions& options) {
  std::vector<int> frames = options.frames;
  if (frames.empty()) {
    int shortest = rows.empty() ? 0 : rows[0].sequence.num_frames();
    for (const SheetRow& row : rows) shortest = std::min(shortest, row.sequence.num_frames());
    frames = SpacedFrames(shortest, std::min(options.count, kMaxColumns));
  }
  PLEAT_RETURN_IF_ERROR(CheckFrames(rows, frames));

  ContactSheetOptions sheet;
  sheet.num_columns = static_cast<int>(frames.size());
  sheet.view.width = options.tile_width;
  sheet.view.height = options.tile_height;
  sheet.view.azimuth_degrees = options.azimuth_degrees;
  std::vector<SheetTile> tiles;
  for (const int t : frames) sheet.column_titles.push_back(absl::StrCat("frame ", t));
  for (const SheetRow& row : rows) {
    sheet.row_titles.push_back(row.label);
    for (const int t : frames) {
      SheetTile tile;
      tile.positions = row.sequence.FrameAsDouble(t);
      tile.triangles = &row.sequence.topology().triangles();
      tiles.push_back(std::move(tile));
    }
  }
  PLEAT_ASSIGN_OR_RETURN(const Image image, RenderContactSheet(tiles, sheet));
  return EncodePng(image);
}

}  // namespace pleat
