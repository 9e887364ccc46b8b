#include "vibro_impact/core/modal_table.h"

#include <algorithm>
#include <cmath>

namespace vibro_impact::core
{
namespace
{
constexpr double two_pi = 6.28318530717958647692;
}

ModalTable::ModalTable(const ModalTableParameters& parameters)
{
  for (std::size_t m = 0; m < parameters.frequency_hz.size(); ++m)
  {
    Mode mode{two_pi * parameters.frequency_hz[m], parameters.contact_deflection[m], parameters.participation[m]};
    if (!parameters.damping_ratio.empty())
    {
      mode.damping_ratio = parameters.damping_ratio[m];
    }
    modes_.push_back(mode);
  }
  std::stable_sort(modes_.begin(), modes_.end(),
                   [](const Mode& a, const Mode& b) { return a.frequency < b.frequency; });
  rigid_body_modes_ = static_cast<int>(
      std::count_if(modes_.begin(), modes_.end(), [](const Mode& mode) { return mode.frequency == 0.0; }));

  if (parameters.static_receptance)
  {
    const double known = elasticReceptance(parameters);
    const double rest = *parameters.static_receptance - known;
    const double frequency = residual_frequency * modes_.back().frequency;
    if (rest > 0.0 && frequency > 0.0)
    {
      modes_.push_back(Mode{frequency, frequency * std::sqrt(rest), 0.0});
    }
  }
}

int ModalTable::modeCount() const
{
  return static_cast<int>(modes_.size());
}

Mode ModalTable::mode(int m) const
{
  return modes_.at(static_cast<std::size_t>(m - 1));
}

double ModalTable::staticReceptance(int kept) const
{
  double sum = 0.0;
  for (int m = modeCount(); m > kept; --m)
  {
    const double compliance = mode(m).contact_deflection / mode(m).frequency;
    sum += compliance * compliance;
  }
  return sum;
}

double ModalTable::staticBaseResponse(int kept) const
{
  double sum = 0.0;
  for (int m = modeCount(); m > kept; --m)
  {
    sum += mode(m).contact_deflection * mode(m).participation / (mode(m).frequency * mode(m).frequency);
  }
  return sum;
}

double ModalTable::receptance(double omega) const
{
  double sum = 0.0;
  for (const Mode& mode : modes_)
  {
    if (mode.contact_deflection != 0.0)
    {
      sum += mode.contact_deflection * mode.contact_deflection / ((mode.frequency - omega) * (mode.frequency + omega));
    }
  }
  return sum;
}

double elasticReceptance(const ModalTableParameters& table)
{
  double sum = 0.0;
  for (std::size_t m = 0; m < table.frequency_hz.size(); ++m)
  {
    if (table.frequency_hz[m] > 0.0)
    {
      const double compliance = table.contact_deflection[m] / (two_pi * table.frequency_hz[m]);
      sum += compliance * compliance;
    }
  }
  return sum;
}

}  // namespace vibro_impact::core
