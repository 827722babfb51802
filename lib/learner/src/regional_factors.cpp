#include "regional_factors.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>

namespace pleat {
namespace {

// Sets of columns that differ, numbered in the order of their first scale.
std::map<std::vector<int>, int> DifferentSets(const RegionalGpParameters& parameters) {
  std::map<std::vector<int>, int> sets;
  for (const RegionalGpParameters::Region& region : parameters.regions) {
    for (const RegionalGpParameters::Scale& scale : region.scales) {
      sets.try_emplace(scale.columns, static_cast<int>(sets.size()));
    }
  }
  return sets;
}

}  // namespace

RegionalFactors::RegionalFactors(const RegionalGpParameters& parameters)
    : num_rows_(parameters.inputs.rows()) {
  const std::map<std::vector<int>, int> sets = DifferentSets(parameters);
  set_bounds_.assign(sets.size(), std::numeric_limits<double>::infinity());
  for (const RegionalGpParameters::Region& region : parameters.regions) {
    for (const RegionalGpParameters::Scale& scale : region.scales) {
      const int set = sets.at(scale.columns);
      set_bounds_[set] = std::min(set_bounds_[set], scale.max_norm);
      scales_.push_back({.set = set,
                         .exponent = static_cast<float>(-.5 * scale.inverse_width),
                         .amplitude = static_cast<float>(scale.amplitude),
                         .linear = static_cast<float>(scale.linear)});
    }
    regions_.push_back({.bias = static_cast<float>(region.bias), .end_scale = scales_.size()});
  }
  std::vector<std::vector<int>> sets_of_column(parameters.inputs.cols());
  for (const auto& [columns, set] : sets) {
    for (const int column : columns) sets_of_column[column].push_back(set);
  }
  std::map<std::vector<int>, int> atom_of_sets;
  std::vector<std::vector<int>> atoms, set_atoms(sets.size());
  for (size_t column = 0; column < sets_of_column.size(); ++column) {
    const std::vector<int>& its_sets = sets_of_column[column];
    if (its_sets.empty()) continue;
    const auto [entry, is_new] = atom_of_sets.try_emplace(its_sets, static_cast<int>(atoms.size()));
    if (is_new) {
      for (const int set : its_sets) set_atoms[set].push_back(entry->second);
      atoms.emplace_back();
    }
    atoms[entry->second].push_back(static_cast<int>(column));
  }
  for (const std::vector<int>& atom : atoms) {
    columns_.insert(columns_.end(), atom.begin(), atom.end());
    atom_ends_.push_back(columns_.size());
  }
  for (const std::vector<int>& set : set_atoms) {
    set_atoms_.insert(set_atoms_.end(), set.begin(), set.end());
    set_ends_.push_back(set_atoms_.size());
  }
  StoreRows(parameters.inputs);
}

void RegionalFactors::StoreRows(const Eigen::MatrixXd& inputs) {
  const ptrdiff_t num_chunks = (num_rows_ + kLanes - 1) / kLanes;
  inputs_.assign(static_cast<size_t>(num_chunks) * chunk_size(), 0);
  for (ptrdiff_t n = 0; n < num_rows_; ++n) {
    float* const lane =
        inputs_.data() + static_cast<size_t>(n / kLanes) * chunk_size() + n % kLanes;
    size_t c = 0;
    for (size_t a = 0; a < atom_ends_.size(); ++a) {
      double square = 0;
      for (; c < atom_ends_[a]; ++c) {
        const auto value = static_cast<float>(inputs(n, columns_[c]));
        lane[c * kLanes] = value;
        square += double(value) * value;
      }
      float* const squares = lane + (columns_.size() + 2 * a) * kLanes;
      squares[0] = static_cast<float>(square);
      squares[kLanes] = static_cast<float>(square - squares[0]);
    }
  }
}

Eigen::MatrixXd RegionalFactors::Inputs(Eigen::Index num_inputs) const {
  Eigen::MatrixXd inputs = Eigen::MatrixXd::Zero(num_rows_, num_inputs);
  for (ptrdiff_t n = 0; n < num_rows_; ++n) {
    const float* const lane =
        inputs_.data() + static_cast<size_t>(n / kLanes) * chunk_size() + n % kLanes;
    for (size_t c = 0; c < columns_.size(); ++c) inputs(n, columns_[c]) = lane[c * kLanes];
  }
  return inputs;
}

// The scratch holds, for a chunk, the products and squares of all atoms in doubles and the products
// and distances of all sets in floats; and for the row, what shortens it in each set and its square
// in each atom.
size_t RegionalFactors::scratch_size() const {
  return kLanes * (2 * atom_ends_.size() + set_ends_.size()) + 3 * set_ends_.size() +
         atom_ends_.size();
}

// The kernel; a struct, so that it can be a friend.
struct RegionalFactorsKernel {
  typedef float Lanes __attribute__((vector_size(64), aligned(4), may_alias));
  typedef uint32_t Bits __attribute__((vector_size(64)));
  typedef float HalfOfLanes __attribute__((vector_size(32), aligned(4), may_alias));
  typedef double Doubles __attribute__((vector_size(64), aligned(8), may_alias));
  static constexpr ptrdiff_t kLanes = RegionalFactors::kLanes, kHalf = kLanes / 2;

