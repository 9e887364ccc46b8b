// Runs the program as a user does, on bags written for it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "../config/tool_test.h"
#include "synthetic_run.h"
#include "vibro_impact/config/configuration.h"
#include "vibro_impact/ros/stream_simulation.h"

namespace vibro_impact::graph
{
namespace
{
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr double sample_period = 5.0e-5;
constexpr std::size_t block_size = 400;
constexpr std::size_t blocks = 12;

double acceleration(std::uint64_t i)
{
  const double time = static_cast<double>(i) * sample_period;
  return 20.0 * std::sin(2700.0 * time) + 3.0 * std::sin(2.0 + 911.0 * time);
}

std::vector<double> excitation()
{
  std::vector<double> samples;
  for (std::size_t i = 0; i < blocks * block_size; ++i)
  {
    samples.push_back(acceleration(i));
  }
  return samples;
}

void flip(double& value)
{
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  bits ^= 1;
  std::memcpy(&value, &bits, sizeof bits);
}

/// What a recorder hears of a simulator, message by message.
class Recorder
{
public:
  explicit Recorder(const core::SystemParameters& parameters)
  {
    startSimulator(parameters);
  }

  /// Another simulator, which knows nothing of what was before.
  void startSimulator(const core::SystemParameters& parameters)
  {
    parameters_ = parameters;
    const auto model = std::make_shared<const core::SwitchedModel>(parameters);
    simulation_ = std::make_unique<StreamSimulation>(model, StreamLimits{});
    changes_ = 0;
    starts_ = 0;
    cause_ = StreamStart::FIRST;
    ModelInfo info;
    toMessage(*model, config::toYaml(parameters), "0.0.0", info);
    write("model_info", info);
  }

  void setContact(const core::ContactParameters& contact)
  {
    core::SystemParameters changed = parameters_;
    changed.contact = contact;
    simulation_->setContact(std::make_shared<const core::SwitchedModel>(changed), 0);
  }

  void reset()
  {
    cause_ = StreamStart::RESET;
    writeImpacts(simulation_->reset());
  }

  static Samples block(std::uint64_t seq, double begin = 1000.0)
  {
    Samples samples{fromTime(ros::Time(begin) + ros::Duration(static_cast<double>(seq) * sample_period)), seq,
                    sample_period, std::vector<double>(block_size)};
    for (std::size_t i = 0; i < block_size; ++i)
    {
      samples.values[i] = acceleration(seq + i);
    }
    return samples;
  }

  void play(const Samples& block)
  {
    record(block);
    answer(block);
  }

  void play(std::uint64_t from, std::uint64_t to, double begin = 1000.0)
  {
    for (std::uint64_t seq = from; seq < to; seq += block_size)
    {
      play(block(seq, begin));
    }
  }

  /// The excitation is recorded, but does not reach the simulator.
  void record(const Samples& block)
  {
    BaseExcitation message;
    toMessage(block, message);
    write("base_excitation", message);
  }

  /// The excitation reaches the simulator, but is not recorded.
  void answer(const Samples& block, bool gap_is_recorded = true, bool force_is_recorded = true,
              bool impacts_are_recorded = false)
  {
    const StreamSimulation::Answer& answer = simulation_->advance(block);
    for (const StreamSimulation::ContactChange& change : answer.contact_changes)
    {
      core::SystemParameters changed = parameters_;
      changed.contact = {change.model->stiffness(), change.model->clearance()};
      ModelInfo info;
      toMessage(*change.model, config::toYaml(changed), "0.0.0", info);
      info.header.stamp = toTime(change.stamp);
      info.seq = change.seq;
      info.number = ++changes_;
      if (change_is_recorded)
      {
        write("model_info", info);
      }
    }
    if (force_is_recorded || impacts_are_recorded)
    {
      writeImpacts(answer);
    }
    const Verdict::Action action = answer.verdict.action;
    if (starts_are_recorded && (action == Verdict::Action::Start || action == Verdict::Action::Restart))
    {
      StreamStart start;
      start.header.stamp = toTime(answer.gap.stamp);
      start.seq = answer.gap.seq;
      start.number = starts_++;
      start.cause = action == Verdict::Action::Restart ? std::uint8_t{StreamStart::RULE} : cause_;
      // It is latched: also a recorder that comes later has it.
      if (!std::exchange(next_start_is_lost, false))
      {
        write("stream_start", start);
      }
    }
    if (force_is_recorded && !answer.force.values.empty())
    {
      ContactForce force;
      toMessage(answer.force, force);
      write("contact_force", force);
    }
    if (gap_is_recorded && !answer.gap.values.empty())
    {
      Gap gap;
      toMessage(answer.gap, gap);
      if (std::exchange(next_gap_is_spoilt, false))
      {
        flip(gap.gap[7]);
      }
      write("gap", gap);
    }
  }

