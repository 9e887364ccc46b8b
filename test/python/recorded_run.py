"""A run of the model itself, written to a bag with rosbag's Python API as shaker and simulator would publish it."""

import math

import numpy
import rosbag
import rospy

from vibro_impact.msg import BaseExcitation, ContactForce, Gap, Impact, ModelInfo, StreamStart

PERIOD = 2.0e-5
BLOCK = 250


def stepped_sine(frequencies, cycles, amplitude):
    """Samples of a sine of `cycles` cycles at each frequency (Hz), its phase continuous."""
    phases, phase = [], 0.0
    for frequency in frequencies:
        count = int(round(cycles / frequency / PERIOD))
        phases.append(phase + 2.0 * math.pi * frequency * PERIOD * numpy.arange(count))
        phase = phases[-1][-1] + 2.0 * math.pi * frequency * PERIOD
    return amplitude * numpy.sin(numpy.concatenate(phases))


def write_run(path, acceleration, model, lost=()):
    """A bag of the run of a model without the excitation blocks of the numbers `lost`."""
    simulation = model.simulation(PERIOD)
    gap, force, impacts = simulation.advance(acceleration)
    start = rospy.Time(1000)

    def head(sample):
        header = Gap().header
        header.stamp = start + rospy.Duration.from_sec(sample * PERIOD)
        return header

    with rosbag.Bag(path, "w") as bag:
        info = ModelInfo(version="0.1.0", configuration=model.configuration, free_frequencies=model.free_frequencies)
        info.contact_frequencies = model.contact_frequencies
        info.mapping_loss = model.mapping_loss
        bag.write("/model_info", info, start)
        bag.write("/stream_start", StreamStart(header=head(0), sample_period=PERIOD), start)
        messages = []
        for first in range(0, len(acceleration), BLOCK):
            part = slice(first, first + BLOCK)
            common = dict(header=head(first), seq=first, sample_period=PERIOD)
            if first not in lost:
                messages.append((first, "/base_excitation", BaseExcitation(acceleration=acceleration[part], **common)))
            messages.append((first, "/gap", Gap(gap=gap[part], **common)))
            messages.append((first, "/contact_force", ContactForce(force=force[part], **common)))
        for impact in impacts:
            sample = int(impact["onset"] // PERIOD)
            offset = impact["onset"] - sample * PERIOD
            values = {name: impact[name].item() for name in impacts.dtype.names if name != "onset"}
            message = Impact(header=head(sample), seq=sample, offset=offset, **values)
            messages.append((sample + 2000, "/impact", message))
        for sample, topic, message in sorted(messages, key=lambda m: m[0]):
            bag.write(topic, message, start + rospy.Duration.from_sec(sample * PERIOD))
    return gap, force, impacts
