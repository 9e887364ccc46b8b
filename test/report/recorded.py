"""Bags of runs that the core computes, as shaker, simulator and rosbag leave them."""

import os
import subprocess
import sys
import tempfile

import numpy
import rosbag
import rospy

import vibro_impact
from vibro_impact.msg import BaseExcitation, ContactForce, Gap, Impact, ModelInfo, StreamStart

CONFIG = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "config")
WRITE_SIGNAL = [path for path in sys.argv[1:] if os.path.basename(path) == "write_signal"]

PERIOD = 2.0e-5
BLOCK = 500
START = rospy.Time(1600000000, 250000000)

BEAM = "{youngs_modulus: %r, density: 954.0, length: 0.0529, height: 0.00127, width: 0.0127, contact_location: 0.02645}"
FREQUENCY = 271.45727650517387  # of beam 1, Hz


def configuration(clearance=0.0, damping=0.01):
    """Two beams at midspan, the second a thousand times stiffer; the default basis."""
    return (
        "beam1: %s\nbeam2: %s\ncontact: {stiffness: 24309.426302924, clearance: %r}\ndamping: {free: %r, contact:"
        " 0.05}\n"
        % (
            BEAM % 1.66e9,
            BEAM % 1.66e12,
            clearance,
            damping,
        )
    )


def stepped_sine(omega_stars, cycles, acceleration=10.0):
    """Samples of steps of a sine, their phase continuous."""
    parts = []
    phase = 0.0
    for omega_star in omega_stars:
        frequency = omega_star * FREQUENCY
        count = int(round(cycles / (frequency * PERIOD)))
        parts.append(acceleration * numpy.sin(phase + 2.0 * numpy.pi * frequency * PERIOD * numpy.arange(count)))
        phase += 2.0 * numpy.pi * frequency * PERIOD * count
    return numpy.concatenate(parts)


def random_drive(duration, deviation=10.0, seed=1):
    """White noise of Gaussian samples, m/s^2."""
    return deviation * numpy.random.RandomState(seed).standard_normal(int(round(duration / PERIOD)))


def shipped_signal(name, duration=None):
    """(samples, sample period) of a signal of config/excitation; `duration`: another length of it, s. The program's
    argument is the tool write_signal."""
    with open(os.path.join(CONFIG, "excitation", name + ".yaml"), encoding="utf-8") as file:
        text = file.read()
    if duration:
        changed = text.replace("duration: 600.0", "duration: %r" % duration)
        assert changed != text, name
        text = changed
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "signal.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        subprocess.run([WRITE_SIGNAL[0], path, "--out", folder], check=True, stdout=subprocess.DEVNULL)
        table = numpy.loadtxt(os.path.join(folder, "signal.csv"), delimiter=",", skiprows=1)
    return table[:, 1], float(table[1, 0] - table[0, 0])


def stamp_of(seconds):
    return START + rospy.Duration.from_sec(seconds)


def write_bag(
    path,
    configuration_text,
    acceleration,
    lost_blocks=(),
    lost_forces=(),
    restarts=(),
    contacts=(),
    damping=0.01,
    period=PERIOD,
):
    """What the simulator answers to `acceleration`, samples `period` s apart, and its impacts, in a bag.

    lost_blocks, lost_forces   numbers of blocks of the gap and of the contact force that are not in it
    restarts                   samples at which a start from rest is told, without one
    contacts                   dictionary of clearances that are told, without effect, by their first samples; with each
                               a configuration() of this damping ratio
    """
    model = vibro_impact.Model(configuration_text)
    simulation = model.simulation(period)

    def header(stamp):
        message = Gap().header
        message.stamp = stamp
        message.frame_id = "base_frame"
        return message

    with rosbag.Bag(path, "w") as bag:
        info = ModelInfo(
            version="0.1.0",
            configuration=model.configuration,
            free_frequencies=model.free_frequencies,
            contact_frequencies=model.contact_frequencies,
            mapping_loss=model.mapping_loss,
        )
        bag.write("/model_info", info, START)
        for seq, cause in [(0, StreamStart.FIRST), *((seq, StreamStart.RESET) for seq in restarts)]:
            stamp = stamp_of(seq * period)
            start = StreamStart(header=header(stamp), seq=seq, sample_period=period, cause=cause)
            bag.write("/stream_start", start, stamp)

        for number, (seq, clearance) in enumerate(sorted(dict(contacts).items())):
            text = vibro_impact.Model(configuration(clearance, damping)).configuration
            stamp = stamp_of(seq * period)
            info = ModelInfo(header=header(stamp), version="0.1.0", configuration=text, seq=seq, number=number + 1)
            bag.write("/model_info", info, stamp)

        def record(impacts, time):
            for impact in impacts:
                sample = int(numpy.floor(impact["onset"] / period))
                message = Impact(
                    header=header(stamp_of(impact["onset"])), seq=sample, offset=impact["onset"] - sample * period
                )
                for field in impact.dtype.names:
                    if field != "onset":
                        setattr(message, field, impact[field].item())
                bag.write("/impact", message, time)

        for number, first in enumerate(range(0, len(acceleration), BLOCK)):
            samples = acceleration[first : first + BLOCK]
            gap, force, impacts = simulation.advance(samples)
            time = stamp_of(first * period)
            head = dict(header=header(time), seq=first, sample_period=period)
            bag.write("/base_excitation", BaseExcitation(acceleration=samples, **head), time)
            if number not in lost_blocks:
                bag.write("/gap", Gap(gap=gap, **head), time)
            if number not in lost_forces:
                bag.write("/contact_force", ContactForce(force=force, **head), time)
            record(impacts, time)
        record(simulation.finish(), stamp_of(len(acceleration) * period))
