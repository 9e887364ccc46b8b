// The monitor against sums over all that it was told, made anew for every report.

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "vibro_impact/core/response_monitor.h"

using namespace vibro_impact::core;

namespace
{
constexpr StreamTime epoch = 1'700'000'000'000'000'000;
constexpr StreamTime second = 1'000'000'000;
constexpr StreamTime sample = 20'000;
constexpr double sample_period = 2.0e-5;

ReleasedImpact impactAt(std::uint64_t number, StreamTime onset, double duration, double impulse)
{
  ReleasedImpact impact;
  impact.number = number;
  impact.onset = onset;
  impact.release = onset + nanoseconds(duration);
  impact.duration = duration;
  impact.impulse = impulse;
  impact.peak_force = 1.6 * impulse / duration;
  impact.energy_lost = 0.3 * impulse;
  return impact;
}

/// A stream of blocks with irregular impacts, every number of it known.
struct Stream
{
  std::vector<ReleasedImpact> impacts;
  std::vector<double> force;

  explicit Stream(double duration)
  {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    force.assign(static_cast<std::size_t>(std::lround(duration / sample_period)), 0.0);
    StreamTime time = epoch;
    while (true)
    {
      time += nanoseconds(0.0005 + 0.003 * uniform(random));
      ReleasedImpact impact = impactAt(impacts.size(), time, 1.0e-4 + 2.0e-4 * uniform(random),
                                       std::pow(10.0, -7.0 + 3.0 * uniform(random)));
      impact.cut_short = impacts.size() % 50 == 49;
      if (impact.release >= epoch + static_cast<StreamTime>(force.size()) * sample)
      {
        return;
      }
      for (StreamTime i = (impact.onset - epoch) / sample + 1; epoch + i * sample < impact.release; ++i)
      {
        force[static_cast<std::size_t>(i)] = impact.impulse / impact.duration;
      }
      time = impact.release;
      impacts.push_back(impact);
    }
  }

