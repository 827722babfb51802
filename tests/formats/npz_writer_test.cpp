#include "formats/painted_box.h"
#include "npy_array.h"
#include "pleat/base/file.h"
#include "pleat/formats/npz.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/formats/sequence_reader.h"
#include "support/python_oracle.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

absl::StatusOr<MeshSequence> ReadBack(const TemporaryFolder& folder, const std::string& bytes,
                                      ReadSequenceOptions options = {}) {
  EXPECT_THAT(WriteFile(folder.File("a.npz"), bytes), IsOk());
  return ReadSequence(folder.File("a.npz"), options);
}

TEST(NpzWriterTest, SequencesComeBackWhole) {
  const TemporaryFolder folder;
  for (const bool has_triangles : {false, true}) {
    const MeshSequence sequence = PaintedBox(3, has_triangles);
    for (const bool compressed : {false, true}) {
      PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence back,
                                 ReadBack(folder, EncodeNpz(sequence, {.compressed = compressed})));
      EXPECT_EQ(EncodeSequence(back), EncodeSequence(sequence));
    }
  }
}

TEST(NpzWriterTest, KeysAreTheUsers) {
  const TemporaryFolder folder;
  const NpzKeys keys = {.positions = "v", .faces = "f", .face_sizes = "n", .frame_rate = "r"};
  const MeshSequence sequence = PaintedBox(2, true);
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const MeshSequence back,
      ReadBack(folder, EncodeNpz(sequence, {.keys = keys}), {.npz_keys = keys}));
  EXPECT_EQ(EncodeSequence(back), EncodeSequence(sequence));
}

TEST(NpzWriterTest, AnArrayTakesTheMeshBesideIt) {
  const TemporaryFolder folder;
  const MeshSequence sequence = PaintedBox(3, false);
  ASSERT_THAT(WriteFile(folder.File("a.npy"), EncodeNpy(sequence)), IsOk());
  EXPECT_THAT(ReadSequence(folder.File("a.npy")),
              HasStatus(absl::StatusCode::kNotFound, testing::HasSubstr("no mesh")));
  WriteMeshOf(sequence, folder.File("a.obj"));
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence back, ReadSequence(folder.File("a.npy")));
  for (int t = 0; t < 3; ++t) EXPECT_EQ(back.frame(t), sequence.frame(t));
}

// NumPy must read what is written, and every form that it writes must be read.
TEST(NpzWriterTest, NumpyAgrees) {
  PLEAT_PYTHON_OR_SKIP(python, "numpy");
  const TemporaryFolder folder;
  const MeshSequence sequence = PaintedBox(3, false);
  ASSERT_THAT(WriteFile(folder.File("a.npz"), EncodeNpz(sequence)), IsOk());
  ASSERT_THAT(WriteFile(folder.File("c.npz"), EncodeNpz(sequence, {.compressed = true})), IsOk());
  ASSERT_THAT(WriteFile(folder.File("a.npy"), EncodeNpy(sequence)), IsOk());
  ASSERT_TRUE(RunScript(python, R"(
import numpy, sys, zipfile
folder = sys.argv[1] + '/'
a, c, alone = numpy.load(folder + 'a.npz'), numpy.load(folder + 'c.npz'), numpy.load(folder + 'a.npy')
assert zipfile.ZipFile(folder + 'a.npz').testzip() is None
for key in a.files:
    assert (a[key] == c[key]).all() and a[key].dtype == c[key].dtype, key
p = a['positions']
assert p.dtype == numpy.float32 and p.shape == (3, 8, 3) and (p == alone).all()
assert a['frame_rate'].tolist() == [30000, 1001]
assert a['material_names'].tolist() == ['skin', 'Stoff \u00e4'], a['material_names']
rest = {key: a[key] for key in a.files if key != 'positions'}
forms = {'float64': p.astype('f8'), 'big': p.astype('>f4'), 'fortran': numpy.asfortranarray(p),
         'fortran64': numpy.asfortranarray(p.astype('>f8'))}
for name, array in forms.items():
    numpy.savez(folder + 'read_' + name, positions=array, **rest)
    numpy.savez_compressed(folder + 'read_' + name + '_deflated', positions=array, **rest)
rest['faces'] = rest['faces'].astype('>u2')
numpy.savez(folder + 'read_short', positions=p, **rest)
)",
                        folder.path()));
  for (const char* name : {"float64", "big", "fortran", "fortran64", "float64_deflated",
                           "big_deflated", "fortran_deflated", "fortran64_deflated", "short"}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence back,
                               ReadSequence(folder.File(std::string("read_") + name + ".npz")));
    EXPECT_EQ(EncodeSequence(back), EncodeSequence(sequence)) << name;
  }
}

}  // namespace
}  // namespace pleat
