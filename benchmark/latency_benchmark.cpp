// From a block's publication to the arrival of the simulator's answers, at real time, beside a plain relay of the same
// blocks in the same run. Started by the script `latency` beside this file.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <ros/ros.h>
#include <vibro_impact/BaseExcitation.h>
#include <vibro_impact/Gap.h>
#include <vibro_impact/Impact.h>
#include <boost/make_shared.hpp>

#include "vibro_impact/ros/node_query.h"

namespace
{
constexpr double sample_rate = 50000.0;
constexpr std::size_t block_size = 250;
/// Of the limiting case, near its resonance: an impact in every cycle of 115 samples.
constexpr double angular_frequency = 1.6 * 1705.6;
constexpr double acceleration = 50.0;
/// The first blocks find cold caches on all sides, and connections that are not there yet, s.
constexpr double warm_up = 2.0;
constexpr double patience = 30.0;

double now()
{
  return ros::SteadyTime::now().toSec();
}

/// Latencies on one path, s.
class Path
{
public:
  explicit Path(std::string name) : name_(std::move(name))
  {
  }

  void add(double latency)
  {
    latencies_.push_back(latency);
  }

  /// The latency that `share` of all do not exceed.
  double quantile(double share)
  {
    if (latencies_.empty())
    {
      return NAN;
    }
    std::sort(latencies_.begin(), latencies_.end());
    return latencies_[static_cast<std::size_t>(share * static_cast<double>(latencies_.size() - 1))];
  }

  void print(double reference)
  {
    const double p99 = quantile(0.99);
    std::printf("| %s | %zu | %.0f | %.0f | %.0f | %.2f |\n", name_.c_str(), latencies_.size(), 1.0e6 * quantile(0.5),
                1.0e6 * p99, 1.0e6 * quantile(1.0), p99 / reference);
  }

  std::size_t count() const
  {
    return latencies_.size();
  }

private:
  std::string name_;
  std::vector<double> latencies_;
};

class Benchmark
{
public:
  explicit Benchmark(std::size_t blocks) : blocks_(blocks), published_(blocks, 0.0)
  {
    const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
    publisher_ = node_.advertise<vibro_impact::BaseExcitation>("base_excitation", 1000);
    relay_subscriber_ = node_.subscribe<vibro_impact::BaseExcitation>(
        "relayed", 1000,
        [this](const vibro_impact::BaseExcitationConstPtr& message) { arrived(relay_, message->seq / block_size); },
        ros::VoidConstPtr(), hints);
    gap_subscriber_ = node_.subscribe<vibro_impact::Gap>(
        "gap", 1000, [this](const vibro_impact::GapConstPtr& message) { arrived(gap_, message->seq / block_size); },
        ros::VoidConstPtr(), hints);
    impact_subscriber_ = node_.subscribe<vibro_impact::Impact>(
        "impact", 100000, [this](const vibro_impact::ImpactConstPtr& message) { arrived(impact_, release(*message)); },
        ros::VoidConstPtr(), hints);
  }

  bool run()
  {
    if (!connect())
    {
      std::fprintf(stderr, "latency_benchmark: error: relay and simulator are not there within %g s\n", patience);
      return false;
    }
    ros::AsyncSpinner spinner(1);
    spinner.start();
    const double start = now();
    const ros::Time stamp = ros::Time::now();
    for (std::size_t block = 0; block < blocks_ && ros::ok(); ++block)
    {
      const double due = start + static_cast<double>((block + 1) * block_size) / sample_rate;
      ros::WallDuration(std::max(0.0, due - now())).sleep();
      publish(block, stamp);
    }
    ros::WallDuration(1.0).sleep();
    spinner.stop();

    const double reference = relay_.quantile(0.99);
    std::printf("| from a block of 5 ms to | messages | p50, us | p99, us | max, us | p99 by the relay's |\n");
    std::printf("| --- | --- | --- | --- | --- | --- |\n");
    for (Path* path : {&relay_, &gap_, &impact_})
    {
      path->print(reference);
    }
    // A relay has queues of ten messages; what it loses is its own.
    const auto warm_up_blocks = static_cast<std::size_t>(std::ceil(warm_up * sample_rate / block_size));
    const bool complete = gap_.count() == blocks_ - warm_up_blocks && impact_.count() > 0;
    const bool met = gap_.quantile(0.99) <= 1.5 * reference && impact_.quantile(0.99) <= 1.5 * reference;
    std::printf("%s; at most 1.5 asked: %s\n", complete ? "no answer lost" : "ANSWERS WERE LOST",
                met ? "met" : "not met");
    return complete;
  }

private:
  bool connect()
  {
    vibro_impact::graph::NodeQuery query;
    const std::string self = ros::this_node::getName();
    const double end = now() + patience;
    while (now() < end && ros::ok())
    {
      // The relay advertises its copies with the first one only: that is for the warm-up.
      if (publisher_.getNumSubscribers() == 2 && isConnected(query, gap_subscriber_.getTopic(), self) &&
          isConnected(query, impact_subscriber_.getTopic(), self))
      {
        return true;
      }
      ros::WallDuration(0.05).sleep();
    }
    return false;
  }

  void publish(std::size_t block, const ros::Time& start)
  {
    const auto message = boost::make_shared<vibro_impact::BaseExcitation>();
    message->seq = block * block_size;
    message->header.stamp = start + ros::Duration(static_cast<double>(message->seq) / sample_rate);
    message->sample_period = 1.0 / sample_rate;
    message->acceleration.resize(block_size);
    for (std::size_t i = 0; i < block_size; ++i)
    {
      message->acceleration[i] =
          acceleration * std::sin(angular_frequency * static_cast<double>(message->seq + i) / sample_rate);
    }
    published_[block] = now();
    publisher_.publish(message);
  }

  /// The block in which an impact ends.
  static std::uint64_t release(const vibro_impact::Impact& impact)
  {
    const double interval = (impact.offset + impact.duration) * sample_rate;
    return (impact.seq + static_cast<std::uint64_t>(std::ceil(interval))) / block_size;
  }

  void arrived(Path& path, std::uint64_t block)
  {
    const double time = now();
    if (block < blocks_ && static_cast<double>(block * block_size) / sample_rate >= warm_up)
    {
      path.add(time - published_[block]);
    }
  }

  std::size_t blocks_;
  std::vector<double> published_;  ///< of each block, written before it is published and read when its answer comes, s
  Path relay_{"a relay's copy"};
  Path gap_{"`gap`"};
  Path impact_{"`impact`"};
  ros::NodeHandle node_;
  ros::Publisher publisher_;
  ros::Subscriber relay_subscriber_;
  ros::Subscriber gap_subscriber_;
  ros::Subscriber impact_subscriber_;
};

}  // namespace

int main(int argc, char** argv)
{
  ros::init(argc, argv, "latency_benchmark");
  const double seconds = argc > 1 ? std::atof(argv[1]) : 0.0;
  if (!(seconds >= 3.0 && seconds <= 36000.0))
  {
    std::fprintf(stderr, "usage: latency_benchmark SECONDS, from 3 to 36000\n");
    return EXIT_FAILURE;
  }
  Benchmark benchmark(static_cast<std::size_t>(seconds * sample_rate) / block_size);
  return benchmark.run() ? EXIT_SUCCESS : EXIT_FAILURE;
}