  SampleBlock block(std::size_t from, std::size_t count) const
  {
    return {from, epoch + static_cast<StreamTime>(from) * sample, sample_period, force.data() + from, count};
  }
};

/// Gives all of the stream in blocks of `block_size`; each of them overtakes the impacts of the last `overtaken` ones,
/// itself included.
std::vector<ResponseStatistics> play(const Stream& stream, ResponseMonitor& monitor, std::size_t block_size,
                                     std::size_t overtaken = 0)
{
  std::vector<ResponseStatistics> reports;
  std::size_t next = 0;
  for (std::size_t from = 0; from < stream.force.size(); from += block_size)
  {
    const std::size_t count = std::min(block_size, stream.force.size() - from);
    const StreamTime heard =
        epoch + (static_cast<StreamTime>(from + count) - static_cast<StreamTime>(overtaken * block_size)) * sample;
    for (; next < stream.impacts.size() && stream.impacts[next].release < heard; ++next)
    {
      monitor.addImpact(stream.impacts[next]);
    }
    monitor.addForce(stream.block(from, count));
    while (const ResponseStatistics* report = monitor.next())
    {
      reports.push_back(*report);
    }
  }
  for (; next < stream.impacts.size(); ++next)
  {
    monitor.addImpact(stream.impacts[next]);
  }
  while (const ResponseStatistics* report = monitor.next(true))
  {
    reports.push_back(*report);
  }
  return reports;
}

/// Sums over what was released in (from, to], one quantity after the other.
void expectSums(const ImpactSums& sums, const Stream& stream, StreamTime from, StreamTime to)
{
  std::vector<ReleasedImpact> chosen;
  std::copy_if(stream.impacts.begin(), stream.impacts.end(), std::back_inserter(chosen),
               [&](const ReleasedImpact& impact) { return impact.release > from && impact.release <= to; });
  std::uint64_t whole = 0;
  double impulse = 0.0;
  double whole_impulse = 0.0;
  double squares = 0.0;
  double greatest = 0.0;
  double peak_force = 0.0;
  double energy = 0.0;
  double forces = 0.0;
  for (const ReleasedImpact& impact : chosen)
  {
    whole += impact.cut_short ? 0 : 1;
    impulse += impact.impulse;
    whole_impulse += impact.cut_short ? 0.0 : impact.impulse;
    squares += impact.cut_short ? 0.0 : impact.impulse * impact.impulse;
    greatest = impact.cut_short ? greatest : std::max(greatest, impact.impulse);
    peak_force = std::max(peak_force, impact.peak_force);
    energy += impact.energy_lost;
    forces += impact.impulse / impact.duration;
  }
  EXPECT_EQ(sums.whole, whole);
  EXPECT_EQ(sums.cut_short, chosen.size() - whole);
  EXPECT_EQ(sums.impulse, impulse);
  EXPECT_EQ(sums.whole_impulse, whole_impulse);
  EXPECT_EQ(sums.impulse_squares, squares);
  EXPECT_EQ(sums.impulse_max, greatest);
  EXPECT_EQ(sums.peak_force, peak_force);
  EXPECT_EQ(sums.energy_lost, energy);
  EXPECT_EQ(sums.mean_forces, forces);
}

/// Samples in contact of those in (from, to], which lie on the grid of samples.
double contactTime(const Stream& stream, StreamTime from, StreamTime to)
{
  const auto begin = stream.force.begin() + std::max<StreamTime>(0, from - epoch) / sample;
  const auto end = stream.force.begin() + (to - epoch) / sample;
  return sample_period * static_cast<double>(std::count_if(begin, end, [](double force) { return force > 0.0; }));
}

/// Of all that it still has to report.
const ResponseStatistics* lastOf(ResponseMonitor& monitor)
{
  const ResponseStatistics* last = nullptr;
  while (const ResponseStatistics* report = monitor.next(true))
  {
    last = report;
  }
  return last;
}

MonitorOptions options()
{
  MonitorOptions options;
  options.window = second / 2;
  options.report_period = second / 10;
  options.wear.coefficient = 2.0e-14;
  options.wear.area = 1.0e-6;
  options.wear.sliding_speed = 0.02;
  return options;
}

class ResponseMonitorTest : public testing::Test
{
protected:
  const Stream stream_{3.0};
  ResponseMonitor monitor_{options()};
};

TEST_F(ResponseMonitorTest, windowAndTotalsEqualTheSumsOfAllThatCame)
{
  const std::vector<ResponseStatistics> reports = play(stream_, monitor_, 250);
  ASSERT_EQ(reports.size(), 30u);
  for (std::size_t i = 0; i < reports.size(); ++i)
  {
    const ResponseStatistics& report = reports[i];
    ASSERT_EQ(report.time, epoch + static_cast<StreamTime>(i + 1) * second / 10);
    const StreamTime from = report.time - second / 2;
    expectSums(report.sums, stream_, from, report.time);
    expectSums(report.total, stream_, 0, report.time);
    const double window = std::min(0.5, 0.1 * static_cast<double>(i + 1));
    EXPECT_NEAR(report.window, window, 1.0e-12);
    EXPECT_NEAR(report.contact_duty, contactTime(stream_, from, report.time) / window, 1.0e-12);
    EXPECT_NEAR(report.total_time, 0.1 * static_cast<double>(i + 1), 1.0e-12);
    EXPECT_NEAR(report.total_contact_time, contactTime(stream_, 0, report.time), 1.0e-12);
    EXPECT_DOUBLE_EQ(report.impact_rate, static_cast<double>(report.sums.whole) / report.window);
    EXPECT_DOUBLE_EQ(report.mean_force, report.sums.impulse / report.window);
    EXPECT_DOUBLE_EQ(report.impact_power, report.sums.energy_lost / report.window);
    EXPECT_DOUBLE_EQ(report.normal_work_rate, 0.02 * report.sums.impulse / report.window);
    EXPECT_DOUBLE_EQ(report.wear_rate, 2.0e-14 * 0.02 * report.sums.impulse / report.window);
    EXPECT_DOUBLE_EQ(report.total_normal_work, 0.02 * report.total.impulse);
    EXPECT_DOUBLE_EQ(report.wear_depth, 2.0e-14 * 0.02 * report.total.impulse / 1.0e-6);
  }
  EXPECT_GT(reports.back().total.whole, 1000u);
  EXPECT_GT(reports.back().total.cut_short, 20u);
  EXPECT_EQ(monitor_.missing(), 0u);
  EXPECT_EQ(monitor_.lateImpacts(), 0u);
  EXPECT_EQ(monitor_.restarts(), 0u);
}

TEST_F(ResponseMonitorTest, neitherTheBlocksNorWhatOvertakesWhatMatters)
{
  const std::vector<ResponseStatistics> expected = play(stream_, monitor_, 250);
  for (const std::size_t block_size : {50U, 500U, 625U, 20000U})
  {
    ResponseMonitor monitor(options());
    const std::vector<ResponseStatistics> reports = play(stream_, monitor, block_size, 20000 / block_size);
    ASSERT_EQ(reports.size(), expected.size());
    for (std::size_t i = 0; i < reports.size(); ++i)
    {
      EXPECT_EQ(reports[i].time, expected[i].time);
      EXPECT_EQ(reports[i].sums.impulse, expected[i].sums.impulse);
      EXPECT_EQ(reports[i].contact_duty, expected[i].contact_duty);
      EXPECT_EQ(reports[i].total.impulse, expected[i].total.impulse);
      EXPECT_EQ(reports[i].histogram, expected[i].histogram);
    }
    EXPECT_EQ(monitor.lateImpacts(), 0u);
  }
}

TEST_F(ResponseMonitorTest, whatComesTooLateIsCountedAndInTheTotals)
{
  // Half a second of settling is not enough for impacts that are overtaken by a second.
  const std::vector<ResponseStatistics> reports = play(stream_, monitor_, 250, 200);
  EXPECT_GT(monitor_.lateImpacts(), 0u);
  expectSums(reports.back().total, stream_, 0, reports.back().time);
  expectSums(reports.back().sums, stream_, reports.back().time - second / 2, reports.back().time);
}

TEST_F(ResponseMonitorTest, theHistogramHoldsEveryWholeImpactOfTheWindow)
{
  const ResponseStatistics report = play(stream_, monitor_, 250).back();
  const std::vector<double>& edges = monitor_.histogramEdges();
  ASSERT_EQ(report.histogram.size(), edges.size() + 1);
  for (std::size_t i = 0; i < report.histogram.size(); ++i)
  {
    const double from = i == 0 ? -1.0 : edges[i - 1];
    const double to = i == edges.size() ? std::numeric_limits<double>::infinity() : edges[i];
    const auto count = std::count_if(stream_.impacts.begin(), stream_.impacts.end(),
                                     [&](const ReleasedImpact& impact)
                                     {
                                       return !impact.cut_short && impact.release > report.time - second / 2 &&
                                              impact.impulse >= from && impact.impulse < to;
                                     });
    EXPECT_EQ(report.histogram[i], static_cast<std::uint64_t>(count)) << i;
  }
}

TEST(ImpulseHistogram, theEdgesAreEquallyWideOnALogarithmicAxis)
{
  ImpulseHistogram histogram(1.0e-3, 10.0, 4);
  EXPECT_EQ(histogram.edges().front(), 1.0e-3);
  EXPECT_EQ(histogram.edges().back(), 10.0);
  EXPECT_NEAR(histogram.edges()[2], 0.1, 1.0e-15);
  for (const double impulse : {0.0, 9.9e-4, 1.0e-3, 0.5, 0.6, 9.9, 10.0, 1.0e9})
  {
    histogram.add(impulse);
  }
  EXPECT_EQ(histogram.counts(), (std::vector<std::uint64_t>{2, 1, 0, 2, 1, 2}));
}

TEST(TimeIntervals, coverWhatLiesInThem)
{
  TimeIntervals intervals;
  intervals.add(10, 20);
  intervals.add(20, 30);
  intervals.add(25, 28);  // has been
  intervals.add(40, 50);
  EXPECT_EQ(intervals.covered(0, 100), 30);
  EXPECT_EQ(intervals.covered(15, 45), 20);
  EXPECT_EQ(intervals.covered(30, 40), 0);
  intervals.forget(30);
  EXPECT_EQ(intervals.covered(0, 100), 10);
}

TEST_F(ResponseMonitorTest, whatIsMissingIsCountedAndNotHeard)
{
  monitor_.addForce(stream_.block(0, 5000));
  monitor_.addForce(stream_.block(7500, 2500));
  monitor_.addImpact(impactAt(0, epoch + second / 100, 1.0e-4, 1.0e-6));
  // In the gap of the force: it was heard of all the same.
  monitor_.addImpact(impactAt(3, epoch + second / 8, 1.0e-4, 1.0e-6));
  const ResponseStatistics* report = lastOf(monitor_);
  ASSERT_NE(report, nullptr);
  EXPECT_EQ(monitor_.forceSamples().missing(), 2500u);
  EXPECT_EQ(monitor_.impacts().missing(), 2u);
  EXPECT_EQ(monitor_.missing(), 2502u);
  EXPECT_NEAR(report->window, 0.15, 1.0e-12);
  EXPECT_DOUBLE_EQ(report->impact_rate, 2.0 / 0.2);
  EXPECT_DOUBLE_EQ(report->mean_force, 2.0e-6 / 0.2);
  EXPECT_NEAR(report->contact_duty,
              (contactTime(stream_, epoch, epoch + second / 10) +
               contactTime(stream_, epoch + 3 * second / 20, epoch + second / 5)) /
                  0.15,
              1.0e-12)
      << "of what was heard of the force";
  EXPECT_EQ(monitor_.next(true), nullptr) << "nothing has come since";
}

TEST_F(ResponseMonitorTest, timeThatGoesBackEmptiesTheWindowAndNotTheTotals)
{
  play(stream_, monitor_, 250);
  // The same recording once more, as a looped bag plays it; of the impacts, the first is heard before the blocks.
  std::vector<ResponseStatistics> again = play(stream_, monitor_, 250);
  ASSERT_EQ(again.size(), 30u);
  EXPECT_EQ(again.front().time, epoch + second / 10);
  EXPECT_EQ(monitor_.restarts(), 2u) << "of the impacts and of the blocks";
  expectSums(again.back().sums, stream_, again.back().time - second / 2, again.back().time);
  EXPECT_EQ(again.back().total.whole + again.back().total.cut_short, 2 * stream_.impacts.size());
  EXPECT_NEAR(again.back().total_time, 6.0, 1.0e-9);
  EXPECT_EQ(monitor_.missing(), 0u);
  EXPECT_EQ(monitor_.lateImpacts(), 0u);
  // The window of the first report holds nothing of the first run.
  expectSums(again.front().sums, stream_, epoch, again.front().time);
}

/// Plays the stream `loops` times without a pause, as a looped bag does. The impacts of a block come before its force
/// (a simulator's order), or `overtaken` blocks later than the force of theirs.
std::vector<ResponseStatistics> playLoops(const Stream& stream, ResponseMonitor& monitor, int loops,
                                          std::optional<std::size_t> overtaken)
{
  constexpr std::size_t block_size = 250;
  const std::size_t blocks = stream.force.size() / block_size;
  std::vector<std::vector<ReleasedImpact>> impacts(blocks);
  for (const ReleasedImpact& impact : stream.impacts)
  {
    impacts.at(static_cast<std::size_t>((impact.release - epoch) / sample) / block_size).push_back(impact);
  }
  std::vector<ResponseStatistics> reports;
  const std::size_t all = static_cast<std::size_t>(loops) * blocks;
  const auto give = [&](std::size_t block)
  {
    for (const ReleasedImpact& impact : impacts[block % blocks])
    {
      monitor.addImpact(impact);
    }
  };
  for (std::size_t i = 0; i < all; ++i)
  {
    if (!overtaken)
    {
      give(i);
    }
    monitor.addForce(stream.block(i % blocks * block_size, block_size));
    while (const ResponseStatistics* report = monitor.next())
    {
      reports.push_back(*report);
    }
    if (overtaken && i >= *overtaken)
    {
      give(i - *overtaken);
    }
  }
  for (std::size_t i = all - overtaken.value_or(0); i < all; ++i)
  {
    give(i);
  }
  while (const ResponseStatistics* report = monitor.next(true))
  {
    reports.push_back(*report);
  }
  return reports;
}

TEST_F(ResponseMonitorTest, lostBlocksOfForceChangeNoRate)
{
  const ResponseStatistics all = play(stream_, monitor_, 250).back();
  ResponseMonitor deaf(options());
  for (const ReleasedImpact& impact : stream_.impacts)
  {
    deaf.addImpact(impact);
  }
  for (std::size_t from = 250; from < stream_.force.size(); from += 500)
  {
    deaf.addForce(stream_.block(from, 250));
  }
  const ResponseStatistics* half = lastOf(deaf);
  ASSERT_NE(half, nullptr);
  EXPECT_EQ(half->time, all.time);
  EXPECT_NEAR(half->window, 0.25, 1.0e-12);
  EXPECT_EQ(half->impact_rate, all.impact_rate);
  EXPECT_EQ(half->mean_force, all.mean_force);
  EXPECT_EQ(half->impact_power, all.impact_power);
  EXPECT_EQ(half->normal_work_rate, all.normal_work_rate);
  EXPECT_EQ(half->wear_rate, all.wear_rate);
  EXPECT_NEAR(half->contact_duty, all.contact_duty, 0.3 * all.contact_duty);
}

TEST_F(ResponseMonitorTest, aLoopIsTheSameWhetherItsImpactsOrItsForceComeFirst)
{
  // Also where the impacts cease long before the loop is over: for longer than a window, and than settling takes.
  Stream quiet = stream_;
  quiet.impacts.erase(std::find_if(quiet.impacts.begin(), quiet.impacts.end(),
                                   [](const ReleasedImpact& impact) { return impact.release > epoch + 2 * second; }),
                      quiet.impacts.end());
  for (const Stream& stream : {stream_, quiet})
  {
    ResponseMonitor ahead(options());
    const std::vector<ResponseStatistics> reports = playLoops(stream, ahead, 3, std::nullopt);
    ResponseMonitor behind(options());
    const std::vector<ResponseStatistics> expected = playLoops(stream, behind, 3, 0);
    ASSERT_EQ(reports.size(), 90u);
    ASSERT_EQ(expected.size(), 90u);
    for (std::size_t i = 0; i < reports.size(); ++i)
    {
      const StreamTime time = epoch + static_cast<StreamTime>(i % 30 + 1) * second / 10;
      EXPECT_EQ(reports[i].time, time);
      EXPECT_EQ(reports[i].stretch, i / 30 + 1);
      expectSums(reports[i].sums, stream, time - second / 2, time);
      EXPECT_EQ(expected[i].time, time);
      EXPECT_EQ(expected[i].sums.impulse, reports[i].sums.impulse);
      EXPECT_EQ(expected[i].impact_rate, reports[i].impact_rate);
      EXPECT_EQ(expected[i].contact_duty, reports[i].contact_duty);
      EXPECT_EQ(expected[i].total.impulse, reports[i].total.impulse);
    }
    for (const ResponseMonitor* monitor : {&ahead, &behind})
    {
      EXPECT_EQ(monitor->restarts(), 4u) << "of the impacts and of the blocks, twice";
      EXPECT_EQ(monitor->lateImpacts(), 0u);
      EXPECT_EQ(monitor->missing(), 0u);
      const ImpactSums& total = monitor->statistics().total;
      EXPECT_EQ(total.whole + total.cut_short, 3 * stream.impacts.size());
    }
  }
}

TEST_F(ResponseMonitorTest, impactsThatALoopLeavesBehindAreLateAndInTheTotals)
{
  const std::vector<ResponseStatistics> reports = playLoops(stream_, monitor_, 2, 4);
  ASSERT_EQ(reports.size(), 60u);
  const StreamTime last_blocks = epoch + 3 * second - 4 * 250 * sample;
  EXPECT_EQ(monitor_.lateImpacts(), static_cast<std::uint64_t>(std::count_if(
                                        stream_.impacts.begin(), stream_.impacts.end(),
                                        [&](const ReleasedImpact& impact) { return impact.release >= last_blocks; })));
  EXPECT_GT(monitor_.lateImpacts(), 0u);
  for (std::size_t i = 30; i < 60; ++i)
  {
    expectSums(reports[i].sums, stream_, reports[i].time - second / 2, reports[i].time);
  }
  EXPECT_EQ(reports.back().total.whole + reports.back().total.cut_short, 2 * stream_.impacts.size());
}

TEST_F(ResponseMonitorTest, anImpactFromTheFutureStopsNothing)
{
  monitor_.addForce(stream_.block(0, 5000));
  monitor_.addImpact(impactAt(0, epoch + 3600 * second, 1.0e-4, 1.0e-6));
  for (std::uint64_t i = 1; i < 10; ++i)
  {
    monitor_.addImpact(impactAt(i, epoch + second / 10 + static_cast<StreamTime>(i) * second / 100, 1.0e-4, 1.0e-6));
  }
  monitor_.addForce(stream_.block(5000, 5000));
  const ResponseStatistics* report = lastOf(monitor_);
  ASSERT_NE(report, nullptr);
  EXPECT_EQ(report->sums.whole, 9u);
  EXPECT_EQ(report->total.whole, 10u);
}

TEST_F(ResponseMonitorTest, aMotionThatBeginsAnewLosesNothing)
{
  monitor_.addForce(stream_.block(0, 5000));
  monitor_.addImpact(impactAt(8, epoch + second / 100, 1.0e-4, 1.0e-6));
  ReleasedImpact open = impactAt(9, epoch + second / 50, 1.0e-4, 1.0e-6);
  open.cut_short = true;
  monitor_.addImpact(open);
  monitor_.addImpact(impactAt(0, epoch + second / 25, 1.0e-4, 1.0e-6));
  const ResponseStatistics* report = lastOf(monitor_);
  ASSERT_NE(report, nullptr);
  EXPECT_EQ(report->sums.whole, 2u);
  EXPECT_EQ(report->sums.cut_short, 1u);
  EXPECT_EQ(monitor_.restarts(), 1u);
  EXPECT_EQ(monitor_.missing(), 0u);
}

TEST_F(ResponseMonitorTest, aJumpForwardBeginsAnotherStretch)
{
  monitor_.addForce(stream_.block(0, 4000));
  SampleBlock later = stream_.block(4000, 6000);
  later.stamp += 3600 * second;
  monitor_.addForce(later);
  const ResponseStatistics* report = monitor_.next();
  ASSERT_NE(report, nullptr) << "the end of the first one";
  EXPECT_EQ(report->time, epoch + 4000 * sample);
  EXPECT_EQ(report->stretch, 1u);
  EXPECT_EQ(monitor_.next(), nullptr) << "nothing in between; and nobody knows whether an impact is still to come";
  report = monitor_.next(true);
  ASSERT_NE(report, nullptr);
  EXPECT_EQ(report->time, later.stamp + second / 10);
  EXPECT_EQ(report->stretch, 2u);
  EXPECT_NEAR(report->window, 0.1, 1.0e-12);
  EXPECT_NEAR(report->total_time, 0.18, 1.0e-12);
  EXPECT_EQ(monitor_.restarts(), 0u);
}

TEST_F(ResponseMonitorTest, waitsForAnImpactThatWasReleasedLaterOrForTheSettlingTime)
{
  monitor_.addForce(stream_.block(0, 10000));
  monitor_.addImpact(impactAt(0, epoch + second / 20, 1.0e-4, 1.0e-6));
  EXPECT_EQ(monitor_.next(), nullptr);
  monitor_.addImpact(impactAt(1, epoch + second / 8, 1.0e-4, 1.0e-6));
  ASSERT_NE(monitor_.next(), nullptr);
  EXPECT_EQ(monitor_.statistics().time, epoch + second / 10);
  EXPECT_EQ(monitor_.next(), nullptr) << "0.2 s have been reached, too";
  monitor_.addForce(stream_.block(10000, 25000));
  ASSERT_NE(monitor_.next(), nullptr);
  EXPECT_EQ(monitor_.statistics().time, epoch + second / 5);
  EXPECT_EQ(monitor_.next(), nullptr);
}

TEST_F(ResponseMonitorTest, whatNoSimulatorSaysIsRefused)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {nan, std::numeric_limits<double>::infinity()})
  {
    ReleasedImpact impact = impactAt(0, epoch, 1.0e-4, 1.0e-6);
    impact.impulse = bad;
    monitor_.addImpact(impact);
    impact = impactAt(0, epoch, 1.0e-4, 1.0e-6);
    impact.duration = bad;
    monitor_.addImpact(impact);
    SampleBlock block = stream_.block(0, 100);
    block.sample_period = bad;
    monitor_.addForce(block);
    monitor_.addExcitation(block);
  }
  SampleBlock block = stream_.block(0, 100);
  block.sample_period = 0.0;
  monitor_.addForce(block);
  EXPECT_EQ(monitor_.refused(), 9u);
  EXPECT_EQ(monitor_.next(true), nullptr);
  EXPECT_EQ(monitor_.impacts().taken(), 0u);
}

