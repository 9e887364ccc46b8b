#pragma once

#include <Eigen/Core>

namespace vibro_impact::core
{
/// By Eigen's dense solvers, in a file of their own because they take long to compile.
struct Eigenmodes
{
  Eigen::VectorXd values;   ///< ascending
  Eigen::MatrixXd vectors;  ///< columns, normalised to V^T M V = I
};

/// Of K v = lambda v, K symmetric.
Eigenmodes eigenmodes(const Eigen::MatrixXd& K);

/// Of K v = lambda M v, both symmetric, M positive definite.
Eigenmodes eigenmodes(const Eigen::MatrixXd& K, const Eigen::MatrixXd& M);

}  // namespace vibro_impact::core
