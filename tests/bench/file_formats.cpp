// Reading and writing animations against reading and writing the bytes of the same files, in turns,
// so that the ratios are of one run. One core; the columns are milliseconds of the fastest round.
//
//   file_formats FOLDER [FRAMES] [VERTICES]
//
// A folder in memory (/dev/shm) leaves the disk out.
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

#include "pleat/base/file.h"
#include "pleat/formats/alembic_writer.h"
#include "pleat/formats/glb_writer.h"
#include "pleat/formats/mdd.h"
#include "pleat/formats/npz.h"
#include "pleat/formats/obj_writer.h"
#include "pleat/formats/pc2.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/formats/sequence_reader.h"

namespace pleat {
namespace {

constexpr int kNumRounds = 9;

// A torus that waves and walks, of about num_vertices vertices and as many quads.
MeshSequence MakeTorus(int num_frames, int num_vertices) {
  const int n = std::max(3, static_cast<int>(std::sqrt(num_vertices / 2.0))), m = 2 * n;
  std::vector<int32_t> corners;
  for (int i = 0; i < m; ++i) {
    for (int k = 0; k < n; ++k) {
      const int next_i = (i + 1) % m, next_k = (k + 1) % n;
      corners.insert(corners.end(),
                     {i * n + k, next_i * n + k, next_i * n + next_k, i * n + next_k});
    }
  }
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < num_frames; ++t) {
    Eigen::Matrix3Xf& frame = frames.emplace_back(3, m * n);
    const float time = static_cast<float>(t);
    for (int v = 0; v < m * n; ++v) {
      const float a = 6.2831853f * static_cast<float>(v / n) / static_cast<float>(m);
      const float b = 6.2831853f * static_cast<float>(v % n) / static_cast<float>(n);
      const float radius = 1 + .3f * std::cos(b) + .05f * std::sin(3 * a + .1f * time);
      frame.col(v) << radius * std::cos(a) + .01f * time, .3f * std::sin(b) + 1,
          radius * std::sin(a);
    }
  }
  return *MeshSequence::Create(
      *Topology::Create(m * n, std::move(corners), std::vector<int32_t>(m * n, 4)),
      std::move(frames), {.name = "torus"});
}

std::vector<Eigen::Matrix3Xf> FramesOf(const MeshSequence& sequence) {
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < sequence.num_frames(); ++t) frames.push_back(sequence.frame(t));
  return frames;
}

// Memory is as in a process that has just begun: what was freed is given back first, and large
// blocks are never kept. Else whether a step finds pages of the one before decides about its time.
double MillisecondsOf(const std::function<bool()>& work) {
  mallopt(M_MMAP_THRESHOLD, 128 << 10);
  malloc_trim(0);
  const auto start = std::chrono::steady_clock::now();
  if (!work()) {
    std::cerr << "a step failed\n";
    std::exit(1);
  }
  return 1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Row {
  std::string name, path;
  std::function<bool()> write;
  std::function<bool()> read_file;  // the positions of the file alone; may be empty
};

void Measure(const Row& row) {
  double fastest[5] = {1e9, 1e9, 1e9, 1e9, 1e9};
  for (int round = 0; round < kNumRounds; ++round) {
    std::string bytes;
    const std::function<bool()> steps[] = {
        row.write,
        [&] {
          absl::StatusOr<std::string> read = ReadFile(row.path);
          if (read.ok()) bytes = *std::move(read);
          return read.ok();
        },
        [&] { return WriteFile(row.path + ".bytes", bytes).ok(); },
        [&] { return !row.read_file || row.read_file(); },
        [&] { return ReadSequence(row.path, {.num_threads = 1}).ok(); }};
    for (int i = 0; i < 5; ++i) fastest[i] = std::min(fastest[i], MillisecondsOf(steps[i]));
  }
  const auto size = static_cast<double>(std::filesystem::file_size(row.path)) / 1e6;
  std::printf("| %s | %.1f | %.1f | %s | %.1f | %.1f | %.1f | %.1f | %.1f |\n", row.name.c_str(),
              size, fastest[1],
              row.read_file ? (std::to_string(fastest[3] / fastest[1]).substr(0, 4)).c_str() : "-",
              fastest[4], fastest[4] / fastest[1], fastest[2], fastest[0], fastest[0] / fastest[2]);
  std::filesystem::remove(row.path + ".bytes");
}

int Run(const std::string& folder, int num_frames, int num_vertices) {
  const MeshSequence sequence = MakeTorus(num_frames, num_vertices);
  const std::vector<Eigen::Matrix3Xf> frames = FramesOf(sequence);
  const std::string stem = folder + "/torus.";
  const PointCache cache{.frames = frames};
  MddCache mdd{.times_s = {}, .frames = frames};
  for (int t = 0; t < num_frames; ++t) mdd.times_s.push_back(static_cast<float>(t) / 30);
  if (!WriteObj(stem + "obj", sequence.topology(), frames[0]).ok()) return 1;
  const auto read_npz = [&](const std::string& path) {
    const absl::StatusOr<std::string> bytes = ReadFile(path);
    return bytes.ok() && DecodeNpz(*bytes, path).ok();
  };
  const std::vector<Row> rows = {
      {"PC2", stem + "pc2", [&] { return WritePointCache(stem + "pc2", cache).ok(); },
       [&] { return ReadPointCache(stem + "pc2").ok(); }},
      {"MDD", stem + "mdd", [&] { return WriteMdd(stem + "mdd", mdd).ok(); },
       [&] { return ReadMdd(stem + "mdd").ok(); }},
      {"NPZ", stem + "npz", [&] { return WriteNpz(stem + "npz", sequence).ok(); },
       [&] { return read_npz(stem + "npz"); }},
      {"NPZ, deflated", folder + "/deflated.npz",
       [&] {
         return WriteFile(folder + "/deflated.npz", EncodeNpz(sequence, {.compressed = true})).ok();
       },
       [&] { return read_npz(folder + "/deflated.npz"); }},
      {"Alembic", stem + "abc", [&] { return WriteAlembic(stem + "abc", sequence).ok(); }, {}},
      {"GLB morphs", stem + "glb", [&] { return WriteGlb(stem + "glb", sequence).ok(); }, {}},
      {"pseq", stem + "pseq", [&] { return WriteSequenceFile(stem + "pseq", sequence).ok(); }, {}}};
  std::printf("%d frames of %d vertices\n", num_frames, sequence.num_vertices());
  std::printf(
      "| format | MB | read bytes ms | read file, times that | read sequence ms | times that | "
      "write bytes ms | write ms | times that |\n|---|---|---|---|---|---|---|---|---|\n");
  for (const Row& row : rows) Measure(row);
  return 0;
}

}  // namespace
}  // namespace pleat

int main(int argc, char** argv) {
  if (argc < 2 || argc > 4) {
    std::cerr << "usage: file_formats FOLDER [FRAMES] [VERTICES]\n";
    return 2;
  }
  return pleat::Run(argv[1], argc > 2 ? std::atoi(argv[2]) : 175,
                    argc > 3 ? std::atoi(argv[3]) : 10'000);
}
