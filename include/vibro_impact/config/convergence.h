#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "vibro_impact/config/output_directory.h"
#include "vibro_impact/core/parameters.h"

namespace vibro_impact::config
{
struct ConvergenceOptions
{
  std::vector<double> omega_stars;  ///< drive frequencies over the lowest natural one of beam 1, each > 0
  double accuracy = 1.0e-3;         ///< wanted: of impulses relative to the greatest, of onsets in drive cycles, > 0
  double acceleration = 1.0;        ///< amplitude of the base acceleration, m/s^2, > 0
  std::uint64_t cycles = 400;       ///< drive cycles from rest until the response is looked at, >= 1
  std::uint64_t statistics_cycles = 10000;  ///< further ones where it has no period until then, >= 100
  int most_modes = 100;                     ///< of the largest basis, >= 1
  unsigned threads = 1;                     ///< that work side by side, >= 1; the results do not depend on it
};

/// An impact of a response that repeats.
struct PhasedImpact
{
  double phase = 0.0;    ///< of the onset, in drive cycles modulo the period
  double impulse = 0.0;  ///< N s
};

/// How far two responses of one period are apart.
struct ImpactChange
{
  double impulse = 0.0;  ///< greatest difference of an impact's impulses, over the greatest impulse of both responses
  double onset = 0.0;    ///< greatest difference of an impact's onsets, in drive cycles
};

/// Compares impact by impact two responses that repeat after `period` drive cycles; which of these comes first does not
/// matter. Partners are the impacts that are each other's nearest in time; one without a partner differs by its
/// whole impulse.
ImpactChange compareImpacts(const std::vector<PhasedImpact>& one, const std::vector<PhasedImpact>& other, int period);

/// A mean over a part of a response, and its standard error.
struct Estimate
{
  double value = 0.0;
  double error = 0.0;
};

/// What is left to compare of a response that does not repeat.
struct ImpactStatistics
{
  Estimate impulse_mean;       ///< N s
  Estimate impulse_spread;     ///< standard deviation of the impulse, N s
  Estimate impacts_per_cycle;  ///< 1
  Estimate impulse_per_cycle;  ///< N s
};

/// One impact of a response without a period.
struct CountedImpact
{
  std::uint64_t cycle = 0;  ///< number of the drive cycle in which it began
  double impulse = 0.0;     ///< N s
};

/// Statistics of the impacts of the cycles 0 ... cycles - 1. The standard errors are those of fifty batches of cycles,
/// so that they hold for impacts that depend on those before them. Throws std::invalid_argument for less than 100
/// cycles.
ImpactStatistics impactStatistics(const std::vector<CountedImpact>& impacts, std::uint64_t cycles);

/// The greatest difference of the four means, in standard errors of that difference.
double standardErrorsApart(const ImpactStatistics& one, const ImpactStatistics& other);

/// The response in one basis at one drive frequency.
struct BasisRun
{
  int modes = 0;                               ///< modes_per_beam; of the conjoined basis modes_free and modes_contact
  std::optional<double> free_frequency_hz;     ///< lowest natural frequency of S0 that moves the gap
  std::optional<double> contact_frequency_hz;  ///< the same of S1
  double highest_frequency_hz = 0.0;           ///< of S1
  double mapping_loss = 0.0;                   ///< greatest share of a mode's energy that a switch loses, 1
  int coordinates = 0;                         ///< of S0
  int moving_coordinates = 0;                  ///< coordinates of S0 that move the gap

  int period = 0;                              ///< in drive cycles; 0: none up to 16
  double impacts_per_cycle = 0.0;              ///< of a period, or without one of all cycles after the first
  double impulse_per_cycle = 0.0;              ///< likewise, N s
  double impulse_mean = 0.0;                   ///< of an impact, likewise, N s
  double impulse_min = 0.0;                    ///< likewise, N s; negative: the basis makes the contact pull
  std::vector<PhasedImpact> impacts;           ///< one period of them
  std::optional<ImpactStatistics> statistics;  ///< without a period
  std::optional<double> separation;  ///< without a period, if neighbouring motions part: by this factor every cycle

  double cost = 0.0;  ///< processor time per drive cycle, s; the one number that is measured, not computed

  // Against those of the larger bases that have the same period, or none like this; nothing without such.
  std::optional<double> impulse_change;    ///< greatest ImpactChange::impulse
  std::optional<double> onset_change;      ///< greatest ImpactChange::onset
  std::optional<double> statistics_apart;  ///< greatest standardErrorsApart()
  bool agrees = false;  ///< with every larger basis that was tried, of which there is one, to the accuracy
};

/// What more and more modes give at one drive frequency.
struct Convergence
{
  double omega_star = 0.0;
  std::vector<BasisRun> runs;  ///< by ascending number of modes
  bool complete = false;       ///< the last of them has all modes that the structures have
  /// Index of the smallest basis that agrees with all larger ones, up to one that has at least twice as many
  /// coordinates that move the gap, or is complete; nothing if there is none.
  std::optional<std::size_t> settled;
};

/// How the work stands.
struct ConvergenceProgress
{
  std::size_t frequencies = 0;  ///< that are done
  std::size_t runs = 0;         ///< so far
};

/// Raises the number of modes of the basis that `parameters` have until the response has settled at each drive
/// frequency, or no more modes can be had. Two responses agree if impulses and onsets differ by no more than the
/// accuracy; without a period, if no mean differs by more than the accuracy or than its sampling uncertainty, four
/// standard errors, explains. `progress` is called in the calling thread. Throws std::invalid_argument where a drive
/// frequency meets an undamped natural one.
std::vector<Convergence> converge(const core::SystemParameters& parameters, const ConvergenceOptions& options,
                                  const std::function<void(const ConvergenceProgress&)>& progress);

/// For each drive frequency a table for reading and what it means, then the smallest basis for all of them.
std::string convergenceReport(const core::SystemParameters& parameters, const ConvergenceOptions& options,
                              const std::vector<Convergence>& results);

/// convergence.csv: one row per drive frequency and basis; cells are empty where there is nothing to say.
OutputFile convergenceTable(const std::vector<Convergence>& results);

}  // namespace vibro_impact::config
