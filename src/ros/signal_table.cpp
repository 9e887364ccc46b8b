#include "vibro_impact/ros/signal_table.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "text.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/config/number.h"
#include "vibro_impact/core/drive_signal.h"
#include "vibro_impact/ros/progress.h"

namespace vibro_impact::graph
{
namespace
{
constexpr std::uint64_t most_samples = 200'000'000;
constexpr std::uint64_t most_rows = 50'000'000;

// A time that is beside a sample by no more than rounding means it, in samples.
constexpr double sample_tolerance = 1.0e-6;

void requireAtMost(std::uint64_t samples, std::uint64_t most, const std::string& advice)
{
  if (samples > most)
  {
    throw config::Error(text("the signal has ", samples, " samples: at most ", most, " can be held at once; ", advice));
  }
}

// What is said of each family besides the length.
std::string about(const core::SineDwellParameters& parameters, double /*sample_rate*/)
{
  const std::vector<core::SineDwell> dwells = core::sineDwells(parameters);
  const auto [least, greatest] = std::minmax_element(dwells.begin(), dwells.end(),
                                                     [](const core::SineDwell& left, const core::SineDwell& right)
                                                     { return left.acceleration < right.acceleration; });
  return text("\n", dwells.size(), dwells.size() == 1 ? " dwell" : " dwells", " of at least ", parameters.dwell,
              " s, amplitudes ", least->acceleration, " to ", greatest->acceleration, " m/s^2");
}

std::string about(const core::RandomParameters& parameters, double /*sample_rate*/)
{
  return text("\nroot mean square ", core::rootMeanSquare(parameters.spectrum), " m/s^2, seed ", parameters.seed);
}

std::string about(const core::ShockParameters& parameters, double sample_rate)
{
  const std::string velocity =
      parameters.shape == core::ShockShape::terminal_peak_sawtooth
          ? text(core::velocityChange(parameters, sample_rate), " m/s; A T/2 is ", core::velocityChange(parameters),
                 " m/s, the fall from the peak takes a sample")
          : text(core::velocityChange(parameters), " m/s");
  return text("\n", parameters.repetitions,
              parameters.repetitions == 1 ? " pulse, which leaves" : " pulses, each of which leaves",
              " the base with a velocity of ", velocity);
}

template <typename Family>
std::string about(const Family& /*parameters*/, double /*sample_rate*/)
{
  return {};
}

}  // namespace

config::SampledExcitation sampleSignal(const ShakerParameters& parameters)
{
  const auto signal = core::makeDriveSignal(parameters.signal, parameters.sample_rate);
  requireAtMost(signal->samples(), most_samples, "let it be shorter, or its sample_rate lower");
  config::SampledExcitation excitation;
  excitation.sample_period = signal->samplePeriod();
  excitation.acceleration.resize(signal->samples());
  signal->generate(0, excitation.acceleration.size(), excitation.acceleration.data());
  return excitation;
}

std::string signalTable(const ShakerParameters& parameters, double from, double to)
{
  const auto signal = core::makeDriveSignal(parameters.signal, parameters.sample_rate);
  const auto samples = static_cast<double>(signal->samples());
  const double begin = std::clamp(std::ceil(from * signal->sampleRate() - sample_tolerance), 0.0, samples);
  const double end = std::clamp(std::floor(to * signal->sampleRate() + sample_tolerance) + 1.0, begin, samples);
  const auto first = static_cast<std::uint64_t>(begin);
  const auto count = static_cast<std::uint64_t>(end - begin);
  if (count == 0)
  {
    const std::string until = std::isfinite(to) ? text("to ", to, " s") : "on";
    throw config::Error(text("the signal has no sample from ", from, " s ", until, ": it lasts ",
                             samples * signal->samplePeriod(), " s"));
  }
  requireAtMost(count, most_rows, "take a part of it by --from and --to");
  std::vector<double> acceleration(count);
  signal->generate(first, count, acceleration.data());
  std::string table = "time,acceleration\n";
  for (std::uint64_t i = 0; i < count; ++i)
  {
    table += config::formatNumber(static_cast<double>(first + i) * signal->samplePeriod()) + "," +
             config::formatNumber(acceleration[i]) + "\n";
  }
  return table;
}

std::string describeSignal(const ShakerParameters& parameters)
{
  const auto signal = core::makeDriveSignal(parameters.signal, parameters.sample_rate);
  return text(signal->samples(), " samples at ", signal->sampleRate(), " Hz, ",
              toClock(static_cast<double>(signal->samples()) * signal->samplePeriod())) +
         std::visit([&](const auto& family) { return about(family, parameters.sample_rate); }, parameters.signal) +
         (parameters.remark.empty() ? "" : "\n" + parameters.remark);
}

}  // namespace vibro_impact::graph
