#!/usr/bin/python3
"""The rules of time, with bags that rosbag plays: simulated time, pauses, any rate, loops."""

import csv
import math
import os
import signal
import subprocess
import tempfile

import rosbag
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticStatus
from roslib.packages import find_node
from sensor_msgs.msg import Imu
from std_srvs.srv import SetBool

from node_process import PATIENCE, NodeProcessTest, wait_until
from simulator_rig import SimulatorRig, configuration, fields
from vibro_impact.msg import BaseExcitation

PERIOD_NS = 20000
BLOCK = 250
SAMPLES = 25000  # half a second
BEGIN = rospy.Time(1700000000)


def drive(number):
    """Near the resonance; from two thirds on growing to a steady acceleration that presses the structures together."""
    steady = max(0, number - 2 * SAMPLES // 3)
    return 50.0 * math.sin(1.6 * 1705.6 * 1.0e-9 * number * PERIOD_NS) if steady == 0 \
        else 10.0 * (1.0 - math.exp(-0.01 * steady))


def blocks():
    for seq in range(0, SAMPLES, BLOCK):
        block = BaseExcitation(seq=seq, sample_period=1.0e-9 * PERIOD_NS)
        block.header.stamp = BEGIN + rospy.Duration(nsecs=seq * PERIOD_NS)
        block.acceleration = [drive(i) for i in range(seq, seq + BLOCK)]
        yield block


def imu_samples():
    """Every fifth sample, as an accelerometer of 10 kHz gives it."""
    for number in range(0, SAMPLES, 5):
        sample = Imu()
        sample.header.stamp = BEGIN + rospy.Duration(nsecs=number * PERIOD_NS)
        sample.linear_acceleration.z = 9.81 + drive(number)
        yield sample


class BagTimeTest(NodeProcessTest):
    node = "simulator"

    def setUp(self):
        super().setUp()
        rospy.set_param("/use_sim_time", True)
        self.addCleanup(rospy.delete_param, "/use_sim_time")
        self.directory = tempfile.TemporaryDirectory()
        self.addCleanup(self.directory.cleanup)

    def bag(self, messages):
        path = os.path.join(self.directory.name, "run.bag")
        with rosbag.Bag(path, "w") as bag:
            for message in messages:
                bag.write("base_excitation", message, message.header.stamp)
        return path

    def rig(self, **parameters):
        return SimulatorRig(self, self.namespace,
                            configuration("limiting_case.yaml", max_input_age=0.5, **parameters), None)

    def play(self, rig, path, *options):
        """Starts to play, with nothing lost at either end."""
        self.assertTrue(wait_until(rig.hears), self.printed())
        player = subprocess.Popen(
            ["rosbag", "play", "--quiet", "--clock", "--wait-for-subscribers", "--queue", "10000", *options, path,
             "base_excitation:=" + self.namespace + "/base_excitation", "__name:=player"],
            stdin=subprocess.PIPE, stdout=subprocess.DEVNULL)
        self.processes.append(player)
        return player

    def play_until(self, arrived, rig, path, *options):
        """Plays until all has arrived: the player would not wait for that, and take what it has not sent with it."""
        player = self.play(rig, path, "--keep-alive", *options)
        self.assertTrue(wait_until(arrived), rig.seen())
        player.send_signal(signal.SIGINT)
        player.wait(PATIENCE)

    def reset(self, rig):
        """What is open is cut short."""
        self.assertTrue(rig.reset().success)
        self.assertTrue(wait_until(lambda: rig.messages["impact"] and rig.messages["impact"][-1].cut_short))

    def live(self, rig):
        """The impacts of the blocks as a shaker sends them."""
        rig.advertise(BaseExcitation)
        rig.connect()
        for block in blocks():
            rig.publisher.publish(block)
        rig.answered(SAMPLES // BLOCK)
        self.reset(rig)
        rig.publisher.unregister()
        impacts = [fields(impact) for impact in rig.messages["impact"]]
        self.assertGreater(len(impacts), 100)
        return impacts

    def expect_the_same_offline(self, rig):
        """What a recorder has kept of the last pass gives the same impacts in simulate."""
        path = os.path.join(self.directory.name, "recorded.bag")
        with rosbag.Bag(path, "w") as bag:
            for topic in ("model_info", "excitation_used"):
                for message in rig.messages[topic]:
                    bag.write(topic, message, BEGIN)
        out = os.path.join(self.directory.name, "out")
        subprocess.check_call(
            [find_node("vibro_impact", "simulate")[0], "--bag", path, "--out", out], stdout=subprocess.DEVNULL)
        with open(os.path.join(out, "impacts.csv")) as stream:
            impacts = [(int(row["number"]), float(row["impulse"])) for row in csv.DictReader(stream)]
        self.assertEqual(impacts, [(impact.number, impact.impulse) for impact in rig.messages["impact"]])

    def test_every_rate_gives_the_same_impacts(self):
        rig = self.rig()
        impacts = self.live(rig)
        path = self.bag(blocks())
        for streams, options in enumerate([["--rate", "0.5"], ["--rate", "5"], ["--immediate"]], 2):
            del rig.messages["impact"][:]
            self.play_until(lambda: rig.count("Blocks accepted") == streams * SAMPLES // BLOCK, rig, path, *options)
            self.reset(rig)
            self.assertEqual([fields(impact) for impact in rig.messages["impact"]], impacts, options)
        for key in ("Blocks refused", "Samples lost", "Restarts"):
            self.assertEqual(rig.count(key), 0, key)

    def test_every_rate_gives_the_same_samples_of_an_accelerometer(self):
        path = self.bag(imu_samples())
        rig = self.rig(input="imu", offset="mean", offset_duration=0.1)
        passes = []
        for passed, options in enumerate([["--rate", "2"], ["--immediate"]]):
            for topic in ("impact", "excitation_used"):
                del rig.messages[topic][:]
            self.play_until(lambda: rig.count("Messages received") == (passed + 1) * SAMPLES // 5, rig, path, *options)
            self.reset(rig)
            used = [value for block in rig.messages["excitation_used"] for value in block.acceleration]
            self.assertEqual(len(used), SAMPLES // 5)
            passes.append((used, [fields(impact) for impact in rig.messages["impact"]]))
        self.assertGreater(len(passes[0][1]), 100)
        self.assertEqual(passes[1], passes[0])
        self.expect_the_same_offline(rig)
        self.assertEqual(rig.count("Samples refused"), 0)
        self.assertEqual(rig.count("Samples lost"), 0)

    def test_a_pause_is_silence_and_loses_nothing(self):
        rig = self.rig()
        impacts = self.live(rig)
        del rig.messages["impact"][:]
        del rig.messages["gap"][:]
        del rig.messages["contact_force"][:]
        self.play(rig, self.bag(blocks()), "--pause", "--rate", "0.1")
        rospy.wait_for_service("/player/pause_playback", PATIENCE)
        pause = rospy.ServiceProxy("/player/pause_playback", SetBool)

        def expect_silence():
            """Diagnostics say that time stands still, and it does."""
            seen = len(rig.messages["diagnostics"])
            self.assertTrue(wait_until(
                lambda: len(rig.messages["diagnostics"]) > seen and rig.status("Input").level == DiagnosticStatus.STALE))
            self.assertIn("time stands still", rig.status("Input").message)
            self.assertEqual(rig.count("Blocks accepted"), SAMPLES // BLOCK + len(rig.messages["gap"]))

        expect_silence()
        self.assertEqual(rig.messages["gap"], [])
        self.assertTrue(pause(False).success)
        self.assertTrue(wait_until(lambda: rig.messages["gap"]), rig.seen())
        self.assertTrue(pause(True).success)
        expect_silence()
        self.assertLess(len(rig.messages["gap"]), SAMPLES // BLOCK)
        self.assertTrue(pause(False).success)
        self.assertTrue(wait_until(lambda: rig.count("Blocks accepted") == 2 * SAMPLES // BLOCK), rig.seen())
        self.reset(rig)
        self.assertEqual([fields(impact) for impact in rig.messages["impact"]], impacts)
        for key in ("Blocks refused", "Samples lost", "Restarts"):
            self.assertEqual(rig.count(key), 0, key)

    def test_a_loop_restarts_and_gives_the_same_impacts_again(self):
        rig = self.rig()
        player = self.play(rig, self.bag(blocks()), "--loop", "--rate", "2")
        self.assertTrue(wait_until(lambda: rig.count("Restarts") >= 2 and sum(
            impact.cut_short for impact in rig.messages["impact"]) >= 2), rig.seen())
        player.send_signal(signal.SIGINT)
        player.wait(PATIENCE)
        passes = []
        for impact in rig.messages["impact"]:
            if not passes or impact.number <= passes[-1][-1].number:
                passes.append([])
            passes[-1].append(impact)
        self.assertGreaterEqual(len(passes), 2)
        for impacts in passes[:2]:
            self.assertGreater(len(impacts), 100)
            self.assertEqual([impact.cut_short for impact in impacts], [False] * (len(impacts) - 1) + [True])
        self.assertEqual([fields(impact) for impact in passes[1]], [fields(impact) for impact in passes[0]])
        self.assertEqual(rig.count("Blocks refused"), 0)
        self.assertEqual(rig.count("Samples lost"), 0)
        self.assertIn("restarted from rest: seq is 0 where %d was expected" % SAMPLES, self.printed())


if __name__ == "__main__":
    rospy.init_node("bag_time_test")
    rostest.rosrun("vibro_impact", "bag_time_test", BagTimeTest)
