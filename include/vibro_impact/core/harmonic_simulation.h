#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "vibro_impact/core/energy_account.h"
#include "vibro_impact/core/history.h"
#include "vibro_impact/core/impact.h"
#include "vibro_impact/core/initial_motion.h"
#include "vibro_impact/core/response.h"
#include "vibro_impact/core/switched_model.h"

namespace vibro_impact::core
{
/// Advances a switched model under the exact harmonic base acceleration a(t) = -A cos(Omega t), whole drive cycles at a
/// time.
///
/// The base displacement is e(t) = A/Omega^2 cos(Omega t): a run from rest starts where the base, too, has no velocity.
/// Where several steady responses coexist it is the start that chooses among them.
class HarmonicSimulation
{
public:
  /// At rest, without a drive.
  explicit HarmonicSimulation(std::shared_ptr<const SwitchedModel> model);
  ~HarmonicSimulation();
  HarmonicSimulation(HarmonicSimulation&&) noexcept;
  HarmonicSimulation& operator=(HarmonicSimulation&&) noexcept;

  /// Back to rest at time zero; impact numbers start anew.
  void reset();

  /// As reset(), but in the given motion instead of at rest. Throws std::invalid_argument, as
  /// SwitchedModel::freeCoordinates() does, and leaves everything as it was.
  void start(const InitialMotion& motion);

  /// From now on drives with `frequency` (rad/s, finite, > 0) and amplitude `acceleration` (m/s^2, finite, >= 0),
  /// starting at phase zero; displacement and velocity are kept, time is set to zero. Throws std::invalid_argument for
  /// a value out of range, and where the drive meets an undamped natural frequency exactly.
  void setDrive(double frequency, double acceleration);

  /// Advances over `cycles` drive cycles. An impact's `interval` is the number of the cycle since setDrive().
  void advance(std::uint64_t cycles, ImpactSink& sink);

  /// The same motion, bit for bit, and its history: `history` takes `cycles` times `samples_per_cycle` (>= 1) samples,
  /// equally spaced, the last of each cycle at its end. The start of the motion is what sample() says before. Nothing
  /// in it allocates.
  void advance(std::uint64_t cycles, ImpactSink& sink, std::size_t samples_per_cycle, HistorySample* history);

  /// Reports an open episode to `sink` as cut short, at the end of the drive.
  void finish(ImpactSink& sink);

  /// Now: at the end of the last cycle, or at the start.
  HistorySample sample() const;

  /// Since reset() or start(), over any number of drives.
  EnergyAccount energyAccount() const;

  double time() const;         ///< since setDrive(), s
  double contactTime() const;  ///< spent in contact since the start from rest, s
  const SwitchedModel& model() const;

private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// The response at one drive frequency: `cycles` cycles from the state in which `simulation` is left by whatever went
/// before (rest after reset()), evaluated at their end.
Response harmonicResponse(HarmonicSimulation& simulation, double frequency, double acceleration, std::uint64_t cycles,
                          const ResponseOptions& options = {});

}  // namespace vibro_impact::core
