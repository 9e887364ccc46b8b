#include "vibro_impact/ros/replay_check.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <tuple>
#include <utility>

#include "contact_replay.h"
#include "recorded_answers.h"
#include "text.h"
#include "vibro_impact/config/configuration.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/ros/conversions.h"
#include "vibro_impact/ros/recording_simulation.h"
#include "vibro_impact/ros/stream_simulation.h"

namespace vibro_impact::graph
{
namespace
{
constexpr std::size_t none = RecordedAnswers::none;
// Blocks without an answer that are tried as the start of a simulator whose first answers are not recorded.
constexpr std::size_t most_tried = 400;
// Share of the first of the two readings in the progress.
constexpr double first_reading = 0.2;

std::string digits(double value)
{
  std::ostringstream stream;
  stream.precision(17);
  stream << value;
  return stream.str();
}

std::string digits(std::uint64_t value)
{
  return std::to_string(value);
}

std::string digits(bool value)
{
  return value ? "true" : "false";
}

std::string digits(const ros::Time& value)
{
  return text(value);
}

std::uint64_t bits(double value)
{
  std::uint64_t result = 0;
  std::memcpy(&result, &value, sizeof result);
  return result;
}

bool identical(double a, double b)
{
  return bits(a) == bits(b);  // also tells zeros and NaNs apart
}

template <typename Value>
bool identical(const Value& a, const Value& b)
{
  return a == b;
}

template <typename Value>
std::optional<ReplayDifference> compare(const std::string& topic, const std::string& place, const std::string& field,
                                        const Value& recorded, const Value& recomputed)
{
  if (identical(recorded, recomputed))
  {
    return std::nullopt;
  }
  return ReplayDifference{topic, place, field, digits(recorded), digits(recomputed)};
}

std::optional<ReplayDifference> compare(const std::string& topic, const std::string& field, const Samples& recorded,
                                        const Samples& recomputed)
{
  const std::string block = text("block of seq ", recorded.seq);
  auto difference = compare(topic, block, "seq", recorded.seq, recomputed.seq);
  difference =
      difference ? difference : compare(topic, block, "header.stamp", toTime(recorded.stamp), toTime(recomputed.stamp));
  difference = difference ? difference
                          : compare(topic, block, "sample_period", recorded.sample_period, recomputed.sample_period);
  difference = difference ? difference
                          : compare(topic, block, "number of samples", std::uint64_t{recorded.values.size()},
                                    std::uint64_t{recomputed.values.size()});
  for (std::size_t i = 0; i < recorded.values.size() && !difference; ++i)
  {
    if (!identical(recorded.values[i], recomputed.values[i]))
    {
      difference = compare(topic, text(block, ", sample ", recorded.seq + i), text(field, "[", i, "]"),
                           recorded.values[i], recomputed.values[i]);
    }
  }
  return difference;
}

std::optional<ReplayDifference> compare(const std::string& topic, const Impact& recorded, const Impact& recomputed)
{
  const std::string place = text("number ", recorded.number, " (seq ", recorded.seq, ")");
  std::optional<ReplayDifference> difference;
  const auto field = [&](const char* name, const auto& a, const auto& b)
  {
    if (!difference)
    {
      difference = compare(topic, place, name, a, b);
    }
  };
  field("number", recorded.number, recomputed.number);
  field("seq", recorded.seq, recomputed.seq);
  field("offset", recorded.offset, recomputed.offset);
  field("header.stamp", recorded.header.stamp, recomputed.header.stamp);
  field("duration", recorded.duration, recomputed.duration);
  field("impulse", recorded.impulse, recomputed.impulse);
  field("peak_force", recorded.peak_force, recomputed.peak_force);
  field("peak_time", recorded.peak_time, recomputed.peak_time);
  field("approach_speed", recorded.approach_speed, recomputed.approach_speed);
  field("separation_speed", recorded.separation_speed, recomputed.separation_speed);
  field("energy_lost", recorded.energy_lost, recomputed.energy_lost);
  field("cut_short", recorded.cut_short != 0, recomputed.cut_short != 0);
  field("dissipated", recorded.dissipated, recomputed.dissipated);
  field("mapping_loss", recorded.mapping_loss, recomputed.mapping_loss);
  field("base_work", recorded.base_work, recomputed.base_work);
  return difference;
}

/// One simulator's model in the course of a recording.
struct Epoch
{
  RecordedModel model;
  std::uint64_t first_number = 0;                // of its first model_info
  std::map<std::size_t, std::uint64_t> missing;  // before which change which number is missing
};

/// A simulator that is started anew tells its model anew.
std::vector<Epoch> epochs(const RecordedRun& recording)
{
  const std::string& topic = recording.topics().model_info;
  std::vector<Epoch> result;
  std::optional<std::uint64_t> last;
  std::string last_configuration;
  recording.readModelInfo(
      [&](const ModelInfo& info)
      {
        // Written out anew, for the text may be another one for the same parameters.
        const core::SystemParameters parameters = fromMessage(info);
        const std::string configuration = config::toYaml(parameters);
        if (last && info.number == *last && configuration == last_configuration)
        {
          return;
        }
        const RecordedChange dated{info.seq, fromTime(info.header.stamp), parameters.contact};
        if (!last || info.number <= *last)
        {
          result.push_back({{parameters, {}, dated}, info.number, {}});
        }
        else
        {
          Epoch& epoch = result.back();
          core::SystemParameters same = epoch.model.parameters;
          same.contact = parameters.contact;
          if (config::toYaml(same) != configuration)
          {
            throw config::Error(text("topic ", topic, ", number ", info.number,
                                     ": is another model than the one before, not another contact"));
          }
          if (info.number > *last + 1)
          {
            epoch.missing.emplace(epoch.model.changes.size(), *last + 1);
          }
          epoch.model.changes.push_back(dated);
        }
        last = info.number;
        last_configuration = configuration;
      });
  if (result.empty())
  {
    throw config::Error("topic " + topic + ": holds no message");
  }
  return result;
}

/// The recorded answers to a block.
struct Answers
{
  std::optional<Samples> gap;
  std::optional<Samples> force;
};

/// What a simulator made of one block.
struct Step
{
  std::size_t block = 0;
  Verdict::Action action = Verdict::Action::Refuse;
  bool cuts_short = false;  // its first impact is that of the motion before the block
  std::vector<StampedImpact> impacts;
  std::uint64_t contact_changes = 0;
};

/// A simulator to be, with all that it was told.
struct Player
{
  StreamSimulation simulation;
  ContactReplay contact;
  std::size_t epoch;
};

/// A block of excitation, and its place in the recording.
struct Block
{
  std::size_t index = 0;
  Samples samples;
};

/// Puts the impacts of both sides together, whichever comes first.
class ImpactComparison
{
public:
  explicit ImpactComparison(std::string topic) : topic_(std::move(topic))
  {
  }

