// The dense kernels, included once by each dense_<instruction set>.cpp, which defines before:
//   PLEAT_DENSE_NAMESPACE  a namespace of its own,
//   kWidth (doubles in a register), kPanelRegisters and kPanelColumns (the micro tile),
//   FusedMultiplyAdd(a, b, c).
// This file must not include headers with inline functions: a copy of one that is compiled for a
// newer processor could be the one that the linker keeps.
//
// Source of the blocking: K. Goto, R. van de Geijn, "Anatomy of high-performance matrix
// multiplication", ACM TOMS 34 (2008).

namespace pleat {
namespace PLEAT_DENSE_NAMESPACE {

constexpr ptrdiff_t kRows = kWidth * kPanelRegisters;  // of a micro tile
constexpr ptrdiff_t kCols = kPanelColumns;
constexpr ptrdiff_t kDepth = 256;      // length of a partial sum; part of the result, do not tune
constexpr ptrdiff_t kBlockRows = 192;  // multiple of every kRows
constexpr ptrdiff_t kBlockCols = 480;  // multiple of every kCols

// Eight lanes on every instruction set, so that sums over lanes have one order.
typedef double Lanes __attribute__((vector_size(64)));
// Lanes in an array. Only for casts: a reference to it would lose the attributes under clang.
typedef double UnalignedLanes __attribute__((vector_size(64), aligned(8), may_alias));
typedef long long LaneBits __attribute__((vector_size(64)));
constexpr ptrdiff_t kLanes = 8;

inline ptrdiff_t Smaller(ptrdiff_t a, ptrdiff_t b) { return a < b ? a : b; }

// Copies `count` (<= kLanes) values; the other lanes become zero.
inline void LoadPart(Lanes& lanes, const double* from, ptrdiff_t count) {
  lanes = Lanes{};
  for (ptrdiff_t l = 0; l < count; ++l) lanes[l] = from[l];
}
inline void StorePart(double* to, const Lanes& lanes, ptrdiff_t count) {
  for (ptrdiff_t l = 0; l < count; ++l) to[l] = lanes[l];
}
inline double SumLanes(const Lanes& v) {
  return ((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7]));
}

// Panels of `height` rows, column after column, zero beyond the last row.
template <ptrdiff_t height>
inline void Pack(DenseView a, ptrdiff_t rows, ptrdiff_t k, double* packed) {
  for (ptrdiff_t i = 0; i < rows; i += height) {
    const ptrdiff_t full = Smaller(height, rows - i);
    const double* panel = a.data + i * a.row_stride;
    if (full == height && a.row_stride == 1) {
      for (ptrdiff_t p = 0; p < k; ++p, packed += height) {
        for (ptrdiff_t r = 0; r < height; ++r) packed[r] = panel[p * a.col_stride + r];
      }
      continue;
    }
    for (ptrdiff_t p = 0; p < k; ++p, packed += height) {
      for (ptrdiff_t r = 0; r < full; ++r) {
        packed[r] = panel[r * a.row_stride + p * a.col_stride];
      }
      for (ptrdiff_t r = full; r < height; ++r) packed[r] = 0;
    }
  }
}

// C (kRows x kCols) += alpha A B for packed panels of depth k.
inline void MicroTile(ptrdiff_t k, const double* a, const double* b, double alpha, double* c,
                      ptrdiff_t ldc) {
  Register sum[kPanelColumns][kPanelRegisters] = {};
  for (ptrdiff_t p = 0; p < k; ++p, a += kRows, b += kCols) {
    Register column[kPanelRegisters];
#pragma GCC unroll 8
    for (ptrdiff_t r = 0; r < kPanelRegisters; ++r) {
      column[r] = *reinterpret_cast<const UnalignedRegister*>(a + r * kWidth);
    }
#pragma GCC unroll 8
    for (ptrdiff_t j = 0; j < kCols; ++j) {
      const Register factor = Broadcast(b[j]);
#pragma GCC unroll 8
      for (ptrdiff_t r = 0; r < kPanelRegisters; ++r) {
        sum[j][r] = FusedMultiplyAdd(column[r], factor, sum[j][r]);
      }
    }
  }
#pragma GCC unroll 8
  for (ptrdiff_t j = 0; j < kCols; ++j) {
#pragma GCC unroll 8
    for (ptrdiff_t r = 0; r < kPanelRegisters; ++r) {
      UnalignedRegister* target = reinterpret_cast<UnalignedRegister*>(c + j * ldc + r * kWidth);
      *target = *target + alpha * sum[j][r];
    }
  }
}

// One block: packed A (rows x k) times packed B (k x cols) into C whose entry (0, 0) lies `offset`
// rows below the diagonal of the whole.
inline void MultiplyBlock(double alpha, const double* a, const double* b, double* c, ptrdiff_t ldc,
                          ptrdiff_t rows, ptrdiff_t cols, ptrdiff_t k, bool lower,
                          ptrdiff_t offset) {
  for (ptrdiff_t j = 0; j < cols; j += kCols) {
    const ptrdiff_t width = Smaller(kCols, cols - j);
    for (ptrdiff_t i = 0; i < rows; i += kRows) {
      const ptrdiff_t height = Smaller(kRows, rows - i);
      if (lower && offset + i + height - 1 < j) continue;
      double* tile = c + i + j * ldc;
      if (height == kRows && width == kCols) {
        MicroTile(k, a + i * k, b + j * k, alpha, tile, ldc);
        continue;
      }
      double edge[kRows * kCols] = {};
      MicroTile(k, a + i * k, b + j * k, alpha, edge, kRows);
      for (ptrdiff_t column = 0; column < width; ++column) {
        for (ptrdiff_t row = 0; row < height; ++row) {
          tile[row + column * ldc] += edge[row + column * kRows];
        }
      }
    }
  }
}

void MultiplyAdd(double alpha, DenseView a, DenseView b, double* c, ptrdiff_t ldc, ptrdiff_t m,
                 ptrdiff_t n, ptrdiff_t k, bool lower, double* scratch) {
  double* packed_a = scratch;
  double* packed_b = scratch + kBlockRows * kDepth;
  for (ptrdiff_t j = 0; j < n; j += kBlockCols) {
    const ptrdiff_t cols = Smaller(kBlockCols, n - j);
    for (ptrdiff_t p = 0; p < k; p += kDepth) {
      const ptrdiff_t depth = Smaller(kDepth, k - p);
      Pack<kCols>(b.Block(p, j).Transposed(), cols, depth, packed_b);
      for (ptrdiff_t i = 0; i < m; i += kBlockRows) {
        const ptrdiff_t rows = Smaller(kBlockRows, m - i);
        if (lower && i + rows - 1 < j) continue;
        Pack<kRows>(a.Block(i, p), rows, depth, packed_a);
        MultiplyBlock(alpha, packed_a, packed_b, c + i + j * ldc, ldc, rows, cols, depth, lower,
                      i - j);
      }
    }
  }
}

// exp of values <= 0: x = n log 2 + r with |r| <= log(2)/2, Taylor polynomial of degree 13 in r
// (remainder below 5e-18), times 2^n through the exponent bits.
inline void Exp(Lanes& x) {
  constexpr double kLowest = -708;  // below it 2^n would be subnormal; exp is 0 to double precision
  constexpr double kShift = 0x1.8p52;
  constexpr double kLog2High = 0x1.62e42fefa38p-1, kLog2Low = 0x1.ef35793c7673p-45;
  const Lanes lowest = Lanes{} + kLowest;
  x = x < lowest ? lowest : x;
  const Lanes shifted = x * 0x1.71547652b82fep0 + kShift;
  const Lanes n = shifted - kShift;
  const Lanes r = (x - n * kLog2High) - n * kLog2Low;
  Lanes y = Lanes{} + 1.0 / 6227020800.0;
  y = y * r + 1.0 / 479001600.0;
  y = y * r + 1.0 / 39916800.0;
  y = y * r + 1.0 / 3628800.0;
  y = y * r + 1.0 / 362880.0;
  y = y * r + 1.0 / 40320.0;
  y = y * r + 1.0 / 5040.0;
  y = y * r + 1.0 / 720.0;
  y = y * r + 1.0 / 120.0;
  y = y * r + 1.0 / 24.0;
  y = y * r + 1.0 / 6.0;
  y = y * r + .5;
  y = y * r + 1.0;
  y = y * r + 1.0;
  // The low bits of `shifted` hold n in two's complement; moved up they are the exponent.
  const LaneBits bits = (LaneBits)shifted;
  const LaneBits power = (bits << 52) + (1023LL << 52);
  x = y * (Lanes)power;
}

void ExpInPlace(double* values, ptrdiff_t count) {
  for (ptrdiff_t i = 0; i < count; i += kLanes) {
    const ptrdiff_t part = Smaller(kLanes, count - i);
    Lanes x;
    LoadPart(x, values + i, part);
    Exp(x);
    StorePart(values + i, x, part);
  }
}

void SquaredDistances(const double* x, ptrdiff_t n, ptrdiff_t q, double* r) {
  for (ptrdiff_t j = 0; j < n; ++j) {
    double* column = r + j * n;
    for (ptrdiff_t i = j; i < n; ++i) column[i] = 0;
    for (ptrdiff_t d = 0; d < q; ++d) {
      const double* values = x + d * n;
      const double own = values[j];
      for (ptrdiff_t i = j; i < n; ++i) {
        column[i] += (values[i] - own) * (values[i] - own);
      }
    }
  }
}

void Kernel(const double* r, const double* t, ptrdiff_t n, double g, double a, double bias,
            double c, double* k0, double* k) {
  for (ptrdiff_t j = 0; j < n; ++j) {
    const double* distance = r + j * n;
    double* rbf = k0 + j * n;
    double* sum = k + j * n;
    ptrdiff_t i = j;
    for (; i + kLanes <= n; i += kLanes) {
      Lanes x = *reinterpret_cast<const UnalignedLanes*>(distance + i) * (-.5 * g);
      Exp(x);
      *reinterpret_cast<UnalignedLanes*>(rbf + i) = a * x;
    }
    if (i < n) {
      Lanes x;
      LoadPart(x, distance + i, n - i);
      x = x * (-.5 * g);
      Exp(x);
      x = a * x;
      StorePart(rbf + i, x, n - i);
    }
    for (i = j; i < n; ++i) sum[i] = rbf[i] + bias;
    if (t != nullptr) {
      const double* linear = t + j * n;
      for (i = j; i < n; ++i) sum[i] += c * linear[i];
    }
  }
}

GramSums GramGradient(double* q, double* s, const double* k0, const double* r, const double* t,
                      ptrdiff_t n, double half_weight, double num_outputs) {
  GramSums sums;
  Lanes total{}, amplitude{}, distance{}, linear{};
  const double scale = half_weight * num_outputs;
  for (ptrdiff_t j = 0; j < n; ++j) {
    const ptrdiff_t diagonal = j + j * n;
    const double own = scale * q[diagonal] - half_weight * s[diagonal];
    q[diagonal] = own;
    s[diagonal] = own * k0[diagonal];
    sums.trace += own;
    sums.amplitude += s[diagonal];
    if (t != nullptr) sums.linear += own * t[diagonal];
    for (ptrdiff_t i = j + 1; i < n; i += kLanes) {
      const ptrdiff_t part = Smaller(kLanes, n - i), at = i + j * n;
      Lanes inverse, product, rbf, squared;
      if (part == kLanes) {
        inverse = *reinterpret_cast<const UnalignedLanes*>(q + at);
        product = *reinterpret_cast<const UnalignedLanes*>(s + at);
        rbf = *reinterpret_cast<const UnalignedLanes*>(k0 + at);
        squared = *reinterpret_cast<const UnalignedLanes*>(r + at);
      } else {
        LoadPart(inverse, q + at, part);
        LoadPart(product, s + at, part);
        LoadPart(rbf, k0 + at, part);
        LoadPart(squared, r + at, part);
      }
      const Lanes gradient = scale * inverse - half_weight * product;
      const Lanes weighted = gradient * rbf;
      total += gradient;
      amplitude += weighted;
      distance += weighted * squared;
      if (t != nullptr) {
        Lanes inner;
        LoadPart(inner, t + at, part);
        linear += gradient * inner;
      }
      if (part == kLanes) {
        *reinterpret_cast<UnalignedLanes*>(q + at) = gradient;
        *reinterpret_cast<UnalignedLanes*>(s + at) = weighted;
      } else {
        StorePart(q + at, gradient, part);
        StorePart(s + at, weighted, part);
      }
    }
  }
  sums.total = sums.trace + 2 * SumLanes(total);
  sums.amplitude += 2 * SumLanes(amplitude);
  sums.distance = 2 * SumLanes(distance);
  sums.linear += 2 * SumLanes(linear);
  return sums;
}

void SymmetricMultiply(const double* m, const double* x, ptrdiff_t n, ptrdiff_t q, double* y) {
  for (ptrdiff_t i = 0; i < n * q; ++i) y[i] = 0;
  for (ptrdiff_t j = 0; j < n; ++j) {
    const double* column = m + j * n;
    for (ptrdiff_t d = 0; d < q; ++d) {
      const double* in = x + d * n;
      double* out = y + d * n;
      const double own = in[j];
      Lanes dot{};
      double tail = column[j] * own;
      ptrdiff_t i = j + 1;
      for (; i + kLanes <= n; i += kLanes) {
        const Lanes entries = *reinterpret_cast<const UnalignedLanes*>(column + i);
        dot += entries * *reinterpret_cast<const UnalignedLanes*>(in + i);
        UnalignedLanes* target = reinterpret_cast<UnalignedLanes*>(out + i);
        *target = *target + entries * own;
      }
      for (; i < n; ++i) {
        tail += column[i] * in[i];
        out[i] += column[i] * own;
      }
      out[j] += SumLanes(dot) + tail;
    }
  }
}

constexpr DenseOps kOps = {kName,
                           kBlockRows* kDepth + kBlockCols* kDepth,
                           MultiplyAdd,
                           ExpInPlace,
                           SquaredDistances,
                           Kernel,
                           GramGradient,
                           SymmetricMultiply};

}  // namespace PLEAT_DENSE_NAMESPACE
}  // namespace pleat
