// The products of every instruction set against a plain loop that sums in the promised order.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "pleat/simd/dense.h"
#include "support/not_a_number.h"
#include "support/random_data.h"

namespace pleat {
namespace {

using Eigen::MatrixXd;
using enum DenseShape;

constexpr double kGuard = 77;

// A matrix as it is meant, and as it lies in memory: NaN where its shape says what the entry is,
// and all around.
struct Operand {
  MatrixXd meant, memory;
  DenseView view;
};

Operand MakeOperand(int rows, int cols, DenseShape shape, bool by_rows, uint64_t seed) {
  Operand a{.meant = RandomMatrix(rows, cols, seed), .memory = {}, .view = {}};
  MatrixXd given = a.meant;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      const bool is_given = shape == kFull || (shape == kUpper ? c >= r : c <= r);
      if (is_given) continue;
      given(r, c) = kNan;
      a.meant(r, c) = shape == kSymmetric ? a.meant(c, r) : 0;
    }
  }
  if (by_rows) given.transposeInPlace();
  a.memory = MatrixXd::Constant(given.rows() + 3, given.cols() + 2, kNan);
  a.memory.block(1, 1, given.rows(), given.cols()) = given;
  const ptrdiff_t ld = a.memory.rows();
  a.view = {a.memory.data() + ld + 1, by_rows ? ld : 1, by_rows ? 1 : ld, shape};
  return a;
}

// C = or += alpha A B^T: every entry is a sum in the order of k, chunk after chunk.
MatrixXd PlainProduct(bool fused, double alpha, const MatrixXd& a, const MatrixXd& b, MatrixXd c,
                      bool overwrite) {
  for (ptrdiff_t begin = 0; begin == 0 || begin < a.cols(); begin += kDenseDepth) {
    const ptrdiff_t end = std::min(begin + kDenseDepth, a.cols());
    for (ptrdiff_t i = 0; i < a.rows(); ++i) {
      for (ptrdiff_t j = 0; j < b.rows(); ++j) {
        double sum = 0;
        for (ptrdiff_t p = begin; p < end; ++p) {
          sum = fused ? std::fma(a(i, p), b(j, p), sum) : sum + a(i, p) * b(j, p);
        }
        c(i, j) = overwrite && begin == 0 ? alpha * sum : c(i, j) + alpha * sum;
      }
    }
  }
  return c;
}

bool IsFused(InstructionSet set) { return set != InstructionSet::kBaseline; }

// As DenseSolver does it with rows that are packed already.
void MultiplyPacked(const DenseOps& ops, const PackedRows& a, const PackedRows& b,
                    DenseProduct product) {
  product.m = a.rows();
  product.n = b.rows();
  const DenseChunk columns = a.columns();
  for (ptrdiff_t begin = columns.begin; begin < columns.end; begin += kDenseDepth) {
    ops.multiply(product, {begin, std::min(begin + kDenseDepth, columns.end)}, a.chunk(begin),
                 b.chunk(begin));
  }
}

// (m, n, k): around the widths of registers, tiles, blocks of rows and chunks of columns.
class DenseMultiplyTest : public ::testing::TestWithParam<std::tuple<int, int, int>> {
 protected:
  // Both ways of summing, for each start of C.
  void Compare(const Operand& a, const Operand& b, bool overwrite) {
    const auto [m, n, k] = GetParam();
    const MatrixXd start = overwrite ? MatrixXd::Constant(m, n, kNan) : RandomMatrix(m, n, 3);
    for (const auto& [set, ops] : DenseVariants()) {
      MatrixXd c = MatrixXd::Constant(m + 2, n, kGuard);
      c.topRows(m) = start;
      DenseSolver(*ops).MultiplyRows(
          a.view, b.view, k,
          {.alpha = -1.5, .c = c.data(), .ldc = m + 2, .m = m, .n = n, .overwrite = overwrite});
      EXPECT_EQ(c.topRows(m), PlainProduct(IsFused(set), -1.5, a.meant, b.meant, start, overwrite))
          << NameOf(set) << " shapes " << int(a.view.shape) << int(b.view.shape);
      EXPECT_TRUE((c.bottomRows(2).array() == kGuard).all()) << NameOf(set);
    }
  }
};

