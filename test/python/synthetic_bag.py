"""Bags of a run as shaker and simulator would publish it, written with rosbag's Python API, to be spoilt at will."""

import numpy
import rosbag
import rospy

from vibro_impact.msg import BaseExcitation, ContactForce, Gap, Impact, ModelInfo, StreamStart

PERIOD = 2.0e-5
BLOCK = 100
START = rospy.Time(1000, 5000)


def stamp_of(sample, start=START):
    return start + rospy.Duration.from_sec(sample * PERIOD)


class SyntheticBag:
    """Messages by topic, each with its time of recording; every contact is an impact.

    first    number of the first sample
    """

    def __init__(self, blocks=20, first=0, start=START, seed=1):
        random = numpy.random.RandomState(seed)
        count = blocks * BLOCK
        self.first = first
        self.acceleration = random.standard_normal(count)
        self.gap = random.standard_normal(count) * 1.0e-4
        self.force = numpy.zeros(count)
        self.onsets = []  # samples from the first one, with fraction
        self.messages = []
        info = ModelInfo(version="0.1.0", configuration="beam: 1", free_frequencies=[1.0, 2.0], contact_frequencies=[3.0])
        self.add("model_info", info, start)
        self.add("stream_start", StreamStart(header=self.header(start), seq=0, sample_period=PERIOD), start)
        for number, begin in enumerate(range(30, count - BLOCK, 250)):
            self.force[begin : begin + 20] = 5.0 + random.random_sample(20)
            onset = begin - 0.25
            self.onsets.append(onset)
            impact = Impact(
                header=self.header(stamp_of(onset, start)),
                number=number,
                seq=first + begin - 1,
                offset=0.75 * PERIOD,
                duration=20 * PERIOD,
                impulse=0.1 * (number + 1),
                peak_force=6.0,
                peak_time=1.0e-4,
                approach_speed=0.2,
                separation_speed=0.1,
                energy_lost=1.0e-3,
                cut_short=number == 1,
                dissipated=2.0e-3,
                mapping_loss=3.0e-3,
                base_work=4.0e-3,
            )
            self.add("impact", impact, stamp_of(begin + 25, start))
        for begin in range(0, count, BLOCK):
            part = slice(begin, begin + BLOCK)
            head = dict(header=self.header(stamp_of(begin, start)), seq=first + begin, sample_period=PERIOD)
            time = stamp_of(begin, start)
            # A recorder hears of the answer before the question now and then.
            early = rospy.Duration(0, 500000) if begin % 300 == 0 else -rospy.Duration(0, 500000)
            self.add("base_excitation", BaseExcitation(acceleration=self.acceleration[part], **head), time)
            self.add("gap", Gap(gap=self.gap[part], **head), time - early)
            self.add("contact_force", ContactForce(force=self.force[part], **head), time - early)

    @staticmethod
    def header(stamp):
        message = Gap().header
        message.stamp = stamp
        message.frame_id = "base_frame"
        return message

    def add(self, topic, message, time):
        self.messages.append((time, topic, message))

    def drop(self, topic, *seqs):
        """Loses the messages of these numbers."""
        self.messages = [m for m in self.messages if not (m[1] == topic and m[2].seq in seqs)]

    def of(self, topic):
        return [m for m in self.messages if m[1] == topic]

    def write(self, path, namespace="", share=(0.0, 1.0), compression="none", append=False, **options):
        messages = sorted(self.messages, key=lambda m: m[0])
        low, high = (int(round(limit * len(messages))) for limit in share)
        with rosbag.Bag(path, "a" if append else "w", compression=compression, **options) as bag:
            for time, topic, message in messages[low:high]:
                bag.write(namespace + "/" + topic, message, time)


def join_with_rosbag(path, namespace=""):
    """What a user writes without the package: the three signals on their common axis, NaN where lost."""
    parts = {"base_excitation": [], "gap": [], "contact_force": []}
    with rosbag.Bag(path) as bag:
        for topic, message, _ in bag.read_messages(topics=[namespace + "/" + name for name in parts]):
            name = topic.split("/")[-1]
            values = {"base_excitation": "acceleration", "gap": "gap", "contact_force": "force"}[name]
            parts[name].append((message.seq, getattr(message, values)))
    first = parts["base_excitation"][0][0]
    last = max(seq + len(values) for seq, values in parts["base_excitation"])
    joined = {}
    for name, blocks in parts.items():
        joined[name] = numpy.full(last - first, numpy.nan)
        for seq, values in blocks:
            joined[name][seq - first : seq - first + len(values)] = values
    return joined