TEST_F(ResponseMonitorTest, aBlockOfNoSimulatorIsRefused)
{
  const std::vector<double> zeros(100);
  const auto refused = [&](const SampleBlock& block)
  {
    const std::uint64_t before = monitor_.refused();
    monitor_.addForce(block);
    monitor_.addGap(block);
    monitor_.addExcitation(block);
    return monitor_.refused() - before;
  };
  for (const double period : {0.0, -1.0e-5, 9.9e-10, 1.001e3, 1.0e6})
  {
    EXPECT_EQ(refused({0, epoch, period, zeros.data(), 1}), 3u) << period;
  }
  const StreamTime last_second = 4'294'967'294 * second;
  EXPECT_EQ(refused({0, last_second + second, 1.0, zeros.data(), 1}), 3u) << "a stamp that no later one can follow";
  EXPECT_EQ(refused({0, last_second, 1.0e-2, zeros.data(), 100}), 3u) << "ends where time does";
  EXPECT_EQ(refused({std::numeric_limits<std::uint64_t>::max() - 50, epoch, 1.0e-3, zeros.data(), 100}), 3u);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()})
  {
    std::vector<double> values = zeros;
    values[99] = bad;
    EXPECT_EQ(refused({0, epoch, 1.0e-3, values.data(), values.size()}), 3u) << bad;
  }
  EXPECT_EQ(monitor_.next(true), nullptr);
  EXPECT_EQ(monitor_.forceSamples().taken() + monitor_.gapSamples().taken(), 0u);
  EXPECT_EQ(monitor_.smallestGap(), std::numeric_limits<double>::infinity());

  // The last ones that are good.
  EXPECT_EQ(refused({0, last_second, 1.0e-3, zeros.data(), 100}), 0u);
  EXPECT_EQ(refused({0, epoch, 1.0e-9, zeros.data(), 100}), 0u);
}