TEST_P(DenseMultiplyTest, EveryShapeAndStrideGivesThePromisedSums) {
  const auto [m, n, k] = GetParam();
  for (const DenseShape a_shape : {kFull, kLower, kUpper, kSymmetric}) {
    for (const DenseShape b_shape : {kFull, kLower, kUpper, kSymmetric}) {
      if ((a_shape == kSymmetric && m != k) || (b_shape == kSymmetric && n != k)) continue;
      for (const bool by_rows : {false, true}) {
        const Operand a = MakeOperand(m, k, a_shape, by_rows, 1);
        const Operand b = MakeOperand(n, k, b_shape, !by_rows, 2);
        Compare(a, b, by_rows);
      }
    }
  }
}

TEST_P(DenseMultiplyTest, AddsAndOverwrites) {
  const auto [m, n, k] = GetParam();
  const Operand a = MakeOperand(m, k, kFull, true, 4), b = MakeOperand(n, k, kFull, true, 5);
  Compare(a, b, false);
  Compare(a, b, true);
}

INSTANTIATE_TEST_SUITE_P(Sizes, DenseMultiplyTest,
                         ::testing::Values(std::tuple(1, 1, 1), std::tuple(3, 5, 0),
                                           std::tuple(0, 4, 3), std::tuple(4, 0, 3),
                                           std::tuple(7, 2, 4), std::tuple(8, 9, 9),
                                           std::tuple(24, 24, 24), std::tuple(25, 23, 257),
                                           std::tuple(53, 49, 53), std::tuple(193, 9, 40),
                                           std::tuple(13, 13, 512), std::tuple(260, 5, 260)));

TEST(DensePartTest, TheWantedSideOfTheDiagonalIsThatOfTheWholeProduct) {
  for (const int n : {1, 5, 8, 23, 24, 25, 200}) {
    const Operand a = MakeOperand(n, 31, kFull, false, 1), b = MakeOperand(n, 31, kFull, true, 2);
    for (const auto& [set, ops] : DenseVariants()) {
      const MatrixXd whole =
          PlainProduct(IsFused(set), 1, a.meant, b.meant, MatrixXd::Zero(n, n), true);
      for (const DensePart part : {DensePart::kLower, DensePart::kUpper}) {
        MatrixXd c = MatrixXd::Constant(n + 1, n, kGuard);
        DenseSolver(*ops).MultiplyRows(
            a.view, b.view, 31,
            {.c = c.data(), .ldc = n + 1, .m = n, .n = n, .part = part, .overwrite = true});
        for (int j = 0; j < n; ++j) {
          const int begin = part == DensePart::kLower ? j : 0;
          const int count = part == DensePart::kLower ? n - j : j + 1;
          EXPECT_EQ(c.col(j).segment(begin, count), whole.col(j).segment(begin, count))
              << NameOf(set) << " " << n << " column " << j;
        }
        EXPECT_TRUE((c.bottomRows(1).array() == kGuard).all()) << NameOf(set) << " " << n;
      }
    }
  }
}

TEST(DenseMultiplyExtremesTest, AnInfiniteEntryStaysInItsRow) {
  const int m = 29, n = 11, k = 40;
  Operand a = MakeOperand(m, k, kFull, false, 1), b = MakeOperand(n, k, kFull, false, 2);
  b.memory = b.memory.cwiseAbs();
  a.memory(1 + 17, 1 + 20) = std::numeric_limits<double>::infinity();
  for (const auto& [set, ops] : DenseVariants()) {
    MatrixXd c(m, n);
    DenseSolver(*ops).MultiplyRows(a.view, b.view, k,
                                   {.c = c.data(), .ldc = m, .m = m, .n = n, .overwrite = true});
    for (int i = 0; i < m; ++i) {
      if (i == 17) {
        EXPECT_TRUE((c.row(i).array() == std::numeric_limits<double>::infinity()).all());
      } else {
        EXPECT_TRUE(c.row(i).allFinite()) << NameOf(set) << " row " << i;
      }
    }
  }
}

TEST(DenseMultiplyExtremesTest, SubnormalNumbersAreNotFlushed) {
  const double least = std::numeric_limits<double>::denorm_min();
  const MatrixXd a = MatrixXd::Constant(9, 3, least), b = MatrixXd::Constant(5, 3, 2);
  for (const auto& [set, ops] : DenseVariants()) {
    MatrixXd c(9, 5);
    DenseSolver(*ops).MultiplyRows(ViewOf(a), ViewOf(b), 3,
                                   {.c = c.data(), .ldc = 9, .m = 9, .n = 5, .overwrite = true});
    EXPECT_TRUE((c.array() == 6 * least).all()) << NameOf(set);
  }
}

