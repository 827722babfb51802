#include "regional_factors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "pleat/simd/dense.h"

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
                         .exponent = -.5 * scale.inverse_width,
                         .amplitude = scale.amplitude,
                         .linear = scale.linear});
    }
    regions_.push_back({.bias = region.bias, .end_scale = scales_.size()});
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
  const ptrdiff_t num_chunks = (num_rows_ + kLanes - 1) / kLanes;
  const size_t chunk_size = kLanes * (columns_.size() + atom_ends_.size());
  inputs_.assign(static_cast<size_t>(num_chunks) * chunk_size, 0);
  for (ptrdiff_t n = 0; n < num_rows_; ++n) {
    double* const lane = inputs_.data() + static_cast<size_t>(n / kLanes) * chunk_size + n % kLanes;
    size_t c = 0;
    for (size_t a = 0; a < atom_ends_.size(); ++a) {
      double square = 0;
      for (; c < atom_ends_[a]; ++c) {
        const double value = parameters.inputs(n, columns_[c]);
        lane[c * kLanes] = value;
        square += value * value;
      }
      lane[(columns_.size() + a) * kLanes] = square;
    }
  }
}

size_t RegionalFactors::scratch_size() const {
  return kLanes * (2 * atom_ends_.size() + 2 * set_ends_.size() + scales_.size()) +
         3 * set_ends_.size() + atom_ends_.size();
}

// The kernel; a struct, so that it can be a friend.
struct RegionalFactorsKernel {
  typedef double Lanes __attribute__((vector_size(64), aligned(8), may_alias));
  static constexpr ptrdiff_t kLanes = RegionalFactors::kLanes;

  static PLEAT_ALWAYS_INLINE Lanes& At(double* values, size_t i) {
    return *reinterpret_cast<Lanes*>(values + i * kLanes);
  }

  // How the sums over one set change when its row is shortened; a row within the bound leaves them
  // as they are, to the bit.
  struct Shortening {
    double factor;          // s
    double distance_more;   // (s^2 - 1) |x|^2
    double distance_slope;  // 2 (1 - s)
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
      const double norm = std::sqrt(square);
      shortenings[set] = {1, 0, 0};
      if (!(norm > f.set_bounds_[set])) continue;
      const double s = f.set_bounds_[set] / norm;
      shortenings[set] = {s, (s * s - 1) * square, 2 * (1 - s)};
    }
  }

  // Of the rows of one chunk: the exponents of all scales and the products of all sets.
  static PLEAT_ALWAYS_INLINE void Sums(const RegionalFactors& f, const double* inputs,
                                       const double* row, const double* atom_squares,
                                       const Shortening* shortenings, double* atoms,
                                       double* products, double* exponents) {
    // |x - x_n|^2 = |x|^2 + |x_n|^2 - 2 x . x_n: of every column only the product is needed.
    const double* squares = inputs + kLanes * f.columns_.size();
    size_t c = 0;
    for (size_t a = 0; a < f.atom_ends_.size(); ++a) {
      Lanes product = {};
      for (; c < f.atom_ends_[a]; ++c) {
        product += row[f.columns_[c]] * *reinterpret_cast<const Lanes*>(inputs + c * kLanes);
      }
      const Lanes square = *reinterpret_cast<const Lanes*>(squares + a * kLanes);
      const Lanes distance = atom_squares[a] + square - 2 * product;
      At(atoms, 2 * a) = distance;
      At(atoms, 2 * a + 1) = product;
    }
    double* distances = products + f.set_ends_.size() * kLanes;
    size_t i = 0;
    for (size_t set = 0; set < f.set_ends_.size(); ++set) {
      Lanes distance = {}, product = {};
      for (; i < f.set_ends_[set]; ++i) {
        distance += At(atoms, 2 * f.set_atoms_[i]);
        product += At(atoms, 2 * f.set_atoms_[i] + 1);
      }
      const Shortening& shortening = shortenings[set];
      const Lanes shortened =
          distance + shortening.distance_more + shortening.distance_slope * product;
      // Rounding may leave less than nothing, which a narrow kernel would blow up.
      At(distances, set) = shortened > 0 ? shortened : Lanes{};
      At(products, set) = shortening.factor * product;
    }
    for (size_t s = 0; s < f.scales_.size(); ++s) {
      At(exponents, s) = f.scales_[s].exponent * At(distances, f.scales_[s].set);
    }
  }

  // factors[r * num_rows + n] of the `count` rows n of one chunk.
  static PLEAT_ALWAYS_INLINE void Kernels(const RegionalFactors& f, double* products, double* rbfs,
                                          ptrdiff_t count, float* factors) {
    size_t s = 0;
    for (const RegionalFactors::Region& region : f.regions_) {
      Lanes kernel = Lanes{} + region.bias;
      for (; s < region.end_scale; ++s) {
        const RegionalFactors::Scale& scale = f.scales_[s];
        kernel += scale.amplitude * At(rbfs, s) + scale.linear * At(products, scale.set);
      }
      for (ptrdiff_t n = 0; n < count; ++n) factors[n] = static_cast<float>(kernel[n]);
      factors += f.num_rows_;
    }
  }

  static PLEAT_ALWAYS_INLINE void Run(const RegionalFactors& f, const double* row, double* scratch,
                                      float* factors) {
    double* atoms = scratch;
    double* products = atoms + 2 * kLanes * f.atom_ends_.size();
    double* exponents = products + 2 * kLanes * f.set_ends_.size();
    double* atom_squares = exponents + kLanes * f.scales_.size();
    auto* shortenings = reinterpret_cast<Shortening*>(atom_squares + f.atom_ends_.size());
    Shorten(f, row, atom_squares, shortenings);
    const auto exp_in_place = ChosenDenseOps().exp_in_place;
    const double* inputs = f.inputs_.data();
    for (ptrdiff_t n = 0; n < f.num_rows_; n += kLanes) {
      Sums(f, inputs, row, atom_squares, shortenings, atoms, products, exponents);
      exp_in_place(exponents, kLanes * static_cast<ptrdiff_t>(f.scales_.size()));
      Kernels(f, products, exponents, std::min(kLanes, f.num_rows_ - n), factors + n);
      inputs += kLanes * (f.columns_.size() + f.atom_ends_.size());
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
