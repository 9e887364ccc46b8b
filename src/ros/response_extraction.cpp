#include "vibro_impact/ros/response_extraction.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "step_search.h"
#include "text.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/core/parameters.h"
#include "vibro_impact/ros/contact_history.h"
#include "vibro_impact/ros/conversions.h"

namespace vibro_impact::graph
{
namespace
{
constexpr double two_pi = 6.283185307179586476925286766559;
// Cycles that a loss may spoil beyond its ends: the step finder needs some to find the drive again.
constexpr double spoilt_cycles = 4.0;
// Share of the first of the two readings in the progress.
constexpr double first_reading = 0.8;

// The samples in contact, as the force shows them.
class ContactTrace
{
public:
  void add(const BlockHead& block, const std::vector<double>& force)
  {
    for (std::size_t i = 0; i < force.size(); ++i)
    {
      const std::uint64_t seq = block.seq + i;
      if (force[i] == 0.0 || seq < end())
      {
        continue;
      }
      if (seq > end() || stretches_.empty())
      {
        stretches_.emplace_back(seq, seq);
      }
      stretches_.back().second = seq + 1;
    }
  }

  // Of the samples from `first` to the one before `last`.
  double share(std::uint64_t first, std::uint64_t last) const
  {
    auto stretch = std::lower_bound(stretches_.begin(), stretches_.end(), first,
                                    [](const auto& candidate, std::uint64_t seq) { return candidate.second <= seq; });
    std::uint64_t sum = 0;
    for (; stretch != stretches_.end() && stretch->first < last; ++stretch)
    {
      sum += std::min(last, stretch->second) - std::max(first, stretch->first);
    }
    return static_cast<double>(sum) / static_cast<double>(last - first);
  }

private:
  std::uint64_t end() const
  {
    return stretches_.empty() ? 0 : stretches_.back().second;
  }

  std::vector<std::pair<std::uint64_t, std::uint64_t>> stretches_;  // first sample, and the one after the last
};

// Everything that one reading of a recording tells.
class Survey : public RecordingSink
{
public:
  Survey(const RecordedTopics& topics, const core::StepSearchOptions& options)
      : check_(topics), options_(options), contacts_(topics.model_info)
  {
  }

  void onExcitation(const BaseExcitation& block) override
  {
    const BlockHead head = headOf(block, block.acceleration.size());
    if (!check_.takeExcitation(head))
    {
      return;
    }
    if (!search_)
    {
      search_.emplace(block.sample_period, options_);
    }
    const auto bad = std::find_if(block.acceleration.begin(), block.acceleration.end(),
                                  [](double value) { return !std::isfinite(value); });
    if (bad != block.acceleration.end())
    {
      check_.refuseExcitation(head);
    }
    search_->add(block.seq, block.acceleration.data(), block.acceleration.size());
  }

  void onGap(const BlockHead& block, const std::vector<double>& gap) override
  {
    check_.takeGap(block, gap);
  }

  void onContactForce(const BlockHead& block, const std::vector<double>& force) override
  {
    if (check_.takeContactForce(block, force))
    {
      trace_.add(block, force);
    }
  }

  void onImpact(const Impact& impact) override
  {
    if (check_.takeImpact(impact))
    {
      impacts_.push_back(impact);
    }
  }

  void onStreamStart(const StreamStart& /*start*/) override
  {
  }
  void onModelInfo(const ModelInfo& info) override
  {
    contacts_.add(info);
  }

  RecordingSummary summary()
  {
    RecordingSummary summary = check_.finish();
    const std::vector<Loss> unknown = contacts_.losses(summary.first);
    summary.losses.insert(summary.losses.end(), unknown.begin(), unknown.end());
    std::stable_sort(summary.losses.begin(), summary.losses.end(),
                     [](const Loss& a, const Loss& b) { return a.first < b.first; });
    return summary;
  }

  const ContactHistory& contacts() const
  {
    return contacts_;
  }

  const ContactTrace& trace() const
  {
    return trace_;
  }

  // After summary().
  std::vector<core::FoundStep> steps()
  {
    return search_->finish();
  }

  // After steps().
  const StepSearch& search() const
  {
    return *search_;
  }

