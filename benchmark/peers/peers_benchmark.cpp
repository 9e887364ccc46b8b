// HarmonicSimulation against what else one could take: the same equations, the same trajectories, no worse accuracy.
// What is measured and how: doc/benchmarks.md.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#ifdef __SSE2__
#include <xmmintrin.h>
#endif

#include <boost/program_options.hpp>

#include "../stopwatch.h"
#include "peer.h"
#include "reference.h"
#include "vibro_impact/config/configuration.h"
#include "vibro_impact/core/beam.h"
#include "vibro_impact/core/harmonic_simulation.h"

namespace
{
using namespace vibro_impact;
using namespace vibro_impact::peers;

constexpr double accuracy = 1.0e-6;  // error of the gap over its greatest value
constexpr int most_cycles = 5;       // compared, from rest
constexpr int later_cycles = 100;    // after those, without the start from rest
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
  const core::Beam beam1(std::get<core::BeamParameters>(parameters.beam1));
  const core::Beam beam2(std::get<core::BeamParameters>(parameters.beam2));
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
  std::uint64_t impacts_ = 0;
};

/// What its impacts say of the gap (zero at onset and release, -F/k at the peak) against the reference; infinite if
/// their number differs.
double ownError(const std::shared_ptr<const core::SwitchedModel>& model, const Problem& problem,
                const Reference& reference, std::uint64_t cycles)
{
  core::HarmonicSimulation simulation(model);
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
    const double deepest = -impact.peak_force / model->stiffness() / problem.gap_unit;
    error = std::max({error, std::abs(reference.gap(onset)), std::abs(reference.gap(release)),
                      std::abs(reference.gap(peak) - deepest)});
  }
  return error / reference.greatestGap();
}

// ---------------------------------------------------------------------------------------------------------------------
// Tuning

/// Methods that damp high modes run into denormal numbers, which cost tens of times as much; whoever cares for speed
/// flushes them to zero. Done for the competitors, not for us.
class FlushedDenormals
{
public:
  FlushedDenormals()
  {
#ifdef __SSE2__
    constexpr unsigned flush_results_and_operands = 0x8040;
    _mm_setcsr(before_ | flush_results_and_operands);
#endif
  }
  ~FlushedDenormals()
  {
#ifdef __SSE2__
    _mm_setcsr(before_);
#endif
  }
  FlushedDenormals(const FlushedDenormals&) = delete;
  FlushedDenormals& operator=(const FlushedDenormals&) = delete;

private:
#ifdef __SSE2__
  unsigned before_ = _mm_getcsr();
#endif
};