  static PLEAT_ALWAYS_INLINE Lanes& At(float* values, size_t i) {
    return *reinterpret_cast<Lanes*>(values + i * kLanes);
  }
  static PLEAT_ALWAYS_INLINE Doubles& At(double* values, size_t i, int half) {
    return *reinterpret_cast<Doubles*>(values + i * kLanes + half * kHalf);
  }
  static PLEAT_ALWAYS_INLINE Doubles Load(const float* values, size_t i, int half) {
    const auto* from = reinterpret_cast<const HalfOfLanes*>(values + i * kLanes + half * kHalf);
    return __builtin_convertvector(*from, Doubles);
  }
  static PLEAT_ALWAYS_INLINE void Store(Doubles numbers, int half, float* values, size_t i) {
    *reinterpret_cast<HalfOfLanes*>(values + i * kLanes + half * kHalf) =
        __builtin_convertvector(numbers, HalfOfLanes);
  }

  // exp(x) for x <= 0, off by 1e-7 of itself at most; below -87 that of -87. x = n log 2 + r with
  // |r| <= log 2 / 2, of which exp(r) is a Taylor polynomial and 2^n is put together from its bits.
  static PLEAT_ALWAYS_INLINE Lanes Exp(Lanes x) {
    constexpr float kLowest = -87;
    constexpr float kRound = 12582912;  // 1.5 * 2^23: adding it leaves a number's nearest integer
    constexpr float kLog2High = .693359375f, kLog2Low = -2.12194440e-4f;  // log 2 in two parts
    x = x > kLowest ? x : Lanes{} + kLowest;
    const Lanes shifted = x * 1.44269504f + kRound;
    const Lanes n = shifted - kRound;
    const Lanes r = (x - n * kLog2High) - n * kLog2Low;
    Lanes p = r * (1.f / 5040) + 1.f / 720;
    p = p * r + 1.f / 120;
    p = p * r + 1.f / 24;
    p = p * r + 1.f / 6;
    p = p * r + .5f;
    p = p * r + 1.f;
    p = p * r + 1.f;
    constexpr uint32_t kRoundBits = 0x4b400000, kBias = 127;
    const Bits power = ((Bits)shifted - kRoundBits + kBias) << 23;
    return p * (Lanes)power;
  }

  // The row as one set sees it.
  struct Shortening {
    double factor;        // s, 1 within the bound
    double square;        // s^2 |x|^2
    double twice_factor;  // 2 s
  };

  static PLEAT_ALWAYS_INLINE void Shorten(const RegionalFactors& f, const double* row,
                                          double* atom_squares, Shortening* shortenings) {
    size_t c = 0;
    for (size_t a = 0; a < f.atom_ends_.size(); ++a) {
      double square = 0;
      for (; c < f.atom_ends_[a]; ++c) square += row[f.columns_[c]] * row[f.columns_[c]];
      atom_squares[a] = square;
    }
    size_t i = 0;
    for (size_t set = 0; set < f.set_ends_.size(); ++set) {
      double square = 0;
      for (; i < f.set_ends_[set]; ++i) square += atom_squares[f.set_atoms_[i]];
      const double norm = std::sqrt(square), bound = f.set_bounds_[set];
      const bool longer = norm > bound;
      const double factor = longer ? bound / norm : 1;
      shortenings[set] = {factor, longer ? bound * bound : square, 2 * factor};
    }
  }

