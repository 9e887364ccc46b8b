#include "vibro_impact/ros/recording_simulation.h"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "contact_replay.h"
#include "recorded_starts.h"
#include "text.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/ros/conversions.h"
#include "vibro_impact/ros/stream_simulation.h"

namespace vibro_impact::graph
{
namespace
{
// Puts what StreamSimulation tells on one time axis.
class StreamRecorder : public MotionObserver
{
public:
  explicit StreamRecorder(const config::HistorySelection& history) : recorder_(history)
  {
  }

  void onStart(Stamp stamp, double sample_period) override
  {
    if (!first_)
    {
      first_ = stamp;
    }
    recorder_.begin(1.0e-9 * static_cast<double>(stamp - *first_), sample_period);
  }

  void onSample(const core::HistorySample& sample) override
  {
    recorder_.onSample(sample);
  }

  void onImpact(const core::Impact& impact) override
  {
    recorder_.onImpact(impact);
  }

  config::SimulatedRun take()
  {
    return std::move(recorder_.run);
  }

private:
  config::RunRecorder recorder_;
  std::optional<Stamp> first_;
};

void note(const Verdict& verdict, RecordingSimulation& result)
{
  switch (verdict.action)
  {
    case Verdict::Action::Start:
    case Verdict::Action::Continue:
      return;
    case Verdict::Action::Bridge:
      result.bridged += verdict.missing;
      break;
    case Verdict::Action::Restart:
      ++result.restarts;
      break;
    case Verdict::Action::Refuse:
      ++result.refused;
      break;
  }
  if (result.first_irregularity.empty())
  {
    result.first_irregularity = verdict.reason;
  }
}

}  // namespace

RecordingSimulation simulateRecording(const RecordedRun& recording, const RecordedModel& recorded,
                                      const StreamLimits& limits, const config::HistorySelection& history,
                                      const config::RunProgress& progress)
{
  StreamRecorder recorder(history);
  StreamSimulation simulation(std::make_shared<const core::SwitchedModel>(recorded.parameters), limits);
  simulation.observe(recorder);
  const std::map<std::size_t, RecordedStart> starts = recordedStarts(recording);
  ContactReplay contact(recorded);
  RecordingSimulation result;
  Samples samples;
  std::size_t index = 0;
  recording.readExcitation(
      [&](const BaseExcitation& block)
      {
        fromMessage(block, samples);
        for (const RecordedChange& change : contact.comeWith(samples, limits.max_stamp_jitter))
        {
          core::SystemParameters changed = recorded.parameters;
          changed.contact = change.contact;
          simulation.setContact(std::make_shared<const core::SwitchedModel>(changed), change.seq);
        }
        const auto start = starts.find(index++);
        if (start != starts.end() && start->second.cause != StreamStart::RULE && result.samples > 0)
        {
          simulation.reset();
          note({Verdict::Action::Restart, 0, start->second.reason}, result);
        }
        const Verdict& verdict = simulation.advance(samples).verdict;
        note(verdict, result);
        if (verdict.action == Verdict::Action::Refuse)
        {
          return;
        }
        const RecordedChange& known = recorded.known_from;
        if (result.samples == 0 && samples.seq < known.seq && samples.stamp < known.stamp)
        {
          throw config::Error(text("the recording begins with sample ", samples.seq,
                                   ", and tells the contact only from sample ", known.seq,
                                   " on: give a configuration as CONFIG"));
        }
        contact.take(samples);
        result.samples += samples.values.size();
        result.sample_period = samples.sample_period;
      },
      progress);
  if (result.samples == 0)
  {
    throw config::Error("topic " + recording.topics().base_excitation + ": " +
                        (result.refused == 0
                             ? "holds no message"
                             : "no block can be taken, the first because " + result.first_irregularity));
  }
  simulation.reset();
  result.run = recorder.take();
  result.run.step = result.sample_period * static_cast<double>(history.every);
  return result;
}

}  // namespace vibro_impact::graph
