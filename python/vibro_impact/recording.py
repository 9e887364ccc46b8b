"""A recording in NumPy arrays."""

import functools
import os

import numpy

from vibro_impact import _recording


class Recording:
    """A run as it was recorded, its blocks joined on one axis of samples.

    acceleration, gap, contact_force   of the base (m/s^2), between the surfaces (m), in the contact (N): float64, one
                    value a sample, NaN where it is lost
    time            of the samples, s: 0 at the first one
    sample_period   s
    first           number of the first sample in the stream that was recorded
    start_stamp     time stamp of the first sample: (seconds, nanoseconds)
    impacts         structured array, one element an impact, in the order of recording: number, onset (s on the axis of
                    time, located between the samples), duration (s), impulse (N s), peak_force (N), peak_time (s from
                    the onset), approach_speed, separation_speed (m/s), energy_lost (J), cut_short, dissipated,
                    mapping_loss, base_work (J)
    losses          list of (first sample, sample after the last one, what is missing), numbers as those of the stream
    models          list of what the simulator computed with, from sample `seq` on: version, configuration (YAML text),
                    free_frequencies, contact_frequencies (Hz), mapping_loss, seq, number
    starts          list of the starts from rest: (number of the sample, cause, reason); cause is 'first', 'rule',
                    'reset' or 'pause'
    topics          names of the topics by quantity: base_excitation, gap, contact_force, impact, model_info,
                    stream_start; empty where there is none
    summary         blocks, samples, repeated (blocks recorded twice, left out), impacts, restarts (of the simulation)
    """

    def __init__(self, joined):
        self.acceleration = joined.acceleration
        self.gap = joined.gap
        self.contact_force = joined.contact_force
        self.sample_period = joined.sample_period
        self.first = joined.first
        self.start_stamp = joined.start_stamp
        self.impacts = joined.impacts
        self.losses = joined.losses
        self.models = joined.models
        self.starts = joined.starts
        self.topics = joined.topics
        self.summary = joined.summary

    @functools.cached_property
    def time(self):
        """Of the samples, s: 0 at the first one."""
        axis = numpy.arange(len(self.acceleration), dtype=float)
        axis *= self.sample_period
        return axis

    def __repr__(self):
        return "<Recording: %d samples of %g s, %d impacts, %d losses>" % (
            len(self.acceleration),
            self.sample_period,
            len(self.impacts),
            len(self.losses),
        )


def bag_paths(bags):
    """The list of paths that one path or a list of them means, as bytes, for a name need not be text; a path is a
    string, bytes or an os.PathLike."""
    one = isinstance(bags, (str, bytes, os.PathLike))
    return [os.fsencode(path) for path in ([bags] if one else bags)]


def name_of(topic):
    """The name of a topic or a name space as bytes; what is not UTF-8 is not found, and said to be so."""
    return os.fsencode(topic)


def read_bag(bags, namespace="", excitation="", stream=None, progress=None):
    """Reads a recording: a bag, or the list of the bags of a split one. Returns a Recording.

    namespace    the run to take from a recording of several, such as "/rig1"
    excitation   the topic of the excitation, where several are recorded
    stream       which of the streams to take (0, 1, ...) where the excitation restarts, jumps in time or changes its
                 period: these have no common axis of samples, so that without this argument they are refused
    progress     a function called with the share read, from 0 to 1, every 50 ms

    Raises vibro_impact.Error if a bag is missing, damaged or holds no run.
    """
    return Recording(_recording.read(bag_paths(bags), name_of(namespace), name_of(excitation), stream, progress))


def extract_responses(
    bags,
    allow_gaps=False,
    namespace="",
    excitation="",
    acceleration_tolerance=0.1,
    shortest_step=4,
    lowest_frequency=1.0,
    progress=None,
):
    """The frequency response in the recording of a stepped-sine run, as the tool extract_frf finds it.

    bags, namespace, excitation, progress   as in read_bag()
    allow_gaps               leave out the steps where something is missing, rather than refuse the recording
    acceleration_tolerance   how far the amplitude of a cycle may be off that of its step, relative
    shortest_step            drive cycles that make a step
    lowest_frequency         of a drive to look for, Hz

    Returns an object with responses and impacts (structured arrays with the columns of frf.csv and impacts.csv), steps
    (list of the (start, end) of each response's step in s from sample 0 of the stream),
    left_out (list of (omega_star, first sample, sample after the last one, reason)), covered (share of the samples that
    belongs to steps, those left out included: where it is small, the drive may have none), contacts (list of (first
    sample, stiffness in N/m, clearance in m, number of responses)), losses and summary (as of a Recording). Raises
    vibro_impact.Error where it cannot give a response.
    """
    return _recording.extract(
        bag_paths(bags),
        name_of(namespace),
        name_of(excitation),
        allow_gaps,
        acceleration_tolerance,
        shortest_step,
        lowest_frequency,
        progress,
    )


def check_replay(
    bags,
    namespace="",
    excitation="",
    max_acceleration=1.0e5,
    max_bridged_gap=0.02,
    max_step_back=0.1,
    max_stamp_jitter=0.05,
    progress=None,
):
    """Recomputes a recording from its excitation and its configuration and compares every bit, as replay_check does.

    bags, namespace, excitation, progress   as in read_bag()
    max_acceleration (m/s^2), max_bridged_gap, max_step_back, max_stamp_jitter (s)   of the simulator recorded

    Returns an object with difference (None, or topic, place, field, recorded and recomputed of the first one),
    complete (whether everything could be compared), what is identical (blocks, samples, impacts), what the stream did
    (starts, unannounced, bridged, refused, not_taken, contact_changes) and what was not compared (losses,
    impacts_not_compared). Raises vibro_impact.Error if the recording is damaged or holds no configuration.
    """
    return _recording.check(
        bag_paths(bags),
        name_of(namespace),
        name_of(excitation),
        max_acceleration,
        max_bridged_gap,
        max_step_back,
        max_stamp_jitter,
        progress,
    )
