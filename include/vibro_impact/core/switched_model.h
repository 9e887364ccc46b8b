#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "vibro_impact/core/initial_motion.h"
#include "vibro_impact/core/parameters.h"
#include "vibro_impact/core/structure.h"
#include "vibro_impact/core/structure_energy.h"

namespace vibro_impact::core
{
/// One of the two linear states, in its own modal coordinates eta_n:
///   eta_n'' + 2 zeta_n omega_n eta_n' + omega_n^2 eta_n = -Gamma_n a(t) + f_n,     g = g_0 + sum_n b_n eta_n
/// All arrays have one entry per coordinate.
struct LinearState
{
  /// omega_n, rad/s, ascending, >= 0. Of the coordinates with omega_n = 0, the motions of a free body, at most one
  /// moves the gap in S0 and none in S1.
  Eigen::ArrayXd frequency;
  Eigen::ArrayXd damping_ratio;       ///< zeta_n, in [0, 1)
  Eigen::ArrayXd contact_deflection;  ///< b_n in S0, d_n in S1: gap per unit coordinate, kg^-1/2
  Eigen::ArrayXd participation;       ///< Gamma_n, kg^1/2
  Eigen::ArrayXd preload;             ///< constant modal force f_n: 0 in S0, -k clearance d_n in S1, N kg^-1/2
  double gap = 0.0;  ///< g_0, m: the clearance; in S1 of the conjoined basis as much less of it as the modes that are
                     ///< left out yield to the preload, so that the gap at rest is the static one

  Eigen::Index size() const
  {
    return frequency.size();
  }
};

/// A mode of one structure on its own.
struct StructureMode
{
  int structure = 1;                ///< 1 or 2
  int number = 0;                   ///< as in Structure::mode(); 0: the attachment shape
  double contact_deflection = 0.0;  ///< its shape at the contact point, kg^-1/2
};

/// The immutable switched model: two linear states, the mapping between them, and the contact. Safe to share.
class SwitchedModel
{
public:
  /// Builds the model. Throws std::invalid_argument as validate() does.
  explicit SwitchedModel(const SystemParameters& parameters);

  /// A model whose motion is made of the given modes alone, those of both structures in one list: contact_deflection is
  /// the gap per unit coordinate (+phi of structure 1, -phi of structure 2). S1 has the Ritz modes of the same space;
  /// nothing is lost in the mapping. As no one says which structure they belong to, all of them are taken for modes 1,
  /// 2,
  /// ... of structure 1. The scales are all 1. Throws std::invalid_argument where there is no mode, a
  /// frequency is negative, a number not finite, the stiffness not positive or a damping ratio outside [0, 1).
  SwitchedModel(const std::vector<Mode>& modes, const ContactParameters& contact, const DampingParameters& damping);

  const ReferenceScales& scales() const
  {
    return scales_;
  }

  /// S0: not in contact.
  const LinearState& free() const
  {
    return free_;
  }
  /// S1: in contact.
  const LinearState& contact() const
  {
    return contact_;
  }

  /// T (free().size() x contact().size()): eta0 = T eta1 and eta1 = T^T eta0, displacement and velocity alike; Ervin,
  /// eq. (13).
  const Eigen::MatrixXd& mapping() const
  {
    return mapping_;
  }

  /// For each S0 coordinate the share 1 - sum_n T_mn^2 of its energy that a switch to S1 loses; zero in the attachment
  /// basis.
  Eigen::ArrayXd mappingLoss() const;

  /// Whether both states live in one space, as in the attachment basis, so that a switch loses nothing.
  bool lossless() const
  {
    return lossless_;
  }

  /// The energy of structure 1 or 2 in the coordinates of S0 and of S1.
  const StructureEnergy& freeEnergy(int structure) const
  {
    return free_energy_.at(static_cast<std::size_t>(structure - 1));
  }
  const StructureEnergy& contactEnergy(int structure) const
  {
    return contact_energy_.at(static_cast<std::size_t>(structure - 1));
  }

  /// The modes of the structures on their own that the states are made of. A point of structure i where these have the
  /// shapes phi_m is displaced by the sum of phi_m times coordinate m over those of that structure.
  const std::vector<StructureMode>& structureModes() const
  {
    return structure_modes_;
  }
  /// Their coordinates (m kg^1/2) = this matrix times those of S0, or of S1 if `in_contact`. In the conjoined basis the
  /// modes in contact hold more of them than S0 keeps.
  const Eigen::MatrixXd& structureCoordinates(bool in_contact) const
  {
    return in_contact ? contact_structure_coordinates_ : structure_coordinates_;
  }

  /// Displacement and velocity of the S0 coordinates (free().size() each) in the given motion. Throws
  /// std::invalid_argument for a mode that the basis does not have, and for a value that is not finite; the message
  /// names both.
  void freeCoordinates(const InitialMotion& motion, Eigen::VectorXd& displacement, Eigen::VectorXd& velocity) const;

  double stiffness() const
  {
    return spring_.stiffness;
  }
  double clearance() const
  {
    return spring_.clearance;
  }

private:
  void buildFromSpace(std::vector<Mode> coordinates, const DampingParameters& damping);

  ContactParameters spring_;
  ReferenceScales scales_;
  LinearState free_;
  LinearState contact_;
  Eigen::MatrixXd mapping_;
  bool lossless_ = false;
  std::vector<StructureMode> structure_modes_;  // of both structures
  Eigen::MatrixXd structure_coordinates_;       // theirs = this matrix times those of S0; its columns are orthonormal
  Eigen::MatrixXd contact_structure_coordinates_;  // theirs = this matrix times those of S1
  std::array<StructureEnergy, 2> free_energy_;
  std::array<StructureEnergy, 2> contact_energy_;
};

}  // namespace vibro_impact::core
