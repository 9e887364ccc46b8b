// HarmonicSimulation against what else one could take: the same equations, the same trajectories, no worse accuracy.
// What is measured and how: README.md of this folder's parent.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/program_options.hpp>

#include "../stopwatch.h"
#include "peer.h"
#include "reference.h"
#include "vibro_impact/config/configuration.h"
#include "vibro_impact/core/harmonic_simulation.h"
#include "vibro_impact/core/pinned_beam.h"

namespace
{
using namespace vibro_impact;
using namespace vibro_impact::peers;

constexpr double accuracy = 1.0e-6;  // error of the gap over its greatest value
constexpr int cycles = 5;
constexpr int later_cycles = 100;  // after those five, without their start from rest
constexpr double samples_per_cycle = 64.0;

// ---------------------------------------------------------------------------------------------------------------------
// Cases

enum class Basis
{
  attachment,
  free_modes
};

struct Case
{
  Basis basis;
  char stiffness;  // A: k* = 1000, B: the table's
  int modes;       // of each beam
  double bar;      // least ratio to the fastest of Runge-Kutta, Odeint and GSL

  std::string basisName() const
  {
    return basis == Basis::attachment ? "attachment" : "free modes";
  }
};

std::vector<Case> allCases()
{
  struct Row
  {
    int modes;
    double bar_a;
    double bar_b;
  };
  std::vector<Case> cases;
  for (const Basis basis : {Basis::attachment, Basis::free_modes})
  {
    for (const Row& row : {Row{1, 40, 31}, Row{3, 137, 131}, Row{5, 149, 89}, Row{10, 114, 48}})
    {
      cases.push_back({basis, 'A', row.modes, row.bar_a});
      cases.push_back({basis, 'B', row.modes, row.bar_b});
    }
  }
  return cases;
}

std::shared_ptr<const core::SwitchedModel> makeModel(const Case& c)
{
  core::SystemParameters parameters =
      config::loadFile(CONFIG_DIRECTORY + std::string(c.stiffness == 'A' ? "/limiting_case.yaml" : "/table1.yaml"));
  if (c.basis == Basis::attachment)
  {
    parameters.basis = core::AttachmentBasis{c.modes};
    return std::make_shared<const core::SwitchedModel>(parameters);
  }
  std::vector<core::Mode> modes;
  const core::PinnedBeam beam1(parameters.beam1);
  const core::PinnedBeam beam2(std::get<core::BeamParameters>(parameters.beam2));
  for (int m = 1; m <= c.modes; ++m)
  {
    modes.push_back(beam1.mode(m));
    modes.push_back(beam2.mode(m));
    modes.back().contact_deflection *= -1.0;
  }
  return std::make_shared<const core::SwitchedModel>(modes, parameters.contact, parameters.damping);
}

// ---------------------------------------------------------------------------------------------------------------------
// Our own

class ImpactList : public core::ImpactSink
{
public:
  void onImpact(const core::Impact& impact) override
  {
    impacts_.push_back(impact);
  }
  const std::vector<core::Impact>& impacts() const
  {
    return impacts_;
  }

private:
  std::vector<core::Impact> impacts_;
};

class ImpactCounter : public core::ImpactSink
{
public:
  void onImpact(const core::Impact& /*impact*/) override
  {
    ++impacts_;
  }

private:
  volatile std::uint64_t impacts_ = 0;
};

/// What its impacts say of the gap (zero at onset and release, -F/k at the peak) against the reference; infinite if
/// their number differs.
double ownError(const core::SwitchedModel& model, const Problem& problem, const Reference& reference)
{
  core::HarmonicSimulation simulation(std::make_shared<const core::SwitchedModel>(model));
  simulation.setDrive(problem.drive_frequency / problem.time_unit, 1.0);
  ImpactList sink;
  simulation.advance(cycles, sink);
  const std::size_t begun = reference.initialState() == 1 ? 1 : 0;
  if (sink.impacts().size() != (reference.switches().size() + begun) / 2)
  {
    return std::numeric_limits<double>::infinity();
  }
  double error = 0.0;
  for (const core::Impact& impact : sink.impacts())
  {
    const double onset = static_cast<double>(impact.interval) * problem.cycle + impact.offset / problem.time_unit;
    const double release = onset + impact.duration / problem.time_unit;
    const double peak = onset + impact.peak_time / problem.time_unit;
    const double deepest = -impact.peak_force / model.stiffness() / problem.gap_unit;
    error = std::max({error, std::abs(reference.gap(onset)), std::abs(reference.gap(release)),
                      std::abs(reference.gap(peak) - deepest)});
  }
  return error / reference.greatestGap();
}

// ---------------------------------------------------------------------------------------------------------------------
// Tuning

double peerError(Run& run, const Problem& problem, const Reference& reference, double end)
{
  Trace trace(problem.cycle / samples_per_cycle);
  if (!run.run(reference.initialState(), end, &trace))
  {
    return std::numeric_limits<double>::infinity();
  }
  double error = 0.0;
  for (const Trace::Sample& sample : trace.samples())
  {
    if (sample.time < end)
    {
      error = std::max(error, std::abs(sample.gap - reference.gap(sample.time)));
    }
  }
  return std::isfinite(error) ? error / reference.greatestGap() : std::numeric_limits<double>::infinity();
}

struct Tuned
{
  double setting;
  double error;
};

/// The cheapest setting that is accurate enough, and not by luck: so are the next four, up to half the step or a tenth
/// of the tolerance.
std::optional<Tuned> tune(const Peer& peer, const Problem& problem, const Reference& reference, double end)
{
  constexpr int confirmations = 4;
  std::optional<Tuned> candidate;
  int confirmed = 0;
  for (const double setting : peer.settings(problem))
  {
    const double error = peerError(*peer.prepare(problem, setting), problem, reference, end);
    if (error > accuracy)
    {
      candidate.reset();
    }
    else if (!candidate)
    {
      candidate = Tuned{setting, error};
      confirmed = 0;
    }
    else if (++confirmed == confirmations)
    {
      return candidate;
    }
  }
  return std::nullopt;
}

// ---------------------------------------------------------------------------------------------------------------------
// Timing

/// Something to time: `prepare` is not timed.
struct Timed
{
  std::function<void()> prepare;
  std::function<void()> run;
  double best = std::numeric_limits<double>::infinity();  // s
};

/// Takes all in turn, `rounds` times; of each the least time of a run. Processor time leaves out what others do on the
/// machine, wall time the cost of asking for processor time: the smaller of the two is nearer to the truth.
void measure(std::vector<Timed>& competitors, int rounds)
{
  constexpr double share = 2.0e-3;  // s for each in a round, at least one run
  for (int round = 0; round < rounds; ++round)
  {
    for (Timed& timed : competitors)
    {
      const double start = wallTime();
      do
      {
        timed.prepare();
        const double thread = threadTime();
        const double wall = wallTime();
        timed.run();
        timed.best = std::min(timed.best, wallTime() - wall);
        timed.best = std::min(timed.best, threadTime() - thread);
      } while (wallTime() - start < share);
    }
  }
}

// ---------------------------------------------------------------------------------------------------------------------
// Table

struct Competitor
{
  std::unique_ptr<Peer> peer;
  int cycles;    // it runs
  bool general;  // of those the bars compare with
};

std::vector<Competitor> makeCompetitors()
{
  std::vector<Competitor> competitors;
  competitors.push_back({makeTransitionMatrix(), cycles, false});
  competitors.push_back({makeRungeKutta4(), cycles, true});
  competitors.push_back({makeDormandPrince(), cycles, true});
  competitors.push_back({makeFehlberg78(), cycles, true});
#ifdef PEERS_WITH_GSL
  competitors.push_back({makeRk8pd(), cycles, true});
#endif
#ifdef PEERS_WITH_CVODE
  competitors.push_back({makeAdams(), 1, false});
#endif
  return competitors;
}

constexpr const char* own_name = "vibro_impact";

class Report
{
public:
  explicit Report(const std::string& csv_file, const std::vector<Competitor>& competitors) : csv_(csv_file)
  {
    csv_ << "basis,case,modes,omega_star,competitor,setting,value,error,cycles,switches,us_per_cycle\n";
    std::printf("%-10s %-4s %12s %6s", "basis", "case", own_name, "later");
    for (const Competitor& competitor : competitors)
    {
      std::printf(" %*s", static_cast<int>(competitor.peer->name().size()), competitor.peer->name().c_str());
    }
    std::printf("  %7s %4s %-4s  %10s %s\n", "ratio", "bar", "met?", "transition", "met?");
  }

