#pragma once

#include <vector>

#include "vibro_impact/core/parameters.h"
#include "vibro_impact/core/structure.h"

namespace vibro_impact::core
{
/// A structure of which a list of modes is known, from any finite-element code or modal test.
///
/// Where the static receptance is given, it completes the list: what the elastic modes leave of it becomes one more
/// mode above them, without participation, at `residual_frequency` times the highest frequency of the list. This is
/// where the static deflections of the unknown modes of a beam have their strain energy: its shapes at the contact are
/// of like size and its frequencies grow as m^2, so that for many known modes N
///   omega^2 = sum_{m > N} m^-4 / sum_{m > N} m^-8 = 7/3 N^4.
class ModalTable : public Structure
{
public:
  /// sqrt(7/3)
  static constexpr double residual_frequency = 1.5275252316519468;

  /// `parameters` must have passed validate(). The modes may be in any order.
  explicit ModalTable(const ModalTableParameters& parameters);

  int modeCount() const override;
  int rigidBodyModeCount() const override
  {
    return rigid_body_modes_;
  }
  Mode mode(int m) const override;
  double staticReceptance(int kept) const override;
  double staticBaseResponse(int kept) const override;
  double receptance(double omega) const override;

private:
  std::vector<Mode> modes_;
  int rigid_body_modes_ = 0;
};

/// sum phi^2/omega^2 of the elastic modes of a list, m/N: the least static receptance that it can have.
double elasticReceptance(const ModalTableParameters& table);

/// What a static receptance may fall short of that sum, as a share of it: by the digits of a table.
constexpr double table_rounding = 1.0e-5;

}  // namespace vibro_impact::core
