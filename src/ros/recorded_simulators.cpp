#include "recorded_simulators.h"

#include <optional>
#include <string>

#include "text.h"
#include "vibro_impact/config/configuration.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/ros/conversions.h"

namespace vibro_impact::graph
{
std::vector<RecordedSimulator> recordedSimulators(const RecordedRun& recording)
{
  std::vector<RecordedSimulator> simulators;
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
        const RecordedChange change{info.seq, fromTime(info.header.stamp), parameters.contact};
        if (!last || info.number <= *last)
        {
          simulators.push_back({{parameters, {}, change}, info.number, {}});
        }
        else
        {
          RecordedSimulator& simulator = simulators.back();
          core::SystemParameters same = simulator.model.parameters;
          same.contact = parameters.contact;
          if (config::toYaml(same) != configuration)
          {
            throw config::Error(text("topic ", recording.topics().model_info, ", number ", info.number,
                                     ": is another model than the one before, not another contact"));
          }
          if (info.number > *last + 1)
          {
            simulator.missing.emplace(simulator.model.changes.size(), *last + 1);
          }
          simulator.model.changes.push_back(change);
        }
        last = info.number;
        last_configuration = configuration;
      });
  return simulators;
}

RecordedModel recordedModel(const RecordedRun& recording)
{
  const std::string& topic = recording.topics().model_info;
  std::vector<RecordedSimulator> simulators = recordedSimulators(recording);
  if (simulators.empty())
  {
    throw config::Error("the recording holds no model_info: give a configuration as CONFIG");
  }
  if (simulators.size() > 1)
  {
    throw config::Error("topic " + topic +
                        ": the configuration changes within the recording, and not by a change of the contact; cut it "
                        "there with 'rosbag filter' and simulate the parts one by one");
  }
  if (const auto& missing = simulators.front().missing; !missing.empty())
  {
    throw config::Error(text("topic ", topic, ": number ", missing.begin()->second,
                             " is missing: the recording has lost a change of the contact"));
  }
  return simulators.front().model;
}

}  // namespace vibro_impact::graph