TEST_F(ResponseMonitorTest, aBlockOfMoreReportsThanAnybodyCouldWantIsRefused)
{
  // 0.1 s from report to report.
  const std::vector<double> zeros(100);
  monitor_.addForce({0, epoch, 10.1, zeros.data(), 100});
  EXPECT_EQ(monitor_.refused(), 1u);
  EXPECT_EQ(monitor_.next(true), nullptr);
  monitor_.addForce({0, epoch, 9.99, zeros.data(), 100});
  EXPECT_EQ(monitor_.refused(), 1u);
  std::size_t reports = 0;
  while (monitor_.next(true) != nullptr)
  {
    ++reports;
  }
  EXPECT_EQ(reports, 9990u);
}

TEST_F(ResponseMonitorTest, aForceThatPullsIsAContact)
{
  const std::vector<double> force = {0.0, 2.0, -1.0, 0.0};
  monitor_.addForce({0, epoch, 0.01, force.data(), force.size()});
  const ResponseStatistics* report = lastOf(monitor_);
  ASSERT_NE(report, nullptr);
  EXPECT_DOUBLE_EQ(report->contact_duty, 0.5);
  EXPECT_DOUBLE_EQ(report->total_contact_time, 0.02);
}

TEST(ArchardWear, slidesAtASpeedOrOverADistance)
{
  ImpactSums sums;
  sums.add(impactAt(0, epoch, 2.0e-4, 1.0e-5));
  sums.add(impactAt(1, epoch + second, 1.0e-4, 3.0e-5));
  ArchardWear wear{2.0e-14, 1.0e-6, 0.5, 0.0};
  EXPECT_DOUBLE_EQ(wear.normalWork(sums), 0.5 * 4.0e-5);
  wear = {2.0e-14, 1.0e-6, 0.0, 1.0e-5};
  // Mean forces of 0.05 N and 0.3 N, each over 10 um.
  EXPECT_DOUBLE_EQ(wear.normalWork(sums), 3.5e-6);
  EXPECT_DOUBLE_EQ(wear.volume(sums), 7.0e-20);
  EXPECT_DOUBLE_EQ(wear.depth(sums), 7.0e-14);
}

