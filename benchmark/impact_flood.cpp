// Publishes impacts and contact_force to a monitor, at real time and as fast as it takes them. Started by the script
// `monitor` beside this file.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <ros/ros.h>
#include <vibro_impact/ContactForce.h>
#include <vibro_impact/Impact.h>
#include <vibro_impact/ImpactStatistics.h>

namespace
{
constexpr double sample_period = 2.0e-5;
constexpr std::size_t block_size = 250;
constexpr double block_time = 5.0e-3;
/// Half of what a monitor queues, so that nothing has to be dropped.
constexpr std::uint64_t most_ahead = 50000;
constexpr double patience = 60.0;

class Flood
{
public:
  Flood(std::uint64_t impacts_per_second, double duration)
      : impacts_per_block_(
            static_cast<std::uint64_t>(std::llround(block_time * static_cast<double>(impacts_per_second)))),
        blocks_(static_cast<std::uint64_t>(std::llround(duration / block_time)))
  {
    impact_publisher_ = node_.advertise<vibro_impact::Impact>("impact", 0);
    force_publisher_ = node_.advertise<vibro_impact::ContactForce>("contact_force", 0);
    subscriber_ = node_.subscribe<vibro_impact::ImpactStatistics>(
        "impact_statistics", 0, [this](const vibro_impact::ImpactStatisticsConstPtr& message) { last_ = *message; });
  }

  /// At `speed` times real time, 0: without waiting. Whether nothing was missing.
  bool run(double speed)
  {
    if (!wait(
            [this]
            {
              return impact_publisher_.getNumSubscribers() == 1 && force_publisher_.getNumSubscribers() == 1 &&
                     subscriber_.getNumPublishers() == 1;
            }))
    {
      std::fprintf(stderr, "impact_flood: error: no monitor within %g s\n", patience);
      return false;
    }
    const std::uint64_t impacts = blocks_ * impacts_per_block_;
    const ros::SteadyTime start = ros::SteadyTime::now();
    for (std::uint64_t block = 0; block < blocks_ && ros::ok(); ++block)
    {
      publish(block);
      ros::spinOnce();
      const double due = speed > 0.0 ? static_cast<double>(block + 1) * block_time / speed : 0.0;
      ros::WallDuration(std::max(0.0, due - (ros::SteadyTime::now() - start).toSec())).sleep();
      if (!wait([&] { return number_ < last_.total_impacts + most_ahead; }))
      {
        break;
      }
    }
    // A second of flight more brings out what the last impacts have come to.
    for (std::uint64_t block = blocks_; block < blocks_ + 200; ++block)
    {
      publishForce(block);
    }
    const bool all = wait([&] { return last_.total_impacts >= impacts; });
    const double elapsed = (ros::SteadyTime::now() - start).toSec();
    std::printf(
        "%llu impacts in %.2f s: %.0f a second; missing %llu, late %llu, samples missing %llu\n",
        static_cast<unsigned long long>(last_.total_impacts), elapsed,
        static_cast<double>(last_.total_impacts) / elapsed, static_cast<unsigned long long>(last_.missing_impacts),
        static_cast<unsigned long long>(last_.late_impacts), static_cast<unsigned long long>(last_.missing_samples));
    return all && last_.missing_impacts == 0 && last_.missing_samples == 0;
  }

private:
  template <typename Condition>
  static bool wait(Condition condition)
  {
    const ros::SteadyTime end = ros::SteadyTime::now() + ros::WallDuration(patience);
    while (!condition())
    {
      if (!ros::ok() || ros::SteadyTime::now() > end)
      {
        return false;
      }
      ros::spinOnce();
      ros::WallDuration(0.001).sleep();
    }
    return true;
  }

  static ros::Time stampOf(std::uint64_t block)
  {
    return ros::Time(1700000000, 0) + ros::Duration().fromNSec(static_cast<std::int64_t>(block) * 5'000'000);
  }

  void publish(std::uint64_t block)
  {
    const ros::Time stamp = stampOf(block);
    for (std::uint64_t i = 0; i < impacts_per_block_; ++i)
    {
      vibro_impact::Impact impact;
      const double onset = block_time * static_cast<double>(i) / static_cast<double>(impacts_per_block_);
      impact.header.stamp = stamp + ros::Duration(onset);
      impact.number = number_++;
      impact.duration = 1.0e-5;
      impact.impulse = 1.0e-6;
      impact.peak_force = 0.15;
      impact_publisher_.publish(impact);
    }
    publishForce(block);
  }

  void publishForce(std::uint64_t block)
  {
    vibro_impact::ContactForce force;
    force.header.stamp = stampOf(block);
    force.seq = block * block_size;
    force.sample_period = sample_period;
    force.force.assign(block_size, 0.0);
    force_publisher_.publish(force);
  }

  ros::NodeHandle node_;
  std::uint64_t impacts_per_block_;
  std::uint64_t blocks_;
  std::uint64_t number_ = 0;
  vibro_impact::ImpactStatistics last_;
  ros::Publisher impact_publisher_;
  ros::Publisher force_publisher_;
  ros::Subscriber subscriber_;
};
}  // namespace

int main(int argc, char** argv)
{
  ros::init(argc, argv, "impact_flood");
  if (argc != 4)
  {
    std::fprintf(stderr, "usage: impact_flood IMPACTS_PER_SECOND SECONDS SPEED (see the script `monitor`)\n");
    return EXIT_FAILURE;
  }
  Flood flood(std::strtoull(argv[1], nullptr, 10), std::strtod(argv[2], nullptr));
  return flood.run(std::strtod(argv[3], nullptr)) ? EXIT_SUCCESS : EXIT_FAILURE;
}
