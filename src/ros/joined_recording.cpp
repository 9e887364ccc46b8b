#include "vibro_impact/ros/joined_recording.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "text.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/ros/stream_rules.h"

namespace vibro_impact::graph
{
namespace
{
bool answers(const BlockHead& question, const BlockHead& answer)
{
  return answer.seq == question.seq && answer.samples == question.samples && answer.stamp == question.stamp &&
         answer.sample_period == question.sample_period;
}

/// The blocks of excitation of one stretch without a restart, by ascending number.
class Axis
{
public:
  explicit Axis(const RecordedTopics& topics) : topic_(topics.base_excitation), check_(topics)
  {
  }

  RecordingCheck& check()
  {
    return check_;
  }

  /// False: a repetition. Throws config::Error where the stretch ends.
  bool take(const BlockHead& block)
  {
    if (!check_.takeExcitation(block))
    {
      return false;
    }
    if (!blocks_.empty() && block.seq - blocks_.front().seq > 2 * recorded_ + StreamRules::max_block_samples)
    {
      throw config::Error(text("topic ", topic_, ", seq ", block.seq, ": ", block.seq - blocks_.front().seq - recorded_,
                               " samples are missing before it, at most ", recorded_ + StreamRules::max_block_samples,
                               " can be where so few are recorded; cut the recording there with 'rosbag filter'"));
    }
    recorded_ += block.samples;
    blocks_.push_back(block);
    return true;
  }

  const std::vector<BlockHead>& blocks() const
  {
    return blocks_;
  }
  std::uint64_t first() const
  {
    return blocks_.front().seq;
  }
  std::size_t size() const
  {
    return static_cast<std::size_t>(blocks_.back().end() - first());
  }

  /// The block that an answer belongs to.
  const BlockHead* question(const BlockHead& answer) const
  {
    const auto found = after(answer.seq);
    return found != blocks_.begin() && answers(*std::prev(found), answer) ? &*std::prev(found) : nullptr;
  }

  /// Whether something at this time after this sample may belong to the stretch.
  bool holds(std::uint64_t seq, double offset, const ros::Time& stamp) const
  {
    const auto found = after(seq);
    const BlockHead& near = found == blocks_.begin() ? *found : *std::prev(found);
    const double samples = static_cast<double>(static_cast<std::int64_t>(seq - near.seq));
    const double expected = near.stamp.toSec() + samples * near.sample_period + offset;
    return std::abs(stamp.toSec() - expected) <= StreamLimits{}.max_stamp_jitter;
  }

private:
  std::vector<BlockHead>::const_iterator after(std::uint64_t seq) const
  {
    return std::upper_bound(blocks_.begin(), blocks_.end(), seq,
                            [](std::uint64_t number, const BlockHead& block) { return number < block.seq; });
  }

  std::string topic_;
  RecordingCheck check_;
  std::vector<BlockHead> blocks_;
  std::uint64_t recorded_ = 0;
};

/// Writes answers where their question is, though it be recorded after them.
class AnswerColumn
{
public:
  explicit AnswerColumn(SampleColumn& column) : column_(column)
  {
  }

  void take(const Axis& axis, const BlockHead& block, const std::vector<double>& samples)
  {
    if (axis.question(block) != nullptr)
    {
      write(axis, block, samples);
    }
    else
    {
      early_.insert_or_assign(block.seq, std::make_pair(block, samples));
    }
  }

  /// A question has been put last on the axis.
  void extend(const Axis& axis)
  {
    const std::size_t before = column_.size();
    column_.resize(axis.size());
    std::fill(column_.data() + before, column_.data() + column_.size(), std::numeric_limits<double>::quiet_NaN());
    const BlockHead& question = axis.blocks().back();
    const auto early = early_.find(question.seq);
    if (early != early_.end() && answers(question, early->second.first))
    {
      write(axis, question, early->second.second);
      early_.erase(early);
    }
  }

private:
  void write(const Axis& axis, const BlockHead& block, const std::vector<double>& samples)
  {
    std::copy(samples.begin(), samples.end(), column_.data() + (block.seq - axis.first()));
  }

  SampleColumn& column_;
  std::map<std::uint64_t, std::pair<BlockHead, std::vector<double>>> early_;
};

class Joiner : public RecordingSink
{
public:
  /// `stretch`: the blocks to take and which messages of excitation they are, the first and the one after the last;
  /// nullptr: all.
  struct Stretch
  {
    Axis axis;
    std::uint64_t begin = 0;
    std::uint64_t end = 0;
  };

  Joiner(const RecordedTopics& topics, const Stretch* stretch) : axis_(topics), stretch_(stretch)
  {
  }