/// Impacts with a pattern of `impulses`, one in each cycle of the drive.
void playPattern(ResponseMonitor& monitor, const std::vector<double>& impulses, double frequency, int cycles,
                 bool with_excitation)
{
  const double pi = std::acos(-1.0);
  const double cycle = 1.0 / frequency;
  std::uint64_t number = 0;
  const auto samples = static_cast<std::size_t>(cycle * cycles / sample_period);
  const std::vector<double> force(samples, 0.0);
  std::vector<double> acceleration(samples);
  for (std::size_t i = 0; i < samples; ++i)
  {
    acceleration[i] = 3.0 * std::sin(2.0 * pi * frequency * sample_period * static_cast<double>(i));
  }
  for (; number + 1 < static_cast<std::uint64_t>(cycles); ++number)
  {
    const double onset = (static_cast<double>(number) + 0.3) * cycle;
    monitor.addImpact(impactAt(number, epoch + nanoseconds(onset), 1.0e-4, impulses[number % impulses.size()]));
  }
  for (std::size_t from = 0; from < samples; from += 250)
  {
    const std::size_t count = std::min<std::size_t>(250, samples - from);
    const StreamTime stamp = epoch + static_cast<StreamTime>(from) * sample;
    if (with_excitation)
    {
      monitor.addExcitation({from, stamp, sample_period, acceleration.data() + from, count});
    }
    monitor.addForce({from, stamp, sample_period, force.data() + from, count});
  }
}

