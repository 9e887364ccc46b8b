#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include <Eigen/Core>

#include "vibro_impact/core/energy_account.h"
#include "vibro_impact/core/history.h"
#include "vibro_impact/core/impact.h"
#include "vibro_impact/core/initial_motion.h"
#include "vibro_impact/core/switched_model.h"

namespace vibro_impact::core
{
/// Advances a switched model under a base acceleration given by equally spaced samples, linear between them.
///
/// Sample 0 finds the model at rest (its static equilibrium). Nothing in advance() allocates, locks, logs or throws.
/// The result depends on the samples alone: however they are cut into calls of advance(), it is the same bit for bit.
class SampledSimulation
{
public:
  /// sample_period in s, finite and > 0; throws std::invalid_argument otherwise.
  SampledSimulation(std::shared_ptr<const SwitchedModel> model, double sample_period);
  ~SampledSimulation();
  /// A copy moves on by itself, from where the original is.
  SampledSimulation(const SampledSimulation& other);
  SampledSimulation& operator=(const SampledSimulation& other);
  SampledSimulation(SampledSimulation&&) noexcept;
  SampledSimulation& operator=(SampledSimulation&&) noexcept;

  /// Back to rest: the next sample is sample 0. An open episode is reported to `sink` as cut short.
  void reset(ImpactSink& sink);

  /// As reset(), but sample 0 finds the model in the given motion. Throws std::invalid_argument, as
  /// SwitchedModel::freeCoordinates() does, and leaves everything as it was.
  void start(const InitialMotion& motion, ImpactSink& sink);

  /// From now on moves `model`, one of the same structures with another contact: between the sample taken last and the
  /// next one. Displacements and velocities are kept, the gap and the spring's energy change at once; an open episode
  /// goes on if the contact does, and is reported to `sink` as cut short if not. Before the first sample it puts to
  /// rest. Builds tables, and so allocates. Throws std::invalid_argument, and changes nothing, if the free modes of the
  /// two models differ.
  void setModel(std::shared_ptr<const SwitchedModel> model, ImpactSink& sink);

  /// Takes the next `count` samples of the base acceleration (m/s^2, finite) and writes the gap (m) and the contact
  /// force (N, positive in compression) at the time of each. Reports every impact that ends on the way.
  void advance(const double* acceleration, std::size_t count, double* gap, double* force, ImpactSink& sink);

  /// Reports an open episode to `sink` as cut short, at the end of the stream.
  void finish(ImpactSink& sink);

  /// The motion at the last sample taken (its gap and force are those of advance()), or before the first one.
  HistorySample sample() const;

  /// The coordinates of SwitchedModel::structureModes() at the last sample taken, or before the first one, m kg^1/2:
  /// how both structures are bent.
  void structureCoordinates(Eigen::VectorXd& coordinates) const;

  /// Since rest or start(), up to the last sample taken.
  EnergyAccount energyAccount() const;

  std::uint64_t samples() const;  ///< samples taken since rest
  double samplePeriod() const;    ///< s
  bool inContact() const;
  /// Sample intervals in which the bound on switches per interval was reached.
  std::uint64_t switchLimitReached() const;
  const SwitchedModel& model() const;

private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace vibro_impact::core
