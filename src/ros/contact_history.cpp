#include "vibro_impact/ros/contact_history.h"

#include <algorithm>
#include <utility>

#include "text.h"
#include "vibro_impact/config/configuration.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/ros/conversions.h"

namespace vibro_impact::graph
{
namespace
{
std::string withoutContact(core::SystemParameters parameters)
{
  parameters.contact = {};
  return config::toYaml(parameters);
}

bool same(const core::ContactParameters& a, const core::ContactParameters& b)
{
  return a.stiffness == b.stiffness && a.clearance == b.clearance;
}
}  // namespace

ContactHistory::ContactHistory(std::string topic) : topic_(std::move(topic))
{
}

void ContactHistory::add(const ModelInfo& info)
{
  const core::SystemParameters parameters = fromMessage(info);
  if (!parameters_)
  {
    parameters_ = parameters;
    rest_ = withoutContact(parameters);
    first_number_ = number_ = info.number;
    first_seq_ = info.seq;
    contacts_.push_back({0, parameters.contact});
    return;
  }
  const core::ContactParameters& present = contacts_.back().contact;
  if (info.number == number_ && rest_ == withoutContact(parameters) && same(parameters.contact, present))
  {
    return;
  }
  if (info.number <= number_ || rest_ != withoutContact(parameters))
  {
    throw config::Error("topic " + topic_ +
                        ": the configuration changes within the recording, and not by a change of the contact; cut it "
                        "there with 'rosbag filter' and extract the parts one by one");
  }
  if (info.number > number_ + 1)
  {
    const std::uint64_t missing = info.number - number_ - 1;
    losses_.push_back(
        {contacts_.back().seq, info.seq,
         text("topic ", topic_, ": number ", number_ + 1, " to ", info.number - 1, " (", missing,
              missing == 1 ? " change" : " changes", " of the contact before seq ", info.seq, ") is missing")});
  }
  number_ = info.number;
  while (!contacts_.empty() && contacts_.back().seq >= info.seq)
  {
    contacts_.pop_back();
  }
  contacts_.push_back({info.seq, parameters.contact});
  contacts_.front().seq = 0;
}

const core::SystemParameters& ContactHistory::parameters() const
{
  if (!parameters_)
  {
    throw config::Error("topic " + topic_ + ": holds no message");
  }
  return *parameters_;
}

const DatedContact& ContactHistory::at(std::uint64_t seq) const
{
  const auto later =
      std::upper_bound(contacts_.begin(), contacts_.end(), seq,
                       [](std::uint64_t sample, const DatedContact& dated) { return sample < dated.seq; });
  return *(later - 1);
}

std::vector<Loss> ContactHistory::losses(std::uint64_t first) const
{
  std::vector<Loss> all = losses_;
  if (first_number_ > 0 && first_seq_ > first)
  {
    all.push_back({first, first_seq_,
                   text("topic ", topic_, ": what holds before seq ", first_seq_, " (number ", first_number_ - 1,
                        ") is missing")});
  }
  return all;
}

}  // namespace vibro_impact::graph