  /// `block`: that of the release. `required`: it must be in the recording.
  void addRecomputed(std::uint64_t run, const StampedImpact& impact, std::size_t block, bool required)
  {
    Entry entry;
    toMessage(impact, entry.impact);
    entry.block = block;
    entry.required = required;
    meet(run, entry, recomputed_, recorded_);
  }

  /// `block`: that of the onset.
  void addRecorded(std::uint64_t run, const Impact& impact, std::size_t block)
  {
    meet(run, {impact, block, true}, recorded_, recomputed_);
  }

  /// Where the motion of this run began is only inferred from what came later. A motion may forget its beginning to the
  /// last bit; the numbers of its impacts do not.
  void doubt(std::uint64_t run)
  {
    doubtful_.insert(run);
  }

  /// A run that the number of an impact has shown to have begun elsewhere, once; 0: none.
  std::uint64_t takeRefuted()
  {
    return std::exchange(refuted_now_, 0);
  }

  /// What has found no counterpart. `judged(run, impact, block)`: whether the end of a recorded impact was recomputed.
  template <typename Judged>
  void finish(ReplayReport& report, const Judged& judged)
  {
    for (const auto& [key, entry] : recorded_)
    {
      const std::uint64_t run = std::get<0>(key);
      if (doubtful_.count(run) != 0 || !judged(run, entry.impact, entry.block))
      {
        ++report.impacts_not_compared;
        continue;
      }
      const auto same = std::find_if(recomputed_.begin(), recomputed_.end(),
                                     [&, of = run, number = entry.impact.number](const auto& other) {
                                       return std::get<0>(other.first) == of && other.second.impact.number == number;
                                     });
      if (same != recomputed_.end())
      {
        note(compare(topic_, entry.impact, same->second.impact), entry.block);
        recomputed_.erase(same);
      }
      else
      {
        note(ReplayDifference{topic_, text("number ", entry.impact.number, " (seq ", entry.impact.seq, ")"), "number",
                              digits(entry.impact.number), "no such impact"},
             entry.block);
      }
    }
    noteMissing(report);
    report.impacts = identical_;
    report.impacts_not_compared += not_compared_;
  }

