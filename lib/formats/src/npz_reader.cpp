#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "alembic_time.h"
#include "npz_arrays.h"
#include "pleat/base/foreign_file.h"
#include "pleat/base/status.h"
#include "pleat/formats/npz.h"

namespace pleat {
namespace {

constexpr char kNpyStart[] = "\x93NUMPY";
constexpr uint64_t kHeaderRoom = 65536 + 12;

// The names that a program may use for positions are not told apart by their shapes alone: a shape
// that is none of an animation is refused with what it should be.
absl::Status CheckPositions(const NpyArray& array, const MeshLimits& limits) {
  const size_t num_dimensions = array.shape.size();
  if (!array.is_float() || (num_dimensions != 2 && num_dimensions != 3) ||
      array.shape.back() != 3) {
    return absl::InvalidArgumentError(absl::StrCat(
        "the positions are ", DescribeNpy(array),
        "; they must be floats of shape (frames, vertices, 3), or (vertices, 3) for one frame"));
  }
  const MeshCounts counts = {.num_vertices = array.shape[num_dimensions - 2],
                             .num_frames = num_dimensions == 2 ? 1 : array.shape[0]};
  if (counts.num_vertices == 0 || counts.num_frames == 0) {
    return absl::InvalidArgumentError(
        absl::StrCat("the positions are ", DescribeNpy(array), ", which is nothing"));
  }
  return CheckSequenceCounts(counts, limits);
}

absl::Status TakePositions(const NpyArray& array, const MeshLimits& limits, NpzContents* contents) {
  PLEAT_RETURN_IF_ERROR(CheckPositions(array, limits));
  if (TakeNpyPositions(array, &contents->frames)) {
    contents->notes.push_back({.kind = "positions_rounded",
                               .text = "positions are float64; they are rounded to float32"});
  }
  return absl::OkStatus();
}

class NpzDecoder {
 public:
  NpzDecoder(NpzArrays arrays, const MeshLimits& limits)
      : arrays_(std::move(arrays)), limits_(limits) {}

  absl::StatusOr<NpzContents> Decode() {
    // Twice the limit, since it is of float32 and the array may have float64.
    const uint64_t max_bytes = 2 * limits_.max_sequence_bytes + kHeaderRoom;
    const std::vector<NpzRole>& roles = NpzRoles();
    PLEAT_ASSIGN_OR_RETURN(std::optional<NpyArray> positions, arrays_.Take(roles[0], max_bytes));
    if (!positions) {
      PLEAT_ASSIGN_OR_RETURN(positions, arrays_.TakeOnlyAnimation(max_bytes));
    }
    if (!positions) {
      return absl::InvalidArgumentError(
          absl::StrCat("no array is known as the positions; there are ", arrays_.List(),
                       "; say which with --key positions=NAME"));
    }
    PLEAT_RETURN_IF_ERROR(TakePositions(*positions, limits_, &contents_));
    PLEAT_RETURN_IF_ERROR(ReadTopology(roles[1], roles[2]));
    PLEAT_RETURN_IF_ERROR(ReadTimes(roles[3]));
    PLEAT_RETURN_IF_ERROR(ReadName());
    AddNotes();
    return std::move(contents_);
  }

 private:
  absl::StatusOr<std::optional<std::vector<int32_t>>> IntegersOf(
      const std::string& name, const std::optional<NpyArray>& array, size_t num_dimensions) {
    if (!array) return std::optional<std::vector<int32_t>>();
    if (!array->is_integer() || array->shape.size() != num_dimensions) {
      return absl::InvalidArgumentError(
          absl::StrCat("the ", name, " are ", DescribeNpy(*array), "; they must be integers in ",
                       num_dimensions, num_dimensions == 1 ? " dimension" : " dimensions"));
    }
    absl::StatusOr<std::vector<int32_t>> values = NpyIntegers(*array);
    if (!values.ok()) return WithContext(name, values.status());
    return std::optional(*std::move(values));
  }

  absl::Status ReadTopology(const NpzRole& faces_role, const NpzRole& sizes_role) {
    const uint64_t max_bytes = limits_.max_document_bytes;
    PLEAT_ASSIGN_OR_RETURN(const std::optional<NpyArray> faces,
                           arrays_.Take(faces_role, max_bytes));
    if (!faces) return absl::OkStatus();
    PLEAT_ASSIGN_OR_RETURN(const std::optional<NpyArray> sizes,
                           arrays_.Take(sizes_role, max_bytes));
    const bool is_table = faces->shape.size() == 2;
    PLEAT_ASSIGN_OR_RETURN(std::optional<std::vector<int32_t>> corners,
                           IntegersOf("faces", faces, is_table ? 2 : 1));
    PLEAT_ASSIGN_OR_RETURN(std::optional<std::vector<int32_t>> face_sizes,
                           IntegersOf("face_sizes", sizes, 1));
    if (!is_table && !face_sizes) {
      return absl::InvalidArgumentError(
          "the faces are one list of corners, so there must be an array 'face_sizes'");
    }
    if (is_table) face_sizes = SizesOfRows(faces->shape[0], faces->shape[1], &*corners);
    return MakeTopology(*std::move(corners), *std::move(face_sizes));
  }