  /// The recorder has only come now, and hears what is latched: the model of a simulator without changes.
  void forget()
  {
    messages_.resize(1);
  }

  void writeTo(const std::string& path) const
  {
    rosbag::Bag bag(path, rosbag::bagmode::Write);
    double time = 5000.0;
    for (const auto& message : messages_)
    {
      message(bag, ros::Time(time += 0.001));
    }
  }

  bool change_is_recorded = true;
  bool starts_are_recorded = true;
  bool next_start_is_lost = false;
  bool next_gap_is_spoilt = false;
  std::size_t cut_short = 0;  ///< impacts so far

private:
  void writeImpacts(const StreamSimulation::Answer& answer)
  {
    for (const StampedImpact& impact : answer.impacts)
    {
      cut_short += impact.impact.cut_short ? 1 : 0;
      Impact message;
      toMessage(impact, message);
      write("impact", message);
    }
  }

  template <typename Message>
  void write(const std::string& topic, const Message& message)
  {
    messages_.push_back([=](rosbag::Bag& bag, const ros::Time& time) { bag.write(topic, time, message); });
  }

  core::SystemParameters parameters_;
  std::unique_ptr<StreamSimulation> simulation_;
  std::uint64_t changes_ = 0;
  std::uint64_t starts_ = 0;
  std::uint8_t cause_ = StreamStart::FIRST;
  std::vector<std::function<void(rosbag::Bag&, const ros::Time&)>> messages_;
};

class ReplayCheck : public ToolTest
{
protected:
  ReplayCheck()
      : ToolTest(REPLAY_CHECK, "replay_check"),
        parameters_(config::loadFile(std::string(CONFIG_DIRECTORY) + "/limiting_case.yaml"))
  {
    parameters_.basis = core::AttachmentBasis{3};
    parameters_.contact.stiffness = 3.0e4;  // not that of any file
  }

  SyntheticRun synthetic() const
  {
    return {parameters_, excitation(), sample_period};
  }

  std::string bag() const
  {
    return directory_.path() + "/run.bag";
  }

  Outcome check(const SyntheticRun& run, const std::string& options = "") const
  {
    run.write(bag());
    return this->run(bag() + options);
  }

  Outcome check(const Recorder& recorder, const std::string& options = "") const
  {
    recorder.writeTo(bag());
    return this->run(bag() + options);
  }

  void expectIdentical(const Outcome& outcome, const std::string& counts) const
  {
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.error;
    EXPECT_THAT(outcome.out, AllOf(StartsWith("identical: "), HasSubstr(counts)));
    EXPECT_EQ(outcome.error, "");
  }

  void expectDifference(const Outcome& outcome, const std::string& what) const
  {
    EXPECT_EQ(outcome.status, 1) << outcome.out << outcome.error;
    EXPECT_THAT(outcome.out, AllOf(StartsWith("different: topic "), HasSubstr(what)));
  }

  /// Without --allow-gaps that is not good enough.
  void expectIncomplete(const Recorder& recorder, const std::string& compared, const std::string& reason) const
  {
    const Outcome outcome = check(recorder);
    EXPECT_EQ(outcome.status, 1) << outcome.error;
    EXPECT_THAT(outcome.out, AllOf(StartsWith("identical where compared: "), HasSubstr(compared), HasSubstr(reason)));
    EXPECT_EQ(run(bag() + " --allow-gaps").status, 0);
  }

