#include "vibro_impact/config/model_summary.h"

#include <cmath>
#include <string>

#include "vibro_impact/config/number.h"

namespace vibro_impact::config
{
namespace
{
constexpr double two_pi = 6.28318530717958647692;

std::vector<double> inHertz(const core::LinearState& state)
{
  std::vector<double> frequencies;
  for (Eigen::Index n = 0; n < state.size(); ++n)
  {
    frequencies.push_back(state.frequency[n] / two_pi);
  }
  return frequencies;
}

// A mode with a node at the contact point, or one that moves both structures alike, leaves the gap as it is but for
// rounding.
std::optional<double> lowestThatMovesTheGap(const core::LinearState& state, const std::vector<double>& frequencies)
{
  constexpr double rounding = 1.0e-9;
  const double greatest = state.contact_deflection.abs().maxCoeff();
  for (Eigen::Index n = 0; n < state.size(); ++n)
  {
    if (std::abs(state.contact_deflection[n]) > rounding * greatest)
    {
      return frequencies[static_cast<std::size_t>(n)];
    }
  }
  return std::nullopt;
}

}  // namespace

ModelSummary summarize(const core::SwitchedModel& model)
{
  ModelSummary summary;
  summary.free_frequencies = inHertz(model.free());
  summary.contact_frequencies = inHertz(model.contact());
  summary.free_frequency_hz = lowestThatMovesTheGap(model.free(), summary.free_frequencies);
  summary.contact_frequency_hz = lowestThatMovesTheGap(model.contact(), summary.contact_frequencies);
  if (summary.free_frequency_hz && summary.contact_frequency_hz)
  {
    summary.frequency_ratio = *summary.contact_frequency_hz / *summary.free_frequency_hz;
  }
  const Eigen::ArrayXd loss = model.mappingLoss();
  summary.mapping_loss.assign(loss.data(), loss.data() + loss.size());
  return summary;
}

OutputFile modelTable(const ModelSummary& summary)
{
  std::string text = "key,value\n";
  const auto add = [&text](const std::string& key, const std::optional<double>& value)
  {
    if (value)
    {
      text += key + "," + formatNumber(*value) + "\n";
    }
  };
  const auto add_all = [&add](const std::string& prefix, const std::vector<double>& values, const std::string& suffix)
  {
    for (std::size_t n = 0; n < values.size(); ++n)
    {
      add(prefix + std::to_string(n + 1) + suffix, values[n]);
    }
  };
  add("free_frequency_hz", summary.free_frequency_hz);
  add("contact_frequency_hz", summary.contact_frequency_hz);
  add("frequency_ratio", summary.frequency_ratio);
  add_all("free_", summary.free_frequencies, "_hz");
  add_all("contact_", summary.contact_frequencies, "_hz");
  add_all("mapping_loss_", summary.mapping_loss, "");
  return {"model.csv", text};
}

}  // namespace vibro_impact::config