double peerError(Run& run, const Problem& problem, const Reference& reference, double end)
{
  Trace trace(problem.cycle / samples_per_cycle);
  const FlushedDenormals flushed;
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

/// How many cycles can be compared. Where the motion is chaotic, errors grow with every switch: no computation in
/// double precision that locates its switches to 1e-12 holds the accuracy longer than a trajectory disturbed by as much
/// does.
int comparableCycles(const Problem& problem)
{
  constexpr double disturbance = 1.0e-12;
  const double end = most_cycles * problem.cycle;
  const Reference reference(problem, end);
  const Reference disturbed(problem, end, disturbance);
  const double interval = problem.cycle / samples_per_cycle;
  double time = 0.0;
  while (time < end && std::abs(disturbed.gap(time) - reference.gap(time)) < 0.1 * accuracy * reference.greatestGap())
  {
    time += interval;
  }
  return std::max(1, static_cast<int>(time / problem.cycle + 0.5 / samples_per_cycle));
}

struct Tuned
{
  double setting;
  double error;
};

/// The tolerance of the integration that checks the reference.
constexpr double tight = 1.0e-12;

constexpr Tuned never{0.0, std::numeric_limits<double>::infinity()};

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

/// Something to time: setting up is timed by itself.
struct Timed
{
  std::function<void()> set_up;
  std::function<void()> run;
  double setting_up = std::numeric_limits<double>::infinity();  // s, the least time
  double running = std::numeric_limits<double>::infinity();
  double spent = 0.0;  // on all
};

/// Lowers `least` to the time that `work` takes. Processor time leaves out what others do on the machine, wall time the
/// cost of asking for processor time: the smaller of the two is nearer to the truth.
void measureOnce(const std::function<void()>& work, double& least)
{
  const double thread = threadTime();
  const double wall = wallTime();
  work();
  least = std::min(least, wallTime() - wall);
  least = std::min(least, threadTime() - thread);
}

/// Takes all in turn, `rounds` times, but for the slow ones, which then have two rounds or half a second.
void measure(std::vector<Timed>& competitors, int rounds)
{
  constexpr double share = 2.0e-3;  // s for each in a round, at least one run
  constexpr double enough = 0.5;    // s
  for (int round = 0; round < rounds; ++round)
  {
    for (Timed& timed : competitors)
    {
      const double start = threadTime();
      while (round < 2 || timed.spent < enough)
      {
        measureOnce(timed.set_up, timed.setting_up);
        measureOnce(timed.run, timed.running);
        if (threadTime() - start > share)
        {
          break;
        }
      }
      timed.spent += threadTime() - start;
    }
  }
}

// ---------------------------------------------------------------------------------------------------------------------
// Table

struct Competitor
{
  std::unique_ptr<Peer> peer;
  int most_cycles;  // it runs
  bool general;     // of those the bars compare with
};

std::vector<Competitor> makeCompetitors()
{
  std::vector<Competitor> competitors;
  competitors.push_back({makeTransitionMatrix(), most_cycles, false});
  competitors.push_back({makeRungeKutta4(), most_cycles, true});
  competitors.push_back({makeDormandPrince(), most_cycles, true});
  competitors.push_back({makeFehlberg78(), most_cycles, true});
#ifdef PEERS_WITH_GSL
  competitors.push_back({makeRk8pd(), most_cycles, true});
#endif
#ifdef PEERS_WITH_CVODE
  competitors.push_back({makeAdams(), 1, false});
#endif
  return competitors;
}

constexpr const char* own_name = "vibro_impact";

/// What is measured of one competitor at one omega*, or the mean over several.
struct Figures
{
  double setting_up = 0.0;  // s
  double cycle = 0.0;       // s; not a number where it is never accurate enough
};

/// The table, in Markdown, and every single figure as CSV.
class Report
{
public:
  Report(const std::string& csv_file, const std::vector<Competitor>& competitors)
      : csv_file_(csv_file), csv_(csv_file), competitors_(competitors)
  {
    csv_ << "basis,case,modes,omega_star,competitor,setting,value,error,cycles,switches,setting_up_us,us_per_cycle\n";
    std::printf("us per drive cycle, mean over omega*; %s\n\n| basis | case | %s | later | ", today().c_str(),
                own_name);
    for (const Competitor& competitor : competitors_)
    {
      std::printf("%s | ", competitor.peer->name().c_str());
    }
    std::printf("fastest of the general ones by ours | bar | met? | transition matrix by ours | met? |\n|");
    for (std::size_t column = 0; column < competitors_.size() + 9; ++column)
    {
      std::printf(" --- |");
    }
    std::printf("\n");
  }

  void add(const Case& c, double omega_star, const std::string& name, const std::string& setting, const Tuned& tuned,
           int cycle_count, std::size_t switches, const Figures& figures)
  {
    csv_ << c.basisName() << ',' << c.stiffness << ',' << c.modes << ',' << omega_star << ',' << name << ',' << setting
         << ',' << tuned.setting << ',' << tuned.error << ',' << cycle_count << ',' << switches << ','
         << figures.setting_up * 1.0e6 << ',' << figures.cycle * 1.0e6 << '\n'
         << std::flush;
    if (!csv_)
    {
      throw std::runtime_error("cannot write '" + csv_file_ + "'");
    }
  }

  /// `own`, `later` and `times`: s per cycle, means over omega*. `accurate`: whether ours is.
  void row(const Case& c, double own, double later, bool accurate, const std::vector<double>& times)
  {
    std::printf("| %s | %d %c | %.2f | %.2f |", c.basisName().c_str(), c.modes, c.stiffness, own * 1.0e6,
                later * 1.0e6);
    double fastest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < competitors_.size(); ++i)
    {
      std::printf(" %.*f |", times[i] < 1.0e-4 ? 1 : 0, times[i] * 1.0e6);
      if (competitors_[i].general && times[i] < fastest)
      {
        fastest = times[i];
      }
    }
    const auto verdict = [&](bool met) { return !accurate ? "inaccurate" : met ? "yes" : "no"; };
    const double ratio = fastest / own;
    const double exact = times.front() / own;
    std::printf(" %.1f | %.0f | %s | %.2f | %s |\n", ratio, c.bar, verdict(ratio >= c.bar), exact,
                verdict(exact >= 1.0));
    std::fflush(stdout);
  }

  /// The reference against ourselves and against a tight integration: the greatest differences stand under the table.
  void check(const Case& c, double omega_star, double own_error, double tight_error, int cycles)
  {
    add(c, omega_star, "tight Fehlberg 7(8)", "tolerance", {tight, tight_error}, cycles, 0, {});
    own_error_ = std::max(own_error_, own_error);
    tight_error_ = std::max(tight_error_, tight_error);
  }
  void finish() const
  {
    std::printf(
        "\ngreatest difference from the reference, by the greatest gap: ours %.1e, Fehlberg 7(8) with the "
        "tolerance %.0e %.1e\n",
        own_error_, tight, tight_error_);
  }

private:
  std::string csv_file_;
  std::ofstream csv_;
  double own_error_ = 0.0;
  double tight_error_ = 0.0;
  const std::vector<Competitor>& competitors_;
};