  const std::optional<ReplayDifference>& difference() const
  {
    return difference_;
  }
  std::size_t differenceBlock() const
  {
    return difference_block_;
  }

private:
  struct Entry
  {
    Impact impact;
    std::size_t block = 0;
    bool required = true;
  };
  using Key = std::tuple<std::uint64_t, std::uint64_t, double>;  // run, seq, offset
  using Entries = std::multimap<Key, Entry>;

  void meet(std::uint64_t run, const Entry& entry, Entries& own, Entries& others)
  {
    const bool is_recorded = &own == &recorded_;
    if (refuted_.count(run) != 0)
    {
      not_compared_ += is_recorded ? 1 : 0;
      return;
    }
    const Key key{run, entry.impact.seq, entry.impact.offset};
    const auto other = others.find(key);
    if (other == others.end())
    {
      own.emplace(key, entry);
      return;
    }
    if (doubtful_.erase(run) != 0 && other->second.impact.number != entry.impact.number)
    {
      not_compared_ += is_recorded ? 1 : 0;
      refute(run);
      return;
    }
    const auto found = is_recorded ? compare(topic_, entry.impact, other->second.impact)
                                   : compare(topic_, other->second.impact, entry.impact);
    identical_ += found ? 0 : 1;
    note(found, is_recorded ? entry.block : other->second.block);
    others.erase(other);
  }

  void refute(std::uint64_t run)
  {
    refuted_.insert(run);
    refuted_now_ = run;
    const auto drop = [run](Entries& entries)
    {
      constexpr double before = -std::numeric_limits<double>::infinity();
      const auto first = entries.lower_bound(Key{run, 0, before});
      const auto last = entries.lower_bound(Key{run + 1, 0, before});
      const auto count = static_cast<std::uint64_t>(std::distance(first, last));
      entries.erase(first, last);
      return count;
    };
    not_compared_ += drop(recorded_);
    drop(recomputed_);
  }

  void note(const std::optional<ReplayDifference>& found, std::size_t block)
  {
    if (found && (!difference_ || block < difference_block_))
    {
      difference_ = found;
      difference_block_ = block;
    }
  }

  void noteMissing(ReplayReport& report) const
  {
    const Entry* first = nullptr;
    const Entry* last = nullptr;
    std::uint64_t count = 0;
    const auto flush = [&]
    {
      if (count > 0)
      {
        report.losses.push_back({first->impact.seq, last->impact.seq + 1,
                                 text("topic ", topic_, ": number ", first->impact.number, " to ", last->impact.number,
                                      " (", count, count == 1 ? " impact" : " impacts", ", seq ", first->impact.seq,
                                      " to ", last->impact.seq, ") is missing")});
      }
      count = 0;
    };
    for (const auto& [key, entry] : recomputed_)
    {
      if (!entry.required)
      {
        continue;
      }
      if (count > 0 && entry.impact.number != last->impact.number + 1)
      {
        flush();
      }
      first = count == 0 ? &entry : first;
      last = &entry;
      ++count;
    }
    flush();
  }

  std::string topic_;
  Entries recorded_, recomputed_;
  std::uint64_t identical_ = 0;
  std::uint64_t not_compared_ = 0;
  std::set<std::uint64_t> doubtful_, refuted_;
  std::uint64_t refuted_now_ = 0;
  std::optional<ReplayDifference> difference_;
  std::size_t difference_block_ = 0;
};

class Replay : public RecordingSink
{
public:
  Replay(const RecordedTopics& topics, const RecordedAnswers& answers, std::vector<Epoch> epochs,
         const StreamLimits& limits)
      : topics_(topics),
        answers_(answers),
        epochs_(std::move(epochs)),
        limits_(limits),
        impacts_(topics.impact.empty() ? "impact" : topics.impact),
        run_of_(answers.excitation().size(), 0),
        contact_(epochs_.front().model)
  {
    report_.losses = answers.unasked();
  }

