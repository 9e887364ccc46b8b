#include "vibro_impact/config/simulated_run.h"

#include <algorithm>

#include "table.h"
#include "vibro_impact/core/harmonic_simulation.h"
#include "vibro_impact/core/response.h"
#include "vibro_impact/core/simulation.h"

namespace vibro_impact::config
{
namespace
{
constexpr double two_pi = 6.28318530717958647693;

const std::vector<Column<HistoryRow>> history_columns = {
    {"time", &HistoryRow::time},
    {"acceleration", &HistoryRow::acceleration},
    {"gap", &HistoryRow::gap},
    {"gap_velocity", &HistoryRow::gap_velocity},
    {"force", &HistoryRow::force},
    {"in_contact", &HistoryRow::in_contact},
    {"energy_structure1", &HistoryRow::energy_structure1},
    {"energy_structure2", &HistoryRow::energy_structure2},
    {"energy_spring", &HistoryRow::energy_spring},
    {"energy_left_out", &HistoryRow::energy_left_out},
    {"base_work", &HistoryRow::base_work},
    {"contact_work", &HistoryRow::contact_work},
    {"dissipated_free", &HistoryRow::dissipated_free},
    {"dissipated_contact", &HistoryRow::dissipated_contact},
    {"mapping_loss", &HistoryRow::mapping_loss},
    {"energy_residual", &HistoryRow::energy_residual},
};

const std::vector<Column<SimulatedImpactRow>> impact_columns = {
    {"omega_star", &SimulatedImpactRow::omega_star},
    {"number", &SimulatedImpactRow::number},
    {"onset_s", &SimulatedImpactRow::onset_s},
    {"duration_s", &SimulatedImpactRow::duration_s},
    {"impulse", &SimulatedImpactRow::impulse},
    {"peak_force", &SimulatedImpactRow::peak_force},
    {"approach_speed", &SimulatedImpactRow::approach_speed},
    {"separation_speed", &SimulatedImpactRow::separation_speed},
    {"cut_short", &SimulatedImpactRow::cut_short},
    {"energy_lost", &SimulatedImpactRow::energy_lost},
    {"dissipated", &SimulatedImpactRow::dissipated},
    {"mapping_loss", &SimulatedImpactRow::mapping_loss},
    {"base_work", &SimulatedImpactRow::base_work},
};

OutputFile summaryTable(const SimulatedRun& run)
{
  std::string text = "key,value\n";
  const auto add = [&text](const std::string& key, const std::optional<double>& value)
  {
    if (value)
    {
      text += key + "," + formatNumber(*value) + "\n";
    }
  };
  add("drive_frequency_hz", run.frequency_hz);
  add("omega_star", run.omega_star);
  add("acceleration", run.amplitude);
  if (run.period)
  {
    text += "period," + std::to_string(*run.period) + "\n";
  }
  add("history_step_s", run.step);
  add("energy_initial", run.energy.initial);
  add("energy_structure1", run.energy.structure1);
  add("energy_structure2", run.energy.structure2);
  add("energy_spring", run.energy.spring);
  add("energy_left_out", run.energy.left_out);
  add("base_work", run.energy.work);
  add("contact_work", run.energy.contact_work);
  add("dissipated_free", run.energy.dissipated_free);
  add("dissipated_contact", run.energy.dissipated_contact);
  add("mapping_loss", run.energy.mapping_loss);
  add("energy_closure", run.energy.closure());
  return {"run.csv", text};
}

int periodOf(const SimulatedRun& run, const core::SwitchedModel& model, double end)
{
  std::vector<core::TimedImpact> impacts;
  for (const SimulatedImpactRow& row : run.impacts)
  {
    core::TimedImpact timed;
    timed.onset = row.onset_s;
    timed.impact.impulse = row.impulse;
    timed.impact.cut_short = row.cut_short;
    impacts.push_back(timed);
  }
  return core::evaluateResponse({two_pi * *run.frequency_hz, *run.amplitude, 0.0, end}, impacts, model.scales())
      .row.period;
}

}  // namespace

void RunRecorder::begin(double offset, double interval)
{
  offset_ = offset;
  interval_ = interval;
}

void RunRecorder::onSample(const core::HistorySample& sample)
{
  HistoryRow row;
  row.time = offset_ + sample.time;
  run.energy = sample.energy;
  if (row.time < selection_.from || seen_++ % selection_.every != 0)
  {
    return;
  }
  if (run.history.size() >= selection_.longest)
  {
    throw Error("history.csv would have more than " + std::to_string(selection_.longest) +
                " rows: let it begin later or take fewer samples");
  }
  row.acceleration = sample.acceleration;
  row.gap = sample.gap;
  row.gap_velocity = sample.gap_velocity;
  row.force = sample.force;
  row.in_contact = sample.in_contact;
  row.energy_structure1 = sample.energy.structure1;
  row.energy_structure2 = sample.energy.structure2;
  row.energy_spring = sample.energy.spring;
  row.energy_left_out = sample.energy.left_out;
  row.base_work = sample.energy.work;
  row.contact_work = sample.energy.contact_work;
  row.dissipated_free = sample.energy.dissipated_free;
  row.dissipated_contact = sample.energy.dissipated_contact;
  row.mapping_loss = sample.energy.mapping_loss;
  row.energy_residual = sample.energy.residual();
  run.history.push_back(row);
}

void RunRecorder::onImpact(const core::Impact& impact)
{
  SimulatedImpactRow row;
  row.omega_star = run.omega_star.value_or(0.0);
  row.number = impact.number;
  row.onset_s = offset_ + (static_cast<double>(impact.interval) * interval_ + impact.offset);
  row.duration_s = impact.duration;
  row.impulse = impact.impulse;
  row.peak_force = impact.peak_force;
  row.approach_speed = impact.approach_speed;
  row.separation_speed = impact.separation_speed;
  row.cut_short = impact.cut_short;
  row.energy_lost = impact.energy_lost;
  row.dissipated = impact.dissipated;
  row.mapping_loss = impact.mapping_loss;
  row.base_work = impact.base_work;
  run.impacts.push_back(row);
}

double omegaStar(double frequency_hz, const core::SwitchedModel& model)
{
  return two_pi * frequency_hz / model.scales().frequency;
}

SimulatedRun simulateHarmonic(const std::shared_ptr<const core::SwitchedModel>& model,
                              const HarmonicRunOptions& options, const std::optional<core::InitialMotion>& initial,
                              const HistorySelection& history, const RunProgress& progress)
{
  const double frequency = options.omega_star * model->scales().frequency;
  const double cycle = two_pi / frequency;
  core::HarmonicSimulation simulation(model);
  if (initial)
  {
    simulation.start(*initial);
  }
  simulation.setDrive(frequency, options.acceleration);

  RunRecorder recorder(history);
  recorder.run.omega_star = options.omega_star;
  recorder.run.frequency_hz = frequency / two_pi;
  recorder.run.amplitude = options.acceleration;
  recorder.run.step = cycle / static_cast<double>(options.samples_per_cycle) * static_cast<double>(history.every);
  recorder.begin(0.0, cycle);
  recorder.onSample(simulation.sample());
  std::vector<core::HistorySample> samples(options.samples_per_cycle);
  for (std::uint64_t i = 0; i < options.cycles; ++i)
  {
    simulation.advance(1, recorder, samples.size(), samples.data());
    for (const core::HistorySample& sample : samples)
    {
      recorder.onSample(sample);
    }
    progress(static_cast<double>(i + 1) / static_cast<double>(options.cycles));
  }
  simulation.finish(recorder);
  recorder.run.period = periodOf(recorder.run, *model, simulation.time());
  return std::move(recorder.run);
}

SimulatedRun simulateSampled(const std::shared_ptr<const core::SwitchedModel>& model,
                             const SampledExcitation& excitation, const std::optional<core::InitialMotion>& initial,
                             const HistorySelection& history, const RunProgress& progress)
{
  constexpr std::size_t samples_per_report = 10000;
  core::SampledSimulation simulation(model, excitation.sample_period);
  RunRecorder recorder(history);
  recorder.run.step = excitation.sample_period * static_cast<double>(history.every);
  recorder.begin(excitation.start, excitation.sample_period);
  if (initial)
  {
    simulation.start(*initial, recorder);
    recorder.run.impacts.clear();  // what is cut short before anything moves is no impact
  }
  const std::size_t count = excitation.acceleration.size();
  for (std::size_t i = 0; i < count; ++i)
  {
    double gap = 0.0;
    double force = 0.0;
    simulation.advance(&excitation.acceleration[i], 1, &gap, &force, recorder);
    recorder.onSample(simulation.sample());
    if ((i + 1) % samples_per_report == 0 || i + 1 == count)
    {
      progress(static_cast<double>(i + 1) / static_cast<double>(count));
    }
  }
  simulation.finish(recorder);
  return std::move(recorder.run);
}

std::vector<OutputFile> runTables(const SimulatedRun& run)
{
  return {{"history.csv", writeTable(history_columns, run.history)},
          {"impacts.csv", writeTable(impact_columns, run.impacts)},
          summaryTable(run)};
}

}  // namespace vibro_impact::config