  core::SystemParameters parameters_;
};

TEST_F(ReplayCheck, SaysIdenticalAndHowMuchWasCompared)
{
  const SyntheticRun run = synthetic();
  ASSERT_GT(run.impacts.size(), 20u);
  expectIdentical(check(run),
                  "12 blocks, 4800 samples, " + std::to_string(run.impacts.size()) + " impacts\n1 start from rest, ");
}

TEST_F(ReplayCheck, FindsOneBitOfAGap)
{
  SyntheticRun run = synthetic();
  flip(run.gaps[3].gap[7]);
  flip(run.gaps[5].gap[1]);
  const Outcome outcome = check(run);
  expectDifference(outcome, "/gap, block of seq 1200, sample 1207: gap[7]: recorded ");
  expectDifference(outcome, "identical before: 3 blocks, 1200 samples, ");
}

TEST_F(ReplayCheck, ShowsBothValuesWithAllDigits)
{
  SyntheticRun run = synthetic();
  std::ostringstream expected;
  expected.precision(17);
  expected << ", recomputed " << run.gaps[3].gap[7];
  flip(run.gaps[3].gap[7]);
  expectDifference(check(run), expected.str() + "\n");
}

TEST_F(ReplayCheck, FindsOneBitOfAForce)
{
  SyntheticRun run = synthetic();
  flip(run.forces[4].force[399]);
  expectDifference(check(run), "/contact_force, block of seq 1600, sample 1999: force[399]: recorded ");
}

TEST_F(ReplayCheck, TellsAZeroFromItsNegative)
{
  SyntheticRun run = synthetic();
  ASSERT_EQ(run.forces[0].force[0], 0.0);
  run.forces[0].force[0] = -0.0;
  expectDifference(check(run), "force[0]: recorded -0, recomputed 0\n");
}

TEST_F(ReplayCheck, FindsOneBitOfAHead)
{
  SyntheticRun run = synthetic();
  run.gaps[2].header.stamp += ros::Duration(0, 1);
  expectDifference(check(run), "/gap, block of seq 800: header.stamp: recorded 1000.040000001, recomputed 1000.04");
  run = synthetic();
  run.gaps[2].seq ^= 1;
  expectDifference(check(run), "/gap, block of seq 801: seq: recorded 801, recomputed 800\n");
  run = synthetic();
  flip(run.forces[2].sample_period);
  expectDifference(check(run), "/contact_force, block of seq 800: sample_period: recorded ");
  run = synthetic();
  run.forces[2].force.pop_back();
  expectDifference(check(run), "number of samples: recorded 399, recomputed 400\n");
}

TEST_F(ReplayCheck, FindsOneBitOfEveryFieldOfAnImpact)
{
  const std::pair<std::string, std::function<void(Impact&)>> fields[] = {
      {"number", [](Impact& impact) { impact.number ^= 1; }},
      {"seq", [](Impact& impact) { impact.seq ^= 1; }},
      {"offset", [](Impact& impact) { flip(impact.offset); }},
      {"header.stamp", [](Impact& impact) { impact.header.stamp += ros::Duration(0, 1); }},
      {"duration", [](Impact& impact) { flip(impact.duration); }},
      {"impulse", [](Impact& impact) { flip(impact.impulse); }},
      {"peak_force", [](Impact& impact) { flip(impact.peak_force); }},
      {"peak_time", [](Impact& impact) { flip(impact.peak_time); }},
      {"approach_speed", [](Impact& impact) { flip(impact.approach_speed); }},
      {"separation_speed", [](Impact& impact) { flip(impact.separation_speed); }},
      {"energy_lost", [](Impact& impact) { flip(impact.energy_lost); }},
      {"cut_short", [](Impact& impact) { impact.cut_short = static_cast<std::uint8_t>(impact.cut_short == 0); }},
      {"dissipated", [](Impact& impact) { flip(impact.dissipated); }},
      {"mapping_loss", [](Impact& impact) { flip(impact.mapping_loss); }},
      {"base_work", [](Impact& impact) { flip(impact.base_work); }},
  };
  const SyntheticRun run = synthetic();
  for (const auto& [field, spoil] : fields)
  {
    SyntheticRun spoilt = run;
    spoil(spoilt.impacts[10]);
    const Outcome outcome = check(spoilt);
    expectDifference(outcome, "/impact, number 1");
    EXPECT_THAT(outcome.out, HasSubstr("): " + field + ": recorded ")) << field;
  }
}

TEST_F(ReplayCheck, NamesTheFirstDifference)
{
  SyntheticRun run = synthetic();
  flip(run.gaps[9].gap[0]);
  flip(run.impacts[2].impulse);
  flip(run.impacts[1].impulse);
  expectDifference(check(run), "/impact, number 1 (seq ");
}

TEST_F(ReplayCheck, FindsAnImpactThatThereWasNot)
{
  SyntheticRun run = synthetic();
  run.impacts.insert(run.impacts.begin() + 5, run.impacts[5]);
  run.impacts[5].offset *= 0.5;
  expectDifference(check(run), "/impact, number 5 (seq ");
}

TEST_F(ReplayCheck, FindsAnotherModel)
{
  SyntheticRun run = synthetic();
  core::SystemParameters other = parameters_;
  flip(other.contact.stiffness);
  run.infos[0].configuration = config::toYaml(other);
  expectDifference(check(run), "/contact_force, block of seq 0, sample ");
}

TEST_F(ReplayCheck, FollowsChangesOfTheContact)
{
  Recorder recorder(parameters_);
  recorder.play(0, 2000);
  recorder.setContact({2.5e4, 1.0e-7});
  recorder.play(2000, 4000);
  recorder.setContact({4.0e4, 0.0});
  recorder.play(0, 2000, 2000.0);
  expectIdentical(check(recorder), "15 blocks, 6000 samples, ");
  EXPECT_THAT(check(recorder).out, HasSubstr("2 starts from rest, 2 changes of the contact, "));
}

TEST_F(ReplayCheck, FollowsAStreamThatRestartsBridgesAndRefuses)
{
  Recorder recorder(parameters_);
  recorder.play(0, 2000);
  Samples bad = Recorder::block(2000);
  bad.values[7] = NAN;
  bad.values.resize(100);
  recorder.play(bad);
  Samples next = Recorder::block(2100);  // bridged
  recorder.play(next);
  recorder.play(2500, 4000);
  recorder.play(Recorder::block(3700));  // a repetition, refused
  recorder.play(0, 2000, 2000.0);        // the shaker restarts
  recorder.play(400, 2000, 1900.0);      // the clock goes back
  recorder.play(0, 2000, 2000.0);        // a looped bag
  recorder.reset();
  const Outcome outcome = check(recorder);
  expectIdentical(outcome, "24 blocks, 9600 samples, ");
  EXPECT_THAT(outcome.out, HasSubstr("\n4 starts from rest, 0 changes of the contact, 1 gaps bridged, 2 blocks "
                                     "refused, 0 not taken\n"));
}

TEST_F(ReplayCheck, FollowsAClockThatSteps)
{
  Recorder recorder(parameters_);
  recorder.play(0, 2000);
  recorder.play(Recorder::block(2000, 999.93));  // refused, and bridged over
  recorder.play(2400, 4000);
  recorder.play(4000, 6000, 5000.0);
  recorder.play(6000, 8000);
  const Outcome outcome = check(recorder);
  expectIdentical(outcome, "19 blocks, 7600 samples, ");
  EXPECT_THAT(outcome.out,
              HasSubstr("\n3 starts from rest, 0 changes of the contact, 1 gaps bridged, 1 blocks refused"));
}

TEST_F(ReplayCheck, FollowsAResetAndAnotherSimulator)
{
  const core::SystemParameters first = parameters_;
  parameters_.contact.stiffness = 5.0e4;
  for (const bool starts_are_recorded : {true, false})
  {
    Recorder recorder(first);
    recorder.starts_are_recorded = starts_are_recorded;
    recorder.play(0, 2000);
    recorder.reset();
    recorder.play(2000, 4000);
    recorder.startSimulator(parameters_);
    recorder.play(4000, 8000);
    recorder.startSimulator(parameters_);
    recorder.play(8000, 10000);
    const Outcome outcome = check(recorder);
    expectIdentical(outcome, "25 blocks, 10000 samples, ");
    EXPECT_THAT(outcome.out, HasSubstr("4 starts from rest (3 by a reset, a pause or another simulator)"));
  }
}

TEST_F(ReplayCheck, FollowsSimulatorsOfOneModelOrWithoutABlock)
{
  core::SystemParameters other = parameters_;
  other.contact.stiffness = 5.0e4;
  Recorder recorder(other);
  recorder.startSimulator(parameters_);  // before the first block
  recorder.play(0, 2000);
  recorder.startSimulator(parameters_);  // says the same as the one before
  recorder.play(2000, 4000);
  recorder.startSimulator(parameters_);
  recorder.startSimulator(other);
  recorder.play(4000, 6000);
  const Outcome outcome = check(recorder);
  expectIdentical(outcome, "15 blocks, 6000 samples, ");
  EXPECT_THAT(outcome.out, HasSubstr("3 starts from rest (2 by a reset, a pause or another simulator)"));
}

TEST_F(ReplayCheck, TellsTheStartsOfALoopedBagApart)
{
  Recorder reset_in_the_second(parameters_);
  reset_in_the_second.play(0, 4000);
  reset_in_the_second.play(0, 2000);
  reset_in_the_second.reset();
  reset_in_the_second.play(2000, 4000);
  expectIdentical(check(reset_in_the_second), "20 blocks");

  Recorder killed_in_the_second(parameters_);
  killed_in_the_second.play(0, 4000);
  killed_in_the_second.play(0, 1200);
  killed_in_the_second.record(Recorder::block(1200));
  killed_in_the_second.record(Recorder::block(1600));
  killed_in_the_second.startSimulator(parameters_);
  killed_in_the_second.play(2000, 4000);
  expectIncomplete(killed_in_the_second, "18 blocks", "topic gap: seq 1200 to 1999 (2 blocks) is missing");

  Recorder late(parameters_);
  late.answer(Recorder::block(0), false, false);
  late.reset();
  late.forget();
  late.answer(Recorder::block(2000), false, false);  // only its start is recorded, which is latched
  late.play(2400, 4000);
  late.play(0, 4000);
  expectIncomplete(late, "10 blocks", "4 blocks from seq 2400 to 3999 cannot be recomputed");

  core::SystemParameters other = parameters_;
  other.contact.stiffness = 5.0e4;
  Recorder to_another(parameters_);
  to_another.play(0, 4000);
  to_another.startSimulator(other);
  to_another.play(0, 4000);
  expectIdentical(check(to_another), "20 blocks");
}

TEST_F(ReplayCheck, PlacesImpactsThatALoopCutsShort)
{
  bool one_is_cut_short = false;
  for (std::uint64_t end = 2800; end <= 8400; end += block_size)
  {
    Recorder recorder(parameters_);
    recorder.play(0, end);
    recorder.play(0, end);
    recorder.play(0, end);
    recorder.reset();
    const Outcome outcome = check(recorder);
    EXPECT_THAT(outcome.out, StartsWith("identical: ")) << end << outcome.error;
    one_is_cut_short = one_is_cut_short || recorder.cut_short > 0;
  }
  EXPECT_TRUE(one_is_cut_short);
}

TEST_F(ReplayCheck, FindsADifferenceInTheFirstBlockOfALaterStart)
{
  Recorder recorder(parameters_);
  recorder.play(0, 2000);
  recorder.next_gap_is_spoilt = true;
  recorder.play(0, 2000, 2000.0);
  expectDifference(check(recorder, " --allow-gaps"), "topic gap, block of seq 0, sample 7");
}

TEST_F(ReplayCheck, TakesABlockThatIsSentAgainCorrected)
{
  Recorder recorder(parameters_);
  recorder.play(0, 2000);
  Samples bad = Recorder::block(2000);
  bad.values[7] = NAN;
  recorder.play(bad);
  recorder.play(2000, 4000);
  expectIdentical(check(recorder), "10 blocks");
}

TEST_F(ReplayCheck, SaysWhichStartIsMissing)
{
  Recorder recorder(parameters_);
  recorder.play(0, 2000);
  recorder.reset();
  recorder.next_start_is_lost = true;
  recorder.play(2000, 4000);
  recorder.reset();
  recorder.play(4000, 6000);
  expectIncomplete(recorder, "10 blocks", "topic stream_start: number 1 is missing");
}

TEST_F(ReplayCheck, NamesLostAnswersBeforeAReset)
{
  for (std::uint64_t at = 1200; at <= 6000; at += block_size)
  {
    Recorder recorder(parameters_);
    recorder.play(0, at);
    for (std::uint64_t seq = at; seq < at + 1200; seq += block_size)
    {
      recorder.record(Recorder::block(seq));
      recorder.answer(Recorder::block(seq), false, false, true);
    }
    recorder.reset();
    recorder.play(at + 1200, at + 4000);
    expectIncomplete(recorder, "blocks", "(3 blocks) is missing");
  }
}

TEST_F(ReplayCheck, TellsModelsApartAtTheFirstContact)
{
  // Before that, the stiffness of the contact shows in no answer.
  parameters_.contact.clearance = 1.0e-5;
  core::SystemParameters other = parameters_;
  other.contact.stiffness = 5.0e4;
  const auto play = [](Recorder& recorder, std::uint64_t from, std::uint64_t to)
  {
    Samples soft = Recorder::block(from);
    for (double& value : soft.values)
    {
      value *= 1.0e-4;
    }
    recorder.play(soft);
    recorder.play(from + block_size, to);
  };
  for (const bool starts_are_recorded : {true, false})
  {
    Recorder recorder(parameters_);
    recorder.starts_are_recorded = starts_are_recorded;
    play(recorder, 0, 2000);
    recorder.startSimulator(parameters_);
    play(recorder, 2000, 4000);
    recorder.startSimulator(other);
    play(recorder, 4000, 6000);
    recorder.reset();
    play(recorder, 6000, 8000);
    expectIdentical(check(recorder), "20 blocks");
  }
  Recorder recorder(parameters_);
  recorder.startSimulator(other);  // the first had no block
  play(recorder, 0, 4000);
  expectIdentical(check(recorder), "10 blocks");
}

TEST_F(ReplayCheck, CountsNoStartTwice)
{
  Recorder recorder(parameters_);
  recorder.play(0, 2000);
  recorder.startSimulator(parameters_);
  recorder.play(2000, 4000);
  recorder.play(0, 2000, 2000.0);
  recorder.play(0, 2000, 3000.0);
  const Outcome outcome = check(recorder);
  expectIdentical(outcome, "20 blocks");
  EXPECT_THAT(outcome.out, HasSubstr("4 starts from rest (1 by"));
}

TEST_F(ReplayCheck, KnowsAStartBeforeTheFirstAnswerThatIsRecorded)
{
  Recorder recorder(parameters_);
  for (std::uint64_t seq = 0; seq < 800; seq += block_size)
  {
    recorder.record(Recorder::block(seq));  // before the simulator was there
  }
  for (std::uint64_t seq = 800; seq < 1600; seq += block_size)
  {
    recorder.record(Recorder::block(seq));
    recorder.answer(Recorder::block(seq), false, false);
  }
  recorder.play(1600, 4000);
  expectIncomplete(recorder, "6 blocks, 2400 samples, ", "topic gap: seq 0 to 1599 (4 blocks) is missing\n");
}

TEST_F(ReplayCheck, TakesABlockThatComesTwiceAtAStart)
{
  Recorder recorder(parameters_);
  recorder.play(0, 400);
  recorder.play(0, 400);  // refused
  recorder.play(400, 4000);
  const Outcome outcome = check(recorder);
  expectIdentical(outcome, "10 blocks, 4000 samples, ");
  EXPECT_THAT(outcome.out,
              HasSubstr("\n1 start from rest, 0 changes of the contact, 0 gaps bridged, 1 blocks refused, "));
}

TEST_F(ReplayCheck, TellsADifferenceFromAStart)
{
  // Where the starts are recorded, nothing else is taken for one.
  Recorder recorder(parameters_);
  recorder.play(0, 2000);
  recorder.starts_are_recorded = false;
  recorder.reset();
  recorder.play(2000, 4000);
  expectDifference(check(recorder), "topic contact_force, block of seq 2000, sample ");
}

TEST_F(ReplayCheck, FindsASimulatorWhoseFirstAnswersAreNotRecorded)
{
  Recorder recorder(parameters_);
  recorder.play(0, 2000);
  for (std::uint64_t seq = 2000; seq < 3600; seq += block_size)
  {
    recorder.record(Recorder::block(seq));  // nobody is there
  }
  recorder.startSimulator(parameters_);
  for (std::uint64_t seq = 3600; seq < 4400; seq += block_size)
  {
    recorder.record(Recorder::block(seq));
    recorder.answer(Recorder::block(seq), false, false);  // the recorder is not yet connected
  }
  recorder.play(4400, 8000);
  expectIncomplete(recorder, "14 blocks, 5600 samples, ",
                   "2 starts from rest (1 by a reset, a pause or another simulator)");
  EXPECT_THAT(run(bag()).out, HasSubstr("not compared: topic gap: seq 2000 to 4399 (6 blocks) is missing\n"));
}

TEST_F(ReplayCheck, WaitsForTheNextStartWhereTheRecordingBeginsInTheMiddle)
{
  Recorder recorder(parameters_);
  Recorder later(parameters_);
  for (std::uint64_t seq = 0; seq < 2000; seq += block_size)
  {
    StreamSimulation ignored(std::make_shared<const core::SwitchedModel>(parameters_), StreamLimits{});
    later.answer(Recorder::block(seq), false, false);
  }
  later.play(2000, 4000);
  later.play(0, 2000, 2000.0);
  expectIncomplete(later, "5 blocks, 2000 samples, ",
                   "not compared: 5 blocks from seq 2000 to 3999 cannot be recomputed: the recording begins in the "
                   "middle of the stream\n");
}

TEST_F(ReplayCheck, RefusesWhatCannotBeComparedAtAll)
{
  synthetic().write(bag(), 0.1, 1.0);  // without the latched model_info
  expectRefusal(bag(), 2, "holds no topic of type vibro_impact/ModelInfo");
  Recorder later(parameters_);
  later.answer(Recorder::block(0), false, false);
  later.play(400, 4000);
  later.writeTo(bag());
  expectRefusal(bag(), 2,
                "nothing can be compared: 9 blocks from seq 400 to 3999 cannot be recomputed: the recording begins in "
                "the middle of the stream");
}

TEST_F(ReplayCheck, TakesARecordingThatEndsInTheMiddle)
{
  Recorder recorder(parameters_);
  recorder.play(0, 4000);
  expectIdentical(check(recorder), "10 blocks, 4000 samples, ");
  // The simulator has ended in good order, and what it cut short is recorded as well.
  recorder.reset();
  expectIdentical(check(recorder), "10 blocks, 4000 samples, ");
  // The last answer came too late for the recorder.
  recorder.record(Recorder::block(4000));
  expectIncomplete(recorder, "10 blocks, 4000 samples, ", "topic gap: seq 4000 to 4399 (1 block) is missing\n");
}

TEST_F(ReplayCheck, SaysWhichAnswersAreMissing)
{
  Recorder recorder(parameters_);
  recorder.play(0, 2000);
  recorder.record(Recorder::block(2000));
  recorder.answer(Recorder::block(2000), false, false);  // neither
  recorder.play(2400, 3200);
  recorder.record(Recorder::block(3200));
  recorder.answer(Recorder::block(3200), true, false);  // the gap only
  recorder.play(3600, 4800);
  expectIncomplete(recorder, "10 blocks, 4000 samples, ", "topic gap: seq 2000 to 2399 (1 block) is missing\n");
  EXPECT_THAT(run(bag()).out, HasSubstr("topic contact_force: seq 3200 to 3599 (1 block) is missing\n"));
  EXPECT_THAT(run(bag()).out, HasSubstr("topic impact: number "));
}

TEST_F(ReplayCheck, TellsBlocksThatTheSimulatorNeverHad)
{
  Recorder recorder(parameters_);
  recorder.play(0, 2000);
  recorder.record(Recorder::block(2000));
  recorder.play(2400, 4800);
  expectIdentical(check(recorder), "11 blocks, 4400 samples, ");
  EXPECT_THAT(run(bag()).out, HasSubstr("1 gaps bridged, 0 blocks refused, 1 not taken\n"));
}

TEST_F(ReplayCheck, JudgesNothingBehindALostExcitationBeforeTheNextStart)
{
  Recorder recorder(parameters_);
  recorder.play(0, 2000);
  recorder.answer(Recorder::block(2000));
  recorder.play(2400, 4800);
  recorder.play(0, 800, 2000.0);
  expectIncomplete(recorder, "7 blocks, 2800 samples, ",
                   "not compared: the excitation of seq 2000 to 2399 (1 block, answered) is missing\n");
  EXPECT_THAT(run(bag()).out,
              HasSubstr("6 blocks from seq 2400 to 4799 cannot be recomputed: the excitation of seq 2000 "
                        "to 2399 is missing\n"));
  EXPECT_THAT(run(bag()).out, HasSubstr(" impacts there\n"));
}

TEST_F(ReplayCheck, IsNotDeceivedByAMotionThatForgetsItsBeginning)
{
  // With such damping two motions under the same drive are soon the same to the last bit.
  parameters_.damping = {0.3, 0.3};
  Recorder recorder(parameters_);
  recorder.play(0, 2000);
  recorder.answer(Recorder::block(2000));  // two blocks without their excitation
  recorder.answer(Recorder::block(2400));
  for (std::uint64_t seq = 2800; seq < 42800; seq += block_size)
  {
    recorder.record(Recorder::block(seq));
    recorder.answer(Recorder::block(seq), false, false);
  }
  recorder.play(42800, 44800);
  recorder.play(0, 2000, 2000.0);
  expectIncomplete(
      recorder, "10 blocks, 4000 samples, ",
      "105 blocks from seq 2800 to 44799 cannot be recomputed: the excitation of seq 2000 to 2799 is missing");
  EXPECT_THAT(run(bag()).out, HasSubstr("\n2 starts from rest, "));
}

TEST_F(ReplayCheck, SaysWhichImpactsAreMissing)
{
  SyntheticRun run = synthetic();
  run.impacts.erase(run.impacts.begin() + 3, run.impacts.begin() + 5);
  const Outcome outcome = check(run);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, AllOf(StartsWith("identical where compared: 12 blocks, "),
                                 HasSubstr("not compared: topic /impact: number 3 to 4 (2 impacts, seq ")));
}

TEST_F(ReplayCheck, SaysWhereAChangeOfTheContactIsMissing)
{
  Recorder recorder(parameters_);
  recorder.play(0, 2000);
  recorder.change_is_recorded = false;
  recorder.setContact({2.5e4, 1.0e-7});
  recorder.play(2000, 4000);
  recorder.change_is_recorded = true;
  recorder.setContact({4.0e4, 0.0});
  recorder.play(4000, 4800);
  recorder.play(0, 800, 2000.0);
  expectIncomplete(recorder, "7 blocks, 2800 samples, ", "topic model_info: number 1 is missing\n");
}

TEST_F(ReplayCheck, FindsADifferenceBehindALoss)
{
  SyntheticRun run = synthetic();
  run.gaps.erase(run.gaps.begin() + 2);
  flip(run.gaps[6].gap[3]);
  const Outcome outcome = check(run);
  expectDifference(outcome, "/gap, block of seq 2800, sample 2803: gap[3]");
  EXPECT_THAT(outcome.out, HasSubstr("not compared: topic /gap: seq 800 to 1199 (1 block) is missing\n"));
}

TEST_F(ReplayCheck, ReadsASplitRecordingAsOne)
{
  const SyntheticRun run = synthetic();
  const std::string first = directory_.path() + "/first.bag";
  const std::string second = directory_.path() + "/second.bag";
  run.write(first, 0.0, 0.1);
  run.write(second, 0.1, 1.0);
  expectIdentical(this->run(second + " " + first), "12 blocks, 4800 samples, ");
}

TEST_F(ReplayCheck, ChoosesTheRunAndTheExcitation)
{
  synthetic().write(bag(), 0.0, 1.0, "/rig1");
  expectIdentical(run(bag() + " --namespace /rig1"), "12 blocks, ");
  {
    rosbag::Bag more(bag(), rosbag::bagmode::Append);
    more.write("/rig1/measured", ros::Time(1000.0), BaseExcitation());
  }
  expectRefusal(bag(), 2, "holds 2 topics of type vibro_impact/BaseExcitation");
  expectIdentical(run(bag() + " --excitation rig1/base_excitation"), "12 blocks, ");
  expectRefusal(bag() + " --excitation /elsewhere", 2,
                "holds no topic /elsewhere of type vibro_impact/BaseExcitation (but /rig1/base_excitation, "
                "/rig1/measured)");
}

TEST_F(ReplayCheck, TakesTheLimitsOfTheSimulator)
{
  SyntheticRun run = synthetic();
  EXPECT_EQ(check(run, " --max-acceleration 1").status, 1);
  EXPECT_THAT(check(run, " --max-acceleration 1").out, HasSubstr("answer: recorded there is one, recomputed refused"));
}

TEST_F(ReplayCheck, RefusesABadCommandLineOrBag)
{
  expectRefusal("", 2, "no bag is given");
  expectRefusal("x.bag --allow-gap", 2, "--allow-gap");
  expectRefusal("x.bag --max-bridged-gap -1", 2, "--max-bridged-gap = \"-1\": must be a number from 0 to 60");
  expectRefusal(directory_.path() + "/absent.bag", 2, "/absent.bag: no such file");
  expectRefusal(directory_.file("text.bag", "text"), 2, "/text.bag: is not a bag");
  synthetic().write(bag());
  const std::string whole = readText(bag());
  expectRefusal(directory_.file("cut.bag", whole.substr(0, whole.size() / 2)), 2, "rosbag reindex");
}

TEST_F(ReplayCheck, Helps)
{
  const Outcome outcome = run("--help");
  EXPECT_EQ(outcome.status, 0);
  for (const std::string option : {"--allow-gaps", "--namespace", "--excitation", "--max-acceleration",
                                   "--max-bridged-gap", "--max-step-back", "--max-stamp-jitter"})
  {
    EXPECT_THAT(outcome.out, HasSubstr(option));
  }
}

}  // namespace
}  // namespace vibro_impact::graph
