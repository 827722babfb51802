// PKWARE, APPNOTE.TXT 6.3.9, sections 4.3.7 (local headers), 4.3.12 (the list), 4.3.14 to 4.3.16
// (its end, with 64 bits too) and 4.5.3 (the 64-bit sizes of a member). All offsets and sizes are
// hostile.
#include "zip_archive.h"

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/bytes.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

constexpr uint32_t kLocalMagic = 0x04034b50, kListMagic = 0x02014b50, kEndMagic = 0x06054b50,
                   kWideEndMagic = 0x06064b50, kWideLocatorMagic = 0x07064b50;
constexpr size_t kLocalBytes = 30, kListBytes = 46, kEndBytes = 22, kWideEndBytes = 56,
                 kWideLocatorBytes = 20;
constexpr size_t kMaxComment = 65535;
constexpr uint16_t kWideField = 1;  // the id of the extra field with 64-bit sizes
constexpr uint32_t kIsWide = 0xffffffff;
constexpr uint16_t kStored = 0, kDeflated = 8;
// Deflate makes at most 258 bytes of 2 bits.
constexpr uint64_t kMaxExpansion = 1032;
constexpr size_t kMaxChunk = size_t{1} << 30;  // zlib counts with 32 bits

template <typename T>
T LoadAt(std::string_view bytes, size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

absl::Status CutOff(const std::string& what) {
  return absl::DataLossError(
      absl::StrCat("the ZIP archive is damaged or cut off: ", what, "; fetch or write it again"));
}

// Takes the values that a list entry leaves to its extra field, in the order of the standard.
absl::Status ReadWideSizes(std::string_view extra, ZipMember* member) {
  uint64_t* const wanted[] = {&member->bytes, &member->compressed_bytes, &member->header};
  while (extra.size() >= 4) {
    const auto id = LoadAt<uint16_t>(extra, 0), size = LoadAt<uint16_t>(extra, 2);
    if (size > extra.size() - 4) break;
    size_t at = 4;
    for (uint64_t* value : wanted) {
      if (id != kWideField || *value != kIsWide) continue;
      if (at + 8 > size_t{4} + size) return CutOff("a member lacks its 64-bit sizes");
      *value = LoadAt<uint64_t>(extra, at);
      at += 8;
    }
    extra.remove_prefix(size_t{4} + size);
  }
  return absl::OkStatus();
}

// before: the checksum of what comes before these bytes.
uint32_t ChecksumOf(std::string_view bytes, uint32_t before = 0) {
  return static_cast<uint32_t>(
      crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

// Fills `inflated` as far as the data go. Says whether they end there; then its size fits.
bool Inflate(std::string_view data, std::string* inflated) {
  z_stream stream{};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) return false;
  size_t used = 0, made = 0;
  int result = Z_OK;
  while (result == Z_OK) {
    const size_t room_in = std::min(data.size() - used, kMaxChunk);
    const size_t room_out = std::min(inflated->size() - made, kMaxChunk);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(data.data() + used));
    stream.avail_in = static_cast<uInt>(room_in);
    stream.next_out = reinterpret_cast<Bytef*>(inflated->data() + made);
    stream.avail_out = static_cast<uInt>(room_out);
    result = inflate(&stream, Z_NO_FLUSH);
    used += room_in - stream.avail_in;
    made += room_out - stream.avail_out;
  }
  inflateEnd(&stream);
  const bool is_whole = result == Z_STREAM_END && made == inflated->size();
  inflated->resize(made);
  return is_whole;
}

std::string Deflate(std::string_view bytes) {
  z_stream stream{};
  deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  std::string data(deflateBound(&stream, bytes.size()) + 64, '\0');
  size_t used = 0, made = 0;
  int result = Z_OK;
  while (result == Z_OK) {
    const size_t room_in = std::min(bytes.size() - used, kMaxChunk);
    const size_t room_out = std::min(data.size() - made, kMaxChunk);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + used));
    stream.avail_in = static_cast<uInt>(room_in);
    stream.next_out = reinterpret_cast<Bytef*>(data.data() + made);
    stream.avail_out = static_cast<uInt>(room_out);
    result = deflate(&stream, used + room_in == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
    used += room_in - stream.avail_in;
    made += room_out - stream.avail_out;
  }
  deflateEnd(&stream);
  data.resize(made);
  return data;
}

