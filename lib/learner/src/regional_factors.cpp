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
  set_bounds_.assign(sets.size(), std::numeric_limits<float>::infinity());
  for (const RegionalGpParameters::Region& region : parameters.regions) {
    for (const RegionalGpParameters::Scale& scale : region.scales) {
      const int set = sets.at(scale.columns);
      set_bounds_[set] = std::min(set_bounds_[set], static_cast<float>(scale.max_norm));
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
      lane[(columns_.size() + a) * kLanes] = static_cast<float>(square);
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

size_t RegionalFactors::scratch_size() const {
  return kLanes * (2 * atom_ends_.size() + 2 * set_ends_.size()) + 3 * set_ends_.size() +
         atom_ends_.size();
}

// The kernel; a struct, so that it can be a friend.
struct RegionalFactorsKernel {
  typedef float Lanes __attribute__((vector_size(64), aligned(4), may_alias));
  typedef uint32_t Bits __attribute__((vector_size(64)));
  static constexpr ptrdiff_t kLanes = RegionalFactors::kLanes;

  static PLEAT_ALWAYS_INLINE Lanes& At(float* values, size_t i) {
    return *reinterpret_cast<Lanes*>(values + i * kLanes);
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

  // How the sums over one set change when its row is shortened; a row within the bound leaves them
  // as they are, to the bit.
  struct Shortening {
    float factor;          // s
    float distance_more;   // (s^2 - 1) |x|^2
    float distance_slope;  // 2 (1 - s)
  };

  static PLEAT_ALWAYS_INLINE void Shorten(const RegionalFactors& f, const float* row,
                                          float* atom_squares, Shortening* shortenings) {
    size_t c = 0;
    for (size_t a = 0; a < f.atom_ends_.size(); ++a) {
      double square = 0;
      for (; c < f.atom_ends_[a]; ++c) square += double(row[f.columns_[c]]) * row[f.columns_[c]];
      atom_squares[a] = static_cast<float>(square);
    }
    size_t i = 0;
    for (size_t set = 0; set < f.set_ends_.size(); ++set) {
      double square = 0;
      for (; i < f.set_ends_[set]; ++i) square += atom_squares[f.set_atoms_[i]];
      const double norm = std::sqrt(square);
      shortenings[set] = {1, 0, 0};
      if (!(norm > f.set_bounds_[set])) continue;
      const double s = f.set_bounds_[set] / norm;
      shortenings[set] = {static_cast<float>(s), static_cast<float>((s * s - 1) * square),
                          static_cast<float>(2 * (1 - s))};
    }
  }

  // Of the rows of one chunk: the products and the distances of all sets.
  static PLEAT_ALWAYS_INLINE void Sums(const RegionalFactors& f, const float* inputs,
                                       const float* row, const float* atom_squares,
                                       const Shortening* shortenings, float* atoms,
                                       float* products) {
    // |x - x_n|^2 = |x|^2 + |x_n|^2 - 2 x . x_n: of every column only the product is needed.
    const float* squares = inputs + kLanes * f.columns_.size();
    size_t c = 0;
    for (size_t a = 0; a < f.atom_ends_.size(); ++a) {
      Lanes product = {};
      for (; c < f.atom_ends_[a]; ++c) {
        product += row[f.columns_[c]] * *reinterpret_cast<const Lanes*>(inputs + c * kLanes);
      }
      const Lanes square = *reinterpret_cast<const Lanes*>(squares + a * kLanes);
      At(atoms, 2 * a) = atom_squares[a] + square - 2 * product;
      At(atoms, 2 * a + 1) = product;
    }
    float* distances = products + f.set_ends_.size() * kLanes;
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

  static PLEAT_ALWAYS_INLINE void Run(const RegionalFactors& f, const float* row, float* scratch,
                                      float* factors) {
    float* atoms = scratch;
    float* products = atoms + 2 * kLanes * f.atom_ends_.size();
    float* atom_squares = products + 2 * kLanes * f.set_ends_.size();
    auto* shortenings = reinterpret_cast<Shortening*>(atom_squares + f.atom_ends_.size());
    Shorten(f, row, atom_squares, shortenings);
    const float* inputs = f.inputs_.data();
    for (ptrdiff_t n = 0; n < f.num_rows_; n += kLanes) {
      Sums(f, inputs, row, atom_squares, shortenings, atoms, products);
      Kernels(f, products, std::min(kLanes, f.num_rows_ - n), factors + n);
      inputs += f.chunk_size();
    }
  }
};

const KernelVariants<RegionalFactors::Function>& RegionalFactors::Variants() {
  static const auto variants = CompiledVariants<RegionalFactorsKernel>();
  return variants;
}

void RegionalFactors::Compute(const float* row, float* scratch, float* factors) const {
  Variants().front().kernel(*this, row, scratch, factors);
}

}  // namespace pleat