TEST(MonitoredPeriod, isThatOfTheResponseTable)
{
  for (const std::vector<double>& impulses : std::vector<std::vector<double>>{
           {1.0e-6}, {1.0e-6, 2.0e-6}, {1.0e-6, 2.0e-6, 1.0e-6, 2.001e-6}, {1.0e-6, 1.1e-6, 1.2e-6}})
  {
    ResponseMonitor monitor(options());
    playPattern(monitor, impulses, 271.4, 160, true);
    const ResponseStatistics* report = lastOf(monitor);
    ASSERT_NE(report, nullptr);
    EXPECT_NEAR(report->drive_frequency, 271.4, 1.0e-6 * 271.4);
    EXPECT_EQ(report->period, static_cast<int>(impulses.size()));
  }
}

TEST(MonitoredPeriod, isNoneWithoutADriveOrARepetition)
{
  ResponseMonitor deaf(options());
  playPattern(deaf, {1.0e-6}, 271.4, 160, false);
  EXPECT_EQ(lastOf(deaf)->period, 0);
  EXPECT_EQ(deaf.statistics().drive_frequency, 0.0);

  MonitorOptions told = options();
  told.drive_frequency = 271.4;
  ResponseMonitor monitor(told);
  playPattern(monitor, {1.0e-6, 2.0e-6}, 271.4, 160, false);
  EXPECT_EQ(lastOf(monitor)->period, 2);

  ResponseMonitor irregular(options());
  std::vector<double> impulses;
  std::mt19937 random(3);
  for (int i = 0; i < 160; ++i)
  {
    impulses.push_back(1.0e-6 * std::uniform_real_distribution<double>(1.0, 2.0)(random));
  }
  playPattern(irregular, impulses, 271.4, 160, true);
  EXPECT_EQ(lastOf(irregular)->period, 0);
}