// What a local header and an entry of the list have in common, from the version on.
void WriteCommonFields(const ZipMember& member, bool is_wide, ByteWriter* writer) {
  writer->Write(uint16_t{45});      // the version that 64-bit sizes need
  writer->Write(uint16_t{0x0800});  // the name is UTF-8
  writer->Write(member.method);
  writer->Write(uint16_t{0});             // the time 0:00
  writer->Write(uint16_t{(1 << 5) | 1});  // the first day of 1980
  writer->Write(member.crc);
  writer->Write(is_wide ? kIsWide : static_cast<uint32_t>(member.compressed_bytes));
  writer->Write(is_wide ? kIsWide : static_cast<uint32_t>(member.bytes));
  writer->Write(static_cast<uint16_t>(member.name.size()));
}

}  // namespace

absl::StatusOr<ZipArchive> ZipArchive::Open(std::string_view bytes) {
  if (!bytes.starts_with("PK")) {
    return absl::InvalidArgumentError("not a ZIP archive: it does not begin with PK");
  }
  ZipArchive archive;
  archive.bytes_ = bytes;
  // The end has a comment of any text behind it, so it is searched from the back.
  if (bytes.size() < kEndBytes) return CutOff("it has no end");
  size_t end = bytes.size() - kEndBytes;
  const size_t last = end - std::min(end, kMaxComment);
  while (LoadAt<uint32_t>(bytes, end) != kEndMagic) {
    if (end == last) return CutOff("its list of members is missing at the end");
    --end;
  }
  uint64_t num_members = LoadAt<uint16_t>(bytes, end + 10);
  uint64_t size = LoadAt<uint32_t>(bytes, end + 12), begin = LoadAt<uint32_t>(bytes, end + 16);
  if (end >= kWideLocatorBytes &&
      LoadAt<uint32_t>(bytes, end - kWideLocatorBytes) == kWideLocatorMagic) {
    const auto wide = LoadAt<uint64_t>(bytes, end - kWideLocatorBytes + 8);
    if (wide > bytes.size() || bytes.size() - wide < kWideEndBytes ||
        LoadAt<uint32_t>(bytes, wide) != kWideEndMagic) {
      return CutOff("its 64-bit end is missing");
    }
    num_members = LoadAt<uint64_t>(bytes, wide + 32);
    size = LoadAt<uint64_t>(bytes, wide + 40);
    begin = LoadAt<uint64_t>(bytes, wide + 48);
  }
  PLEAT_RETURN_IF_ERROR(archive.ReadList(begin, size, num_members));
  return archive;
}

absl::Status ZipArchive::ReadList(uint64_t begin, uint64_t size, uint64_t num_members) {
  if (begin > bytes_.size() || size > bytes_.size() - begin || num_members > size / kListBytes) {
    return CutOff("its list of members reaches beyond the end");
  }
  std::string_view list = bytes_.substr(begin, size);
  for (uint64_t i = 0; i < num_members; ++i) {
    if (list.size() < kListBytes || LoadAt<uint32_t>(list, 0) != kListMagic) {
      return CutOff(absl::StrCat("entry ", i, " of its list is none"));
    }
    ZipMember member;
    member.is_encrypted = (LoadAt<uint16_t>(list, 8) & 1) != 0;
    member.method = LoadAt<uint16_t>(list, 10);
    member.crc = LoadAt<uint32_t>(list, 16);
    member.compressed_bytes = LoadAt<uint32_t>(list, 20);
    member.bytes = LoadAt<uint32_t>(list, 24);
    member.header = LoadAt<uint32_t>(list, 42);
    const size_t name = LoadAt<uint16_t>(list, 28), extra = LoadAt<uint16_t>(list, 30),
                 comment = LoadAt<uint16_t>(list, 32);
    if (name + extra + comment > list.size() - kListBytes) {
      return CutOff(absl::StrCat("entry ", i, " of its list reaches beyond the end"));
    }
    member.name = NameToUtf8(list.substr(kListBytes, name));
    PLEAT_RETURN_IF_ERROR(ReadWideSizes(list.substr(kListBytes + name, extra), &member));
    members_.push_back(std::move(member));
    list.remove_prefix(kListBytes + name + extra + comment);
  }
  return absl::OkStatus();
}

