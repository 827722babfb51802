// Reading a folder of OBJ frames against `cat` of the same bytes and against other parsers, in
// turns, so that the ratios are of one run. The columns are wall seconds of the fastest round.
//
//   obj_folder FOLDER [FRAMES] [VERTICES]
//
// An empty or missing folder is filled with a torus that waves. The other parsers are optional
// packages; one that was not there when this was built is named and left out.
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

#include "pleat/base/status.h"
#include "pleat/formats/obj_reader.h"
#include "pleat/formats/obj_writer.h"
#include "pleat/formats/sequence_reader.h"
#ifdef PLEAT_BENCH_TINYOBJ
#include <tiny_obj_loader.h>
#endif
#ifdef PLEAT_BENCH_ASSIMP
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#endif

namespace pleat {
namespace {

namespace fs = std::filesystem;

constexpr int kNumRounds = 3;

// A torus of about num_vertices vertices and as many quads, whose coordinates have as many digits
// as those of captures.
absl::Status FillFolder(const std::string& folder, int num_frames, int num_vertices) {
  const int n = std::max(3, static_cast<int>(std::sqrt(num_vertices / 2.0))), m = 2 * n;
  std::vector<int32_t> corners;
  for (int i = 0; i < m; ++i) {
    for (int k = 0; k < n; ++k) {
      const int next_i = (i + 1) % m, next_k = (k + 1) % n;
      corners.insert(corners.end(),
                     {i * n + k, next_i * n + k, next_i * n + next_k, i * n + next_k});
    }
  }
  PLEAT_ASSIGN_OR_RETURN(const Topology topology, Topology::Create(m * n, std::move(corners),
                                                                   std::vector<int32_t>(m * n, 4)));
  for (int t = 0; t < num_frames; ++t) {
    Eigen::Matrix3Xf frame(3, m * n);
    for (int v = 0; v < m * n; ++v) {
      const float a = 6.2831853f * static_cast<float>(v / n) / static_cast<float>(m);
      const float b = 6.2831853f * static_cast<float>(v % n) / static_cast<float>(n);
      const float radius =
          1 + .3f * std::cos(b) + .05f * std::sin(3 * a + .1f * static_cast<float>(t));
      frame.col(v) << radius * std::cos(a), .3f * std::sin(b), radius * std::sin(a);
    }
    PLEAT_RETURN_IF_ERROR(
        WriteObj(folder + "/frame_" + std::to_string(t) + ".obj", topology, frame));
  }
  return absl::OkStatus();
}

// Each reader returns the vertices that it found in all files, so that all are seen to read them.
struct Reader {
  const char* name;
  std::function<int64_t()> read;
};

int64_t ReadAsSequence(const std::string& folder, int num_threads) {
  const absl::StatusOr<MeshSequence> sequence = ReadSequence(folder, {.num_threads = num_threads});
  return sequence.ok() ? int64_t{sequence->num_vertices()} * sequence->num_frames() : -1;
}

int64_t ReadOneByOne(const std::vector<std::string>& paths) {
  int64_t num_vertices = 0;
  for (const std::string& path : paths) {
    const absl::StatusOr<MeshFile> mesh = ReadObj(path);
    num_vertices += mesh.ok() ? mesh->positions.cols() : -1'000'000;
  }
  return num_vertices;
}

#ifdef PLEAT_BENCH_TINYOBJ
int64_t ReadWithTinyObj(const std::vector<std::string>& paths) {
  int64_t num_vertices = 0;
  for (const std::string& path : paths) {
    tinyobj::attrib_t attributes;
    std::vector<tinyobj::shape_t> shapes;
    std::vector<tinyobj::material_t> materials;
    std::string warning, error;
    const bool read = tinyobj::LoadObj(&attributes, &shapes, &materials, &warning, &error,
                                       path.c_str(), nullptr, /*triangulate=*/false);
    num_vertices += read ? static_cast<int64_t>(attributes.vertices.size() / 3) : -1'000'000;
  }
  return num_vertices;
}
#endif

#ifdef PLEAT_BENCH_ASSIMP
int64_t ReadWithAssimp(const std::vector<std::string>& paths) {
  int64_t num_vertices = 0;
  for (const std::string& path : paths) {
    Assimp::Importer importer;  // without post-processing, corners that share a vertex stay apart
    const aiScene* scene = importer.ReadFile(path, 0);
    num_vertices += scene != nullptr && scene->mNumMeshes > 0 ? 1 : -1'000'000;
  }
  return num_vertices;
}
#endif

double SecondsOf(const std::function<int64_t()>& read, int64_t* result) {
  const auto start = std::chrono::steady_clock::now();
  *result = read();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void PrintTable(const std::vector<Reader>& readers, uint64_t num_bytes) {
  std::vector<double> seconds(readers.size(), 1e9);
  std::vector<int64_t> results(readers.size());
  for (int round = 0; round < kNumRounds; ++round) {
    for (size_t r = 0; r < readers.size(); ++r) {
      seconds[r] = std::min(seconds[r], SecondsOf(readers[r].read, &results[r]));
    }
  }
  std::printf("| reader | s | MB/s | times cat | result |\n|---|---|---|---|---|\n");
  for (size_t r = 0; r < readers.size(); ++r) {
    std::printf("| %s | %.2f | %.0f | %.1f | %lld |\n", readers[r].name, seconds[r],
                static_cast<double>(num_bytes) / 1e6 / seconds[r], seconds[r] / seconds[0],
                static_cast<long long>(results[r]));
  }
}

std::vector<std::string> ObjFiles(const std::string& folder, uint64_t* num_bytes) {
  std::vector<std::string> paths;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() != ".obj") continue;
    paths.push_back(entry.path().string());
    *num_bytes += entry.file_size();
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

int Run(const std::string& folder, int num_frames, int num_vertices) {
  uint64_t num_bytes = 0;
  std::vector<std::string> paths = ObjFiles(folder, &num_bytes);
  if (paths.empty()) {
    if (const absl::Status status = FillFolder(folder, num_frames, num_vertices); !status.ok()) {
      std::cerr << status << "\n";
      return 1;
    }
    paths = ObjFiles(folder, &num_bytes);
  }
  std::printf("%zu files, %.1f MB\n", paths.size(), static_cast<double>(num_bytes) / 1e6);
  const std::string cat = "cat '" + folder + "'/*.obj >/dev/null";
  std::vector<Reader> readers = {
      {"cat", [&] { return int64_t{std::system(cat.c_str())}; }},
      {"Pleat, the folder, 1 thread", [&] { return ReadAsSequence(folder, 1); }},
      {"Pleat, the folder, a thread per core", [&] { return ReadAsSequence(folder, 0); }},
      {"Pleat, file by file, 1 thread", [&] { return ReadOneByOne(paths); }}};
#ifdef PLEAT_BENCH_TINYOBJ
  readers.push_back({"tinyobjloader, file by file", [&] { return ReadWithTinyObj(paths); }});
#else
  std::printf("tinyobjloader was not there (package libtinyobjloader-dev)\n");
#endif
#ifdef PLEAT_BENCH_ASSIMP
  readers.push_back({"Assimp, file by file", [&] { return ReadWithAssimp(paths); }});
#else
  std::printf("Assimp was not there (package libassimp-dev)\n");
#endif
  PrintTable(readers, num_bytes);
  return 0;
}

}  // namespace
}  // namespace pleat

int main(int argc, char** argv) {
  if (argc < 2 || argc > 4) {
    std::cerr << "usage: obj_folder FOLDER [FRAMES] [VERTICES]\n";
    return 2;
  }
  return pleat::Run(argv[1], argc > 2 ? std::atoi(argv[2]) : 2000,
                    argc > 3 ? std::atoi(argv[3]) : 1000);
}
