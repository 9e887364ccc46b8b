#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "vibro_impact/core/drive_steps.h"
#include "vibro_impact/core/response.h"
#include "vibro_impact/ros/contact_history.h"
#include "vibro_impact/ros/recorded_run.h"
#include "vibro_impact/ros/recording_check.h"

namespace vibro_impact::graph
{
struct ExtractionOptions
{
  bool allow_gaps = false;        ///< leave steps out where something is missing, rather than refuse the recording
  core::StepSearchOptions steps;  ///< what counts as a step of the drive
  core::ResponseOptions response;
};

/// A step of the drive, or the part of one under one contact, that is not evaluated because of a loss, or because it
/// has too few cycles, as those that a change of the contact has left of it.
struct LeftOutStep
{
  double omega_star = 0.0;  ///< drive frequency over the lowest natural frequency of beam 1, 1
  std::uint64_t first = 0;  ///< number of its first sample
  std::uint64_t last = 0;   ///< number of the sample after its last one
  std::string reason;       ///< the loss, or how many cycles there are
};

/// A contact of the recording and its share of the responses.
struct ContactSpan
{
  DatedContact from;
  std::size_t responses = 0;  ///< so many, after those of the contact before
};

/// The frequency response that a recording holds. The time axis is that of the stream: sample 0 at 0 s.
struct Extraction
{
  RecordingSummary recording;
  std::vector<core::Response> responses;  ///< one per step and contact, in order of time
  std::vector<ContactSpan> contacts;      ///< in order of time, at least one
  std::vector<LeftOutStep> left_out;
  double covered = 0.0;  ///< share of the samples that belongs to steps, those left out included
};

/// Reads a recording, a long one twice: for what it holds and the steps of its drive, and for the exact frequencies of
/// these.
/// A step in which the contact changes is cut there, and each part of it evaluated by itself. Throws config::Error, in
/// one message, where it cannot give a response: see RecordingCheck; something is missing and gaps are not allowed; no
/// model_info, or several that differ in more than the contact; no step of constant frequency; no step left.
Extraction extractResponses(const RecordedRun& recording, const ExtractionOptions& options,
                            const RecordedRun::Progress& progress = {});

}  // namespace vibro_impact::graph