const ZipMember* ZipArchive::Find(std::string_view name) const {
  const auto found = std::find_if(members_.rbegin(), members_.rend(),
                                  [&](const ZipMember& member) { return member.name == name; });
  return found == members_.rend() ? nullptr : &*found;
}

absl::StatusOr<std::string_view> ZipArchive::DataOf(const ZipMember& member) const {
  const uint64_t at = member.header;
  if (at > bytes_.size() || bytes_.size() - at < kLocalBytes ||
      LoadAt<uint32_t>(bytes_, at) != kLocalMagic) {
    return CutOff(absl::StrCat("no member begins at byte ", at));
  }
  const uint64_t skipped =
      kLocalBytes + LoadAt<uint16_t>(bytes_, at + 26) + LoadAt<uint16_t>(bytes_, at + 28);
  if (skipped > bytes_.size() - at || member.compressed_bytes > bytes_.size() - at - skipped) {
    return CutOff(absl::StrCat("the member at byte ", at, " reaches beyond the end"));
  }
  return bytes_.substr(at + skipped, member.compressed_bytes);
}

absl::StatusOr<std::string_view> ZipArchive::Read(const ZipMember& member, uint64_t max_bytes,
                                                  std::string* inflated) const {
  if (member.is_encrypted) return absl::InvalidArgumentError("it is encrypted: write it without");
  if (member.method != kStored && member.method != kDeflated) {
    return absl::InvalidArgumentError(
        absl::StrCat("it is compressed by method ", member.method,
                     ", which is not read: write it with numpy.savez or numpy.savez_compressed"));
  }
  PLEAT_ASSIGN_OR_RETURN(std::string_view data, DataOf(member));
  const bool is_stored = member.method == kStored;
  if (is_stored && member.bytes != data.size()) return CutOff("a stored member has two sizes");
  if (member.bytes > max_bytes || member.bytes / kMaxExpansion > data.size()) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "it declares ", member.bytes, " bytes in ", data.size(), " compressed ones; the limit is ",
        std::min(max_bytes, kMaxExpansion * data.size())));
  }
  if (!is_stored) {
    inflated->assign(member.bytes, '\0');
    if (!Inflate(data, inflated)) {
      return CutOff(absl::StrCat("after ", inflated->size(), " bytes of ", member.bytes,
                                 " a member ends, or is no deflated data"));
    }
    data = *inflated;
  }
  if (ChecksumOf(data) != member.crc) return CutOff("a checksum is wrong");
  return data;
}

std::string ZipArchive::Start(const ZipMember& member, uint64_t num_bytes) const {
  const absl::StatusOr<std::string_view> data = DataOf(member);
  if (!data.ok() || member.is_encrypted) return "";
  if (member.method == kStored) return std::string(data->substr(0, num_bytes));
  if (member.method != kDeflated) return "";
  std::string start(std::min(num_bytes, member.bytes), '\0');
  Inflate(*data, &start);
  return start;
}

