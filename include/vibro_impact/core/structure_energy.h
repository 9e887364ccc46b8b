#pragma once

#include <Eigen/Core>

namespace vibro_impact::core
{
/// The share of one structure in the energy of a linear state, as quadratic forms of the state's coordinates:
///   E = (eta'^T kinetic eta' + eta^T strain eta)/2.
struct StructureEnergy
{
  Eigen::MatrixXd kinetic;  ///< symmetric; those of both structures add up to the unit matrix
  Eigen::MatrixXd strain;   ///< symmetric, (rad/s)^2; those of both structures and k b b^T of the spring in S1 add up
                            ///< to diag(omega_n^2)

  /// J. Does not allocate.
  double energy(const Eigen::Ref<const Eigen::VectorXd>& displacement,
                const Eigen::Ref<const Eigen::VectorXd>& velocity) const
  {
    double sum = 0.0;
    for (Eigen::Index n = 0; n < kinetic.cols(); ++n)
    {
      sum += velocity(n) * kinetic.col(n).dot(velocity) + displacement(n) * strain.col(n).dot(displacement);
    }
    return 0.5 * sum;
  }
};

}  // namespace vibro_impact::core