  void add(const Case& c, double omega_star, const std::string& name, const std::string& setting, const Tuned& tuned,
           int cycle_count, std::size_t switches, double time)
  {
    csv_ << c.basisName() << ',' << c.stiffness << ',' << c.modes << ',' << omega_star << ',' << name << ',' << setting
         << ',' << tuned.setting << ',' << tuned.error << ',' << cycle_count << ',' << switches << ',' << time * 1.0e6
         << '\n'
         << std::flush;
  }

  /// `own`, `later` and `times`: s per cycle, means over omega*; not a number where a competitor failed.
  void row(const Case& c, double own, double later, const std::vector<Competitor>& competitors,
           const std::vector<double>& times)
  {
    std::printf("%-10s %-4s %12.2f %6.2f", c.basisName().c_str(), (std::to_string(c.modes) + " " + c.stiffness).c_str(),
                own * 1.0e6, later * 1.0e6);
    double fastest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < competitors.size(); ++i)
    {
      std::printf(" %*.1f", static_cast<int>(competitors[i].peer->name().size()), times[i] * 1.0e6);
      if (competitors[i].general && times[i] < fastest)
      {
        fastest = times[i];
      }
    }
    const double ratio = fastest / own;
    const double exact = times.front() / own;
    std::printf("  %7.1f %4.0f %-4s  %10.2f %s\n", ratio, c.bar, ratio >= c.bar ? "yes" : "no", exact,
                exact >= 1.0 ? "yes" : "no");
    std::fflush(stdout);
  }

private:
  std::ofstream csv_;
};