// What Receive has made is read back as the product with the unit matrix.
TEST(PackedRowsTest, AReceivedProductIsAFactorOfTheNext) {
  struct Case {
    DenseShape a, b, result;
    int m, n, k;
  };
  for (const Case& test :
       {Case{kFull, kFull, kFull, 30, 300, 40}, Case{kFull, kFull, kFull, 300, 7, 5},
        Case{kLower, kUpper, kLower, 290, 290, 290}, Case{kUpper, kLower, kUpper, 61, 61, 61}}) {
    const Operand a = MakeOperand(test.m, test.k, test.a, false, 1);
    const Operand b = MakeOperand(test.n, test.k, test.b, true, 2);
    const MatrixXd unit = MatrixXd::Identity(test.n, test.n);
    for (const auto& [set, ops] : DenseVariants()) {
      PackedRows first, second, received, units;
      // What an earlier and larger use has left must not matter.
      received.Pack(*ops, ViewOf(MatrixXd::Constant(330, 330, kNan)), 330, 330);
      first.Pack(*ops, a.view, test.m, test.k);
      second.Pack(*ops, b.view, test.n, test.k);
      units.Pack(*ops, ViewOf(unit), test.n, test.n);
      DenseProduct product;
      received.Receive(*ops, test.result, test.m, test.n, &product);
      MultiplyPacked(*ops, first, second, product);
      MatrixXd c(test.m, test.n);
      MultiplyPacked(*ops, received, units, {.c = c.data(), .ldc = test.m, .overwrite = true});
      EXPECT_EQ(
          c, PlainProduct(IsFused(set), 1, a.meant, b.meant, MatrixXd::Zero(test.m, test.n), true))
          << NameOf(set) << " " << test.m;
      EXPECT_NEAR(received.SquaredNorm(*ops), c.squaredNorm(), 1e-13 * c.squaredNorm());
    }
  }
}

// Row after row of each chunk, which no width of a register changes.
TEST(PackedRowsTest, SquaredNormsHaveTheSameBitsEverywhere) {
  for (const DenseShape shape : {kFull, kLower, kUpper}) {
    const Operand a = MakeOperand(67, 300, shape, false, 6);
    double expected = 0;
    for (ptrdiff_t begin = 0; begin < 300; begin += kDenseDepth) {
      double chunk = 0;
      for (int r = 0; r < 67; ++r) {
        double row = 0;
        for (ptrdiff_t p = begin; p < std::min<ptrdiff_t>(begin + kDenseDepth, 300); ++p) {
          row += a.meant(r, p) * a.meant(r, p);
        }
        chunk += row;
      }
      expected += chunk;
    }
    for (const auto& [set, ops] : DenseVariants()) {
      PackedRows rows;
      rows.Pack(*ops, a.view, 67, 300);
      EXPECT_EQ(rows.SquaredNorm(*ops), expected) << NameOf(set);
    }
  }
}

TEST(PackedRowsTest, SomeColumnsAreTheSameAsThoseOfTheWhole) {
  const Operand a = MakeOperand(31, 600, kFull, false, 1), b = MakeOperand(18, 600, kFull, true, 2);
  for (const auto& [set, ops] : DenseVariants()) {
    PackedRows part, whole;
    part.Pack(*ops, a.view, 31, DenseChunk{256, 600});
    whole.Pack(*ops, b.view, 18, 600);
    EXPECT_EQ(part.columns().begin, 256);
    MatrixXd c = MatrixXd::Zero(31, 18);
    MultiplyPacked(*ops, part, whole, {.c = c.data(), .ldc = 31});
    const MatrixXd expected = a.meant.rightCols(344) * b.meant.rightCols(344).transpose();
    EXPECT_LT((c - expected).cwiseAbs().maxCoeff(), 1e-12) << NameOf(set);
  }
}

TEST(PackedRowsTest, ChunksAreAlignedAlsoAfterAMove) {
  for (const auto& [set, ops] : DenseVariants()) {
    for (const int rows : {1, 5, 24, 25, 100}) {
      PackedRows packed;
      packed.Pack(*ops, ViewOf(RandomMatrix(rows, 300, 1)), rows, 300);
      PackedRows moved = std::move(packed);
      EXPECT_EQ(moved.rows(), rows);
      EXPECT_EQ(reinterpret_cast<uintptr_t>(moved.chunk(0).data) % kDenseAlignment, 0u)
          << NameOf(set) << " " << rows;
    }
  }
}

}  // namespace
}  // namespace pleat
