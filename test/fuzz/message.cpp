// Any sequence of blocks, resets and changes of the contact, from the message that comes in to the messages that go
// out.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <stdexcept>
#include <vector>

#include <fuzzer/FuzzedDataProvider.h>
#include <ros/serialization.h>

#include "require.h"
#include "vibro_impact/core/switched_model.h"
#include "vibro_impact/ros/checked_stream.h"
#include "vibro_impact/ros/conversions.h"
#include "vibro_impact/ros/stream_simulation.h"

namespace core = vibro_impact::core;
namespace graph = vibro_impact::graph;
namespace serialization = ros::serialization;
using graph::StreamSimulation;
using vibro_impact::fuzz::require;
using Action = graph::Verdict::Action;
using Model = std::shared_ptr<const core::SwitchedModel>;

namespace
{
// Ten million samples a second: the shortest period allowed, a nanosecond, is not far, so that no bridge is long.
constexpr double usual_period = 1.0e-7;
constexpr std::int64_t usual_nanoseconds = 100;

graph::StreamLimits limits()
{
  graph::StreamLimits limits;
  limits.max_bridged_gap = 20.0 * usual_period;
  limits.max_step_back = 50.0 * usual_period;
  limits.max_stamp_jitter = 10.0 * usual_period;
  limits.max_cycles_per_sample = 10.0;  // of the usual 0.05; what is simulated at all is simulated at once
  return limits;
}

// One mode of twenty samples a cycle, a few contacts.
Model model(std::size_t contact)
{
  static const auto build = [](double stiffness, double clearance)
  {
    core::SystemParameters parameters;
    parameters.beam1 = core::ModalTableParameters{{5.0e5}, {1.0}, {1.0}, {}, {}};
    parameters.beam2 = core::RigidSurface{};
    parameters.contact = {stiffness, clearance};
    parameters.damping = {0.01, 0.05};
    parameters.basis = core::AttachmentBasis{1};
    return std::make_shared<const core::SwitchedModel>(parameters);
  };
  static const std::vector<Model> models = {build(1.0e+14, 1.0e-9), build(4.0e+14, 0.0), build(1.0e+13, -1.0e-9)};
  return models[contact % models.size()];
}

double anyDouble(FuzzedDataProvider& provider)
{
  const auto bits = provider.ConsumeIntegral<std::uint64_t>();
  double value = 0.0;
  std::memcpy(&value, &bits, sizeof(value));
  return value;
}

bool same(double a, double b)
{
  return std::memcmp(&a, &b, sizeof(a)) == 0;
}

bool same(const std::vector<double>& a, const std::vector<double>& b)
{
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

// As it comes from the wire.
vibro_impact::BaseExcitation transported(const vibro_impact::BaseExcitation& message)
{
  std::vector<std::uint8_t> bytes(serialization::serializationLength(message));
  serialization::OStream output(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  serialization::serialize(output, message);
  vibro_impact::BaseExcitation received;
  graph::CheckedStream input(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  input.next(received);
  require(input.getLength() == 0, "a message is read to its end");
  return received;
}

// Counts the impacts of each stream.
class Counter : public graph::MotionObserver
{
public:
  void onStart(graph::Stamp /*stamp*/, double /*sample_period*/) override
  {
    impacts_ = 0;
  }
  void onSample(const core::HistorySample& sample) override
  {
    require(std::isfinite(sample.gap) && std::isfinite(sample.force), "the motion is finite");
  }
  void onImpact(const core::Impact& impact) override
  {
    require(impact.number == impacts_, "impacts are numbered without a gap");
    ++impacts_;
  }

private:
  std::uint64_t impacts_ = 0;
};

// Two simulations of one stream, of which the second never sees the blocks that are refused, and is observed.
class Run
{
public:
  Run()
  {
    twin_.observe(counter_);
  }

  void advance(const vibro_impact::BaseExcitation& message)
  {
    graph::Samples block;
    graph::fromMessage(transported(message), block);
    require(block.seq == message.seq && same(block.sample_period, message.sample_period) &&
                same(block.values, message.acceleration),
            "transport changes nothing");

    const StreamSimulation::Answer& answer = simulation_.advance(block);
    const graph::Verdict& verdict = answer.verdict;
    if (verdict.action == Action::Refuse)
    {
      require(!verdict.reason.empty(), "a refusal says why");
      require(answer.gap.values.empty() && answer.force.values.empty() && answer.impacts.empty() &&
                  answer.contact_changes.empty(),
              "a refused block has no answer");
      return;
    }
    const bool anew = verdict.action == Action::Start || verdict.action == Action::Restart;
    require(verdict.action == Action::Start ? !started_ : started_, "the first block starts the stream");
    require(anew || block.seq == next_seq_ + verdict.missing, "samples taken and bridged are all there are");
    require((verdict.action == Action::Bridge) == (!anew && verdict.missing > 0), "what is missing is bridged");
    require(verdict.reason.empty() == (verdict.action == Action::Start || verdict.action == Action::Continue),
            "what is out of the ordinary has a reason");
    started_ = true;
    next_seq_ = block.seq + block.values.size();

    for (const graph::Samples* samples : {&answer.gap, &answer.force})
    {
      require(samples->values.size() == block.values.size() && samples->seq == block.seq &&
                  samples->stamp == block.stamp && same(samples->sample_period, block.sample_period),
              "every sample is answered");
      for (const double value : samples->values)
      {
        require(std::isfinite(value), "answers are finite");
      }
    }
    publish(answer);
    compare(answer, twin_.advance(block));
  }

  void reset()
  {
    const StreamSimulation::Answer& answer = simulation_.reset();
    publish(answer);
    started_ = false;
    compare(answer, twin_.reset());
  }

  void setContact(const Model& model, std::uint64_t seq)
  {
    require(taken(simulation_, model, seq) == taken(twin_, model, seq), "a contact is taken or refused by both");
  }

  std::uint64_t nextSeq() const
  {
    return next_seq_;
  }

private:
  static bool taken(StreamSimulation& simulation, const Model& model, std::uint64_t seq)
  {
    try
    {
      simulation.setContact(model, seq);
      return true;
    }
    catch (const std::invalid_argument&)
    {
      return false;
    }
  }

  static void publish(const StreamSimulation::Answer& answer)
  {
    vibro_impact::Gap gap;
    vibro_impact::ContactForce force;
    graph::toMessage(answer.gap, gap);
    graph::toMessage(answer.force, force);
    for (const graph::StampedImpact& impact : answer.impacts)
    {
      vibro_impact::Impact message;
      graph::toMessage(impact, message);
      for (const double value : {message.offset, message.duration, message.impulse, message.peak_force,
                                 message.approach_speed, message.separation_speed, message.energy_lost})
      {
        require(std::isfinite(value), "impacts are finite");
      }
      require(message.duration >= 0.0, "no impact lasts less than nothing");
    }
  }

  static void compare(const StreamSimulation::Answer& a, const StreamSimulation::Answer& b)
  {
    require(a.verdict.action == b.verdict.action, "a refused block leaves the rules as they were");
    require(same(a.gap.values, b.gap.values) && same(a.force.values, b.force.values),
            "a refused block leaves the motion as it was");
    require(a.impacts.size() == b.impacts.size() && a.contact_changes.size() == b.contact_changes.size(),
            "a refused block leaves impacts and contact as they were");
    for (std::size_t i = 0; i < a.impacts.size(); ++i)
    {
      require(a.impacts[i].stamp == b.impacts[i].stamp && a.impacts[i].impact.number == b.impacts[i].impact.number &&
                  same(a.impacts[i].impact.impulse, b.impacts[i].impact.impulse),
              "a refused block leaves the impacts as they were");
    }
  }

  StreamSimulation simulation_{model(0), limits()};
  StreamSimulation twin_{model(0), limits()};
  bool started_ = false;
  std::uint64_t next_seq_ = 0;
  Counter counter_;
};

vibro_impact::BaseExcitation block(FuzzedDataProvider& provider, std::uint64_t expected, std::int64_t& time)
{
  // Each feature in one block of four, so that streams go on now and then.
  const unsigned int unusual = provider.ConsumeIntegral<std::uint8_t>() & provider.ConsumeIntegral<std::uint8_t>();
  vibro_impact::BaseExcitation message;
  message.seq = expected;
  if ((unusual & 1U) != 0)
  {
    message.seq += static_cast<std::uint64_t>(provider.ConsumeIntegral<std::int8_t>());
  }
  if ((unusual & 2U) != 0)
  {
    message.seq = provider.ConsumeIntegral<std::uint64_t>();
  }
  time += static_cast<std::int64_t>(message.seq - expected) % 1000 * usual_nanoseconds;
  if ((unusual & 4U) != 0)
  {
    time += provider.ConsumeIntegral<std::int16_t>();
  }
  message.header.stamp.fromNSec(static_cast<std::uint64_t>(time < 0 ? 0 : time));
  if ((unusual & 8U) != 0)
  {
    message.header.stamp.sec = provider.ConsumeIntegral<std::uint32_t>();
    message.header.stamp.nsec = provider.ConsumeIntegral<std::uint32_t>();
  }
  message.sample_period = usual_period;
  if ((unusual & 16U) != 0)
  {
    message.sample_period = anyDouble(provider);
  }
  if ((unusual & 32U) != 0)
  {
    message.header.frame_id = provider.ConsumeRandomLengthString(8);
  }
  const auto count = provider.ConsumeIntegralInRange<std::size_t>(0, 24);
  for (std::size_t i = 0; i < count; ++i)
  {
    message.acceleration.push_back((unusual & 64U) != 0 ? anyDouble(provider)
                                                        : 1.0e3 * provider.ConsumeIntegral<std::int8_t>());
  }
  time += static_cast<std::int64_t>(count) * usual_nanoseconds;
  return message;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  FuzzedDataProvider provider(data, size);
  Run run;
  std::int64_t time = 1000000000;
  while (provider.remaining_bytes() > 0)
  {
    const auto what = provider.ConsumeIntegral<std::uint8_t>();
    switch (what % 8)
    {
      case 0:
        run.reset();
        break;
      case 1:
      {
        // The next sample, one near it, or any.
        const auto ahead = provider.ConsumeIntegral<std::uint8_t>();
        const std::uint64_t seq =
            ahead == 0 ? 0 : (ahead == 1 ? provider.ConsumeIntegral<std::uint64_t>() : run.nextSeq() + ahead - 2U);
        run.setContact(model(what / 8), seq);
        break;
      }
      default:
        run.advance(block(provider, run.nextSeq(), time));
    }
  }
  return 0;
}