  // Rows that are shorter than the table end in -1.
  std::vector<int32_t> SizesOfRows(int64_t num_rows, int64_t width, std::vector<int32_t>* corners) {
    std::vector<int32_t> sizes;
    size_t end = 0;
    for (int64_t row = 0; row < num_rows && width > 0; ++row) {
      int64_t size = width;
      const int32_t* first = corners->data() + row * width;
      while (size > 0 && first[size - 1] == -1) --size;
      std::copy(first, first + size, corners->begin() + static_cast<std::ptrdiff_t>(end));
      end += static_cast<size_t>(size);
      sizes.push_back(static_cast<int32_t>(size));
    }
    corners->resize(end);
    return sizes;
  }

  absl::Status MakeTopology(std::vector<int32_t> corners, std::vector<int32_t> sizes) {
    PLEAT_RETURN_IF_ERROR(CheckCounts({.num_faces = static_cast<int64_t>(sizes.size())}, limits_));
    const auto num_vertices = static_cast<int>(contents_.frames[0].cols());
    const size_t num_left_out = LeaveOutFlatFaces(&corners, &sizes);
    if (!corners.empty() && std::ranges::min(corners) == 1 &&
        std::ranges::max(corners) == num_vertices) {
      return absl::InvalidArgumentError(
          "the faces count their vertices from 1; write them counted from 0");
    }
    absl::StatusOr<Topology> topology =
        Topology::Create(num_vertices, std::move(corners), std::move(sizes));
    if (!topology.ok()) return WithContext("the faces", topology.status());
    contents_.topology = *std::move(topology);
    if (num_left_out == 0) return ReadAppearance();
    contents_.notes.push_back(
        {.kind = "faces_left_out",
         .text = absl::StrCat(num_left_out, num_left_out == 1 ? " face" : " faces",
                              " with fewer than 3 corners left out, and with that the texture "
                              "coordinates and materials")});
    return absl::OkStatus();
  }

  static size_t LeaveOutFlatFaces(std::vector<int32_t>* corners, std::vector<int32_t>* sizes) {
    uint64_t num_corners = 0;
    for (const int32_t size : *sizes) {
      // What cannot be is left for Topology to name.
      if (size < 0 || (num_corners += static_cast<uint64_t>(size)) > corners->size()) return 0;
    }
    size_t from = 0, to = 0, num_kept = 0;
    for (const int32_t size : *sizes) {
      const auto count = static_cast<size_t>(size);
      if (size >= 3) {
        std::copy_n(corners->begin() + static_cast<std::ptrdiff_t>(from), count,
                    corners->begin() + static_cast<std::ptrdiff_t>(to));
        to += count;
        (*sizes)[num_kept++] = size;
      }
      from += count;
    }
    const size_t num_left_out = sizes->size() - num_kept;
    if (num_left_out > 0) {
      corners->resize(to);
      sizes->resize(num_kept);
    }
    return num_left_out;
  }

  absl::StatusOr<std::vector<int32_t>> ReadList(const std::string& name) {
    PLEAT_ASSIGN_OR_RETURN(const std::optional<NpyArray> array,
                           arrays_.TakeNamed(name, limits_.max_document_bytes));
    PLEAT_ASSIGN_OR_RETURN(std::optional<std::vector<int32_t>> list, IntegersOf(name, array, 1));
    return list ? *std::move(list) : std::vector<int32_t>();
  }

  absl::Status ReadAppearance() {
    MeshAppearance& appearance = contents_.appearance;
    PLEAT_ASSIGN_OR_RETURN(const std::optional<NpyArray> texcoords,
                           arrays_.TakeNamed("texcoords", limits_.max_document_bytes));
    if (texcoords) {
      if (!texcoords->is_float() || texcoords->shape.size() != 2 || texcoords->shape[1] != 2) {
        return absl::InvalidArgumentError(absl::StrCat("the texcoords are ",
                                                       DescribeNpy(*texcoords),
                                                       "; they must be floats of shape (K, 2)"));
      }
      const std::vector<float> values = NpyFloats(*texcoords);
      for (size_t i = 0; i + 1 < values.size(); i += 2) {
        appearance.texcoords.emplace_back(values[i], values[i + 1]);
      }
    }
    PLEAT_ASSIGN_OR_RETURN(appearance.corner_texcoords, ReadList("corner_texcoords"));
    PLEAT_ASSIGN_OR_RETURN(appearance.face_materials, ReadList("face_materials"));
    PLEAT_ASSIGN_OR_RETURN(appearance.material_names, ReadTexts("material_names"));
    PLEAT_ASSIGN_OR_RETURN(const std::vector<std::string> library, ReadTexts("material_library"));
    if (!library.empty()) appearance.material_library = library[0];
    return absl::OkStatus();
  }

