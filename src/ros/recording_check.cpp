#include "vibro_impact/ros/recording_check.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "text.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/ros/stream_rules.h"

namespace vibro_impact::graph
{
namespace
{
// Numbers of samples up to here are exact in a double, by which samples are dated.
constexpr std::uint64_t last_seq = std::uint64_t{1} << 53;
constexpr const char* not_finite = "holds a sample that is not finite";

bool startsBefore(const BlockHead& block, std::uint64_t seq)
{
  return block.seq < seq;
}

// The block of this number among blocks of ascending ones.
const BlockHead* find(const std::vector<BlockHead>& blocks, std::uint64_t seq)
{
  const auto found = std::lower_bound(blocks.begin(), blocks.end(), seq, startsBefore);
  return found != blocks.end() && found->seq == seq ? &*found : nullptr;
}

// Why an answer is none to an excitation block; empty if it is.
std::string mismatch(const BlockHead& block, const BlockHead& answer)
{
  if (answer.samples != block.samples)
  {
    return text("has ", answer.samples, " samples instead of ", block.samples);
  }
  if (answer.sample_period != block.sample_period)
  {
    return text("has sample_period ", answer.sample_period, " s instead of ", block.sample_period, " s");
  }
  if (answer.stamp != block.stamp)
  {
    return text("has header.stamp ", answer.stamp, " instead of ", block.stamp);
  }
  return {};
}
}  // namespace

RecordingCheck::RecordingCheck(RecordedTopics topics) : topics_(std::move(topics))
{
}

bool RecordingCheck::takeExcitation(const BlockHead& block)
{
  const auto place = [&] { return text("topic ", topics_.base_excitation, ", seq ", block.seq, ": "); };
  // Written so that NaN fails, too.
  if (!(block.sample_period >= StreamRules::min_sample_period && block.sample_period <= StreamRules::max_sample_period))
  {
    throw config::Error(text(place(), "sample_period is ", block.sample_period, " s, must be in [",
                             StreamRules::min_sample_period, ", ", StreamRules::max_sample_period, "] s"));
  }
  if (block.seq > last_seq || block.samples > last_seq - block.seq)
  {
    throw config::Error(text(place(), "the number is too great, must be at most ", last_seq));
  }
  if (excitation_.empty())
  {
    excitation_.push_back(block);
    return true;
  }
  const BlockHead& before = excitation_.back();
  const std::uint64_t expected = before.end();
  const char* const advice = "; cut the recording there with 'rosbag filter' and extract the parts one by one";
  if (block.seq < expected)
  {
    const BlockHead* same = find(excitation_, block.seq);
    if (same != nullptr && mismatch(*same, block).empty())
    {
      ++repeated_;
      return false;
    }
    throw config::Error(
        text(place(), "the stream restarts, seq ", expected, " was expected (header.stamp ", block.stamp, ")", advice));
  }
  if (block.sample_period != before.sample_period)
  {
    throw config::Error(text(place(), "sample_period changes from ", before.sample_period, " s to ",
                             block.sample_period, " s", advice));
  }
  const double elapsed = block.stamp.toSec() - before.stamp.toSec();  // further than a ros::Duration reaches
  const double counted = static_cast<double>(block.seq - before.seq) * block.sample_period;
  if (std::abs(elapsed - counted) > StreamLimits{}.max_stamp_jitter)
  {
    throw config::Error(text(place(), "header.stamp jumps, it is ", elapsed - counted,
                             " s off what the count of samples says", advice));
  }
  if (block.seq > expected)
  {
    losses_.push_back({expected, block.seq,
                       text("topic ", topics_.base_excitation, ": seq ", expected, " to ", block.seq - 1, " (",
                            block.seq - expected, " samples) is missing")});
  }
  excitation_.push_back(block);
  return true;
}

void RecordingCheck::refuseExcitation(const BlockHead& block)
{
  losses_.push_back({block.seq, block.end(),
                     text("topic ", topics_.base_excitation, ": the block of seq ", block.seq, " ", not_finite)});
}

bool RecordingCheck::take(Answers& answers, const BlockHead& block, const std::vector<double>& samples)
{
  answers.blocks.push_back(block);
  const bool finite = std::all_of(samples.begin(), samples.end(), [](double value) { return std::isfinite(value); });
  if (!finite)
  {
    answers.not_finite.insert(block.seq);
  }
  return finite;
}

bool RecordingCheck::takeGap(const BlockHead& block, const std::vector<double>& gap)
{
  return take(gaps_, block, gap);
}

bool RecordingCheck::takeContactForce(const BlockHead& block, const std::vector<double>& force)
{
  bool in_contact = contact_goes_on_ && !forces_.blocks.empty() && forces_.blocks.back().end() == block.seq;
  if (!take(forces_, block, force))
  {
    contact_goes_on_ = false;  // nobody knows
    return false;
  }
  for (std::size_t i = 0; i < force.size(); ++i)
  {
    const bool was_in_contact = in_contact;
    in_contact = force[i] != 0.0;  // a truncated basis pulls, too
    if (was_in_contact && !in_contact)
    {
      last_separated_ = std::max(last_separated_, block.seq + i);
    }
  }
  contact_goes_on_ = in_contact;
  return true;
}

bool RecordingCheck::takeImpact(const Impact& impact)
{
  const std::pair<const char*, double> values[] = {
      {"offset", impact.offset},
      {"duration", impact.duration},
      {"impulse", impact.impulse},
      {"peak_force", impact.peak_force},
      {"approach_speed", impact.approach_speed},
      {"separation_speed", impact.separation_speed},
  };
  for (const auto& [field, value] : values)
  {
    if (!std::isfinite(value))
    {
      throw config::Error(
          text("topic ", topics_.impact, ", number ", impact.number, ": ", field, " is ", value, ", must be finite"));
    }
  }
  if (last_impact_ && impact.number == last_impact_->number && impact.seq == last_impact_->seq &&
      impact.offset == last_impact_->offset)
  {
    return false;
  }
  const bool restart = last_impact_ && impact.number <= last_impact_->number;
  if (last_impact_)
  {
    expectImpact(impact, restart ? 0 : last_impact_->number + 1, std::min(last_impact_->seq, impact.seq));
  }
  else
  {
    first_impact_ = impact;
  }
  restarts_ += restart ? 1 : 0;
  ++impacts_;
  last_impact_ = impact;
  return true;
}

void RecordingCheck::expectImpact(const Impact& impact, std::uint64_t number, std::uint64_t since)
{
  if (impact.number > number)
  {
    const std::uint64_t missing = impact.number - number;
    losses_.push_back({since, impact.seq + 1,
                       text("topic ", topics_.impact, ": number ", number, " to ", impact.number - 1, " (", missing,
                            missing == 1 ? " impact" : " impacts", " before seq ", impact.seq, ") is missing")});
  }
}

void RecordingCheck::compare(Answers answers, const std::string& topic, std::vector<Loss>& losses) const
{
  std::stable_sort(answers.blocks.begin(), answers.blocks.end(),
                   [](const BlockHead& a, const BlockHead& b) { return a.seq < b.seq; });
  // Blocks in a row that are missing are one loss.
  std::uint64_t missing = 0;
  std::uint64_t first = 0;
  std::uint64_t last = 0;
  const auto flush = [&]
  {
    if (missing > 0)
    {
      losses.push_back({first, last,
                        text("topic ", topic, ": seq ", first, " to ", last - 1, " (", missing,
                             missing == 1 ? " block" : " blocks", ") is missing")});
    }
    missing = 0;
  };
  for (const BlockHead& block : excitation_)
  {
    const BlockHead* answer = find(answers.blocks, block.seq);
    if (answer == nullptr)
    {
      first = missing == 0 ? block.seq : first;
      last = block.end();
      ++missing;
      continue;
    }
    flush();
    std::string difference = mismatch(block, *answer);
    if (difference.empty() && answers.not_finite.count(block.seq) != 0)
    {
      difference = not_finite;
    }
    if (!difference.empty())
    {
      losses.push_back(
          {block.seq, block.end(), text("topic ", topic, ": the block of seq ", block.seq, " ", difference)});
    }
  }
  flush();
}

// An answer proves that there was a question.
void RecordingCheck::findUnasked(std::vector<Loss>& losses) const
{
  std::map<std::uint64_t, std::uint64_t> answered;  // first sample and the one after the last
  for (const Answers* answers : {&gaps_, &forces_})
  {
    for (const BlockHead& answer : answers->blocks)
    {
      // Between the first and the last block the numbers of these have shown what is missing.
      if (answer.seq < excitation_.front().seq || answer.seq >= excitation_.back().end())
      {
        answered.emplace(answer.seq, answer.end());
      }
    }
  }
  // A recorder that comes in the middle of the stream hears of one topic before the other.
  if (!answered.empty() && answered.begin()->first > 0)
  {
    answered.erase(answered.begin(), answered.lower_bound(excitation_.front().seq));
  }
  for (auto block = answered.begin(); block != answered.end();)
  {
    const std::uint64_t first = block->first;
    std::uint64_t last = first;
    std::uint64_t blocks = 0;
    for (; block != answered.end() && (blocks == 0 || block->first == last); ++block)
    {
      last = block->second;
      ++blocks;
    }
    losses.push_back({first, last,
                      text("topic ", topics_.base_excitation, ": seq ", first, " to ", last - 1, " (", blocks,
                           blocks == 1 ? " block" : " blocks", ", answered) is missing")});
  }
}

// A contact that has ended was an impact.
void RecordingCheck::findMissingEnd(std::vector<Loss>& losses) const
{
  const double end = last_impact_
                         ? static_cast<double>(last_impact_->seq) +
                               (last_impact_->offset + last_impact_->duration) / excitation_.front().sample_period
                         : 0.0;
  // The release lies between a sample in contact and this one; that of an impact cut short, on the former.
  constexpr double apart = 1.5;
  if (static_cast<double>(last_separated_) > end + apart)
  {
    const std::string which = last_impact_ ? text("what follows number ", last_impact_->number) : "every impact";
    losses.push_back(
        {last_impact_ ? last_impact_->seq : 0, last_separated_ + 1,
         text("topic ", topics_.impact, ": ", which, " (contact up to seq ", last_separated_ - 1, ") is missing")});
  }
}

RecordingSummary RecordingCheck::finish()
{
  if (excitation_.empty())
  {
    throw config::Error("topic " + topics_.base_excitation + ": holds no block of excitation");
  }
  if (last_separated_ > 0 && topics_.impact.empty())
  {
    throw config::Error("topic " + topics_.contact_force +
                        ": shows a contact that ends, but the recording holds no topic of type vibro_impact/Impact");
  }
  // Before the first impact none can be missing unless the recording begins in the middle of the stream.
  if (first_impact_ && excitation_.front().seq == 0)
  {
    expectImpact(*first_impact_, 0, 0);
  }
  RecordingSummary summary;
  summary.blocks = excitation_.size();
  summary.repeated = repeated_;
  summary.impacts = impacts_;
  summary.restarts = restarts_;
  summary.first = excitation_.front().seq;
  summary.sample_period = excitation_.front().sample_period;
  for (const BlockHead& block : excitation_)
  {
    summary.samples += block.samples;
  }
  summary.losses = losses_;
  compare(gaps_, topics_.gap, summary.losses);
  compare(forces_, topics_.contact_force, summary.losses);
  findUnasked(summary.losses);
  findMissingEnd(summary.losses);
  std::stable_sort(summary.losses.begin(), summary.losses.end(),
                   [](const Loss& a, const Loss& b) { return a.first < b.first; });
  return summary;
}

}  // namespace vibro_impact::graph