  void onExcitation(const BaseExcitation& block) override
  {
    const std::uint64_t message = messages_++;
    const BlockHead head = headOf(block, block.acceleration.size());
    if ((stretch_ != nullptr && (message < stretch_->begin || message >= stretch_->end)) || !axis_.take(head))
    {
      return;
    }
    SampleColumn& column = joined_.acceleration;
    const std::size_t before = column.size();
    const auto position = static_cast<std::size_t>(head.seq - axis_.first());
    const bool finite = std::all_of(block.acceleration.begin(), block.acceleration.end(),
                                    [](double value) { return std::isfinite(value); });
    column.resize(axis_.size());
    std::fill(column.data() + before, column.data() + (finite ? position : column.size()),
              std::numeric_limits<double>::quiet_NaN());
    if (finite)
    {
      std::copy(block.acceleration.begin(), block.acceleration.end(), column.data() + position);
    }
    else
    {
      axis_.check().refuseExcitation(head);
    }
    gap_.extend(axis_);
    force_.extend(axis_);
  }

  void onGap(const BlockHead& block, const std::vector<double>& gap) override
  {
    if (belongs(block.seq, 0.0, block.stamp) && axis_.check().takeGap(block, gap))
    {
      gap_.take(axis_, block, gap);
    }
  }

  void onContactForce(const BlockHead& block, const std::vector<double>& force) override
  {
    if (belongs(block.seq, 0.0, block.stamp) && axis_.check().takeContactForce(block, force))
    {
      force_.take(axis_, block, force);
    }
  }

  void onImpact(const Impact& impact) override
  {
    if (belongs(impact.seq, impact.offset, impact.header.stamp) && axis_.check().takeImpact(impact))
    {
      joined_.impacts.push_back(impact);
    }
  }

  void onModelInfo(const ModelInfo& info) override
  {
    // A simulator that was started anew counts from 0 again.
    const auto same = [&](const ModelInfo& other)
    { return other.number == info.number && other.seq == info.seq && other.configuration == info.configuration; };
    if (joined_.models.empty() || !same(joined_.models.back()))
    {
      joined_.models.push_back(info);
    }
  }

  void onStreamStart(const StreamStart& start) override
  {
    const auto same = [&](const StreamStart& other) { return other.number == start.number && other.seq == start.seq; };
    if (belongs(start.seq, 0.0, start.header.stamp) && (joined_.starts.empty() || !same(joined_.starts.back())))
    {
      joined_.starts.push_back(start);
    }
  }

  JoinedRecording finish()
  {
    joined_.summary = axis_.check().finish();
    joined_.start = axis_.blocks().front().stamp;
    for (SampleColumn* column : {&joined_.acceleration, &joined_.gap, &joined_.contact_force})
    {
      column->shrinkToFit();
    }
    return std::move(joined_);
  }

private:
  bool belongs(std::uint64_t seq, double offset, const ros::Time& stamp) const
  {
    return stretch_ == nullptr || stretch_->axis.holds(seq, offset, stamp);
  }

  Axis axis_;
  const Stretch* stretch_;
  std::uint64_t messages_ = 0;  // of excitation
  JoinedRecording joined_;
  AnswerColumn gap_{joined_.gap};
  AnswerColumn force_{joined_.contact_force};
};

Joiner::Stretch findStretch(const RecordedRun& recording, std::size_t wanted)
{
  std::optional<Joiner::Stretch> found;
  Joiner::Stretch current{Axis(recording.topics())};
  std::size_t stretches = 0;
  const auto close = [&](std::uint64_t message)
  {
    current.end = message;
    if (stretches++ == wanted)
    {
      found = current;
    }
  };
  std::uint64_t message = 0;
  recording.readExcitation(
      [&](const BaseExcitation& block)
      {
        const BlockHead head = headOf(block, block.acceleration.size());
        try
        {
          current.axis.take(head);
        }
        catch (const config::Error&)
        {
          if (current.axis.blocks().empty())
          {
            throw;  // the block is none by itself
          }
          close(message);
          current = {Axis(recording.topics()), message};
          current.axis.take(head);
        }
        ++message;
      });
  if (!current.axis.blocks().empty())
  {
    close(message);
  }
  if (!found)
  {
    throw config::Error(text("stream is ", wanted, ", must be less than ", stretches, ", as many streams topic ",
                             recording.topics().base_excitation, " holds"));
  }
  return std::move(*found);
}
}  // namespace

JoinedRecording joinRecording(const RecordedRun& recording, std::optional<std::size_t> stream,
                              const RecordedRun::Progress& progress)
{
  std::optional<Joiner::Stretch> stretch;
  if (stream)
  {
    stretch = findStretch(recording, *stream);
  }
  Joiner joiner(recording.topics(), stretch ? &*stretch : nullptr);
  recording.read(joiner, progress);
  return joiner.finish();
}

}  // namespace vibro_impact::graph
