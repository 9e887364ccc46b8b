#include "vibro_impact/core/wear_feedback.h"

#include <algorithm>

namespace vibro_impact::core
{
void WearFeedback::hold(const ContactParameters& contact, bool unworn)
{
  contact_ = contact;
  waiting_ = false;
  if (unworn)
  {
    request_.reset();
    unworn_ = contact.clearance;
    handed_over_ = 0.0;
    return;
  }
  if (request_ && contact.clearance == request_->contact.clearance)
  {
    unworn_ = request_->unworn;
    handed_over_ = request_->depth;
    request_.reset();
    ++taken_;
    return;
  }
  unworn_ = contact.clearance - handed_over_;
}

std::optional<ContactParameters> WearFeedback::ask(StreamTime time, double depth)
{
  // Time that has gone back is another stream's.
  const bool too_soon = last_time_ && time >= *last_time_ && time - *last_time_ < limits_.interval;
  if (!contact_ || waiting_ || too_soon)
  {
    return std::nullopt;
  }
  const double to_hand_over = std::min(depth, handed_over_ + limits_.greatest_step);
  ContactParameters wanted = *contact_;
  wanted.clearance = unworn_ + to_hand_over;
  if (!(wanted.clearance > contact_->clearance))
  {
    return std::nullopt;
  }
  request_ = Request{wanted, unworn_, to_hand_over};
  waiting_ = true;
  last_time_ = time;
  ++asked_;
  return wanted;
}

void WearFeedback::refuse()
{
  // The request is kept: an answer may be lost on its way when the simulation has taken it.
  waiting_ = false;
  ++refused_;
}

}  // namespace vibro_impact::core
