#pragma once

#include <string>

#include <ros/time.h>
#include <vibro_impact/BaseExcitation.h>
#include <vibro_impact/ContactForce.h>
#include <vibro_impact/Gap.h>
#include <vibro_impact/Impact.h>
#include <vibro_impact/ModelInfo.h>
#include <vibro_impact/StructureMotion.h>

#include "vibro_impact/core/switched_model.h"
#include "vibro_impact/ros/samples.h"
#include "vibro_impact/ros/stream_simulation.h"

namespace vibro_impact::graph
{
/// The one frame of all messages: contact normal along z, positive as displacement is.
extern const char* const base_frame;

Stamp fromTime(const ros::Time& time);
/// `stamp` must not be negative nor beyond the range of ros::Time.
ros::Time toTime(Stamp stamp);

// Messages to what they mean and back; no value is changed on the way. toMessage() writes every field and reuses the
// memory that the message holds, fromMessage() likewise where it writes into its argument.

void toMessage(const Samples& samples, BaseExcitation& message);
void toMessage(const Samples& samples, Gap& message);
void toMessage(const Samples& samples, ContactForce& message);
void toMessage(const StampedImpact& impact, Impact& message);
/// `model` is the one that moves, `sample_period` (s) that of the stream.
void toMessage(const StreamSimulation::Motion& motion, const core::SwitchedModel& model, double sample_period,
               StructureMotion& message);
/// `configuration` is the YAML text that gives `model`; stamp, seq and number are zero: it holds from the start.
void toMessage(const core::SwitchedModel& model, const std::string& configuration, const std::string& version,
               ModelInfo& message);

void fromMessage(const BaseExcitation& message, Samples& samples);
void fromMessage(const Gap& message, Samples& samples);
void fromMessage(const ContactForce& message, Samples& samples);
StampedImpact fromMessage(const Impact& message);
/// The parameters of the model. Throws config::Error as config::parse() does if the configuration is none.
core::SystemParameters fromMessage(const ModelInfo& message);

}  // namespace vibro_impact::graph
