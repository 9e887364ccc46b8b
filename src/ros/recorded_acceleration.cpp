#include "vibro_impact/ros/recorded_acceleration.h"

#include <utility>

#include "text.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/ros/conversions.h"
#include "vibro_impact/ros/recorded_run.h"
#include "vibro_impact/ros/sensor_samples.h"

namespace vibro_impact::graph
{
namespace
{
// Joins blocks to one stretch.
class Joiner
{
public:
  Joiner(const std::string& topic, const StreamLimits& limits) : topic_(topic), rules_(limits)
  {
  }

  void take(const Samples& block)
  {
    const Verdict verdict = rules_.judge(block);
    switch (verdict.action)
    {
      case Verdict::Action::Start:
        result.sample_period = block.sample_period;
        break;
      case Verdict::Action::Continue:
        break;
      case Verdict::Action::Bridge:
        note(verdict.reason);
        bridge(verdict.missing, block.values.front());
        break;
      case Verdict::Action::Restart:
        throw config::Error("topic " + topic_ + ": " + verdict.reason + ": must be one stretch");
      case Verdict::Action::Refuse:
        refuse(verdict.reason, block.values.size());
        return;
    }
    result.acceleration.insert(result.acceleration.end(), block.values.begin(), block.values.end());
    rules_.take(block, verdict.action, false);
  }

  void refuse(const std::string& reason, std::uint64_t samples)
  {
    note(reason);
    result.refused += samples;
  }

  RecordedAcceleration result;

private:
  void note(const std::string& reason)
  {
    if (result.first_irregularity.empty())
    {
      result.first_irregularity = reason;
    }
  }

  void bridge(std::uint64_t missing, double next)
  {
    const double last = rules_.lastSample();
    const double slope = (next - last) / static_cast<double>(missing + 1);
    for (std::uint64_t i = 1; i <= missing; ++i)
    {
      result.acceleration.push_back(last + slope * static_cast<double>(i));
    }
    result.bridged += missing;
  }

  std::string topic_;
  StreamRules rules_;
};

template <typename Message>
void readSensor(const std::vector<std::string>& bags, const std::string& topic, const InputParameters& input,
                const StreamLimits& limits, Joiner& joiner)
{
  SensorSamples samples(input, limits);
  readTopic<Message>(bags, topic,
                     [&](const Message& message)
                     {
                       const SampleGrid::Answer& answer = samples.take(message);
                       if (answer.refused != 0)
                       {
                         joiner.refuse(answer.refusal, answer.refused);
                       }
                       for (const Samples& block : answer.blocks)
                       {
                         joiner.take(block);
                       }
                     });
  if (samples.grid().measuring())
  {
    throw config::Error("topic " + topic +
                        ": is too short for sample_period and offset to be measured: must hold more than " +
                        text(SampleGrid::measured_intervals + 1, " samples and ", input.grid.offset_duration,
                             " s, or both must be given"));
  }
}

}  // namespace

RecordedAcceleration readRecordedAcceleration(const std::vector<std::string>& bags, const std::string& topic,
                                              const InputParameters& input, const StreamLimits& limits)
{
  Joiner joiner(topic, limits);
  switch (input.kind)
  {
    case InputKind::accel:
      readSensor<geometry_msgs::AccelStamped>(bags, topic, input, limits, joiner);
      break;
    case InputKind::imu:
      readSensor<sensor_msgs::Imu>(bags, topic, input, limits, joiner);
      break;
    default:
    {
      Samples samples;
      readTopic<BaseExcitation>(bags, topic,
                                [&](const BaseExcitation& block)
                                {
                                  fromMessage(block, samples);
                                  joiner.take(samples);
                                });
    }
  }
  if (joiner.result.acceleration.empty())
  {
    const std::string& reason = joiner.result.first_irregularity;
    throw config::Error("topic " + topic + ": holds no sample that can be taken" +
                        (reason.empty() ? "" : ", the first because " + reason));
  }
  return std::move(joiner.result);
}

}  // namespace vibro_impact::graph
