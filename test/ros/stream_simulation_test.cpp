#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <stdexcept>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "../core/common.h"
#include "vibro_impact/core/simulation.h"
#include "vibro_impact/ros/stream_simulation.h"

namespace core = vibro_impact::core;
using vibro_impact::graph::Samples;
using vibro_impact::graph::Stamp;
using vibro_impact::graph::StampedImpact;
using vibro_impact::graph::StreamLimits;
using vibro_impact::graph::StreamSimulation;
using Action = vibro_impact::graph::Verdict::Action;

namespace
{
constexpr double period = 2.0e-5;
constexpr Stamp nanoseconds = 20000;  // of a period
constexpr Stamp begin = 1700000000000000000;
constexpr std::size_t block_size = 250;

std::shared_ptr<const core::SwitchedModel> model(double clearance = 0.0, double stiffness_factor = 1.0)
{
  core::SystemParameters parameters;
  parameters.beam1 = core::BeamParameters{1.66e9, 954.0, 0.0529, core::Rectangle{0.00127, 0.0127}, 0.02645};
  parameters.beam2 = core::RigidSurface{};
  parameters.contact = {stiffness_factor * 24309.426302924, clearance};
  parameters.damping = {0.01, 0.05};
  parameters.basis = core::AttachmentBasis{3};
  return std::make_shared<core::SwitchedModel>(parameters);
}

/// Near the resonance at omega* = 1.6: an impact in every cycle of 115 samples.
double acceleration(std::uint64_t i)
{
  return 50.0 * std::sin(1.6 * 1705.6 * static_cast<double>(i) * period);
}

Samples block(std::uint64_t seq, std::size_t count = block_size)
{
  Samples samples{begin + static_cast<Stamp>(seq) * nanoseconds, seq, period, std::vector<double>(count)};
  for (std::size_t i = 0; i < count; ++i)
  {
    samples.values[i] = acceleration(seq + i);
  }
  return samples;
}

/// Everything that came of a stream.
struct Record
{
  std::vector<double> gap;
  std::vector<double> force;
  std::vector<StampedImpact> impacts;