void compare(const Case& c, const std::vector<double>& omega_stars, const std::vector<Competitor>& competitors,
             int rounds, Report& report)
{
  const std::shared_ptr<const core::SwitchedModel> model = makeModel(c);
  const double share = 1.0 / static_cast<double>(omega_stars.size());
  double own = 0.0;
  double later = 0.0;
  bool accurate = true;
  std::vector<double> means(competitors.size(), 0.0);
  for (const double omega_star : omega_stars)
  {
    const Problem problem(*model, omega_star);
    const int cycles = comparableCycles(problem);
    if (cycles < most_cycles)
    {
      std::fprintf(stderr, "%s, %d %c, omega* %g: chaotic, compared over %d cycles\n", c.basisName().c_str(), c.modes,
                   c.stiffness, omega_star, cycles);
    }
    const Reference reference(problem, cycles * problem.cycle);
    const auto count = static_cast<std::uint64_t>(cycles);
    const double own_error = ownError(model, problem, reference, count);
    const double tight_error =
        peerError(*makeFehlberg78()->prepare(problem, tight), problem, reference, cycles * problem.cycle);
    report.check(c, omega_star, own_error, tight_error, cycles);
    accurate = accurate && own_error <= accuracy;

    core::HarmonicSimulation simulation(model);
    ImpactCounter sink;
    const auto set_up = [&]()
    {
      simulation.reset();
      simulation.setDrive(omega_star / problem.time_unit, 1.0);
    };
    std::vector<Timed> timed;
    timed.push_back({set_up, [&]() { simulation.advance(count, sink); }});
    timed.push_back({[&]()
                     {
                       set_up();
                       simulation.advance(count, sink);
                     },
                     [&]() { simulation.advance(later_cycles, sink); }});
    std::vector<std::unique_ptr<Run>> runs(competitors.size());
    std::vector<Tuned> settings;
    for (std::size_t i = 0; i < competitors.size(); ++i)
    {
      const Peer& peer = *competitors[i].peer;
      const double end = std::min(cycles, competitors[i].most_cycles) * problem.cycle;
      settings.push_back(tune(peer, problem, reference, end).value_or(never));
      if (settings.back().error > accuracy)
      {
        std::fprintf(stderr, "%s, %d %c, omega* %g: %s is never accurate enough\n", c.basisName().c_str(), c.modes,
                     c.stiffness, omega_star, peer.name().c_str());
      }
      timed.push_back({[&, i]() { runs[i] = peer.prepare(problem, settings[i].setting); },
                       [&, i, end]()
                       {
                         const FlushedDenormals flushed;
                         runs[i]->run(reference.initialState(), end, nullptr);
                       }});
    }
    measure(timed, rounds);

    const std::size_t switches = reference.switches().size();
    own += share * timed[0].running / cycles;
    later += share * timed[1].running / later_cycles;
    report.add(c, omega_star, own_name, "", {0.0, own_error}, cycles, switches,
               {timed[0].setting_up, timed[0].running / cycles});
    for (std::size_t i = 0; i < competitors.size(); ++i)
    {
      const Timed& its = timed[i + 2];
      const int its_cycles = std::min(cycles, competitors[i].most_cycles);
      const double cycle =
          settings[i].error > accuracy ? std::numeric_limits<double>::quiet_NaN() : its.running / its_cycles;
      means[i] += share * cycle;
      report.add(c, omega_star, competitors[i].peer->name(), competitors[i].peer->settingName(), settings[i],
                 its_cycles, switches, {its.setting_up, cycle});
    }
  }
  report.row(c, own, later, accurate, means);
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
    report.finish();
  }
  catch (const std::exception& error)
  {
    std::cerr << "peers_benchmark: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