void compare(const Case& c, const std::vector<double>& omega_stars, const std::vector<Competitor>& competitors,
             int rounds, Report& report)
{
  const std::shared_ptr<const core::SwitchedModel> model = makeModel(c);
  const double share = 1.0 / static_cast<double>(omega_stars.size());
  double own = 0.0;
  double later = 0.0;
  std::vector<double> means(competitors.size(), 0.0);
  for (const double omega_star : omega_stars)
  {
    const Problem problem(*model, omega_star);
    const Reference reference(problem, cycles * problem.cycle);
    const double own_error = ownError(*model, problem, reference);
    if (!(own_error <= accuracy))
    {
      std::fprintf(stderr, "%s %d %c at omega* %g: own error %g, allowed: %g\n", c.basisName().c_str(), c.modes,
                   c.stiffness, omega_star, own_error, accuracy);
    }

    core::HarmonicSimulation simulation(model);
    ImpactCounter sink;
    const auto start = [&]()
    {
      simulation.reset();
      simulation.setDrive(omega_star / problem.time_unit, 1.0);
    };
    std::vector<Timed> timed;
    timed.push_back({start, [&]() { simulation.advance(cycles, sink); }});
    timed.push_back({[&]()
                     {
                       start();
                       simulation.advance(cycles, sink);
                     },
                     [&]() { simulation.advance(later_cycles, sink); }});
    std::vector<std::unique_ptr<Run>> runs;
    std::vector<std::optional<Tuned>> settings;
    for (const Competitor& competitor : competitors)
    {
      const double end = competitor.cycles * problem.cycle;
      settings.push_back(tune(*competitor.peer, problem, reference, end));
      if (!settings.back())
      {
        std::fprintf(stderr, "%s %d %c at omega* %g: %s is never accurate enough\n", c.basisName().c_str(), c.modes,
                     c.stiffness, omega_star, competitor.peer->name().c_str());
        runs.push_back(nullptr);
        timed.push_back({[]() {}, []() {}});
        continue;
      }
      runs.push_back(competitor.peer->prepare(problem, settings.back()->setting));
      Run* run = runs.back().get();
      timed.push_back({[]() {}, [run, &reference, end]() { run->run(reference.initialState(), end, nullptr); }});
    }
    measure(timed, rounds);

    const std::size_t switches = reference.switches().size();
    own += share * timed[0].best / cycles;
    later += share * timed[1].best / later_cycles;
    report.add(c, omega_star, own_name, "", {0.0, own_error}, cycles, switches, timed[0].best / cycles);
    for (std::size_t i = 0; i < competitors.size(); ++i)
    {
      const double time =
          settings[i] ? timed[i + 2].best / competitors[i].cycles : std::numeric_limits<double>::quiet_NaN();
      means[i] += share * time;
      report.add(c, omega_star, competitors[i].peer->name(), competitors[i].peer->settingName(),
                 settings[i].value_or(Tuned{0.0, std::numeric_limits<double>::infinity()}), competitors[i].cycles,
                 switches, time);
    }
  }
  report.row(c, own, later, competitors, means);
}
}  // namespace

int main(int argc, char** argv)
{
  namespace options = boost::program_options;
  std::string csv;
  options::options_description description("Options");
  description.add_options()("help,h", "this text")("quick",
                                                   "3 and 5 modes of each beam, omega* 1.6 and 2.4, attachment basis")(
      "csv", options::value(&csv)->default_value("peers.csv"), "file of every single figure");
  options::variables_map values;
  try
  {
    options::store(options::parse_command_line(argc, argv, description), values);
    options::notify(values);
    if (values.count("help") != 0)
    {
      std::cout << "usage: peers_benchmark [OPTION...]\n" << description;
      return 0;
    }
    const bool quick = values.count("quick") != 0;
    const std::vector<double> omega_stars =
        quick ? std::vector<double>{1.6, 2.4} : std::vector<double>{0.8, 1.2, 1.6, 2.0, 2.4, 3.2};
    const std::vector<Competitor> competitors = makeCompetitors();
    Report report(csv, competitors);
    for (const Case& c : allCases())
    {
      if (!quick || (c.basis == Basis::attachment && (c.modes == 3 || c.modes == 5)))
      {
        compare(c, omega_stars, competitors, quick ? 3 : 10, report);
      }
    }
  }
  catch (const std::exception& error)
  {
    std::cerr << "peers_benchmark: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