TEST(DriveFrequency, isUnknownForADriveThatIsNoSteadyOne)
{
  std::vector<double> sweep(50000);
  std::vector<double> noise(50000);
  std::mt19937 random(5);
  for (std::size_t i = 0; i < sweep.size(); ++i)
  {
    const double time = sample_period * static_cast<double>(i);
    sweep[i] = std::sin(1000.0 * time * (1.0 + 2.0 * time));
    noise[i] = std::normal_distribution<double>()(random);
  }
  for (const std::vector<double>& values : {sweep, noise})
  {
    DriveFrequency frequency;
    frequency.add({0, epoch, sample_period, values.data(), values.size()});
    EXPECT_EQ(frequency.at(epoch + second), 0.0);
  }
}

TEST(DriveFrequency, beginsAnewWhereSamplesAreMissing)
{
  std::vector<double> sine(10000);
  for (std::size_t i = 0; i < sine.size(); ++i)
  {
    sine[i] = std::sin(1234.5 * sample_period * static_cast<double>(i));
  }
  DriveFrequency frequency;
  frequency.add({0, epoch, sample_period, sine.data(), 5000});
  const double expected = 1234.5 / (2.0 * std::acos(-1.0));
  EXPECT_NEAR(frequency.at(epoch + second), expected, 1.0e-6 * expected);
  EXPECT_EQ(frequency.at(epoch + second / 200), 0.0) << "two cycles are too few";
  frequency.add({5100, epoch + 5100 * sample, sample_period, sine.data() + 5100, 100});
  EXPECT_EQ(frequency.at(epoch + second), 0.0);
  frequency.add({5200, epoch + 5200 * sample, sample_period, sine.data() + 5200, 4800});
  EXPECT_NEAR(frequency.at(epoch + second), expected, 1.0e-6 * expected);
}

TEST(Quantities, areFoundByTheirName)
{
  ResponseStatistics statistics;
  statistics.impact_rate = 12.0;
  ASSERT_NE(findQuantity("impact_rate"), nullptr);
  EXPECT_EQ(findQuantity("impact_rate")->value(statistics), 12.0);
  EXPECT_EQ(findQuantity("impact_rates"), nullptr);
}

}  // namespace
