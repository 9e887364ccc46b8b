#include "vibro_impact/ros/replay_check.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "contact_replay.h"
#include "recorded_answers.h"
#include "recorded_simulators.h"
#include "replay_comparison.h"
#include "text.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/ros/conversions.h"
#include "vibro_impact/ros/stream_simulation.h"

namespace vibro_impact::graph
{
namespace
{
constexpr std::size_t none = RecordedAnswers::none;
// Share of the first of the two readings in the progress.
constexpr double first_reading = 0.2;

/// A block of excitation, and its place in the recording.
struct Block
{
  std::size_t index = 0;
  Samples samples;
};

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

/// What a simulator may have had, and what it made of it. Of a block without a recorded answer either the recording has
/// lost the answer, or the simulator never had the block; and a start from rest may be another simulator's.
struct Account
{
  StreamSimulation simulation;
  ContactReplay contact;
  std::size_t simulator = 0;  // which of the recording's
  std::vector<Step> steps;    // since the last block with an answer
  std::size_t skipped = 0;    // blocks since then that it never had
  bool skips = false;         // has not had the last one
};

/// The blocks whose answers are missing on a topic, in stretches.
class MissingAnswers
{
public:
  explicit MissingAnswers(std::string topic) : topic_(std::move(topic))
  {
  }

  void add(const BlockHead& block, std::vector<Loss>& losses)
  {
    if (blocks_ > 0 && stretch_.last != block.seq)
    {
      flush(losses);
    }
    stretch_.first = blocks_ == 0 ? block.seq : stretch_.first;
    stretch_.last = block.end();
    ++blocks_;
  }

  void flush(std::vector<Loss>& losses)
  {
    if (blocks_ > 0)
    {
      stretch_.reason = text("topic ", topic_, ": seq ", stretch_.first, " to ", stretch_.last - 1, " (", blocks_,
                             blocks_ == 1 ? " block" : " blocks", ") is missing");
      losses.push_back(stretch_);
    }
    blocks_ = 0;
  }

private:
  std::string topic_;
  Loss stretch_;
  std::uint64_t blocks_ = 0;
};

class Replay : public RecordingSink
{
public:
  Replay(const RecordedTopics& topics, const RecordedAnswers& answers, std::vector<RecordedSimulator> simulators,
         const StreamLimits& limits)
      : topics_(topics),
        answers_(answers),
        simulators_(std::move(simulators)),
        limits_(limits),
        impacts_(topics.impact.empty() ? "impact" : topics.impact),
        missing_gaps_(topics.gap),
        missing_forces_(topics.contact_force),
        run_of_(answers.excitation().size(), 0),
        contact_(simulators_.front().model)
  {
    report_.losses = answers.unasked();
  }

  void onExcitation(const BaseExcitation& block) override
  {
    const std::size_t index = read_++;
    if (difference_)
    {
      return;
    }
    waiting_.emplace_back();
    waiting_.back().index = index;
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
    const std::size_t place = block == none ? hint : block;
    if (place < decided_)
    {
      placeImpact(place, impact);
    }
    else if (difference_)
    {
      ++report_.impacts_not_compared;
    }
    else
    {
      unplaced_.emplace_back(place, impact);
    }
  }

  void onModelInfo(const ModelInfo& /*info*/) override
  {
  }

  void onStreamStart(const StreamStart& /*start*/) override
  {
  }

  ReplayReport finish();

private:
  void take(const BlockHead& head, const std::vector<double>& values, std::size_t block,
            std::optional<Samples> Answers::*member)
  {
    if (block != none && !difference_)
    {
      recorded_[block].*member = Samples{fromTime(head.stamp), head.seq, head.sample_period, values};
      judgeWhatIsComplete();
    }
  }

  void judgeWhatIsComplete();
  void judge(const Block& block, const Answers& recorded, bool is_known_start);
  void leaveUnanswered(const Block& block, bool is_start);
  bool settleUnanswered();

  void startAnew(const Block& block, const RecordedStart& start);
  void leaveMotion(std::size_t next_block);
  void endMotion(std::size_t next_block, bool is_known);
  std::vector<Account> atRest(const std::set<std::size_t>& simulators);
  std::set<std::size_t> simulatorsToCome() const;
  Verdict::Action feed(Account& account, const Block& block, const StreamSimulation::Answer** answer = nullptr);
  std::vector<Account> takeThoseThatFit(std::vector<Account>& accounts, const Block& block, const Answers& recorded,
                                        std::optional<ReplayDifference>& difference);
  void adopt(std::vector<Account> accounts, const Block& block, const Answers& recorded);
  void adopt(const Step& step);

