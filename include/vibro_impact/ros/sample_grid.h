#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vibro_impact/ros/samples.h"
#include "vibro_impact/ros/stream_rules.h"

namespace vibro_impact::graph
{
/// What is known beforehand of a source of single stamped samples.
struct GridParameters
{
  std::optional<double> sample_period;  ///< s; nothing: the median of the first intervals between samples
  std::optional<double> offset = 0.0;   ///< taken off every sample, m/s^2; nothing: the mean of the first samples
  double offset_duration = 2.0;         ///< how long that mean is taken for, s
};

/// Puts single stamped samples on an even grid: a stream of blocks as StreamRules judges them.
///
/// The grid begins at the first sample, which is number 0, and goes on by the sample period. Between two samples that
/// follow one another within 1.5 periods its values lie on the straight line between these; a sample within a
/// nanosecond of a time of the grid gives its value there bit for bit. Where samples lie further apart, the times of
/// the grid between them are left out: the numbers of the blocks have a hole, which StreamRules bridges or restarts on
/// as it does where a block is missing. Where it restarts, the grid begins anew at the sample behind the hole.
///
/// Until what is to be measured (period, offset) is known the samples wait, and are then put on the grid from the first
/// one on.
class SampleGrid
{
public:
  /// The median of so many intervals is the sample period.
  static constexpr std::size_t measured_intervals = 101;
  /// More samples than this do not wait: then the mean is that of those.
  static constexpr std::size_t max_waiting_samples = 1'000'000;
  /// What is measured is measured without a longer pause than this (or max_bridged_gap, if that is longer), s.
  static constexpr double max_pause = 1.0;

  /// What one sample brought.
  struct Answer
  {
    std::string refusal;          ///< why samples were not taken: what was found, its value, and what is allowed
    std::uint64_t refused = 0;    ///< how many: this one, or those that waited and are given up
    std::vector<Samples> blocks;  ///< what is known of the grid now, and was not before
  };

  /// `quantity`: how messages call the value.
  SampleGrid(const GridParameters& parameters, const StreamLimits& limits, const std::string& quantity);

  /// Takes a sample (m/s^2), or refuses it and changes nothing. The answer holds until the next call.
  const Answer& take(Stamp stamp, double value);

  /// Whether what is to be measured is not known yet.
  bool measuring() const
  {
    return !period_ || !offset_;
  }
  /// s; nothing while it is being measured.
  const std::optional<double>& samplePeriod() const
  {
    return period_;
  }
  /// m/s^2; nothing while it is being measured.
  const std::optional<double>& offset() const
  {
    return offset_;
  }

private:
  struct Sample
  {
    Stamp stamp = 0;
    double value = 0.0;
  };

  std::string fault(Stamp stamp, double value) const;
  void forget();
  void measure();
  void place(const Sample& sample);
  void add(Stamp stamp, double value);
  Stamp at(std::uint64_t index) const;

  GridParameters parameters_;
  StreamLimits limits_;
  std::string quantity_;
  std::optional<double> period_;
  std::optional<double> offset_;
  std::vector<Sample> waiting_;
  std::optional<Sample> last_;    ///< taken last, with its offset
  std::optional<Sample> placed_;  ///< put on the grid last, without
  Stamp anchor_ = 0;              ///< time of the grid's number anchor_seq_
  std::uint64_t anchor_seq_ = 0;
  std::uint64_t next_ = 0;  ///< number of the grid's next sample
  Answer answer_;
};

}  // namespace vibro_impact::graph
