"""A run as its recording tells it: samples, steps of the drive with their responses, integrity."""

from collections import namedtuple

import numpy as np

import vibro_impact
from vibro_impact.report import segments as parts
from vibro_impact.report import spectra

# Lines that share the power of a random drive, at least, and of a sine or a slow sweep, at most, in a segment of 4096
# samples.
RANDOM_LINES = 16.0

# recording; segments; captured: for each segment the impacts that made its response; star: I* over an impulse in N s;
# stepped: whether the segments are steps of the drive; without_steps: why they are not; left_out: steps that were not
# evaluated; replay, replay_error: what came of the replay check; drive_lines: how many spectral lines share the drive's
# power; suffix: how labels call the run
Run = namedtuple(
    "Run", "bags recording segments captured star stepped without_steps left_out replay replay_error drive_lines suffix"
)


def is_random(run):
    return not run.stepped and run.drive_lines is not None and run.drive_lines > RANDOM_LINES


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


def read(bags, namespace, excitation, replay, suffix, stage):
    """Reads one run. `stage` is called with what is being done."""
    stage("reading " + " ".join(bags))
    recording = vibro_impact.read_bag(bags, namespace=namespace, excitation=excitation)
    stage("finding the steps of the drive")
    drive_lines = spectra.spectral_lines(recording.acceleration)
    left_out = []
    without_steps = ""
    try:
        found = vibro_impact.extract_responses(bags, allow_gaps=True, namespace=namespace, excitation=excitation)
        segments = parts.of_steps(found.steps, found.responses, recording)
        captured = captured_of(found.responses, found.impacts, recording.first * recording.sample_period)
        star = impulse_scale(found.responses)
        left_out = found.left_out
    except vibro_impact.Error as error:
        without_steps = str(error)
        segments = parts.equal_parts(recording)
        captured, star = [], 0.0
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
        not without_steps,
        without_steps,
        left_out,
        report,
        replay_error,
        drive_lines,
        suffix,
    )
