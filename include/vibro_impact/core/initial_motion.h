#pragma once

#include <vector>

namespace vibro_impact::core
{
/// Displacement and velocity relative to the base with which a run begins, in the modes of each structure on its own:
/// entry m - 1 belongs to mode m of Structure::mode(), mass-normalised, so that the point x of the structure is
/// displaced by sum_m phi_m(x) displacement[m - 1]. Measured from the unloaded structure, also where the contact is an
/// interference fit. Modes that are not given, and attachment shapes, are at zero.
struct InitialMotion
{
  struct OfStructure
  {
    std::vector<double> displacement;  ///< m kg^1/2, finite
    std::vector<double> velocity;      ///< m/s kg^1/2, finite
  };
  OfStructure structure1;
  OfStructure structure2;
};

}  // namespace vibro_impact::core