  // Computes the products and the distances of all sets for the rows of one chunk.
  static PLEAT_ALWAYS_INLINE void Sums(const RegionalFactors& f, const float* inputs,
                                       const double* row, const Shortening* shortenings,
                                       double* atoms, float* products) {
    const float* squares = inputs + kLanes * f.columns_.size();
    size_t c = 0;
    for (size_t a = 0; a < f.atom_ends_.size(); ++a) {
      Doubles low = {}, high = {};
      for (; c < f.atom_ends_[a]; ++c) {
        const double value = row[f.columns_[c]];
        low += value * Load(inputs, c, 0);
        high += value * Load(inputs, c, 1);
      }
      At(atoms, 2 * a, 0) = low;
      At(atoms, 2 * a, 1) = high;
      for (const int half : {0, 1}) {
        At(atoms, 2 * a + 1, half) = Load(squares, 2 * a, half) + Load(squares, 2 * a + 1, half);
      }
    }
    float* distances = products + f.set_ends_.size() * kLanes;
    size_t begin = 0;
    for (size_t set = 0; set < f.set_ends_.size(); ++set) {
      const Shortening& own = shortenings[set];
      for (const int half : {0, 1}) {
        Doubles square = {}, product = {};
        for (size_t i = begin; i < f.set_ends_[set]; ++i) {
          product += At(atoms, 2 * f.set_atoms_[i], half);
          square += At(atoms, 2 * f.set_atoms_[i] + 1, half);
        }
        const Doubles distance = own.square + square - own.twice_factor * product;
        // Rounding may leave less than nothing, which a narrow kernel would blow up.
        Store(distance > 0 ? distance : Doubles{}, half, distances, set);
        Store(own.factor * product, half, products, set);
      }
      begin = f.set_ends_[set];
    }
  }

  // factors[r * num_rows + n] of the `count` rows n of one chunk.
  static PLEAT_ALWAYS_INLINE void Kernels(const RegionalFactors& f, float* products,
                                          ptrdiff_t count, float* factors) {
    float* distances = products + f.set_ends_.size() * kLanes;
    size_t s = 0;
    for (const RegionalFactors::Region& region : f.regions_) {
      Lanes kernel = Lanes{} + region.bias;
      for (; s < region.end_scale; ++s) {
        const RegionalFactors::Scale& scale = f.scales_[s];
        kernel += scale.amplitude * Exp(scale.exponent * At(distances, scale.set)) +
                  scale.linear * At(products, scale.set);
      }
      if (count == kLanes) {
        At(factors, 0) = kernel;
      } else {
        for (ptrdiff_t n = 0; n < count; ++n) factors[n] = kernel[n];
      }
      factors += f.num_rows_;
    }
  }

  static PLEAT_ALWAYS_INLINE void Run(const RegionalFactors& f, const double* row, double* scratch,
                                      float* factors) {
    double* atoms = scratch;
    double* set_lanes = atoms + 2 * kLanes * f.atom_ends_.size();
    auto* products = reinterpret_cast<float*>(set_lanes);
    double* atom_squares = set_lanes + kLanes * f.set_ends_.size();
    auto* shortenings = reinterpret_cast<Shortening*>(atom_squares + f.atom_ends_.size());
    Shorten(f, row, atom_squares, shortenings);
    const float* inputs = f.inputs_.data();
    for (ptrdiff_t n = 0; n < f.num_rows_; n += kLanes) {
      Sums(f, inputs, row, shortenings, atoms, products);
      Kernels(f, products, std::min(kLanes, f.num_rows_ - n), factors + n);
      inputs += f.chunk_size();
    }
  }
};

const KernelVariants<RegionalFactors::Function>& RegionalFactors::Variants() {
  static const auto variants = CompiledVariants<RegionalFactorsKernel>();
  return variants;
}

void RegionalFactors::Compute(const double* row, double* scratch, float* factors) const {
  Variants().front().kernel(*this, row, scratch, factors);
}

}  // namespace pleat
