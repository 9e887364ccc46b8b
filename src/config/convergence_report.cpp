#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>

#include "table.h"
#include "vibro_impact/config/convergence.h"

namespace vibro_impact::config
{
namespace
{
// A mapping that loses less than this loses nothing but rounding.
constexpr double rounding_loss = 1.0e-9;

std::string rounded(double value, int digits)
{
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  stream.precision(digits);
  stream << value;
  return stream.str();
}

std::string rounded(const std::optional<double>& value, int digits)
{
  return value ? rounded(*value, digits) : "-";
}

std::string rounded(const Estimate& estimate)
{
  return rounded(estimate.value, 5) + " +- " + rounded(estimate.error, 2);
}

// Lines of cells, aligned to the right below their heads.
class TextTable
{
public:
  explicit TextTable(std::vector<std::string> heads) : lines_{std::move(heads)}
  {
  }

  void add(std::vector<std::string> cells)
  {
    lines_.push_back(std::move(cells));
  }

  std::string text() const
  {
    std::vector<std::size_t> widths(lines_.front().size(), 0);
    for (const auto& line : lines_)
    {
      for (std::size_t i = 0; i < line.size(); ++i)
      {
        widths[i] = std::max(widths[i], line[i].size());
      }
    }
    std::string result;
    for (const auto& line : lines_)
    {
      for (std::size_t i = 0; i < line.size(); ++i)
      {
        result += std::string(2 + widths[i] - line[i].size(), ' ') + line[i];
      }
      result.erase(result.find_last_not_of(' ') + 1);
      result += '\n';
    }
    return result;
  }

private:
  std::vector<std::vector<std::string>> lines_;
};

bool isConjoined(const core::SystemParameters& parameters)
{
  return std::holds_alternative<core::ConjoinedBasis>(parameters.basis);
}

std::string basisOf(const core::SystemParameters& parameters, int modes)
{
  const std::string number = std::to_string(modes);
  return isConjoined(parameters) ? "modes_free = modes_contact = " + number : "modes_per_beam = " + number;
}

std::string mark(const Convergence& result, const BasisRun& run)
{
  return result.settled && run.modes == result.runs[*result.settled].modes ? "<" : "";
}

std::string impactText(const Convergence& result, bool conjoined)
{
  std::vector<std::string> heads = {"modes",         "free Hz",          "contact Hz", "highest Hz",  "period",
                                    "impacts/cycle", "mean impulse N s", "its change", "onset change"};
  if (conjoined)
  {
    heads.insert(heads.end(), {"least impulse N s", "mapping loss"});
  }
  heads.insert(heads.end(), {"us/cycle", ""});
  TextTable table(heads);
  for (const BasisRun& run : result.runs)
  {
    std::vector<std::string> cells = {std::to_string(run.modes),
                                      rounded(run.free_frequency_hz, 6),
                                      rounded(run.contact_frequency_hz, 6),
                                      rounded(run.highest_frequency_hz, 4),
                                      run.period > 0 ? std::to_string(run.period) : "none",
                                      rounded(run.impacts_per_cycle, 4),
                                      rounded(run.impulse_mean, 6),
                                      rounded(run.impulse_change, 2),
                                      rounded(run.onset_change, 2)};
    if (conjoined)
    {
      cells.insert(cells.end(), {rounded(run.impulse_min, 3), rounded(run.mapping_loss, 2)});
    }
    cells.insert(cells.end(), {rounded(1.0e6 * run.cost, 3), mark(result, run)});
    table.add(std::move(cells));
  }
  return table.text();
}

std::string statisticsText(const Convergence& result)
{
  TextTable table(
      {"modes", "mean impulse N s", "spread N s", "impacts/cycle", "impulse/cycle N s", "part by", "apart", ""});
  for (const BasisRun& run : result.runs)
  {
    if (run.statistics)
    {
      const ImpactStatistics& statistics = *run.statistics;
      table.add({std::to_string(run.modes), rounded(statistics.impulse_mean), rounded(statistics.impulse_spread),
                 rounded(statistics.impacts_per_cycle), rounded(statistics.impulse_per_cycle),
                 rounded(run.separation, 3), rounded(run.statistics_apart, 2), mark(result, run)});
    }
  }
  return table.text();
}

double greatestRelativeError(const ImpactStatistics& statistics)
{
  double greatest = 0.0;
  for (const Estimate& estimate :
       {statistics.impulse_mean, statistics.impulse_spread, statistics.impacts_per_cycle, statistics.impulse_per_cycle})
  {
    if (estimate.value != 0.0)
    {
      greatest = std::max(greatest, estimate.error / std::abs(estimate.value));
    }
  }
  return greatest;
}

// What a response without a period is.
std::string withoutPeriod(const BasisRun& run)
{
  if (run.separation)
  {
    return "Chaotic: no period up to 16 cycles, and neighbouring motions part by a factor of " +
           rounded(run.separation, 3) +
           " every cycle. No number of modes makes single impacts converge; what can be compared are statistics.";
  }
  return "No period up to 16 cycles, though neighbouring motions stay together: a beat of two frequencies, a longer "
         "period or a slow transient. Its impacts have no partners to be compared with, its statistics have.";
}

// Whether what has settled is the basis of all modes that there are, with which no other agrees.
bool hasNoneToAgreeWith(const Convergence& result)
{
  return *result.settled + 1 == result.runs.size();
}

std::string settledText(const core::SystemParameters& parameters, const ConvergenceOptions& options,
                        const Convergence& result)
{
  const BasisRun& run = result.runs[*result.settled];
  const std::string period = run.period == 0 ? withoutPeriod(run) + "\n" : std::string();
  if (hasNoneToAgreeWith(result))
  {
    return period + basisOf(parameters, run.modes) +
           " has all modes that the structures have: there is no larger basis" +
           (result.runs.size() > 1 ? ", and no smaller one agrees with it to " + rounded(options.accuracy, 3)
                                   : ", nor a smaller one, to compare it with") +
           ". Whether a modal table lists modes enough, a longer one can tell.\n";
  }
  const std::string from = basisOf(parameters, run.modes) + " on";
  if (run.period == 0)
  {
    return period + "Statistics agree from " + from + ", to " + rounded(options.accuracy, 3) +
           " or within their sampling uncertainty (standard errors up to " +
           rounded(100.0 * greatestRelativeError(*run.statistics), 2) + " %).\n";
  }
  if (run.impacts.empty())
  {
    return "No impacts, from " + from + ".\n";
  }
  return "Settled: impulses and onsets agree to " + rounded(options.accuracy, 3) + " from " + from + " (period " +
         std::to_string(run.period) + ").\n";
}

std::string unsettledText(const core::SystemParameters& parameters, const ConvergenceOptions& options,
                          const Convergence& result)
{
  const BasisRun& last = result.runs.back();
  const std::string up_to = " up to " + basisOf(parameters, last.modes) + ", the largest basis tried. ";
  std::string text = last.period == 0 ? withoutPeriod(last) + "\nNot settled" + up_to : "Not settled" + up_to;
  // The bases that could have shown it: the larger half.
  const std::size_t half = result.runs.size() / 2;
  if (std::any_of(result.runs.begin() + static_cast<std::ptrdiff_t>(half), result.runs.end(),
                  [&](const BasisRun& run) { return run.period != last.period; }))
  {
    return text +
           "The period still changes with the basis: several responses coexist, and which of them a run from rest "
           "ends in, small differences decide.\n";
  }
  const bool close = result.runs.size() > 1 && result.runs[result.runs.size() - 2].agrees;
  return text + (close ? "The last two agree to " + rounded(options.accuracy, 3) +
                             ", but no basis is large enough to confirm it.\n"
                       : "Differences are still larger than " + rounded(options.accuracy, 3) + ".\n");
}

std::string lossText(const std::vector<Convergence>& results)
{
  double least = 1.0;
  std::size_t negative = 0;
  std::size_t runs = 0;
  for (const Convergence& result : results)
  {
    for (const BasisRun& run : result.runs)
    {
      least = std::min(least, run.mapping_loss);
      negative += run.impulse_min < 0.0 ? 1 : 0;
      ++runs;
    }
  }
  if (least <= rounding_loss)
  {
    return {};
  }
  std::string text = "The mapping of the conjoined basis loses energy at every switch, at best " + rounded(least, 2) +
                     " of a mode's energy with these numbers of modes; the attachment basis loses none.\n";
  if (negative > 0)
  {
    text += "In " + std::to_string(negative) + " of " + std::to_string(runs) +
            " runs an impulse is negative: the truncated contact pulls.\n";
  }
  return text;
}

}  // namespace

std::string convergenceReport(const core::SystemParameters& parameters, const ConvergenceOptions& options,
                              const std::vector<Convergence>& results)
{
  std::string text;
  const Convergence* greatest = nullptr;
  std::string unsettled;
  for (const Convergence& result : results)
  {
    text += "omega* " + rounded(result.omega_star, 15) + "\n" + impactText(result, isConjoined(parameters));
    if (std::any_of(result.runs.begin(), result.runs.end(), [](const BasisRun& run) { return run.statistics; }))
    {
      text += "statistics of the responses without a period, with standard errors\n" + statisticsText(result);
    }
    if (result.settled)
    {
      text += settledText(parameters, options, result);
      if (greatest == nullptr || result.runs[*result.settled].modes > greatest->runs[*greatest->settled].modes)
      {
        greatest = &result;
      }
    }
    else
    {
      text += unsettledText(parameters, options, result);
      unsettled += (unsettled.empty() ? "" : ", ") + rounded(result.omega_star, 15);
    }
    text += '\n';
  }
  text += lossText(results);
  if (greatest != nullptr)
  {
    text +=
        (hasNoneToAgreeWith(*greatest) ? "Best basis there is: "
                                       : "Smallest basis for an accuracy of " + rounded(options.accuracy, 3) + ": ") +
        basisOf(parameters, greatest->runs[*greatest->settled].modes) +
        (results.size() > 1 ? ", which omega* " + rounded(greatest->omega_star, 15) + " asks for" : "") + ".\n";
  }
  if (!unsettled.empty())
  {
    text += "None was found for omega* " + unsettled + ".\n";
  }
  return text;
}

OutputFile convergenceTable(const std::vector<Convergence>& results)
{
  struct Row
  {
    double omega_star = 0.0;
    int modes = 0;
    std::optional<double> free_frequency_hz, contact_frequency_hz;
    double highest_frequency_hz = 0.0, mapping_loss = 0.0;
    int period = 0;
    double impacts_per_cycle = 0.0, impulse_mean = 0.0, impulse_min = 0.0, impulse_per_cycle = 0.0;
    std::optional<double> impulse_change, onset_change, impulse_mean_error, impulse_spread, impulse_spread_error,
        impacts_per_cycle_error, impulse_per_cycle_error, separation, statistics_apart;
    bool settled = false;
    double cost_us_per_cycle = 0.0;
  };
  std::vector<Row> rows;
  for (const Convergence& result : results)
  {
    for (const BasisRun& run : result.runs)
    {
      Row row;
      row.omega_star = result.omega_star;
      row.modes = run.modes;
      row.free_frequency_hz = run.free_frequency_hz;
      row.contact_frequency_hz = run.contact_frequency_hz;
      row.highest_frequency_hz = run.highest_frequency_hz;
      row.mapping_loss = run.mapping_loss;
      row.period = run.period;
      row.impacts_per_cycle = run.impacts_per_cycle;
      row.impulse_mean = run.impulse_mean;
      row.impulse_min = run.impulse_min;
      row.impulse_per_cycle = run.impulse_per_cycle;
      row.impulse_change = run.impulse_change;
      row.onset_change = run.onset_change;
      if (run.statistics)
      {
        row.impulse_mean_error = run.statistics->impulse_mean.error;
        row.impulse_spread = run.statistics->impulse_spread.value;
        row.impulse_spread_error = run.statistics->impulse_spread.error;
        row.impacts_per_cycle_error = run.statistics->impacts_per_cycle.error;
        row.impulse_per_cycle_error = run.statistics->impulse_per_cycle.error;
      }
      row.separation = run.separation;
      row.statistics_apart = run.statistics_apart;
      row.settled = result.settled && run.modes >= result.runs[*result.settled].modes;
      row.cost_us_per_cycle = 1.0e6 * run.cost;
      rows.push_back(row);
    }
  }
  static const std::vector<Column<Row>> columns = {
      {"omega_star", &Row::omega_star},
      {"modes", &Row::modes},
      {"free_frequency_hz", &Row::free_frequency_hz},
      {"contact_frequency_hz", &Row::contact_frequency_hz},
      {"highest_frequency_hz", &Row::highest_frequency_hz},
      {"mapping_loss", &Row::mapping_loss},
      {"period", &Row::period},
      {"impacts_per_cycle", &Row::impacts_per_cycle},
      {"impulse_mean", &Row::impulse_mean},
      {"impulse_min", &Row::impulse_min},
      {"impulse_per_cycle", &Row::impulse_per_cycle},
      {"impulse_change", &Row::impulse_change},
      {"onset_change", &Row::onset_change},
      {"impulse_mean_error", &Row::impulse_mean_error},
      {"impulse_spread", &Row::impulse_spread},
      {"impulse_spread_error", &Row::impulse_spread_error},
      {"impacts_per_cycle_error", &Row::impacts_per_cycle_error},
      {"impulse_per_cycle_error", &Row::impulse_per_cycle_error},
      {"separation_per_cycle", &Row::separation},
      {"statistics_apart", &Row::statistics_apart},
      {"settled", &Row::settled},
      {"cost_us_per_cycle", &Row::cost_us_per_cycle},
  };
  return {"convergence.csv", writeTable(columns, rows)};
}

}  // namespace vibro_impact::config