  absl::StatusOr<std::vector<std::string>> ReadTexts(const std::string& name) {
    PLEAT_ASSIGN_OR_RETURN(const std::optional<NpyArray> array,
                           arrays_.TakeNamed(name, limits_.max_document_bytes));
    if (!array) return std::vector<std::string>();
    if (array->kind == 'U' || array->kind == 'S') return NpyTexts(*array);
    return absl::InvalidArgumentError(
        absl::StrCat("array '", name, "' is ", DescribeNpy(*array), "; it must be text"));
  }

  absl::Status ReadTimes(const NpzRole& role) {
    PLEAT_ASSIGN_OR_RETURN(const std::optional<NpyArray> rate,
                           arrays_.Take(role, limits_.max_document_bytes));
    if (rate && (rate->is_integer() || rate->is_float())) {
      const int64_t count = rate->num_items();
      const double first = count > 0 ? NpyNumber(*rate, 0) : 0;
      const double second = count == 2 ? NpyNumber(*rate, 1) : 1;
      constexpr double kLargest = std::numeric_limits<int32_t>::max();
      const bool is_fraction = first >= 1 && first <= kLargest && first == std::floor(first) &&
                               second >= 1 && second <= kLargest && second == std::floor(second);
      if (count == 2 && is_fraction && first / second <= 10'000) {
        contents_.frame_rate = {static_cast<int32_t>(first), static_cast<int32_t>(second)};
      } else if (count == 1 && first > 0) {
        contents_.frame_rate = RateOfStep(1 / first);
      }
    }
    if (rate && !contents_.frame_rate) {
      contents_.notes.push_back({.severity = NoteSeverity::kWarning,
                                 .kind = "times_invalid",
                                 .text = absl::StrCat("the frame rate is ", DescribeNpy(*rate),
                                                      ", which is no rate; say --fps")});
    }
    PLEAT_ASSIGN_OR_RETURN(const std::optional<NpyArray> first,
                           arrays_.TakeNamed("first_frame", limits_.max_document_bytes));
    if (first && first->num_items() == 1 && (first->is_integer() || first->is_float()) &&
        std::isfinite(NpyNumber(*first, 0))) {
      contents_.first_frame = NpyNumber(*first, 0);
    }
    return absl::OkStatus();
  }

  absl::Status ReadName() {
    PLEAT_ASSIGN_OR_RETURN(const std::vector<std::string> name, ReadTexts("name"));
    if (!name.empty()) contents_.name = name[0];
    return absl::OkStatus();
  }

  void AddNotes() {
    if (!arrays_.renamed().empty()) {
      contents_.notes.push_back(
          {.kind = "arrays_taken",
           .text = absl::StrCat("read are the ", absl::StrJoin(arrays_.renamed(), ", the "),
                                "; say --key for others")});
    }
    const std::vector<std::string> not_taken = arrays_.NotTaken();
    if (not_taken.empty()) return;
    contents_.notes.push_back(
        {.kind = "not_kept",
         .text = absl::StrCat("not kept: the arrays ", absl::StrJoin(not_taken, ", "))});
  }

  NpzArrays arrays_;
  const MeshLimits& limits_;
  NpzContents contents_;
};

absl::StatusOr<NpzContents> DecodeArrays(std::string_view bytes, const NpzKeys& keys,
                                         const MeshLimits& limits) {
  if (bytes.empty()) return absl::InvalidArgumentError("the file is empty");
  if (bytes.starts_with(kNpyStart)) {
    PLEAT_ASSIGN_OR_RETURN(const NpyArray array, ParseNpy(bytes));
    NpzContents contents;
    PLEAT_RETURN_IF_ERROR(TakePositions(array, limits, &contents));
    return contents;
  }
  if (!bytes.starts_with("PK")) {
    const std::string other = DescribeForeignBytes(bytes);
    return absl::InvalidArgumentError(other.empty()
                                          ? "neither an array (.npy) nor an archive (.npz) of NumPy"
                                          : absl::StrCat("this is ", other));
  }
  PLEAT_ASSIGN_OR_RETURN(NpzArrays arrays, NpzArrays::Open(bytes, keys));
  return NpzDecoder(std::move(arrays), limits).Decode();
}

}  // namespace

absl::StatusOr<NpzContents> DecodeNpz(std::string_view bytes, const std::string& file,
                                      const NpzKeys& keys, const MeshLimits& limits) {
  return WithContext(file, DecodeArrays(bytes, keys, limits));
}

absl::Status SetNpzKey(const std::string& assignment, NpzKeys* keys) {
  const size_t equals = assignment.find('=');
  std::vector<std::string> known;
  for (const NpzRole& role : NpzRoles()) {
    known.emplace_back(role.name);
    if (equals == std::string::npos || assignment.substr(0, equals) != role.name ||
        equals + 1 == assignment.size()) {
      continue;
    }
    keys->*role.key = assignment.substr(equals + 1);
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(
      absl::StrCat("'", assignment, "' is no key; write ROLE=NAME with one of the roles ",
                   absl::StrJoin(known, ", ")));
}

}  // namespace pleat