  std::string doubt(const Block& block, bool is_known_start) const;
  std::string missingBefore(const Block& block) const;
  void loseTrack(const Block& block, const std::string& reason);
  void closeLoss();

  void placeImpacts();
  void placeImpact(std::size_t block, const Impact& impact);
  void noteMissing(std::size_t block, bool gap, bool force);
  std::shared_ptr<const core::SwitchedModel> model(std::size_t simulator, const core::ContactParameters& contact);

  RecordedTopics topics_;
  const RecordedAnswers& answers_;
  std::vector<RecordedSimulator> simulators_;
  std::optional<std::uint64_t> missing_start_;  // running number of the one that should come next
  StreamLimits limits_;
  ReplayReport report_;
  ImpactComparison impacts_;
  MissingAnswers missing_gaps_, missing_forces_;

  std::size_t read_ = 0, gaps_ = 0, forces_ = 0;
  std::deque<Block> waiting_;  // for their answers
  std::map<std::size_t, Answers> recorded_;
  std::vector<std::pair<std::size_t, Impact>> unplaced_;  // by the block of their onset

  std::vector<Account> accounts_;        // none: the motion is not known
  std::vector<std::size_t> unanswered_;  // blocks since the last one with an answer
  std::uint64_t run_ = 0;                // from rest to rest; 0: none
  std::vector<std::uint64_t> run_of_;    // by block; 0: not recomputed
  std::set<std::uint64_t> open_runs_;    // whose end is not known
  std::size_t taken_ = 0;                // the last block that was
  std::size_t decided_ = 0;              // blocks so far
  std::optional<Loss> lost_;             // while the motion is not known
  std::uint64_t lost_blocks_ = 0;
  ContactReplay contact_;  // up to the last block decided on
  std::size_t simulator_ = 0;
  std::map<std::tuple<std::size_t, double, double>, std::shared_ptr<const core::SwitchedModel>> models_;
  std::optional<ReplayDifference> difference_;
  std::size_t difference_block_ = 0;
};

std::shared_ptr<const core::SwitchedModel> Replay::model(std::size_t simulator, const core::ContactParameters& contact)
{
  auto& known = models_[{simulator, contact.stiffness, contact.clearance}];
  if (!known)
  {
    core::SystemParameters parameters = simulators_[simulator].model.parameters;
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
    const Block block = std::move(waiting_.front());
    waiting_.pop_front();
    const bool starts_are_known = !topics_.stream_start.empty();
    // Without a record of the starts the first block may be one; others show by what does not fit (judge()).
    const RecordedStart first{StreamStart::FIRST, {}, true, {}};
    const RecordedStart* start = starts_are_known ? answers_.startOf(index) : (index == 0 ? &first : nullptr);
    if (start != nullptr)
    {
      startAnew(block, *start);
    }
    if (recorded == recorded_.end())
    {
      leaveUnanswered(block, start != nullptr);
    }
    else
    {
      const Answers answers = std::move(recorded->second);
      recorded_.erase(recorded);
      judge(block, answers, starts_are_known && start != nullptr);
    }
  }
}

/// By the rules of time a motion begins anew in its course; by a reset, a pause or in another simulator, aside from it.
void Replay::startAnew(const Block& block, const RecordedStart& start)
{
  missing_start_ = start.missing_next;
  if (start.cause == StreamStart::RULE)
  {
    std::vector<Account> restarting;
    for (const Account& account : accounts_)
    {
      Account trial = account;
      if (feed(trial, block) == Verdict::Action::Restart)
      {
        restarting.push_back(account);
        restarting.back().skips = false;
      }
    }
    if (!restarting.empty())
    {
      accounts_ = std::move(restarting);
      return;
    }
  }
  std::set<std::size_t> simulators =
      start.of_another_simulator ? simulatorsToCome() : std::set<std::size_t>{simulator_};
  for (const Account& account : accounts_)
  {
    simulators.insert(account.simulator);
  }
  leaveMotion(block.index);
  accounts_ = atRest(simulators);
}

/// The present one and those behind it: one that had no block has told its model nonetheless, and one that tells the
/// same model as the one before it is taken for a repetition (recordedSimulators()).
std::set<std::size_t> Replay::simulatorsToCome() const
{
  std::set<std::size_t> simulators;
  for (std::size_t simulator = simulator_; simulator < simulators_.size(); ++simulator)
  {
    simulators.insert(simulators.end(), simulator);
  }
  return simulators;
}

std::vector<Account> Replay::atRest(const std::set<std::size_t>& simulators)
{
  std::vector<Account> accounts;
  for (const std::size_t simulator : simulators)
  {
    const ContactReplay contact = simulator == simulator_ ? contact_ : ContactReplay(simulators_[simulator].model);
    accounts.push_back({{model(simulator, contact.contact()), limits_}, contact, simulator, {}, 0, false});
  }
  return accounts;
}

Verdict::Action Replay::feed(Account& account, const Block& block, const StreamSimulation::Answer** answer)
{
  for (const RecordedChange& change : account.contact.comeWith(block.samples, limits_.max_stamp_jitter))
  {
    const auto changed = model(account.simulator, change.contact);
    try
    {
      account.simulation.setContact(changed, change.seq);
    }
    catch (const std::invalid_argument&)  // where blocks are missing, the sample may be behind
    {
      account.simulation.setContact(changed, 0);
    }
  }
  const bool in_contact = account.simulation.inContact();
  const StreamSimulation::Answer& given = account.simulation.advance(block.samples);
  const Verdict::Action action = given.verdict.action;
  if (action != Verdict::Action::Refuse)
  {
    account.contact.take(block.samples);
  }
  account.steps.push_back({block.index, action, in_contact && action == Verdict::Action::Restart, given.impacts,
                           given.contact_changes.size()});
  if (answer != nullptr)
  {
    *answer = &given;
  }
  return action;
}

void Replay::judge(const Block& block, const Answers& recorded, bool is_known_start)
{
  std::optional<ReplayDifference> difference;
  std::vector<Account> before;
  const bool starts_are_known = !topics_.stream_start.empty();
  if (!starts_are_known)
  {
    before = accounts_;
  }
  std::vector<Account> fitting = takeThoseThatFit(accounts_, block, recorded, difference);
  if (fitting.empty() && !starts_are_known)
  {
    std::vector<Account> resting = atRest(simulatorsToCome());
    fitting = takeThoseThatFit(resting, block, recorded, difference);
    if (!fitting.empty())
    {
      accounts_ = std::move(before);
      leaveMotion(block.index);
    }
  }
  if (!fitting.empty())
  {
    adopt(std::move(fitting), block, recorded);
  }
  else if (const std::string reason = doubt(block, is_known_start); !reason.empty())
  {
    loseTrack(block, reason);
  }
  else
  {
    difference_ = difference;
    difference_block_ = block.index;
    waiting_.clear();
    recorded_.clear();
    return;
  }
  unanswered_.clear();
  decided_ = block.index + 1;
  placeImpacts();
}

/// The accounts that explain the recorded answers, one for each simulator: two models may be told apart by later
/// answers only, such as before the first contact. None: `difference` is that of the first.
std::vector<Account> Replay::takeThoseThatFit(std::vector<Account>& accounts, const Block& block,
                                              const Answers& recorded, std::optional<ReplayDifference>& difference)
{
  std::vector<Account> fitting;
  for (Account& account : accounts)
  {
    if (!fitting.empty() && fitting.back().simulator == account.simulator)
    {
      continue;
    }
    const StreamSimulation::Answer* answer = nullptr;
    std::optional<ReplayDifference> found;
    if (feed(account, block, &answer) == Verdict::Action::Refuse)
    {
      found = ReplayDifference{topics_.base_excitation, text("block of seq ", block.samples.seq), "answer",
                               "there is one", "refused, " + answer->verdict.reason};
    }
    if (recorded.force && !found)
    {
      found = compare(topics_.contact_force, "force", *recorded.force, answer->force);
    }
    if (recorded.gap && !found)
    {
      found = compare(topics_.gap, "gap", *recorded.gap, answer->gap);
    }
    if (!found)
    {
      fitting.push_back(std::move(account));
    }
    difference = difference ? difference : found;
  }
  return fitting;
}

/// The first block without an answer is where the accounts part: one has it and what follows, the other has not.
void Replay::leaveUnanswered(const Block& block, bool is_start)
{
  unanswered_.push_back(block.index);
  if (accounts_.empty())
  {
    contact_.comeWith(block.samples, limits_.max_stamp_jitter);
    contact_.take(block.samples);
    return;
  }
  const bool part = !is_start && std::none_of(accounts_.begin(), accounts_.end(),
                                              [](const Account& account) { return account.skips; });
  std::vector<Account> accounts;
  bool is_taken = false;
  for (Account& account : accounts_)
  {
    if (account.skips)
    {
      ++account.skipped;
      accounts.push_back(std::move(account));
      continue;
    }
    std::optional<Account> without;
    if (part)
    {
      without = account;
      without->skips = true;
      ++without->skipped;
    }
    const bool takes = feed(account, block) != Verdict::Action::Refuse;
    is_taken = is_taken || takes;
    accounts.push_back(std::move(account));
    if (takes && without)
    {
      accounts.push_back(std::move(*without));
    }
  }
  accounts_ = std::move(accounts);
  // Nothing that is recorded would show what was made of it, and a motion may forget its beginning to the last bit.
  if (const std::string reason = missingBefore(block); is_taken && !is_start && !reason.empty())
  {
    unanswered_.pop_back();
    loseTrack(block, reason);
    unanswered_.clear();
  }
}

/// What is missing in the excitation right before a block; empty: nothing.
std::string Replay::missingBefore(const Block& block) const
{
  const std::uint64_t expected = block.index == 0 ? 0 : answers_.excitation()[block.index - 1].end();
  return block.index == 0 || block.samples.seq <= expected
             ? std::string()
             : text("the excitation of seq ", expected, " to ", block.samples.seq - 1, " is missing");
}

/// Why the motion before a block may be another one than is known here; empty: there is no reason.
std::string Replay::doubt(const Block& block, bool is_known_start) const
{
  const std::uint64_t seq = block.samples.seq;
  const RecordedSimulator& simulator = simulators_[simulator_];
  if (simulator.first_number > 0 && block.samples.stamp < simulator.model.known_from.stamp)
  {
    return text("topic ", topics_.model_info, ": the contact before seq ", simulator.model.known_from.seq,
                " is missing");
  }
  if (const auto missing = simulator.missing.find(contact_.told()); missing != simulator.missing.end())
  {
    return text("topic ", topics_.model_info, ": number ", missing->second, " is missing");
  }
  if (is_known_start)
  {
    return {};
  }
  if (missing_start_)
  {
    return text("topic ", topics_.stream_start, ": number ", *missing_start_, " is missing");
  }
  if (!unanswered_.empty())
  {
    return text("it is not known which of the blocks before it, from seq ",
                answers_.excitation()[unanswered_.front()].seq, " on, the simulator had: their answers are missing");
  }
  if (lost_)
  {
    return lost_->reason;
  }
  if (accounts_.empty() || (topics_.stream_start.empty() && block.index == 0 && seq > 0))
  {
    return "the recording begins in the middle of the stream";
  }
  if (block.index > 0 && seq < answers_.excitation()[block.index - 1].end())
  {
    return text("the excitation before seq ", seq, " is missing, where a stream begins anew");
  }
  return missingBefore(block);
}

/// What is known of the contact goes on.
void Replay::loseTrack(const Block& block, const std::string& reason)
{
  if (!accounts_.empty())
  {
    open_runs_.insert(run_);
    const auto present = std::find_if(accounts_.begin(), accounts_.end(),
                                      [this](const Account& account) { return account.simulator == simulator_; });
    contact_ = present == accounts_.end() ? contact_ : present->contact;
    accounts_.clear();
  }
  contact_.comeWith(block.samples, limits_.max_stamp_jitter);
  contact_.take(block.samples);
  if (!lost_)
  {
    lost_ = Loss{unanswered_.empty() ? block.samples.seq : answers_.excitation()[unanswered_.front()].seq, 0, reason};
    lost_blocks_ = 0;
  }
  lost_blocks_ += unanswered_.size() + 1;
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

void Replay::noteMissing(std::size_t block, bool gap, bool force)
{
  if (gap)
  {
    missing_gaps_.add(answers_.excitation()[block], report_.losses);
  }
  if (force)
  {
    missing_forces_.add(answers_.excitation()[block], report_.losses);
  }
}

/// What explains the recorded answers is what there was.
void Replay::adopt(std::vector<Account> accounts, const Block& block, const Answers& recorded)
{
  const Account& account = accounts.front();
  closeLoss();
  for (const Step& step : account.steps)
  {
    adopt(step);
    if (step.action != Verdict::Action::Refuse && step.block != block.index)
    {
      noteMissing(step.block, true, true);
    }
  }
  noteMissing(block.index, !recorded.gap, !recorded.force);
  if (recorded.gap && recorded.force)
  {
    ++report_.blocks;
    report_.samples += block.samples.values.size();
  }
  report_.not_taken += account.skipped;
  contact_ = account.contact;
  simulator_ = account.simulator;
  accounts_ = std::move(accounts);
  for (Account& present : accounts_)
  {
    present.steps.clear();
    present.skipped = 0;
    present.skips = false;
  }
}

void Replay::adopt(const Step& step)
{
  if (step.action == Verdict::Action::Refuse)
  {
    ++report_.refused;
    return;
  }
  auto impact = step.impacts.begin();
  if (step.cuts_short)
  {
    impacts_.addRecomputed(run_, *impact++, step.block, true);
  }
  if (step.action == Verdict::Action::Start || step.action == Verdict::Action::Restart)
  {
    ++run_;
    ++report_.starts;
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
  for (; impact != step.impacts.end(); ++impact)
  {
    impacts_.addRecomputed(run_, *impact, step.block, true);
  }
}

/// Impacts whose block has been decided on.
void Replay::placeImpacts()
{
  const auto is_placed = [this](const std::pair<std::size_t, Impact>& entry)
  {
    const bool is_decided = entry.first < decided_;
    if (is_decided)
    {
      placeImpact(entry.first, entry.second);
    }
    return is_decided;
  };
  unplaced_.erase(std::remove_if(unplaced_.begin(), unplaced_.end(), is_placed), unplaced_.end());
}

void Replay::placeImpact(std::size_t block, const Impact& impact)
{
  if (run_of_[block] != 0)
  {
    impacts_.addRecorded(run_of_[block], impact, block);
  }
  else
  {
    ++report_.impacts_not_compared;
  }
}

/// Blocks whose fate no later answer tells. Returns whether the motion behind them is known.
bool Replay::settleUnanswered()
{
  std::set<std::size_t> refused;
  if (!accounts_.empty())
  {
    for (const Step& step : accounts_.front().steps)
    {
      if (step.action == Verdict::Action::Refuse)
      {
        refused.insert(step.block);
      }
    }
  }
  for (const std::size_t block : unanswered_)
  {
    if (refused.count(block) == 0)
    {
      noteMissing(block, true, true);
    }
  }
  const bool is_known = unanswered_.size() == refused.size();
  report_.refused += refused.size();
  unanswered_.clear();
  return is_known;
}

/// Another one begins with a block, aside from the rules of time.
void Replay::leaveMotion(std::size_t next_block)
{
  report_.unannounced += accounts_.empty() ? 0 : 1;
  endMotion(next_block, settleUnanswered());
  accounts_.clear();
}

/// The motion ends before a block.
void Replay::endMotion(std::size_t next_block, bool is_known)
{
  if (accounts_.empty())
  {
    return;
  }
  if (!is_known)
  {
    open_runs_.insert(run_);
    return;
  }
  // The simulator, or the recorder, may have ended in good order or not.
  for (const StampedImpact& impact : accounts_.front().simulation.reset().impacts)
  {
    impacts_.addRecomputed(run_, impact, next_block, false);
  }
}

ReplayReport Replay::finish()
{
  if (!difference_)
  {
    const bool is_known = settleUnanswered();
    endMotion(decided_, is_known && !answers_.endsUnasked());
  }
  closeLoss();
  missing_gaps_.flush(report_.losses);
  missing_forces_.flush(report_.losses);
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
  std::vector<RecordedSimulator> simulators = recordedSimulators(recording);
  if (simulators.empty())
  {
    throw config::Error("topic " + recording.topics().model_info + ": holds no message");
  }
  Replay replay(recording.topics(), answers, std::move(simulators), limits);
  recording.read(replay, share(first_reading, 1.0));
  return replay.finish();
}

}  // namespace vibro_impact::graph
