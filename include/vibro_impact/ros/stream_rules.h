#pragma once

#include <cstdint>
#include <string>

#include "vibro_impact/core/sample_block.h"
#include "vibro_impact/ros/sample_clock.h"
#include "vibro_impact/ros/samples.h"

namespace vibro_impact::graph
{
/// What an excitation stream may do before it is no longer taken for the same stream.
struct StreamLimits
{
  double max_acceleration = 1.0e5;  ///< greatest magnitude of a sample, m/s^2
  double max_bridged_gap = 0.02;    ///< longest stretch of missing samples that is bridged, s
  double max_step_back = 0.1;       ///< a block that goes back by at most this is a repetition; by more, a new start, s
  double max_stamp_jitter = 0.05;   ///< how far a stamp may be off what the count of samples says, s
  /// Cycles that the model's highest mode may make from one sample to the next: the work for a block grows with them.
  /// A second of a mode of 100 kHz; the slowest accelerometers are far below.
  double max_cycles_per_sample = 1.0e5;
};

/// What is to be done with a block.
struct Verdict
{
  enum class Action
  {
    Start,     ///< the first block: from rest at its stamp
    Continue,  ///< it follows the last one
    Bridge,    ///< `missing` samples lie between, to be bridged by a straight line
    Restart,   ///< not the same stream any more: from rest at its stamp
    Refuse     ///< take nothing of it
  };

  Action action = Action::Start;
  std::uint64_t missing = 0;  ///< samples between the last block and this one: bridged, or lost by a restart
  std::string reason;         ///< of a bridge, a restart or a refusal: what was found, its value, and what is allowed
};

/// The rules for a stream of excitation blocks that may misbehave. `seq` counts the samples, the stamps date them;
/// where the two contradict each other, the stream is not the one that it was.
class StreamRules
{
public:
  /// More samples than this make no block. (200 s at 50 kHz.)
  static constexpr std::size_t max_block_samples = 10'000'000;
  /// s
  static constexpr double min_sample_period = core::min_sample_period;
  /// s
  static constexpr double max_sample_period = core::max_sample_period;

  explicit StreamRules(const StreamLimits& limits);

  /// Judges a block and changes nothing.
  Verdict judge(const Samples& block) const;

  /// The block was taken, as judge() said. `episode_carried_over`: an episode has been open since before the block
  /// taken last.
  void take(const Samples& block, Verdict::Action action, bool episode_carried_over);

  /// Whatever comes next starts a stream.
  void forget();

  bool started() const
  {
    return started_;
  }
  /// Number of the sample that should come next.
  std::uint64_t nextSeq() const
  {
    return next_seq_;
  }
  /// The last sample taken.
  double lastSample() const
  {
    return last_sample_;
  }
  const SampleClock& clock() const
  {
    return clock_;
  }

private:
  /// What is wrong with the block whatever came before it; empty: nothing.
  std::string fault(const Samples& block) const;

  StreamLimits limits_;
  bool started_ = false;
  SampleClock clock_;
  double sample_period_ = 0.0;
  std::uint64_t next_seq_ = 0;
  Stamp last_stamp_ = 0;
  double last_sample_ = 0.0;
};

}  // namespace vibro_impact::graph
