#include <algorithm>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "vibro_impact/ros/extremes.h"

using vibro_impact::graph::Extremes;
using vibro_impact::graph::ExtremesHold;
using vibro_impact::graph::Samples;

namespace
{
constexpr double period = 1.0e-3;

Samples samples(std::size_t first, const std::vector<double>& values)
{
  return {1000000000 + 1000000 * static_cast<vibro_impact::graph::Stamp>(first), first, period, values};
}

TEST(ExtremesHold, givesTheExtremesOfEveryStretch)
{
  ExtremesHold hold(250.0);  // stretches of 4 samples
  const auto& ended = hold.take(samples(0, {3.0, -1.0, 2.0, 4.0, 9.0, 8.0, 7.0, 7.5, 1.0}),
                                samples(0, {0.0, 5.0, 1.0, 5.0, 0.0, 0.0, 0.0, 0.0, 6.0}));
  ASSERT_EQ(ended.size(), 2u);
  EXPECT_EQ(ended[0].force, 5.0);
  EXPECT_EQ(ended[0].gap, -1.0);
  EXPECT_EQ(ended[0].stamp, 1001000000) << "time of the first sample with the greatest force";
  EXPECT_EQ(ended[1].force, 0.0);
  EXPECT_EQ(ended[1].gap, 7.0);
  EXPECT_EQ(ended[1].stamp, 1004000000);
}

TEST(ExtremesHold, doesNotDependOnHowTheStreamIsCut)
{
  std::vector<double> gap;
  std::vector<double> force;
  for (std::size_t i = 0; i < 1000; ++i)
  {
    gap.push_back(static_cast<double>((i * 7919) % 1009));
    force.push_back(static_cast<double>((i * 104729) % 997));
  }
  std::vector<std::vector<Extremes>> results;
  for (const std::size_t cut : {1u, 7u, 64u, 1000u})
  {
    ExtremesHold hold(90.0);
    std::vector<Extremes> all;
    for (std::size_t first = 0; first < gap.size(); first += cut)
    {
      const auto begin = static_cast<std::ptrdiff_t>(first);
      const auto end = static_cast<std::ptrdiff_t>(std::min(first + cut, gap.size()));
      const auto& ended = hold.take(samples(first, {gap.begin() + begin, gap.begin() + end}),
                                    samples(first, {force.begin() + begin, force.begin() + end}));
      all.insert(all.end(), ended.begin(), ended.end());
    }
    results.push_back(all);
  }
  EXPECT_EQ(results[0].size(), 1000u / 11);
  for (const auto& result : results)
  {
    ASSERT_EQ(result.size(), results[0].size());
    for (std::size_t i = 0; i < result.size(); ++i)
    {
      EXPECT_EQ(result[i].force, results[0][i].force);
      EXPECT_EQ(result[i].gap, results[0][i].gap);
      EXPECT_EQ(result[i].stamp, results[0][i].stamp);
    }
  }
}

TEST(ExtremesHold, neverGivesMoreThanOneForASample)
{
  ExtremesHold hold(1.0e4);
  EXPECT_EQ(hold.take(samples(0, {1.0, 2.0, 3.0}), samples(0, {0.0, 0.0, 0.0})).size(), 3u);
}

}  // namespace
