"""A run as its recording tells it: samples, steps of the drive with their responses, integrity."""

from collections import namedtuple

import numpy as np

import vibro_impact
from vibro_impact.report import segments as parts
from vibro_impact.report import spectra

# Lines that share the power of a random drive in a segment, at least (spectra.spectral_lines); a sweep has no more than
# half as many.
RANDOM_LINES = 12.0
# A random drive is there most of the time, a shock is not.
RANDOM_SHARE = 0.5
# Share of the samples that steps must cover: noise holds stretches that look like a few cycles of a sine.
STEPPED_SHARE = 0.5
# What a drive can be, by --drive.
DRIVES = ("steps", "random", "other")

# recording; segments; captured: for each segment the impacts that made its response; star: I* over an impulse in N s;
# drive: one of DRIVES, the segments are the steps of a drive of steps; told: whether the user has said so;
# without_steps: why there are no steps; left_out: steps that were not evaluated; replay, replay_error: what came of the
# replay check; spectral_lines: how the drive was judged, None of a drive of steps and where it could not be; suffix:
# how labels call the run
Run = namedtuple(
    "Run",
    "bags recording segments captured star drive told without_steps left_out replay replay_error spectral_lines suffix",
)


def captured_of(responses, impacts, first_time):
    """The captured impacts of each response, their onset counted from `first_time` in s: `impacts` has them one after
    the other."""
    impacts["onset_s"] -= first_time
    ends = np.cumsum(responses["impacts"]).astype(int)
    return [impacts[end - int(row["impacts"]) : end] for end, row in zip(ends, responses)]


def impulse_scale(responses):
    """I* over the impulse in N s, the same for all; 0 where there is no impact."""
    greatest = responses[np.argmax(responses["impulse_mean"])]
    return float(greatest["impulse_star_mean"] / greatest["impulse_mean"]) if greatest["impulse_mean"] > 0.0 else 0.0


def is_random(lines):
    """Whether a signal with these spectra.SpectralLines is random."""
    return lines is not None and lines.lines > RANDOM_LINES and lines.loud >= RANDOM_SHARE


def read(bags, namespace, excitation, replay, suffix, drive, stage):
    """Reads one run. `drive`: what its drive is, one of DRIVES; None: to be found out. `stage` is called with what is
    being done."""
    stage("reading " + " ".join(bags))
    recording = vibro_impact.read_bag(bags, namespace=namespace, excitation=excitation)
    stage("finding the steps of the drive")
    found, without_steps = None, ""
    if drive in (None, "steps"):
        try:
            found = vibro_impact.extract_responses(bags, allow_gaps=True, namespace=namespace, excitation=excitation)
        except vibro_impact.Error as error:
            if drive:
                raise vibro_impact.Error("--drive: is steps, but there are none: %s" % error)
            without_steps = str(error)
        if not drive and found and found.covered <= STEPPED_SHARE:
            without_steps = "steps cover only %.2g %% of the samples" % (100.0 * found.covered)
            found = None
    else:
        without_steps = "the drive was said to be %s (--drive)" % drive
    lines = None
    if found:
        kind = "steps"
        segments = parts.of_steps(found.steps, found.responses, recording)
        captured = captured_of(found.responses, found.impacts, recording.first * recording.sample_period)
        star = impulse_scale(found.responses)
        left_out = found.left_out
    else:
        lines = spectra.spectral_lines(recording.acceleration, recording.sample_period)
        kind = drive or ("random" if is_random(lines) else "other")
        segments = parts.equal_parts(recording)
        captured, star, left_out = [], 0.0, []
    report, replay_error = None, "The replay check was left out (--no-replay)."
    if replay:
        stage("recomputing the recording")
        try:
            report, replay_error = vibro_impact.check_replay(bags, namespace=namespace, excitation=excitation), ""
        except vibro_impact.Error as error:
            replay_error = str(error)
    return Run(
        bags,
        recording,
        segments,
        captured,
        star,
        kind,
        bool(drive),
        without_steps,
        left_out,
        report,
        replay_error,
        lines,
        suffix,
    )
