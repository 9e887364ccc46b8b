#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "vibro_impact/config/output_directory.h"
#include "vibro_impact/config/sampled_excitation.h"
#include "vibro_impact/core/energy_account.h"
#include "vibro_impact/core/history.h"
#include "vibro_impact/core/impact.h"
#include "vibro_impact/core/initial_motion.h"
#include "vibro_impact/core/switched_model.h"

namespace vibro_impact::config
{
/// One row of history.csv. Column names are the members' names.
struct HistoryRow
{
  double time = 0.0;               ///< s
  double acceleration = 0.0;       ///< of the base, m/s^2
  double gap = 0.0;                ///< m, negative while the contact spring is compressed
  double gap_velocity = 0.0;       ///< m/s
  double force = 0.0;              ///< contact force, N, positive in compression
  bool in_contact = false;         ///< S1
  double energy_structure1 = 0.0;  ///< EnergyAccount::structure1 and so on, J
  double energy_structure2 = 0.0;
  double energy_spring = 0.0;
  double energy_left_out = 0.0;
  double base_work = 0.0;  ///< since the run began, as all that follows
  double contact_work = 0.0;
  double dissipated_free = 0.0;
  double dissipated_contact = 0.0;
  double mapping_loss = 0.0;
  double energy_residual = 0.0;  ///< EnergyAccount::residual(): what the account does not close by
};

/// One row of the impacts.csv of a single run: as ImpactRow, then its energies.
struct SimulatedImpactRow
{
  double omega_star = 0.0;  ///< drive frequency over the lowest one of beam 1; 0 if the drive is not harmonic
  std::uint64_t number = 0;
  double onset_s = 0.0;  ///< on the time axis of the history, s
  double duration_s = 0.0;
  double impulse = 0.0;           ///< N s
  double peak_force = 0.0;        ///< N
  double approach_speed = 0.0;    ///< m/s
  double separation_speed = 0.0;  ///< m/s
  bool cut_short = false;         ///< Impact::cut_short
  double energy_lost = 0.0;       ///< J, as all that follows
  double dissipated = 0.0;
  double mapping_loss = 0.0;
  double base_work = 0.0;
};

/// All that one simulation brought.
struct SimulatedRun
{
  std::optional<double> omega_star;    ///< of a harmonic drive
  std::optional<double> frequency_hz;  ///< of a harmonic drive
  std::optional<double> amplitude;     ///< of a harmonic drive, m/s^2
  std::optional<int> period;           ///< of the response to a harmonic drive, as ResponseRow::period
  double step = 0.0;                   ///< from one row of the history to the next, s
  std::vector<HistoryRow> history;
  std::vector<SimulatedImpactRow> impacts;  ///< in order of release
  core::EnergyAccount energy;               ///< at the last sample, whether it is a row of the history or not
};

/// Which samples become rows of the history.
struct HistorySelection
{
  double from = -std::numeric_limits<double>::infinity();  ///< none before this time, s
  std::uint64_t every = 1;                                 ///< of those only each so-manieth, >= 1
  std::size_t longest = 2'000'000;                         ///< more rows than this are refused
};

/// Puts together a SimulatedRun while a simulation advances. onSample() throws Error where the history becomes longer
/// than the selection allows.
class RunRecorder : public core::ImpactSink
{
public:
  explicit RunRecorder(const HistorySelection& selection) : selection_(selection)
  {
  }

  /// What follows counts from `offset` (s) on; impacts count intervals of `interval` (s) from there.
  void begin(double offset, double interval);

  void onSample(const core::HistorySample& sample);
  void onImpact(const core::Impact& impact) override;

  SimulatedRun run;  ///< so far: history, impacts, energy

private:
  HistorySelection selection_;
  double offset_ = 0.0;
  double interval_ = 0.0;
  std::uint64_t seen_ = 0;
};

struct HarmonicRunOptions
{
  double omega_star = 1.0;                ///< drive frequency over the lowest one of beam 1, > 0
  double acceleration = 1.0;              ///< amplitude, m/s^2, >= 0
  std::uint64_t cycles = 100;             ///< >= 1
  std::uint64_t samples_per_cycle = 200;  ///< of the history, >= 1
};

/// A drive frequency in Hz over the lowest natural frequency of beam 1.
double omegaStar(double frequency_hz, const core::SwitchedModel& model);

/// How much is done, from 0 to 1; called in the calling thread.
using RunProgress = std::function<void(double)>;

/// One run under an exact harmonic drive, a(t) = -A cos(Omega t), from rest or from `initial`. The history begins with
/// the start of the run. Throws std::invalid_argument for an initial motion that the model does not have, and where the
/// drive meets an undamped natural frequency.
SimulatedRun simulateHarmonic(const std::shared_ptr<const core::SwitchedModel>& model,
                              const HarmonicRunOptions& options, const std::optional<core::InitialMotion>& initial,
                              const HistorySelection& history, const RunProgress& progress);

/// One run under samples, straight lines between them; sample for sample what a node computes. Throws as
/// simulateHarmonic().
SimulatedRun simulateSampled(const std::shared_ptr<const core::SwitchedModel>& model,
                             const SampledExcitation& excitation, const std::optional<core::InitialMotion>& initial,
                             const HistorySelection& history, const RunProgress& progress);

/// history.csv, impacts.csv, and run.csv: rows of key and value, drive_frequency_hz, omega_star, acceleration and
/// period of a harmonic drive, then history_step_s, the energies at the end and energy_closure.
std::vector<OutputFile> runTables(const SimulatedRun& run);

}  // namespace vibro_impact::config
