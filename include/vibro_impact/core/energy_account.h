#pragma once

#include <algorithm>
#include <cmath>

namespace vibro_impact::core
{
/// Where the energy came from and went since a run began (rest or a given motion). In J, and in the frame of the base:
/// of the motion relative to it. Every entry is computed by itself, the dissipation as the integral of 2 zeta omega
/// eta'^2 over time, so that residual() is a check of them all.
struct EnergyAccount
{
  double initial = 0.0;             ///< stored when the run began
  double structure1 = 0.0;          ///< stored now in structure 1, kinetic and strain
  double structure2 = 0.0;          ///< stored now in structure 2, kinetic and strain; 0 of a rigid surface
  double spring = 0.0;              ///< stored now in the contact spring, k g^2/2 in contact
  double left_out = 0.0;            ///< stored now in modes that the conjoined basis leaves out and a preload holds
                                    ///< deflected; 0 in the attachment basis
  double work = 0.0;                ///< of the base on both structures, -integral a sum Gamma eta' dt
  double contact_work = 0.0;        ///< put into the spring by changes of clearance or stiffness
  double dissipated_free = 0.0;     ///< by damping in S0
  double dissipated_contact = 0.0;  ///< by damping in S1
  double mapping_loss = 0.0;        ///< lost at the switches by a truncated mapping; 0 in the attachment basis
  double turnover = 0.0;            ///< initial, and the sums of |work|, dissipation and |mapping loss| of every span
                                    ///< between two switches, and of |contact work|: what the residual is measured by

  double stored() const
  {
    return structure1 + structure2 + spring + left_out;
  }
  /// initial + work + contact work - dissipated - lost - stored: 0 but for rounding.
  double residual() const
  {
    return initial + work + contact_work - dissipated_free - dissipated_contact - mapping_loss - stored();
  }
  /// |residual| as a share of the turnover or of what is stored, whichever is more; 0 where nothing ever moved.
  double closure() const
  {
    const double scale = std::max(turnover, stored());
    return scale > 0.0 ? std::abs(residual()) / scale : 0.0;
  }
};

}  // namespace vibro_impact::core