  void onExcitation(const BaseExcitation& block) override
  {
    waiting_.emplace_back();
    waiting_.back().index = read_++;
    fromMessage(block, waiting_.back().samples);
    judgeWhatIsComplete();
  }

  void onGap(const BlockHead& block, const std::vector<double>& gap) override
  {
    take(block, gap, answers_.ofGap(gaps_++), &Answers::gap);
  }

  void onContactForce(const BlockHead& block, const std::vector<double>& force) override
  {
    take(block, force, answers_.ofForce(forces_++), &Answers::force);
  }

  void onImpact(const Impact& impact) override
  {
    const std::size_t hint = read_ > 0 ? read_ - 1 : 0;
    const std::size_t block = answers_.blockOf(impact.seq, impact.header.stamp, hint);
    unplaced_.emplace_back(block == none ? hint : block, impact);
    placeImpacts();
    dropRefuted();
  }

  void onModelInfo(const ModelInfo& /*info*/) override
  {
  }

  ReplayReport finish();

private:
  void take(const BlockHead& head, const std::vector<double>& values, std::size_t block,
            std::optional<Samples> Answers::*member)
  {
    if (block != none)
    {
      recorded_[block].*member = Samples{fromTime(head.stamp), head.seq, head.sample_period, values};
      judgeWhatIsComplete();
    }
  }

  void judgeWhatIsComplete();
  void judge(const Block& block, const Answers& recorded);
  void leaveUnanswered(Block block);
  void settleUnanswered();
  bool follow(const Block& block, const Answers& recorded, std::optional<ReplayDifference>& difference);
  bool startAnew(const Block& block, const Answers& recorded, std::optional<ReplayDifference>& difference);
  std::string doubt(const Block& block) const;
  void loseTrack(const Block& block, const std::string& reason);

  const StreamSimulation::Answer& feed(Player& player, const Block& block);
  std::optional<ReplayDifference> attempt(Player& player, std::size_t unanswered, const Block& block,
                                          const Answers& recorded);
  StreamSimulation atRest(std::size_t epoch, const core::ContactParameters& contact);
  void adopt(const Block& block, const Answers& recorded);
  void placeImpacts();
  void dropRefuted();
  void noteMissing(const std::string& topic, const Block& block);
  void flushMissing(const std::string& topic);
  void closeLoss();
  std::shared_ptr<const core::SwitchedModel> model(std::size_t epoch, const core::ContactParameters& contact);

  RecordedTopics topics_;
  const RecordedAnswers& answers_;
  std::vector<Epoch> epochs_;
  StreamLimits limits_;
  ReplayReport report_;
  ImpactComparison impacts_;

  std::size_t read_ = 0, gaps_ = 0, forces_ = 0;
  std::deque<Block> waiting_;  // for their answers
  std::map<std::size_t, Answers> recorded_;
  std::vector<std::pair<std::size_t, Impact>> unplaced_;  // by the block of their onset

