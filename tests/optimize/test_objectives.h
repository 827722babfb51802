// Objectives with known minima for the optimizer tests.
#pragma once

#include <cmath>
#include <limits>

#include "pleat/optimize/objective.h"

namespace pleat {

// sum_i 100 (x_{i+1} - x_i^2)^2 + (1 - x_i)^2: minimum 0 at (1, ..., 1) in a curved valley.
class Rosenbrock : public Objective {
 public:
  explicit Rosenbrock(int num_unknowns) : num_unknowns_(num_unknowns) {}
  int num_unknowns() const override { return num_unknowns_; }
  double Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) override {
    if (gradient) gradient->setZero(x.size());
    double value = 0;
    for (int i = 0; i + 1 < num_unknowns_; ++i) {
      const double bend = x[i + 1] - x[i] * x[i], rest = 1 - x[i];
      value += 100 * bend * bend + rest * rest;
      if (!gradient) continue;
      (*gradient)[i] += -400 * bend * x[i] - 2 * rest;
      (*gradient)[i + 1] += 200 * bend;
    }
    return value;
  }

 private:
  int num_unknowns_;
};

// 1/2 sum_i c_i (x_i - i)^2 with conditions 1 ... 1e4.
class Quadratic : public Objective {
 public:
  explicit Quadratic(int num_unknowns) : num_unknowns_(num_unknowns) {}
  int num_unknowns() const override { return num_unknowns_; }
  double Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) override {
    if (gradient) gradient->resize(x.size());
    double value = 0;
    for (int i = 0; i < num_unknowns_; ++i) {
      const double c = std::pow(1e4, double(i) / num_unknowns_);
      value += .5 * c * (x[i] - i) * (x[i] - i);
      if (gradient) (*gradient)[i] = c * (x[i] - i);
    }
    return value;
  }

 private:
  int num_unknowns_;
};

// x - log x, defined for x > 0 only: minimum 1 at 1.
class LogBarrier : public Objective {
 public:
  int num_unknowns() const override { return 1; }
  double Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) override {
    if (gradient) gradient->resize(1);
    if (x[0] <= 0) return std::numeric_limits<double>::quiet_NaN();
    if (gradient) (*gradient)[0] = 1 - 1 / x[0];
    return x[0] - std::log(x[0]);
  }
};

}  // namespace pleat
