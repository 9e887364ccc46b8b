#include "recorded_answers.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "text.h"
#include "vibro_impact/ros/stream_rules.h"

namespace vibro_impact::graph
{
namespace
{
double seconds(const ros::Time& later, const ros::Time& earlier)
{
  return later.toSec() - earlier.toSec();  // further than a ros::Duration reaches
}

std::uint64_t distance(std::uint64_t a, std::uint64_t b)
{
  return a > b ? a - b : b - a;
}
}  // namespace

RecordedAnswers::RecordedAnswers(const RecordedRun& recording, const RecordedRun::Progress& progress)
{
  PlacingReader reader;
  recording.read(reader, progress);
  for (const PlacedBlock& block : reader.excitation)
  {
    excitation_.push_back(block.head);
  }
  of_gap_ = match(reader.excitation, reader.gaps, has_gap_);
  of_force_ = match(reader.excitation, reader.forces, has_force_);
  findUnasked(reader.gaps, reader.forces);
  findStretches();
  starts_ = placeStarts(reader.excitation, reader.starts);
}

// An answer has the number and the stamp of its question. One that has only one of the two, and is left over, is a
// wrong answer to a question that is left over, too.
std::vector<std::size_t> RecordedAnswers::match(const std::vector<PlacedBlock>& questions,
                                                const std::vector<PlacedBlock>& answers,
                                                std::vector<bool>& answered) const
{
  std::vector<std::size_t> by_number(questions.size());
  std::iota(by_number.begin(), by_number.end(), std::size_t{0});
  std::vector<std::size_t> by_stamp = by_number;
  const auto number = [&](std::size_t i) { return questions[i].head.seq; };
  const auto stamp = [&](std::size_t i) { return questions[i].head.stamp; };
  std::stable_sort(by_number.begin(), by_number.end(), [&](auto a, auto b) { return number(a) < number(b); });
  std::stable_sort(by_stamp.begin(), by_stamp.end(), [&](auto a, auto b) { return stamp(a) < stamp(b); });

  std::vector<std::size_t> result(answers.size(), none);
  answered.assign(questions.size(), false);
  // The nearest in the order of recording, among questions of a range, in that order, that fit: outwards from the
  // answer, as a looped bag asks the same again and again.
  const auto take = [&](std::size_t answer, auto first, auto last, const auto& fits)
  {
    const std::uint64_t position = answers[answer].position;
    auto behind = std::lower_bound(first, last, position,
                                   [&](std::size_t question, std::uint64_t value)
                                   { return questions[question].position < value; });
    auto before = behind;
    while (before != first || behind != last)
    {
      const bool is_before = behind == last || (before != first && position - questions[*(before - 1)].position <=
                                                                       questions[*behind].position - position);
      const std::size_t question = is_before ? *--before : *behind++;
      if (!answered[question] && fits(questions[question].head))
      {
        answered[question] = true;
        result[answer] = question;
        return;
      }
    }
  };
  const auto by = [&](const std::vector<std::size_t>& order, const auto& key, const auto& value, std::size_t answer,
                      const auto& fits)
  {
    const auto first =
        std::lower_bound(order.begin(), order.end(), value, [&](std::size_t i, const auto& v) { return key(i) < v; });
    const auto last =
        std::upper_bound(first, order.end(), value, [&](const auto& v, std::size_t i) { return v < key(i); });
    take(answer, first, last, fits);
  };
  for (std::size_t i = 0; i < answers.size(); ++i)
  {
    const BlockHead& head = answers[i].head;
    by(by_number, number, head.seq, i, [&](const BlockHead& question) { return question.stamp == head.stamp; });
  }
  for (std::size_t i = 0; i < answers.size(); ++i)
  {
    const BlockHead& head = answers[i].head;
    if (result[i] == none)
    {
      by(by_number, number, head.seq, i,
         [&](const BlockHead& question)
         { return std::abs(seconds(question.stamp, head.stamp)) <= StreamLimits{}.max_stamp_jitter; });
    }
    if (result[i] == none)
    {
      by(by_stamp, stamp, head.stamp, i, [](const BlockHead&) { return true; });
    }
  }
  // Of a block that comes twice in succession the first is taken.
  for (std::size_t& question : result)
  {
    while (question != none && question > 0 && !answered[question - 1] && questions[question].repeats)
    {
      answered[question] = false;
      answered[--question] = true;
    }
  }
  return result;
}

void RecordedAnswers::findUnasked(const std::vector<PlacedBlock>& gaps, const std::vector<PlacedBlock>& forces)
{
  std::map<std::pair<ros::Time, std::uint64_t>, std::uint64_t> blocks;  // by stamp and first sample: after the last
  const auto collect = [&](const std::vector<PlacedBlock>& answers, const std::vector<std::size_t>& of)
  {
    for (std::size_t i = 0; i < answers.size(); ++i)
    {
      if (of[i] == none)
      {
        blocks.emplace(std::make_pair(answers[i].head.stamp, answers[i].head.seq), answers[i].head.end());
      }
    }
    ends_unasked_ = ends_unasked_ || (!answers.empty() && of.back() == none);
  };
  collect(gaps, of_gap_);
  collect(forces, of_force_);
  for (auto block = blocks.begin(); block != blocks.end();)
  {
    const std::uint64_t first = block->first.second;
    std::uint64_t last = first;
    std::uint64_t count = 0;
    for (; block != blocks.end() && (count == 0 || block->first.second == last); ++block)
    {
      last = block->second;
      ++count;
    }
    unasked_.push_back({first, last,
                        text("the excitation of seq ", first, " to ", last - 1, " (", count,
                             count == 1 ? " block" : " blocks", ", answered) is missing")});
  }
}

void RecordedAnswers::findStretches()
{
  for (std::size_t i = 0; i < excitation_.size(); ++i)
  {
    const BlockHead* before = i > 0 ? &excitation_[i - 1] : nullptr;
    const BlockHead& block = excitation_[i];
    if (before == nullptr || block.seq < before->end() ||
        std::abs(seconds(block.stamp, before->stamp) - static_cast<double>(block.seq - before->seq) *
                                                           before->sample_period) > StreamLimits{}.max_stamp_jitter)
    {
      stretches_.push_back(i);
    }
  }
}

std::size_t RecordedAnswers::blockOf(std::uint64_t seq, const ros::Time& stamp, std::size_t hint) const
{
  // Samples that are missing behind a stretch may have been bridged.
  const auto inside = [&](std::size_t stretch, bool or_behind)
  {
    const auto first = excitation_.begin() + static_cast<std::ptrdiff_t>(stretches_[stretch]);
    const auto last = stretch + 1 < stretches_.size()
                          ? excitation_.begin() + static_cast<std::ptrdiff_t>(stretches_[stretch + 1])
                          : excitation_.end();
    const auto after = std::upper_bound(
        first, last, seq, [](std::uint64_t sample, const BlockHead& block) { return sample < block.seq; });
    if (after == first || (after == last && seq >= (after - 1)->end() && !or_behind))
    {
      return none;
    }
    const BlockHead& block = *(after - 1);
    const double expected = static_cast<double>(seq - block.seq) * block.sample_period;
    const double tolerance = StreamLimits{}.max_stamp_jitter + block.sample_period;
    return std::abs(seconds(stamp, block.stamp) - expected) <= tolerance
               ? static_cast<std::size_t>(after - 1 - excitation_.begin())
               : none;
  };
  if (stretches_.empty())
  {
    return none;
  }
  const std::size_t middle = static_cast<std::size_t>(std::upper_bound(stretches_.begin() + 1, stretches_.end(), hint) -
                                                      stretches_.begin() - 1);
  for (const bool or_behind : {false, true})
  {
    for (std::size_t away = 0; away < stretches_.size(); ++away)
    {
      std::size_t nearest = none;
      // One more on either side: the end of that before may be nearer than a block of this one.
      for (const std::size_t stretch : {middle - away, middle + away, middle - away - 1, middle + away + 1})
      {
        // Below the first, the difference wraps around.
        const std::size_t block = stretch < stretches_.size() ? inside(stretch, or_behind) : none;
        nearest =
            block != none && (nearest == none || distance(block, hint) < distance(nearest, hint)) ? block : nearest;
      }
      if (nearest != none)
      {
        return nearest;
      }
    }
  }
  return none;
}

std::size_t RecordedAnswers::blockAfter(std::size_t block, std::uint64_t seq) const
{
  const auto next_stretch = std::upper_bound(stretches_.begin(), stretches_.end(), block);
  const auto last = next_stretch == stretches_.end() ? excitation_.end()
                                                     : excitation_.begin() + static_cast<std::ptrdiff_t>(*next_stretch);
  const auto found =
      std::lower_bound(excitation_.begin() + static_cast<std::ptrdiff_t>(block), last, seq,
                       [](const BlockHead& candidate, std::uint64_t sample) { return candidate.end() <= sample; });
  return found == last ? none : static_cast<std::size_t>(found - excitation_.begin());
}

}  // namespace vibro_impact::graph