  void add(const StreamSimulation::Answer& answer)
  {
    gap.insert(gap.end(), answer.gap.values.begin(), answer.gap.values.end());
    force.insert(force.end(), answer.force.values.begin(), answer.force.values.end());
    impacts.insert(impacts.end(), answer.impacts.begin(), answer.impacts.end());
  }
};

void expectSame(const StampedImpact& a, const StampedImpact& b)
{
  EXPECT_EQ(a.stamp, b.stamp);
  EXPECT_EQ(a.impact.number, b.impact.number);
  EXPECT_EQ(a.impact.interval, b.impact.interval);
  EXPECT_EQ(a.impact.offset, b.impact.offset);
  EXPECT_EQ(a.impact.duration, b.impact.duration);
  EXPECT_EQ(a.impact.impulse, b.impact.impulse);
  EXPECT_EQ(a.impact.peak_force, b.impact.peak_force);
  EXPECT_EQ(a.impact.peak_time, b.impact.peak_time);
  EXPECT_EQ(a.impact.approach_speed, b.impact.approach_speed);
  EXPECT_EQ(a.impact.separation_speed, b.impact.separation_speed);
  EXPECT_EQ(a.impact.energy_lost, b.impact.energy_lost);
  EXPECT_EQ(a.impact.cut_short, b.impact.cut_short);
}

void expectSame(const Record& a, const Record& b)
{
  EXPECT_EQ(a.gap, b.gap);
  EXPECT_EQ(a.force, b.force);
  ASSERT_EQ(a.impacts.size(), b.impacts.size());
  for (std::size_t i = 0; i < a.impacts.size(); ++i)
  {
    expectSame(a.impacts[i], b.impacts[i]);
  }
}

/// The number of samples after which an episode is open.
std::uint64_t openAfter(std::uint64_t at_least)
{
  StreamSimulation simulation(model(), StreamLimits{});
  for (std::uint64_t seq = 0;; ++seq)
  {
    if (simulation.advance(block(seq, 1)).force.values[0] > 0.0 && seq + 1 >= at_least)
    {
      return seq + 1;
    }
  }
}

TEST(StreamSimulation, answersAsTheCoreDoes)
{
  core::Recorder sink;
  const Samples excitation = block(1000, 20000);
  std::vector<double> gap(20000);
  std::vector<double> force(20000);
  core::SampledSimulation direct(model(), period);
  direct.advance(excitation.values.data(), excitation.values.size(), gap.data(), force.data(), sink);

  StreamSimulation simulation(model(), StreamLimits{});
  const auto& answer = simulation.advance(excitation);
  EXPECT_EQ(answer.verdict.action, Action::Start);
  EXPECT_EQ(answer.gap.stamp, excitation.stamp);
  EXPECT_EQ(answer.gap.seq, 1000u);
  EXPECT_EQ(answer.gap.sample_period, period);
  EXPECT_EQ(answer.force.stamp, excitation.stamp);
  EXPECT_EQ(answer.force.seq, 1000u);
  EXPECT_EQ(answer.force.sample_period, period);
  EXPECT_EQ(answer.gap.values, gap);
  EXPECT_EQ(answer.force.values, force);
  EXPECT_EQ(answer.switch_limits, direct.switchLimitReached());
  ASSERT_GT(sink.impacts.size(), 50u);
  ASSERT_EQ(answer.impacts.size(), sink.impacts.size());
  for (std::size_t i = 0; i < sink.impacts.size(); ++i)
  {
    StampedImpact expected{sink.impacts[i], 0};
    expected.impact.interval += 1000;
    expected.stamp = begin + static_cast<Stamp>(expected.impact.interval) * nanoseconds +
                     std::llround(expected.impact.offset * 1.0e9);
    expectSame(answer.impacts[i], expected);
  }
}

// The simulation of one such sample would take hours.
TEST(StreamSimulation, refusesAPeriodOfTooManyCycles)
{
  StreamSimulation simulation(model(), StreamLimits{});
  Samples excitation = block(0, 10);
  excitation.sample_period = 250.0;
  const auto& answer = simulation.advance(excitation);
  EXPECT_EQ(answer.verdict.action, Action::Refuse);
  EXPECT_EQ(answer.verdict.reason.find("sample_period is 250 s, must be at most 12"), 0u) << answer.verdict.reason;
  EXPECT_TRUE(answer.gap.values.empty());
  EXPECT_EQ(simulation.advance(block(0)).verdict.action, Action::Start);
}

TEST(StreamSimulation, blocksOfAnyLengthGiveTheSame)
{
  constexpr std::uint64_t samples = 10000;
  std::vector<Record> records;
  for (const std::size_t cut : {1u, 7u, 250u, 333u, 10000u})
  {
    StreamSimulation simulation(model(), StreamLimits{});
    Record record;
    for (std::uint64_t seq = 0; seq < samples; seq += cut)
    {
      record.add(simulation.advance(block(seq, std::min<std::size_t>(cut, samples - seq))));
    }
    records.push_back(record);
  }
  ASSERT_GT(records[0].impacts.size(), 50u);
  for (const Record& record : records)
  {
    expectSame(record, records[0]);
  }
}

TEST(StreamSimulation, refusedBlocksLeaveTheStateUntouched)
{
  StreamSimulation undisturbed(model(), StreamLimits{});
  StreamSimulation disturbed(model(), StreamLimits{});
  Record expected;
  Record record;
  for (std::uint64_t seq = 0; seq < 10000; seq += block_size)
  {
    expected.add(undisturbed.advance(block(seq)));
    record.add(disturbed.advance(block(seq)));

    std::vector<Samples> bad(6, block(seq + block_size));
    bad[0].values[17] = std::numeric_limits<double>::quiet_NaN();
    bad[1].values.clear();
    bad[2].sample_period = -period;
    bad[3] = block(seq);
    bad[4].stamp = 0;
    bad[5].values[block_size - 1] = 1.0e6;
    for (const Samples& samples : bad)
    {
      const auto& answer = disturbed.advance(samples);
      EXPECT_EQ(answer.verdict.action, Action::Refuse);
      EXPECT_TRUE(answer.gap.values.empty());
      EXPECT_TRUE(answer.force.values.empty());
      EXPECT_TRUE(answer.impacts.empty());
    }
  }
  expectSame(record, expected);
}

TEST(StreamSimulation, bridgeIsAStraightLine)
{
  // 600 samples are lost: more than one piece of the bridge.
  Samples bridge = block(1000, 600);
  const double from = acceleration(999);
  const double to = acceleration(1600);
  for (std::size_t i = 0; i < 600; ++i)
  {
    bridge.values[i] = from + (to - from) / 601.0 * static_cast<double>(i + 1);
  }
  StreamSimulation whole(model(), StreamLimits{});
  Record expected;
  expected.add(whole.advance(block(0, 1000)));
  std::vector<StampedImpact> impacts = whole.advance(bridge).impacts;
  expected.impacts.insert(expected.impacts.end(), impacts.begin(), impacts.end());
  expected.add(whole.advance(block(1600, 2000)));

  StreamSimulation simulation(model(), StreamLimits{});
  Record record;
  record.add(simulation.advance(block(0, 1000)));
  const auto& answer = simulation.advance(block(1600, 2000));
  EXPECT_EQ(answer.verdict.action, Action::Bridge);
  EXPECT_EQ(answer.verdict.missing, 600u);
  EXPECT_EQ(answer.gap.seq, 1600u);
  EXPECT_EQ(answer.gap.values.size(), 2000u);
  record.add(answer);
  expectSame(record, expected);
}

TEST(StreamSimulation, restartIsFromRestAndCutsTheOpenImpactShort)
{
  const std::uint64_t open = openAfter(1000);
  StreamSimulation simulation(model(), StreamLimits{});
  const std::size_t before = simulation.advance(block(0, open)).impacts.size();

  Samples later = block(open + 5000, 2000);
  const auto& answer = simulation.advance(later);
  EXPECT_EQ(answer.verdict.action, Action::Restart);
  EXPECT_EQ(answer.verdict.missing, 5000u);

  StreamSimulation fresh(model(), StreamLimits{});
  const auto& expected = fresh.advance(later);
  EXPECT_EQ(answer.gap.values, expected.gap.values);
  EXPECT_EQ(answer.force.values, expected.force.values);
  ASSERT_EQ(answer.impacts.size(), expected.impacts.size() + 1);
  const StampedImpact& cut = answer.impacts.front();
  EXPECT_TRUE(cut.impact.cut_short);
  EXPECT_EQ(cut.impact.number, before);
  EXPECT_LT(cut.impact.interval, open);
  EXPECT_EQ(cut.stamp,
            begin + static_cast<Stamp>(cut.impact.interval) * nanoseconds + std::llround(cut.impact.offset * 1.0e9))
      << "dated on the stream that it belongs to";
  for (std::size_t i = 0; i < expected.impacts.size(); ++i)
  {
    expectSame(answer.impacts[i + 1], expected.impacts[i]);
  }
}

TEST(StreamSimulation, newPeriodRestartsFromRest)
{
  StreamSimulation simulation(model(), StreamLimits{});
  simulation.advance(block(0, 1000));
  Samples slower = block(1000, 1000);
  slower.sample_period = 4.0e-5;
  const auto& answer = simulation.advance(slower);
  EXPECT_EQ(answer.verdict.action, Action::Restart);
  StreamSimulation fresh(model(), StreamLimits{});
  EXPECT_EQ(answer.gap.values, fresh.advance(slower).gap.values);
}

TEST(StreamSimulation, restartedPublisherRestartsTheNumbers)
{
  StreamSimulation simulation(model(), StreamLimits{});
  ASSERT_GT(simulation.advance(block(0, 5000)).impacts.size(), 10u);
  Samples anew = block(0, 5000);
  anew.stamp += 10000000000;
  const auto& answer = simulation.advance(anew);
  EXPECT_EQ(answer.verdict.action, Action::Restart);
  const auto first = std::find_if(answer.impacts.begin(), answer.impacts.end(),
                                  [](const StampedImpact& impact) { return !impact.impact.cut_short; });
  ASSERT_NE(first, answer.impacts.end());
  EXPECT_EQ(first->impact.number, 0u);
  EXPECT_LT(first->impact.interval, 1000u);
  EXPECT_GE(first->stamp, anew.stamp);
}

TEST(StreamSimulation, resetCutsTheOpenImpactShortAndStartsAnew)
{
  const std::uint64_t open = openAfter(1000);
  StreamSimulation simulation(model(), StreamLimits{});
  simulation.advance(block(0, open));
  const auto& cut = simulation.reset();
  ASSERT_EQ(cut.impacts.size(), 1u);
  EXPECT_TRUE(cut.impacts[0].impact.cut_short);
  EXPECT_TRUE(cut.gap.values.empty());
  EXPECT_TRUE(simulation.reset().impacts.empty());

  const auto& answer = simulation.advance(block(open, 2000));
  EXPECT_EQ(answer.verdict.action, Action::Start);
  StreamSimulation fresh(model(), StreamLimits{});
  EXPECT_EQ(answer.gap.values, fresh.advance(block(open, 2000)).gap.values);
}

TEST(StreamSimulation, resetBeforeTheFirstBlockDoesNothing)
{
  StreamSimulation simulation(model(), StreamLimits{});
  EXPECT_TRUE(simulation.reset().impacts.empty());
}

TEST(StreamSimulation, impactOnJitteredStampsIsDatedByItsSample)
{
  // Every second block of 50 samples (1 ms) is stamped half a millisecond late; episodes reach over the borders of
  // blocks.
  StreamSimulation simulation(model(), StreamLimits{});
  std::vector<Stamp> dates;
  std::vector<StampedImpact> impacts;
  for (std::uint64_t seq = 0; seq < 20000; seq += 50)
  {
    Samples samples = block(seq, 50);
    samples.stamp += (seq / 50) % 2 == 0 ? 0 : 500000;
    for (Stamp i = 0; i < 50; ++i)
    {
      dates.push_back(samples.stamp + i * nanoseconds);
    }
    const auto& answer = simulation.advance(samples);
    EXPECT_NE(answer.verdict.action, Action::Refuse) << answer.verdict.reason;
    impacts.insert(impacts.end(), answer.impacts.begin(), answer.impacts.end());
  }
  ASSERT_GT(impacts.size(), 50u);
  for (const StampedImpact& impact : impacts)
  {
    EXPECT_EQ(impact.stamp, dates[impact.impact.interval] + std::llround(impact.impact.offset * 1.0e9));
  }
}

TEST(StreamSimulation, preloadedContactIsDatedByItsFirstBlock)
{
  // An interference fit that stays in contact for the whole of a drifting stream.
  StreamSimulation simulation(model(-1.0e-3), StreamLimits{});
  for (std::uint64_t seq = 0; seq < 10000; seq += block_size)
  {
    Samples samples = block(seq);
    samples.stamp += static_cast<Stamp>(seq) * 100;
    EXPECT_TRUE(simulation.advance(samples).impacts.empty());
  }
  const auto& answer = simulation.reset();
  ASSERT_EQ(answer.impacts.size(), 1u);
  EXPECT_EQ(answer.impacts[0].stamp, begin);
  EXPECT_EQ(answer.impacts[0].impact.interval, 0u);

  EXPECT_TRUE(simulation.reset().impacts.empty()) << "it rests, and no stream has begun";
  EXPECT_TRUE(simulation.advance(block(0)).impacts.empty());
}

// Changes of the contact -------------------------------------------------------------------------------------------

TEST(StreamSimulation, contactChangesAtItsSampleHoweverTheBlocksAreCut)
{
  constexpr std::uint64_t samples = 10000;
  // One of them in contact at least, and two in one of the greater blocks.
  const std::vector<std::uint64_t> changes = {1037, 1501, 4000, openAfter(5000)};
  std::vector<Record> records;
  for (const std::size_t cut : {1u, 7u, 250u, 333u, 10000u})
  {
    StreamSimulation simulation(model(), StreamLimits{});
    double clearance = 0.0;
    for (const std::uint64_t seq : changes)
    {
      clearance -= 2.0e-6;
      simulation.setContact(model(clearance, 1.0 - 1.0e4 * clearance), seq);
    }
    Record record;
    std::vector<StreamSimulation::ContactChange> taken;
    for (std::uint64_t seq = 0; seq < samples; seq += cut)
    {
      const auto& answer = simulation.advance(block(seq, std::min<std::size_t>(cut, samples - seq)));
      record.add(answer);
      taken.insert(taken.end(), answer.contact_changes.begin(), answer.contact_changes.end());
    }
    records.push_back(record);
    ASSERT_EQ(taken.size(), changes.size());
    for (std::size_t i = 0; i < changes.size(); ++i)
    {
      EXPECT_EQ(taken[i].seq, changes[i]);
      EXPECT_EQ(taken[i].stamp, begin + static_cast<Stamp>(changes[i]) * nanoseconds);
      EXPECT_EQ(taken[i].model->clearance(), -2.0e-6 * static_cast<double>(i + 1));
    }
    EXPECT_EQ(simulation.model().clearance(), clearance);
  }
  ASSERT_GT(records[0].impacts.size(), 30u);
  for (const Record& record : records)
  {
    expectSame(record, records[0]);
  }
  StreamSimulation unchanged(model(), StreamLimits{});
  const auto& before = unchanged.advance(block(0, samples)).gap.values;
  EXPECT_EQ(std::vector<double>(before.begin(), before.begin() + 1037),
            std::vector<double>(records[0].gap.begin(), records[0].gap.begin() + 1037));
  EXPECT_NE(before[1037], records[0].gap[1037]);
}

TEST(StreamSimulation, contactChangesAtTheNextSampleThatComes)
{
  StreamSimulation simulation(model(), StreamLimits{});
  StreamSimulation expected(model(), StreamLimits{});
  expected.setContact(model(1.0e-6), 1000);
  simulation.advance(block(0, 1000));
  expected.advance(block(0, 1000));
  simulation.setContact(model(5.0e-6), 0);
  simulation.setContact(model(1.0e-6), 0);  // the later request counts
  const auto& answer = simulation.advance(block(1000, 1000));
  ASSERT_EQ(answer.contact_changes.size(), 1u);
  EXPECT_EQ(answer.contact_changes[0].seq, 1000u);
  EXPECT_EQ(answer.gap.values, expected.advance(block(1000, 1000)).gap.values);
  EXPECT_TRUE(simulation.advance(block(2000)).contact_changes.empty());
}

TEST(StreamSimulation, contactChangesInsideABridge)
{
  StreamSimulation simulation(model(), StreamLimits{});
  simulation.setContact(model(3.0e-6), 1300);
  simulation.advance(block(0, 1000));
  const auto& answer = simulation.advance(block(1600, 500));
  ASSERT_EQ(answer.verdict.action, Action::Bridge);
  ASSERT_EQ(answer.contact_changes.size(), 1u);
  EXPECT_EQ(answer.contact_changes[0].seq, 1300u);
  // The same line in two blocks.
  StreamSimulation whole(model(), StreamLimits{});
  whole.setContact(model(3.0e-6), 1300);
  whole.advance(block(0, 1000));
  Samples line = block(1000, 600);
  for (std::size_t i = 0; i < 600; ++i)
  {
    line.values[i] = acceleration(999) + (acceleration(1600) - acceleration(999)) / 601.0 * static_cast<double>(i + 1);
  }
  whole.advance(line);
  EXPECT_EQ(answer.gap.values, whole.advance(block(1600, 500)).gap.values);
}

TEST(StreamSimulation, streamStartsAtRestUnderTheContactThatHoldsThere)
{
  StreamSimulation simulation(model(), StreamLimits{});
  simulation.setContact(model(-1.0e-6), 0);
  simulation.setContact(model(-2.0e-6), 500);
  simulation.setContact(model(-3.0e-6), 1000);
  simulation.setContact(model(-4.0e-6), 1100);
  const auto& answer = simulation.advance(block(1000, 100));
  ASSERT_EQ(answer.contact_changes.size(), 1u);
  EXPECT_EQ(answer.contact_changes[0].seq, 1000u);
  EXPECT_EQ(answer.contact_changes[0].stamp, block(1000).stamp);
  StreamSimulation worn(model(-3.0e-6), StreamLimits{});
  EXPECT_EQ(answer.gap.values, worn.advance(block(1000, 100)).gap.values);

  // Neither a reset nor a restart brings an earlier contact back; what waits goes on waiting.
  simulation.reset();
  EXPECT_EQ(simulation.advance(block(0, 100)).gap.values,
            StreamSimulation(model(-3.0e-6), StreamLimits{}).advance(block(0, 100)).gap.values);
  const auto& restarted = simulation.advance(block(50000, 100));
  ASSERT_EQ(restarted.verdict.action, Action::Restart);
  ASSERT_EQ(restarted.contact_changes.size(), 1u);
  EXPECT_EQ(restarted.contact_changes[0].seq, 50000u);
  EXPECT_EQ(restarted.gap.values,
            StreamSimulation(model(-4.0e-6), StreamLimits{}).advance(block(50000, 100)).gap.values);
}

TEST(StreamSimulation, theSameContactIsNoChange)
{
  StreamSimulation simulation(model(), StreamLimits{});
  StreamSimulation expected(model(), StreamLimits{});
  for (std::uint64_t seq = 0; seq < 5000; seq += block_size)
  {
    simulation.setContact(model(), 0);
    const auto& answer = simulation.advance(block(seq));
    EXPECT_TRUE(answer.contact_changes.empty());
    EXPECT_EQ(answer.gap.values, expected.advance(block(seq)).gap.values);
  }
}

TEST(StreamSimulation, contactOfThePastIsRefused)
{
  StreamSimulation simulation(model(), StreamLimits{});
  StreamSimulation expected(model(), StreamLimits{});
  simulation.advance(block(0, 1000));
  expected.advance(block(0, 1000));
  try
  {
    simulation.setContact(model(-1.0e-6), 999);
    ADD_FAILURE();
  }
  catch (const std::invalid_argument& error)
  {
    EXPECT_STREQ(error.what(), "seq: 999 has been simulated; allowed: 0, the next sample, or at least 1000");
  }
  EXPECT_EQ(simulation.advance(block(1000)).gap.values, expected.advance(block(1000)).gap.values);
}

TEST(StreamSimulation, noMoreThanAThousandChangesWait)
{
  StreamSimulation simulation(model(), StreamLimits{});
  const auto worn = model(1.0e-6);
  for (std::uint64_t seq = 1; seq <= StreamSimulation::max_waiting_changes; ++seq)
  {
    simulation.setContact(worn, seq);
  }
  EXPECT_THROW(simulation.setContact(worn, 5000), std::invalid_argument);
  EXPECT_NO_THROW(simulation.setContact(worn, 1000)) << "in place of one that waits";
  EXPECT_EQ(simulation.advance(block(0, 2000)).contact_changes.size(), 1u);
  EXPECT_NO_THROW(simulation.setContact(worn, 5000));
}

TEST(StreamSimulation, recordsTheMotionAndAnswersAsWithout)
{
  const std::vector<core::BasisParameters> bases = {core::AttachmentBasis{4}, core::ConjoinedBasis{4, 4}};
  for (const core::BasisParameters& basis : bases)
  {
    core::SystemParameters parameters;
    const core::BeamParameters beam{1.66e9, 954.0, 0.0529, core::Rectangle{0.00127, 0.0127}, 0.02};
    parameters.beam1 = beam;
    parameters.beam2 = beam;
    std::get<core::BeamParameters>(parameters.beam2).youngs_modulus *= 10.0;
    parameters.contact = {24309.4, 1.0e-6};
    parameters.damping = {0.01, 0.05};
    parameters.basis = basis;
    const auto beams = std::make_shared<const core::SwitchedModel>(parameters);
    StreamSimulation simulation(beams, StreamLimits{});
    StreamSimulation expected(beams, StreamLimits{});
    Record record;
    Record expected_record;
    std::uint64_t next_row = 0;
    std::size_t open_rows = 0;
    std::vector<double> forces;  // since the last row
    simulation.recordMotion(7);
    for (std::uint64_t seq = 0; seq < 20000; seq += seq % 3 == 0 ? 250 : 11)
    {
      const Samples excitation = block(seq, seq % 3 == 0 ? 250 : 11);
      const StreamSimulation::Answer& answer = simulation.advance(excitation);
      record.add(answer);
      expected_record.add(expected.advance(excitation));
      const StreamSimulation::Motion& motion = answer.motion;
      const std::size_t columns = beams->structureModes().size();
      ASSERT_EQ(motion.coordinates.size(), motion.gap.size() * columns);
      ASSERT_EQ(motion.force.size(), motion.gap.size());
      for (std::size_t row = 0; row < motion.gap.size(); ++row)
      {
        ASSERT_EQ(motion.step, 7u);
        const std::uint64_t sample = motion.seq + 7 * row;
        ASSERT_EQ(sample, next_row);
        next_row += 7;
        ASSERT_EQ(motion.gap[row], answer.gap.values[sample - seq]);
        ASSERT_EQ(motion.acceleration[row], excitation.values[sample - seq]);
        // The gap is what the structures and the clearance make it; in the conjoined basis the modes that are left out
        // yield to the force as well.
        double gap = 1.0e-6;
        double scale = 1.0e-6;
        for (std::size_t column = 0; column < columns; ++column)
        {
          const core::StructureMode& mode = beams->structureModes()[column];
          const double share = mode.contact_deflection * motion.coordinates[row * columns + column];
          gap += mode.structure == 1 ? share : -share;
          scale += std::abs(share);
        }
        const bool open = answer.force.values[sample - seq] == 0.0;
        open_rows += open ? 1 : 0;
        const bool exact = open || std::holds_alternative<core::AttachmentBasis>(basis);
        ASSERT_NEAR(gap, motion.gap[row], exact ? 1e-12 * scale : 0.1 * scale) << "row " << row;
      }
      for (std::size_t i = 0; i < answer.force.values.size(); ++i)
      {
        forces.push_back(answer.force.values[i]);
        if ((seq + i) % 7 == 0)
        {
          ASSERT_EQ(motion.force[(seq + i - motion.seq) / 7], *std::max_element(forces.begin(), forces.end()));
          forces.clear();
        }
      }
    }
    expectSame(record, expected_record);
    EXPECT_GT(record.impacts.size(), 20u);
    EXPECT_GT(open_rows, 1000u);

    simulation.recordMotion(0);
    EXPECT_TRUE(simulation.advance(block(20000 + 250)).motion.gap.empty());
  }
}

TEST(StreamSimulation, recordsTheMotionOfABridgeToo)
{
  StreamSimulation simulation(model(), StreamLimits{});
  simulation.recordMotion(10);
  simulation.advance(block(0));
  const StreamSimulation::Motion& motion = simulation.advance(block(505)).motion;
  EXPECT_EQ(motion.seq, 250u);
  EXPECT_EQ(motion.stamp, begin + 250 * nanoseconds);
  EXPECT_EQ(motion.gap.size(), 51u);  // 250 ... 750
  simulation.reset();
  const StreamSimulation::Motion& after = simulation.advance(block(3, 12)).motion;
  EXPECT_EQ(after.seq, 10u);
  EXPECT_EQ(after.gap.size(), 1u);
}

}  // namespace
