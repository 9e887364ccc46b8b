#include "eigenmodes.h"

#include <Eigen/Eigenvalues>

namespace vibro_impact::core
{
Eigenmodes eigenmodes(const Eigen::MatrixXd& K)
{
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(K);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigenmodes eigenmodes(const Eigen::MatrixXd& K, const Eigen::MatrixXd& M)
{
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(K, M);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace vibro_impact::core