  std::optional<Player> player_;            // nothing: the motion is not known
  std::optional<StreamSimulation> before_;  // the block that is judged: with an episode open
  std::vector<Step> steps_;                 // of the last attempt
  std::deque<Block> unanswered_;            // since the last answered block
  bool forgotten_ = false;                  // there were more of them
  std::uint64_t run_ = 0;                   // from rest to rest; 0: none
  std::vector<std::uint64_t> run_of_;       // by block; 0: not recomputed
  std::set<std::uint64_t> open_runs_;       // whose end is not known
  struct Inferred
  {
    bool unannounced = false;
    std::uint64_t blocks = 0, samples = 0;  // compared
    std::uint64_t first = 0, last = 0;      // numbers of samples
  };
  std::map<std::uint64_t, Inferred> inferred_;  // runs that began with a block whose answer is not recorded
  std::size_t taken_ = 0;                       // the last block that was
  std::size_t decided_ = 0;                     // blocks so far
  std::optional<Loss> lost_;                    // while the motion is not known
  std::uint64_t lost_blocks_ = 0;
  std::map<std::string, std::pair<Loss, std::uint64_t>> missing_;  // by topic: the answers that are, and how many
  ContactReplay contact_;
  std::size_t epoch_ = 0;
  std::map<std::tuple<std::size_t, double, double>, std::shared_ptr<const core::SwitchedModel>> models_;
  std::map<std::tuple<std::size_t, double, double>, StreamSimulation> resting_;
  std::optional<ReplayDifference> difference_;
  std::size_t difference_block_ = 0;
};

std::shared_ptr<const core::SwitchedModel> Replay::model(std::size_t epoch, const core::ContactParameters& contact)
{
  auto& known = models_[{epoch, contact.stiffness, contact.clearance}];
  if (!known)
  {
    core::SystemParameters parameters = epochs_[epoch].model.parameters;
    parameters.contact = contact;
    known = std::make_shared<const core::SwitchedModel>(parameters);
  }
  return known;
}

/// Judges blocks in their order as soon as all of their answers that are recorded have been read.
void Replay::judgeWhatIsComplete()
{
  while (!waiting_.empty() && !difference_)
  {
    const std::size_t index = waiting_.front().index;
    const auto recorded = recorded_.find(index);
    const bool gap_is_there = recorded != recorded_.end() && recorded->second.gap;
    const bool force_is_there = recorded != recorded_.end() && recorded->second.force;
    if (answers_.hasGap(index) != gap_is_there || answers_.hasForce(index) != force_is_there)
    {
      return;
    }
    Block block = std::move(waiting_.front());
    waiting_.pop_front();
    if (recorded == recorded_.end())
    {
      leaveUnanswered(std::move(block));
    }
    else
    {
      const Answers answers = std::move(recorded->second);
      recorded_.erase(recorded);
      judge(block, answers);
    }
  }
}

void Replay::leaveUnanswered(Block block)
{
  unanswered_.push_back(std::move(block));
  if (unanswered_.size() > most_tried)
  {
    noteMissing(topics_.gap, unanswered_.front());
    noteMissing(topics_.contact_force, unanswered_.front());
    unanswered_.pop_front();
    forgotten_ = true;
  }
}

void Replay::judge(const Block& block, const Answers& recorded)
{
  std::optional<ReplayDifference> difference;
  if (!follow(block, recorded, difference) && !startAnew(block, recorded, difference))
  {
    const std::string reason = doubt(block);
    if (reason.empty())
    {
      difference_ = difference;
      difference_block_ = block.index;
      return;
    }
    loseTrack(block, reason);
  }
  unanswered_.clear();
  forgotten_ = false;
  before_.reset();
  decided_ = block.index + 1;
  placeImpacts();
  dropRefuted();
}

/// Whether the motion so far explains the recorded answers. Of blocks without one either the recording has lost the
/// answers, or the simulator never had them.
bool Replay::follow(const Block& block, const Answers& recorded, std::optional<ReplayDifference>& difference)
{
  if (!player_)
  {
    return false;
  }
  contact_ = player_->contact;
  epoch_ = player_->epoch;
  if (!unanswered_.empty() && !forgotten_)
  {
    Player fork = *player_;
    if (!attempt(fork, unanswered_.size(), block, recorded))
    {
      player_ = std::move(fork);
      adopt(block, recorded);
      return true;
    }
  }
  if (player_->simulation.inContact())
  {
    before_ = player_->simulation;
  }
  difference = attempt(*player_, 0, block, recorded);
  if (difference)
  {
    return false;
  }
  report_.not_taken += unanswered_.size();
  adopt(block, recorded);
  return true;
}

/// Whether a start from rest, with this block or with one before it whose answer is not recorded, explains the answers.
bool Replay::startAnew(const Block& block, const Answers& recorded, std::optional<ReplayDifference>& difference)
{
  std::vector<std::pair<std::size_t, ContactReplay>> starts{{epoch_, contact_}};
  if (epoch_ + 1 < epochs_.size())
  {
    const bool over = contact_.told() == contact_.recorded().changes.size();
    starts.emplace(over ? starts.begin() : starts.end(), epoch_ + 1, ContactReplay(epochs_[epoch_ + 1].model));
  }
  for (std::size_t before = 0; before <= unanswered_.size(); ++before)
  {
    for (const auto& [epoch, contact] : starts)
    {
      Player player{atRest(epoch, contact.contact()), contact, epoch};
      const auto found = attempt(player, before, block, recorded);
      if (!found)
      {
        if (player_ && unanswered_.empty() && before_)
        {
          // The motion before may have been ended in good order, or not.
          for (const StampedImpact& impact : before_->reset().impacts)
          {
            impacts_.addRecomputed(run_, impact, block.index, false);
          }
        }
        else if (player_ && !unanswered_.empty())
        {
          open_runs_.insert(run_);
        }
        const bool unannounced = player_.has_value();
        report_.unannounced += unannounced ? 1 : 0;
        for (std::size_t i = 0; i + before < unanswered_.size(); ++i)
        {
          noteMissing(topics_.gap, unanswered_[i]);
          noteMissing(topics_.contact_force, unanswered_[i]);
        }
        player_ = std::move(player);
        adopt(block, recorded);
        if (const auto inferred = inferred_.find(run_); inferred != inferred_.end())
        {
          inferred->second.unannounced = unannounced;
        }
        return true;
      }
      difference = difference ? difference : found;
      if (player.contact.told() == contact.told())
      {
        player.simulation.reset();
        resting_.emplace(std::make_tuple(epoch, contact.contact().stiffness, contact.contact().clearance),
                         std::move(player.simulation));
      }
    }
  }
  return false;
}

/// Why the motion before a block may be another one than is known here; empty: there is no reason.
std::string Replay::doubt(const Block& block) const
{
  const std::vector<BlockHead>& heads = answers_.excitation();
  const std::uint64_t seq = block.samples.seq;
  const Epoch& epoch = epochs_[epoch_];
  if (epoch.first_number > 0 && block.samples.stamp < epoch.model.known_from.stamp)
  {
    return text("topic ", topics_.model_info, ": the contact before seq ", epoch.model.known_from.seq, " is missing");
  }
  if (const auto missing = epoch.missing.find(contact_.told()); missing != epoch.missing.end())
  {
    return text("topic ", topics_.model_info, ": number ", missing->second, " is missing");
  }
  if (!unanswered_.empty())
  {
    return text("it is not known which of the blocks before it, from seq ", unanswered_.front().samples.seq,
                " on, the simulator had: their answers are missing");
  }
  if (seq == 0)
  {
    return {};
  }
  if (lost_)
  {
    return lost_->reason;
  }
  if (block.index == 0)
  {
    return "the recording begins in the middle of the stream";
  }
  const std::uint64_t expected = heads[block.index - 1].end();
  if (seq > expected)
  {
    return text("the excitation of seq ", expected, " to ", seq - 1, " is missing");
  }
  return seq < expected ? text("the excitation before seq ", seq, " is missing, where a stream begins anew")
                        : std::string();
}

void Replay::loseTrack(const Block& block, const std::string& reason)
{
  if (player_)
  {
    open_runs_.insert(run_);
    player_.reset();
  }
  const Block& first = unanswered_.empty() ? block : unanswered_.front();
  if (!lost_)
  {
    lost_ = Loss{first.samples.seq, 0, reason};
    lost_blocks_ = 0;
  }
  unanswered_.push_back(block);
  for (const Block& passed : unanswered_)
  {
    contact_.comeWith(passed.samples, limits_.max_stamp_jitter);
    contact_.take(passed.samples);
  }
  lost_blocks_ += unanswered_.size();
  lost_->last = block.samples.seq + block.samples.values.size();
}

void Replay::closeLoss()
{
  if (lost_)
  {
    lost_->reason = text(lost_blocks_, lost_blocks_ == 1 ? " block" : " blocks", " from seq ", lost_->first, " to ",
                         lost_->last - 1, " cannot be recomputed: ", lost_->reason);
    report_.losses.push_back(*lost_);
    lost_.reset();
  }
}

void Replay::noteMissing(const std::string& topic, const Block& block)
{
  auto& [loss, blocks] = missing_[topic];
  if (blocks > 0 && loss.last != block.samples.seq)
  {
    flushMissing(topic);
  }
  if (blocks == 0)
  {
    loss.first = block.samples.seq;
  }
  loss.last = block.samples.seq + block.samples.values.size();
  ++blocks;
}

void Replay::flushMissing(const std::string& topic)
{
  auto& [loss, blocks] = missing_[topic];
  if (blocks > 0)
  {
    loss.reason = text("topic ", topic, ": seq ", loss.first, " to ", loss.last - 1, " (", blocks,
                       blocks == 1 ? " block" : " blocks", ") is missing");
    report_.losses.push_back(loss);
    blocks = 0;
  }
}

const StreamSimulation::Answer& Replay::feed(Player& player, const Block& block)
{
  for (const RecordedChange& change : player.contact.comeWith(block.samples, limits_.max_stamp_jitter))
  {
    const auto changed = model(player.epoch, change.contact);
    try
    {
      player.simulation.setContact(changed, change.seq);
    }
    catch (const std::invalid_argument&)  // where blocks are missing, the sample may be behind
    {
      player.simulation.setContact(changed, 0);
    }
  }
  const bool in_contact = player.simulation.inContact();
  const StreamSimulation::Answer& answer = player.simulation.advance(block.samples);
  const Verdict::Action action = answer.verdict.action;
  if (action != Verdict::Action::Refuse)
  {
    player.contact.take(block.samples);
  }
  steps_.push_back({block.index, action, in_contact && action == Verdict::Action::Restart, answer.impacts,
                    answer.contact_changes.size()});
  return answer;
}

/// Plays the last so many blocks without an answer, and then `block`, for whose answers it returns the difference.
std::optional<ReplayDifference> Replay::attempt(Player& player, std::size_t unanswered, const Block& block,
                                                const Answers& recorded)
{
  steps_.clear();
  for (std::size_t i = unanswered_.size() - unanswered; i < unanswered_.size(); ++i)
  {
    feed(player, unanswered_[i]);
  }
  const StreamSimulation::Answer& answer = feed(player, block);
  if (answer.verdict.action == Verdict::Action::Refuse)
  {
    return ReplayDifference{topics_.base_excitation, text("block of seq ", block.samples.seq), "answer", "there is one",
                            "refused, " + answer.verdict.reason};
  }
  std::optional<ReplayDifference> difference;
  if (recorded.force)
  {
    difference = compare(topics_.contact_force, "force", *recorded.force, answer.force);
  }
  if (recorded.gap && !difference)
  {
    difference = compare(topics_.gap, "gap", *recorded.gap, answer.gap);
  }
  return difference;
}

StreamSimulation Replay::atRest(std::size_t epoch, const core::ContactParameters& contact)
{
  const auto kept = resting_.find({epoch, contact.stiffness, contact.clearance});
  if (kept == resting_.end())
  {
    return {model(epoch, contact), limits_};
  }
  StreamSimulation simulation = std::move(kept->second);
  resting_.erase(kept);
  return simulation;
}

/// What was attempted explains the recorded answers.
void Replay::adopt(const Block& block, const Answers& recorded)
{
  closeLoss();
  std::size_t unanswered = unanswered_.size() + 1 - steps_.size();
  for (const Step& step : steps_)
  {
    const bool is_answered = step.block == block.index;
    if (step.action == Verdict::Action::Refuse)
    {
      ++report_.refused;
      ++unanswered;
      continue;
    }
    std::size_t impact = 0;
    if (step.cuts_short)
    {
      impacts_.addRecomputed(run_, step.impacts[impact++], step.block, true);
    }
    if (step.action == Verdict::Action::Start || step.action == Verdict::Action::Restart)
    {
      ++run_;
      ++report_.starts;
      if (!is_answered)
      {
        inferred_[run_].first = block.samples.seq;
        impacts_.doubt(run_);
      }
    }
    else
    {
      // Impacts of a stretch that was bridged are dated in blocks that were not taken.
      std::fill(run_of_.begin() + static_cast<std::ptrdiff_t>(taken_ + 1),
                run_of_.begin() + static_cast<std::ptrdiff_t>(step.block), run_);
    }
    taken_ = step.block;
    report_.bridged += step.action == Verdict::Action::Bridge ? 1 : 0;
    report_.contact_changes += step.contact_changes;
    run_of_[step.block] = run_;
    for (; impact < step.impacts.size(); ++impact)
    {
      impacts_.addRecomputed(run_, step.impacts[impact], step.block, true);
    }
    if (!is_answered)
    {
      noteMissing(topics_.gap, unanswered_[unanswered]);
      noteMissing(topics_.contact_force, unanswered_[unanswered]);
      ++unanswered;
    }
  }
  if (!recorded.gap)
  {
    noteMissing(topics_.gap, block);
  }
  if (!recorded.force)
  {
    noteMissing(topics_.contact_force, block);
  }
  if (recorded.gap && recorded.force)
  {
    ++report_.blocks;
    report_.samples += block.samples.values.size();
  }
  if (const auto inferred = inferred_.find(run_); inferred != inferred_.end())
  {
    const bool both = recorded.gap && recorded.force;
    inferred->second.blocks += both ? 1 : 0;
    inferred->second.samples += both ? block.samples.values.size() : 0;
    inferred->second.last = block.samples.seq + block.samples.values.size();
  }
}

/// A motion that did not begin where it was inferred to is not known.
void Replay::dropRefuted()
{
  const std::uint64_t run = impacts_.takeRefuted();
  if (run == 0)
  {
    return;
  }
  const Inferred inferred = inferred_[run];
  inferred_.erase(run);
  report_.blocks -= inferred.blocks;
  report_.samples -= inferred.samples;
  --report_.starts;
  report_.unannounced -= inferred.unannounced ? 1 : 0;
  const Loss loss{inferred.first, inferred.last, "it is not known which of the blocks before them the simulator had"};
  const bool goes_on = run == run_ && player_;
  if (goes_on)
  {
    contact_ = player_->contact;
    epoch_ = player_->epoch;
    player_.reset();
  }
  const std::optional<Loss> present = lost_;
  const std::uint64_t present_blocks = lost_blocks_;
  lost_ = loss;
  lost_blocks_ = inferred.blocks;
  if (!goes_on)
  {
    closeLoss();
    lost_ = present;
    lost_blocks_ = present_blocks;
  }
}

/// Impacts whose block has been decided on.
void Replay::placeImpacts()
{
  const auto is_placed = [this](const std::pair<std::size_t, Impact>& entry)
  {
    const auto& [block, impact] = entry;
    if (block >= decided_)
    {
      return false;
    }
    if (run_of_[block] != 0)
    {
      impacts_.addRecorded(run_of_[block], impact, block);
    }
    else
    {
      ++report_.impacts_not_compared;
    }
    return true;
  };
  unplaced_.erase(std::remove_if(unplaced_.begin(), unplaced_.end(), is_placed), unplaced_.end());
}

/// Blocks behind the last answer.
void Replay::settleUnanswered()
{
  bool taken = forgotten_;
  for (const Block& block : unanswered_)
  {
    if (player_ && !forgotten_ && feed(*player_, block).verdict.action == Verdict::Action::Refuse)
    {
      ++report_.refused;
      continue;
    }
    taken = true;
    noteMissing(topics_.gap, block);
    noteMissing(topics_.contact_force, block);
  }
  if (player_ && (taken || answers_.endsUnasked()))
  {
    open_runs_.insert(run_);
  }
  else if (player_)
  {
    // A recorder may have ended before the simulator did.
    for (const StampedImpact& impact : player_->simulation.reset().impacts)
    {
      impacts_.addRecomputed(run_, impact, decided_, false);
    }
  }
}

ReplayReport Replay::finish()
{
  if (!difference_)
  {
    settleUnanswered();
  }
  closeLoss();
  for (const std::string& topic : {topics_.gap, topics_.contact_force})
  {
    flushMissing(topic);
  }
  report_.impacts_not_compared += unplaced_.size();
  const auto is_judged = [this](std::uint64_t run, const Impact& impact, std::size_t block)
  {
    const double samples = std::floor((impact.offset + impact.duration) / answers_.excitation()[block].sample_period);
    constexpr double longest = 1.0e15;
    if (!(samples >= 0.0 && samples < longest))
    {
      return true;
    }
    // A release shows with the next sample, unless the motion ends.
    const std::size_t end =
        answers_.blockAfter(block, impact.seq + static_cast<std::uint64_t>(samples) + (impact.cut_short != 0 ? 0 : 1));
    return end != none && run_of_[end] == run && (impact.cut_short == 0 || open_runs_.count(run) == 0);
  };
  impacts_.finish(report_, is_judged);
  const bool impact_first = impacts_.difference() && (!difference_ || impacts_.differenceBlock() <= difference_block_);
  report_.difference = impact_first ? impacts_.difference() : difference_;
  return report_;
}

}  // namespace

ReplayReport checkReplay(const RecordedRun& recording, const StreamLimits& limits,
                         const RecordedRun::Progress& progress)
{
  const auto share = [&](double from, double to) -> RecordedRun::Progress
  {
    if (!progress)
    {
      return {};
    }
    return [&progress, from, to](double done) { progress(from + (to - from) * done); };
  };
  const RecordedAnswers answers(recording, share(0.0, first_reading));
  Replay replay(recording.topics(), answers, epochs(recording), limits);
  recording.read(replay, share(first_reading, 1.0));
  return replay.finish();
}

}  // namespace vibro_impact::graph