  // On the stream's time axis, by ascending onset.
  std::vector<core::TimedImpact> impacts(double sample_period) const
  {
    std::vector<core::TimedImpact> timed;
    timed.reserve(impacts_.size());
    for (const Impact& message : impacts_)
    {
      timed.push_back({static_cast<double>(message.seq) * sample_period + message.offset, fromMessage(message).impact});
    }
    const auto earlier = [](const core::TimedImpact& a, const core::TimedImpact& b) { return a.onset < b.onset; };
    if (!std::is_sorted(timed.begin(), timed.end(), earlier))
    {
      std::stable_sort(timed.begin(), timed.end(), earlier);
    }
    return timed;
  }

private:
  RecordingCheck check_;
  core::StepSearchOptions options_;
  std::optional<StepSearch> search_;
  std::vector<Impact> impacts_;
  ContactHistory contacts_;
  ContactTrace trace_;
};

// A step or a part of one.
struct StepPart
{
  core::FoundStep step;
  bool cut = false;
};

// The steps, cut where the contact changes.
std::vector<StepPart> cutAtChanges(const std::vector<core::FoundStep>& steps, const ContactHistory& history)
{
  std::vector<StepPart> parts;
  for (const core::FoundStep& step : steps)
  {
    StepPart rest{step};
    for (const DatedContact& dated : history.contacts())
    {
      if (dated.seq > rest.step.first && dated.seq < rest.step.last)
      {
        rest.cut = true;
        parts.push_back(rest);
        parts.back().step.last = rest.step.first = dated.seq;
      }
    }
    parts.push_back(rest);
  }
  return parts;
}

void requireNoLoss(const RecordingSummary& summary)
{
  constexpr std::size_t shown = 3;
  std::string reasons;
  for (std::size_t i = 0; i < std::min(shown, summary.losses.size()); ++i)
  {
    reasons += (i == 0 ? "" : "; ") + summary.losses[i].reason;
  }
  if (summary.losses.size() > shown)
  {
    reasons += "; and " + std::to_string(summary.losses.size() - shown) + " more losses";
  }
  if (!reasons.empty())
  {
    throw config::Error("the recording is not complete: " + reasons +
                        " (--allow-gaps leaves the steps out where something is missing)");
  }
}

// Reads the excitation once more.
void readAgain(const RecordedRun& recording, core::DriveStepMeter& meter, const RecordedRun::Progress& progress)
{
  std::uint64_t next = 0;
  recording.readExcitation(
      [&](const BaseExcitation& block)
      {
        // Repetitions have been found to be just that.
        if (block.seq >= next)
        {
          meter.add(block.seq, block.acceleration.data(), block.acceleration.size());
          next = block.seq + block.acceleration.size();
        }
      },
      progress);
}

// The first loss that touches a step.
const Loss* lossIn(const core::MeasuredStep& step, const std::vector<Loss>& losses, double sample_period)
{
  const double margin = spoilt_cycles * two_pi / (step.fit.frequency * sample_period);
  for (const Loss& loss : losses)
  {
    if (static_cast<double>(loss.first) <= static_cast<double>(step.last) + margin &&
        static_cast<double>(step.first) <= static_cast<double>(loss.last) + margin)
    {
      return &loss;
    }
  }
  return nullptr;
}

std::vector<core::TimedImpact> within(const std::vector<core::TimedImpact>& impacts, const core::DriveStep& step)
{
  const auto before = [](const core::TimedImpact& impact, double time) { return impact.onset < time; };
  return {std::lower_bound(impacts.begin(), impacts.end(), step.start, before),
          std::lower_bound(impacts.begin(), impacts.end(), step.end, before)};
}
}  // namespace

Extraction extractResponses(const RecordedRun& recording, const ExtractionOptions& options,
                            const RecordedRun::Progress& progress)
{
  Survey survey(recording.topics(), options.steps);
  recording.read(survey,
                 [&](double share)
                 {
                   if (progress)
                   {
                     progress(first_reading * share);
                   }
                 });
  Extraction extraction;
  extraction.recording = survey.summary();
  const RecordingSummary& summary = extraction.recording;
  if (!options.allow_gaps)
  {
    requireNoLoss(summary);
  }
  const ContactHistory& history = survey.contacts();
  const core::ReferenceScales scales = core::referenceScales(history.parameters());
  for (const DatedContact& dated : history.contacts())
  {
    extraction.contacts.push_back({dated, 0});
  }
  const auto cycles = [&](const core::FoundStep& step)
  { return static_cast<double>(step.last - step.first) * summary.sample_period * step.frequency / two_pi; };
  // Never rounded up to as many as a step has.
  const auto digits = [](double value) { return std::floor(100.0 * value) / 100.0; };
  std::vector<core::FoundStep> found;
  std::uint64_t covered = 0;
  for (const auto& [part, cut] : cutAtChanges(survey.steps(), history))
  {
    covered += part.last - part.first;
    if (cycles(part) >= options.steps.shortest_step)
    {
      found.push_back(part);
    }
    else
    {
      extraction.left_out.push_back({part.frequency / scales.frequency, part.first, part.last,
                                     text(cut ? "changes of the contact leave " : "has ", digits(cycles(part)),
                                          " cycles, a step has at least ", options.steps.shortest_step)});
    }
  }
  extraction.covered = static_cast<double>(covered) / static_cast<double>(std::max<std::uint64_t>(summary.samples, 1));
  const auto tell = [&](double share)
  {
    if (progress)
    {
      progress(first_reading + (1.0 - first_reading) * share);
    }
  };
  const auto steps =
      survey.search().measure(found, [&](core::DriveStepMeter& meter) { readAgain(recording, meter, tell); });
  tell(1.0);
  if (steps.empty() && extraction.left_out.empty())
  {
    throw config::Error("topic " + recording.topics().base_excitation +
                        ": no steps of constant frequency found in its " + std::to_string(summary.samples) +
                        " samples (a swept sine has none)");
  }

  const auto impacts = survey.impacts(summary.sample_period);
  for (const core::MeasuredStep& measured : steps)
  {
    core::DriveStep step = core::driveStep(measured, summary.sample_period);
    if (const Loss* loss = lossIn(measured, summary.losses, summary.sample_period))
    {
      extraction.left_out.push_back({step.frequency / scales.frequency, measured.first, measured.last, loss->reason});
      continue;
    }
    const DatedContact& dated = history.at(measured.first);
    step.contact = dated.contact;
    step.contact_share = survey.trace().share(measured.first + (measured.last - measured.first) / 2, measured.last);
    ++extraction.contacts[static_cast<std::size_t>(&dated - history.contacts().data())].responses;
    extraction.responses.push_back(core::evaluateResponse(step, within(impacts, step), scales, options.response));
  }
  if (extraction.responses.empty())
  {
    throw config::Error("no step is left: all " + std::to_string(extraction.left_out.size()) +
                        " are left out, the first: " + extraction.left_out.front().reason);
  }
  return extraction;
}

}  // namespace vibro_impact::graph