void ZipWriter::Add(const std::string& name, std::span<const std::string_view> parts) {
  ZipMember member{.name = name, .header = num_bytes_};
  for (const std::string_view part : parts) {
    member.bytes += part.size();
    member.crc = ChecksumOf(part, member.crc);
  }
  member.compressed_bytes = member.bytes;
  std::string deflated;
  if (options_.deflates) {
    std::string whole;
    whole.reserve(member.bytes);
    for (const std::string_view part : parts) whole.append(part);
    deflated = Deflate(whole);
    parts = {};
    member.method = kDeflated;
    member.compressed_bytes = deflated.size();
  }
  const bool is_wide = std::max(member.compressed_bytes, member.bytes) >= options_.wide_from;
  ByteWriter writer;
  writer.Write(kLocalMagic);
  WriteCommonFields(member, is_wide, &writer);
  writer.Write(static_cast<uint16_t>(is_wide ? 20 : 0));
  writer.WriteRaw(name);
  if (is_wide) {
    writer.Write(kWideField);
    writer.Write(uint16_t{16});
    writer.Write(member.bytes);
    writer.Write(member.compressed_bytes);
  }
  Append(writer.Release());
  if (options_.deflates) Append(std::move(deflated));
  for (const std::string_view part : parts) {
    parts_.push_back(part);
    num_bytes_ += part.size();
  }
  members_.push_back(std::move(member));
}

void ZipWriter::Add(const std::string& name, std::string bytes) {
  const std::string_view part = kept_.emplace_back(std::move(bytes));
  Add(name, std::span(&part, 1));
}

void ZipWriter::Append(std::string bytes) {
  parts_.emplace_back(kept_.emplace_back(std::move(bytes)));
  num_bytes_ += parts_.back().size();
}

std::string ZipWriter::Finish() {
  std::string bytes;
  const std::vector<std::string_view> parts = FinishParts();
  bytes.reserve(num_bytes_);
  for (const std::string_view part : parts) bytes.append(part);
  return bytes;
}

std::vector<std::string_view> ZipWriter::FinishParts() {
  ByteWriter list;
  const uint64_t begin = num_bytes_;
  const bool is_wide = begin >= options_.wide_from || members_.size() >= 0xffff;
  for (const ZipMember& member : members_) {
    list.Write(kListMagic);
    list.Write(uint16_t{45});
    WriteCommonFields(member, is_wide, &list);
    list.Write(static_cast<uint16_t>(is_wide ? 28 : 0));
    list.WriteRaw(std::string_view("\0\0\0\0\0\0\0\0\0\0", 10));  // no comment, disk 0, attributes
    list.Write(is_wide ? kIsWide : static_cast<uint32_t>(member.header));
    list.WriteRaw(member.name);
    if (!is_wide) continue;
    list.Write(kWideField);
    list.Write(uint16_t{24});
    list.Write(member.bytes);
    list.Write(member.compressed_bytes);
    list.Write(member.header);
  }
  const uint64_t size = list.size();
  if (is_wide) {
    list.Write(kWideEndMagic);
    list.Write(uint64_t{kWideEndBytes - 12});
    list.Write(uint16_t{45});
    list.Write(uint16_t{45});
    list.Write(uint64_t{0});  // the only disk
    for (int i = 0; i < 2; ++i) list.Write(uint64_t{members_.size()});
    list.Write(size);
    list.Write(begin);
    list.Write(kWideLocatorMagic);
    list.Write(uint32_t{0});
    list.Write(begin + size);
    list.Write(uint32_t{1});
  }
  list.Write(kEndMagic);
  list.Write(uint32_t{0});
  for (int i = 0; i < 2; ++i) {
    list.Write(static_cast<uint16_t>(is_wide ? 0xffff : members_.size()));
  }
  list.Write(is_wide ? kIsWide : static_cast<uint32_t>(size));
  list.Write(is_wide ? kIsWide : static_cast<uint32_t>(begin));
  list.Write(uint16_t{0});
  Append(list.Release());
  return parts_;
}

}  // namespace pleat
