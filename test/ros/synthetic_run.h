#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <ros/time.h>
#include <rosbag/bag.h>
#include <vibro_impact/BaseExcitation.h>
#include <vibro_impact/ContactForce.h>
#include <vibro_impact/Gap.h>
#include <vibro_impact/Impact.h>
#include <vibro_impact/ModelInfo.h>
#include <vibro_impact/StreamStart.h>

#include "../core/common.h"
#include "../core/played_signal.h"
#include "vibro_impact/config/configuration.h"
#include "vibro_impact/core/simulation.h"
#include "vibro_impact/core/switched_model.h"
#include "vibro_impact/ros/conversions.h"

namespace vibro_impact::graph
{
/// The messages of a run, as shaker and simulator would publish them, to be spoilt and written to bags without a
/// master.
struct SyntheticRun
{
  /// Plays the samples to the model in blocks of `block` samples.
  SyntheticRun(core::SystemParameters parameters, const std::vector<double>& samples, double sample_period,
               std::size_t block = 400)
      : SyntheticRun(std::move(parameters), samples, sample_period, {}, block)
  {
  }

  /// The contact changes with blocks: at the samples given, multiples of `block`.
  SyntheticRun(core::SystemParameters parameters, const std::vector<double>& samples, double sample_period,
               const std::map<std::uint64_t, core::ContactParameters>& changes, std::size_t block = 400)
  {
    core::Recorder sink;
    const auto model = std::make_shared<const core::SwitchedModel>(parameters);
    infos.emplace_back();
    toMessage(*model, config::toYaml(parameters), "0.0.0", infos.back());

    core::SampledSimulation simulation(model, sample_period);
    for (std::size_t i = 0; i < samples.size(); i += block)
    {
      const std::size_t count = std::min(block, samples.size() - i);
      if (const auto change = changes.find(i); change != changes.end())
      {
        parameters.contact = change->second;
        const auto changed = std::make_shared<const core::SwitchedModel>(parameters);
        simulation.setModel(changed, sink);
        ModelInfo info;
        toMessage(*changed, config::toYaml(parameters), "0.0.0", info);
        info.header.stamp = stampOf(i, sample_period);
        info.seq = i;
        info.number = infos.size();
        infos.push_back(info);
      }
      BaseExcitation excitation;
      excitation.header.stamp = stampOf(i, sample_period);
      excitation.seq = i;
      excitation.sample_period = sample_period;
      excitation.acceleration.assign(samples.begin() + static_cast<std::ptrdiff_t>(i),
                                     samples.begin() + static_cast<std::ptrdiff_t>(i + count));
      Gap gap;
      ContactForce force;
      gap.header = force.header = excitation.header;
      gap.seq = force.seq = excitation.seq;
      gap.sample_period = force.sample_period = sample_period;
      gap.gap.resize(count);
      force.force.resize(count);
      simulation.advance(excitation.acceleration.data(), count, gap.gap.data(), force.force.data(), sink);
      excitations.push_back(excitation);
      gaps.push_back(gap);
      forces.push_back(force);
    }
    simulation.finish(sink);
    for (const core::Impact& impact : sink.impacts)
    {
      Impact message;
      toMessage({impact, fromTime(stampOf(impact.interval, sample_period) + ros::Duration(impact.offset))}, message);
      impacts.push_back(message);
    }
  }

  static ros::Time stampOf(std::uint64_t sample, double sample_period)
  {
    return ros::Time(1000.0) + ros::Duration(static_cast<double>(sample) * sample_period);
  }

  /// Writes what was published in the share [from, to) of the run, with topics in a name space such as "/rig1".
  void write(const std::string& path, double from = 0.0, double to = 1.0, const std::string& name_space = "") const
  {
    rosbag::Bag bag(path, rosbag::bagmode::Write);
    const double end = (excitations.back().header.stamp - excitations.front().header.stamp).toSec() + 1.0;
    std::multimap<double, std::function<void(const ros::Time&)>> records;  // by time of recording
    const auto put = [&](const std::string& topic, const auto& message, double delay)
    {
      const double time = std::max(0.0, (message.header.stamp - excitations.front().header.stamp).toSec());
      if (time >= from * end && time < to * end)
      {
        records.emplace(time + delay, [&bag, &message, topic = name_space + "/" + topic](const ros::Time& stamp)
                        { bag.write(topic, stamp, message); });
      }
    };
    for (const ModelInfo& message : infos)
    {
      put("model_info", message, 0.0);
    }
    for (const StreamStart& message : starts)
    {
      put("stream_start", message, 0.0);
    }
    for (const BaseExcitation& message : excitations)
    {
      put("base_excitation", message, 0.001);
    }
    for (const Gap& message : gaps)
    {
      put("gap", message, 0.0005);  // a recorder hears of the answer before the question now and then
    }
    for (const ContactForce& message : forces)
    {
      put("contact_force", message, 0.002);
    }
    for (const Impact& message : impacts)
    {
      put("impact", message, 0.002);
    }
    for (const auto& [time, record] : records)
    {
      record(excitations.front().header.stamp + ros::Duration(time));
    }
  }

  std::vector<BaseExcitation> excitations;
  std::vector<Gap> gaps;
  std::vector<ContactForce> forces;
  std::vector<Impact> impacts;
  std::vector<ModelInfo> infos;
  std::vector<StreamStart> starts;  ///< none unless a test gives some
};
}  // namespace vibro_impact::graph
