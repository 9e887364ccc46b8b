#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <vibro_impact/Impact.h>

#include "vibro_impact/ros/recorded_run.h"

namespace vibro_impact::graph
{
/// A range of samples of which something is missing in a recording.
struct Loss
{
  std::uint64_t first = 0;  ///< number of the first sample
  std::uint64_t last = 0;   ///< number of the sample after the last one
  std::string reason;       ///< what is missing, where
};

/// What a recording has been found to hold.
struct RecordingSummary
{
  std::uint64_t blocks = 0;    ///< of excitation, repetitions apart
  std::uint64_t samples = 0;   ///< of excitation
  std::uint64_t repeated = 0;  ///< blocks of excitation recorded twice
  std::uint64_t impacts = 0;
  std::uint64_t restarts = 0;  ///< of the simulation from rest, as the impacts' running numbers tell
  std::uint64_t first = 0;     ///< number of the first sample
  double sample_period = 0.0;  ///< s
  std::vector<Loss> losses;    ///< by ascending first sample
};

/// Proves that nothing of a run is missing in its recording, or says what is: the excitation's samples are numbered
/// without a gap, every block of it was answered by a gap and a contact force of its number, finite ones, there is no
/// answer without its block, and impacts are numbered without a gap up to the last contact that the force shows to have
/// ended.
class RecordingCheck
{
public:
  explicit RecordingCheck(RecordedTopics topics);

  /// The next block of excitation as recorded. False: a repetition, to be left. Throws config::Error where the stream
  /// restarts, jumps in time (StreamLimits::max_stamp_jitter) or changes its period, as the samples before and after
  /// have no common time axis, and where the period or the number is out of range.
  bool takeExcitation(const BlockHead& block);
  /// The block taken last holds a sample that is not finite.
  void refuseExcitation(const BlockHead& block);

  /// An answer and its samples; one with a sample that is not finite is lost. False: it is such a one.
  bool takeGap(const BlockHead& block, const std::vector<double>& gap);
  bool takeContactForce(const BlockHead& block, const std::vector<double>& force);
  /// False: a repetition, to be left. Throws config::Error for an impact with a value that is not finite.
  bool takeImpact(const Impact& impact);

  /// Compares everything taken. Throws config::Error if there is no excitation, or a contact has ended but
  /// there is no topic of impacts.
  RecordingSummary finish();

private:
  /// Blocks of one topic.
  struct Answers
  {
    std::vector<BlockHead> blocks;
    std::set<std::uint64_t> not_finite;  // first samples of those that hold something else than finite numbers
  };

  static bool take(Answers& answers, const BlockHead& block, const std::vector<double>& samples);
  void expectImpact(const Impact& impact, std::uint64_t number, std::uint64_t since);
  void compare(Answers answers, const std::string& topic, std::vector<Loss>& losses) const;
  void findUnasked(std::vector<Loss>& losses) const;
  void findMissingEnd(std::vector<Loss>& losses) const;

  RecordedTopics topics_;
  std::vector<BlockHead> excitation_;
  Answers gaps_;
  Answers forces_;
  bool contact_goes_on_ = false;      // over the end of the last block of force
  std::uint64_t last_separated_ = 0;  // sample without contact that follows one in contact, the last one
  std::vector<Loss> losses_;
  std::uint64_t repeated_ = 0;
  std::uint64_t impacts_ = 0;
  std::uint64_t restarts_ = 0;
  std::optional<Impact> first_impact_;
  std::optional<Impact> last_impact_;
};

}  // namespace vibro_impact::graph
