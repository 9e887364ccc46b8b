"""A simulator as a process of its own in a namespace of its own, and all that it publishes."""

import math
import os
import threading

import rospkg
import rospy
import yaml
from diagnostic_msgs.msg import DiagnosticArray
from std_srvs.srv import Trigger

from node_process import PATIENCE, is_connected, wait_until
from vibro_impact.msg import BaseExcitation, ContactForce, Gap, Impact, ModelInfo
from vibro_impact.srv import SetContact

PACKAGE = rospkg.RosPack().get_path("vibro_impact")

# Of the sine that a ShakenSimulator is shaken by: s, samples, Hz, m/s^2.
PERIOD = 2e-5
BLOCK = 500
FREQUENCY = 434.33
ACCELERATION = 10.0


def configuration(name, **parameters):
    """A configuration that is shipped, for a node that loses nothing and tells often what it does."""
    with open(os.path.join(PACKAGE, "config", name)) as stream:
        return dict(yaml.safe_load(stream), queue_size=0, diagnostic_period=0.1, **parameters)


def fields(message):
    """All that an impact says, without what roscpp writes into its header."""
    return [str(message.header.stamp)] + [getattr(message, slot) for slot in message.__slots__ if slot != "header"]


def sine_block(seq):
    """Near the resonance of the limiting case: an impact in every cycle."""
    message = BaseExcitation(seq=seq, sample_period=PERIOD)
    message.header.stamp = rospy.Time(1700000000) + rospy.Duration(nsecs=round(1e9 * seq * PERIOD))
    message.acceleration = [
        ACCELERATION * math.sin(2.0 * math.pi * FREQUENCY * i * PERIOD) for i in range(seq, seq + BLOCK)]
    return message


class SimulatorRig:
    def __init__(self, test, name_space, parameters, kind=BaseExcitation):
        """`kind` is the type of base_excitation; None: it is not published here, or not yet."""
        test.namespace = name_space
        self.test = test
        self.name_space = name_space
        self.name = name_space + "/simulator"
        self.messages = {}
        self.topics = []
        for topic, message in [("gap", Gap), ("contact_force", ContactForce), ("impact", Impact)]:
            self.subscribe(name_space + "/" + topic, topic, message)
        self.subscribe(name_space + "/model_info", "model_info", ModelInfo, self.keep_new)
        if parameters.get("input", "block") != "block":
            self.subscribe(name_space + "/excitation_used", "excitation_used", BaseExcitation)
        self.subscribe("/diagnostics", "diagnostics", DiagnosticArray)
        if kind:
            self.advertise(kind)
        # Not before: what rospy registers while a node of that topic does may never hear of it.
        test.start(parameters)
        rospy.wait_for_service(self.name + "/set_contact", PATIENCE)
        self.reset = rospy.ServiceProxy(self.name + "/reset", Trigger)
        self.set_contact = rospy.ServiceProxy(self.name + "/set_contact", SetContact)

    def advertise(self, kind):
        self.publisher = rospy.Publisher(self.name_space + "/base_excitation", kind, queue_size=0)
        self.test.interfaces.append(self.publisher)

    def subscribe(self, topic, key, kind, keep=None):
        self.messages[key] = []
        self.topics.append(topic)
        self.test.interfaces.append(rospy.Subscriber(topic, kind, keep or self.messages[key].append, queue_size=None))

    def keep_new(self, info):
        """rospy may connect twice for a moment, and then hears a latched message twice."""
        infos = self.messages["model_info"]
        if not infos or info.number > infos[-1].number:
            infos.append(info)

    def hears(self):
        """Whether nothing that the simulator says is missed."""
        return self.messages["model_info"] and is_connected(self.name, self.topics)

    def connect(self):
        self.test.assertTrue(wait_until(
            lambda: self.publisher.get_num_connections() == 1 and self.hears()), self.test.printed())

    def statuses(self):
        """All statuses of this simulator so far, the latest first."""
        for message in reversed(self.messages["diagnostics"]):
            for status in message.status:
                if status.name.lstrip("/").startswith(self.name.lstrip("/") + ":"):
                    yield status

    def status(self, name):
        """The latest status of that name."""
        return next(status for status in self.statuses() if status.name.endswith(": " + name))

    def value(self, key):
        """A value of this simulator's latest diagnostics; nothing before the first."""
        return next((value.value for status in self.statuses() for value in status.values if value.key == key), None)

    def count(self, key):
        """A number of this simulator's latest diagnostics; -1 before the first."""
        return int(self.value(key) or -1)

    def answered(self, blocks):
        """Waits for all answers to so many blocks."""
        self.test.assertTrue(wait_until(
            lambda: self.count("Blocks accepted") == blocks and len(self.messages["gap"]) == blocks
            and len(self.messages["contact_force"]) == blocks
            and len(self.messages["impact"]) == self.count("Impacts")
            and len(self.messages["model_info"]) == 1 + self.count("Contact changes")), self.seen() + self.test.printed())

    def seen(self):
        """How many messages of each topic there are, and what the diagnostics have counted."""
        return "%s, %s\n" % ({topic: len(messages) for topic, messages in self.messages.items()},
                             {key: self.count(key) for key in ("Blocks accepted", "Blocks refused", "Impacts")})


class ShakenSimulator:
    """The limiting case in the namespace of a test, and a thread that shakes it at about real time while `playing` is set."""

    def __init__(self, test):
        self.rig = SimulatorRig(test, test.namespace, configuration("limiting_case.yaml"))
        self.rig.connect()
        self.playing = threading.Event()
        self.playing.set()
        self.ended = threading.Event()
        self.player = threading.Thread(target=self.play)
        self.player.start()

    def play(self):
        seq = 0
        while not self.ended.wait(BLOCK * PERIOD):
            if self.playing.is_set():
                self.rig.publisher.publish(sine_block(seq))
                seq += BLOCK

    def end(self):
        self.ended.set()
        self.player.join()
