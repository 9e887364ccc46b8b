#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "vibro_impact/core/history.h"
#include "vibro_impact/core/impact.h"
#include "vibro_impact/core/simulation.h"
#include "vibro_impact/core/switched_model.h"
#include "vibro_impact/ros/samples.h"
#include "vibro_impact/ros/stream_rules.h"

namespace vibro_impact::graph
{
/// An impact on the time axis of its stream.
struct StampedImpact
{
  core::Impact impact;  ///< `interval` is the number (seq) of the excitation sample at or before the onset
  Stamp stamp = 0;      ///< of the onset: the time of that sample plus the offset, ns
};

/// Who wants the motion at every sample, those of bridged gaps included, and the impacts as they end.
class MotionObserver : public core::ImpactSink
{
public:
  /// From here on samples and intervals count from zero: the model is at rest at the sample of this stamp, and one
  /// follows every `sample_period` (s).
  virtual void onStart(Stamp stamp, double sample_period) = 0;
  virtual void onSample(const core::HistorySample& sample) = 0;
};

/// A simulation that follows an excitation stream by the rules of time. Its time is the stream's: it never asks a
/// clock.
///
/// The same samples give the same impacts (number, seq, offset and all that was computed) bit for bit, however they are
/// cut into blocks; exactly stamped samples give the same stamps as well. A copy follows the stream by itself.
class StreamSimulation : private core::ImpactSink
{
public:
  /// Another contact has been taken.
  struct ContactChange
  {
    std::uint64_t seq = 0;  ///< number of the first sample it holds for
    Stamp stamp = 0;        ///< of that sample
    std::shared_ptr<const core::SwitchedModel> model;
  };

  /// How both structures are bent, at every sample whose number is a multiple of `step`; rows of a bridged gap come
  /// first. Nothing where none is recorded.
  struct Motion
  {
    std::uint64_t step = 0;
    std::uint64_t seq = 0;             ///< number of the sample of the first row
    Stamp stamp = 0;                   ///< of that sample
    std::vector<double> coordinates;   ///< of core::SwitchedModel::structureModes(), row after row, m kg^1/2
    std::vector<double> gap;           ///< of each row, m
    std::vector<double> force;         ///< greatest at the samples since the row before, N
    std::vector<double> acceleration;  ///< of the base at each row, m/s^2
  };

  /// What one block, reset() or finish() brought.
  struct Answer
  {
    Verdict verdict;
    Samples gap;                         ///< m; one sample for each of the block, none if it was refused
    Samples force;                       ///< N, likewise
    std::vector<StampedImpact> impacts;  ///< in order of release
    std::vector<ContactChange> contact_changes;
    Motion motion;
    std::uint64_t switch_limits = 0;  ///< sample intervals in which the bound on switches was reached
  };

  /// More changes of the contact than this do not wait.
  static constexpr std::size_t max_waiting_changes = 1000;

  StreamSimulation(std::shared_ptr<const core::SwitchedModel> model, const StreamLimits& limits);

  /// `model`, one of the same structures with another contact, holds from sample `seq` on, or from the next one that
  /// comes if that is 0. It is taken between that sample and the one before (core::SampledSimulation::setModel), or
  /// with the start of a stream from there; restarts and reset() do not bring an earlier contact back, and leave
  /// changes waiting that are yet to come. Of two changes at one sample the later request counts. Throws
  /// std::invalid_argument, and changes nothing, if that sample has been simulated or max_waiting_changes wait.
  void setContact(std::shared_ptr<const core::SwitchedModel> model, std::uint64_t seq);

  /// Judges a block of base acceleration (m/s^2) and, unless it is refused, advances over it. A refused block leaves
  /// the state untouched. The answer holds until the next call.
  const Answer& advance(const Samples& excitation);

  /// Tells `observer`, which must outlive the simulation, of all that is to come. The answers do not depend on it.
  void observe(MotionObserver& observer)
  {
    observer_ = &observer;
  }

  /// From now on answers hold the motion at every `step`-th sample; 0: none. Nothing else in them depends on it.
  void recordMotion(std::uint64_t step)
  {
    motion_step_ = step;
  }

  /// Back to rest; the next block starts a stream. An open episode is answered as cut short.
  const Answer& reset();

  /// Whether an episode is open, which reset() would cut short.
  bool inContact() const
  {
    return rules_.started() && simulation_->inContact();
  }

  /// The model that the sample taken last was simulated with.
  const core::SwitchedModel& model() const
  {
    return *model_;
  }
  /// Of the stream since it began, anew or from rest; nothing before the first block.
  core::EnergyAccount energyAccount() const;

private:
  void onImpact(const core::Impact& impact) override;
  void advanceSamples(std::uint64_t seq, const double* acceleration, std::size_t count, double* gap, double* force);
  void take(const double* acceleration, std::size_t count, double* gap, double* force);
  std::uint64_t untilRow(std::uint64_t seq) const;
  void recordRow(std::uint64_t seq, double gap, double acceleration);
  bool takeContact(std::uint64_t seq);
  void noteContactChange(std::uint64_t seq);
  void bridge(std::uint64_t seq, std::uint64_t missing, double from, double to);
  void clearAnswer();
  void rest();
  double longestPeriod() const;

  std::shared_ptr<const core::SwitchedModel> model_;
  std::map<std::uint64_t, std::shared_ptr<const core::SwitchedModel>> waiting_;  ///< by the sample they hold from
  StreamRules rules_;
  double max_cycles_per_sample_;
  std::optional<core::SampledSimulation> simulation_;
  std::uint64_t first_seq_ = 0;  ///< the sample that found the model at rest
  bool carried_over_ = false;    ///< the open episode began before the block taken last
  MotionObserver* observer_ = nullptr;
  std::uint64_t motion_step_ = 0;
  double greatest_force_ = 0.0;  ///< at the samples since the last row
  Eigen::VectorXd coordinates_;
  Answer answer_;
};

}  // namespace vibro_impact::graph
