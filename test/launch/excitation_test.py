#!/usr/bin/python3
"""What the shaker plays besides sines: tables, recordings of any acceleration, and the profiles that are shipped."""

import math
import os
import subprocess
import tempfile

import rosbag
import rospy
import rostest
import yaml
from geometry_msgs.msg import AccelStamped

from node_process import PATIENCE, NodeProcessTest, wait_until
from vibro_impact.msg import BaseExcitation

# Not by its name in the package: an install below the repository has a file of the same name, and roslaunch takes neither.
LAUNCH_FILE = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "launch", "shaker.launch")

PERIOD = 0.004  # s
SAMPLES = 500


def acceleration(sample):
    """A sample (m/s^2) by its number."""
    return 2.0 * math.sin(0.05 * sample) + 0.5 * math.cos(0.31 * sample)


def launch_parameters(*arguments):
    """The parameters with which shaker.launch starts its node, by their names below the node's."""
    text = subprocess.run(
        ["roslaunch", "--dump-params", LAUNCH_FILE] + list(arguments), check=True, stdout=subprocess.PIPE,
        universal_newlines=True, timeout=PATIENCE, env=dict(os.environ, PWD="/where/it/is/started")).stdout
    return {name[len("/shaker/"):]: value for name, value in yaml.safe_load(text).items()}


class ExcitationTest(NodeProcessTest):
    node = "shaker"

    def setUp(self):
        super().setUp()
        self.folder = tempfile.TemporaryDirectory()

    def tearDown(self):
        super().tearDown()
        self.folder.cleanup()

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def play(self, signal, **other):
        """The blocks that a shaker publishes of `signal`, as fast as it can."""
        blocks = []
        self.interfaces.append(rospy.Subscriber(
            self.namespace + "/base_excitation", BaseExcitation, blocks.append, queue_size=None))
        parameters = {"signal": signal, "signal_directory": self.folder.name, "wait_for_subscribers": 1,
                      "speed": 1.0e6, "block_rate": 5.0, "linger": 0.2}
        parameters.update(other)
        process = self.start(parameters)
        self.assertEqual(process.wait(PATIENCE), 0, self.printed())
        self.assertIn("published", self.printed())
        return blocks

    def expect_samples(self, blocks, expected):
        self.assertTrue(wait_until(lambda: sum(len(block.acceleration) for block in blocks) == len(expected)))
        self.assertEqual([block.seq for block in blocks], list(range(0, len(expected), 50)))
        self.assertEqual({block.sample_period for block in blocks}, {PERIOD})
        start = blocks[0].header.stamp
        for block in blocks:
            self.assertEqual((block.header.stamp - start).to_nsec(), round(1e9 * PERIOD * block.seq))
        self.assertEqual([value for block in blocks for value in block.acceleration], expected)

    def test_plays_a_table(self):
        expected = [acceleration(i) for i in range(SAMPLES)]
        with open(self.path("measured.csv"), "w") as table:
            table.write("time,acceleration\n")
            table.writelines("%.3f,%r\n" % (17.0 + PERIOD * i, value) for i, value in enumerate(expected))
        self.expect_samples(self.play({"type": "table", "file": "measured.csv"}), expected)

    def test_plays_the_blocks_of_a_bag(self):
        expected = [acceleration(i) for i in range(SAMPLES)]
        with rosbag.Bag(self.path("run.bag"), "w") as bag:
            for seq in range(0, SAMPLES, 20):
                block = BaseExcitation(seq=seq, sample_period=PERIOD, acceleration=expected[seq:seq + 20])
                block.header.stamp = rospy.Time(100) + rospy.Duration(nsecs=round(1e9 * PERIOD * seq))
                bag.write("/rig1/base_excitation", block, block.header.stamp)
        blocks = self.play({"type": "bag", "files": ["run.bag"], "topic": "/rig1/base_excitation"})
        self.expect_samples(blocks, expected)

    def test_plays_the_accelerations_of_a_bag(self):
        with rosbag.Bag(self.path("run.bag"), "w") as bag:
            for i in range(SAMPLES):
                message = AccelStamped()
                message.header.frame_id = "deck"
                message.header.stamp = rospy.Time(100) + rospy.Duration(nsecs=round(1e9 * PERIOD * i))
                message.accel.linear.x = -acceleration(i)
                if i != 77:
                    bag.write("/deck/accel", message, message.header.stamp)
        blocks = self.play({"type": "bag", "files": ["run.bag"], "topic": "/deck/accel", "input": "accel", "axis": "-x",
                            "sample_period": PERIOD})
        expected = [acceleration(i) for i in range(SAMPLES)]
        # Found again on the straight line, as the simulator bridges it.
        expected[77] = sum(block.acceleration[27] for block in blocks if block.seq == 50)
        self.assertAlmostEqual(expected[77], 0.5 * (expected[76] + expected[78]), delta=1e-12)
        self.expect_samples(blocks, expected)
        self.assertIn("1 samples bridged, 0 refused", self.printed())

    def test_ends_with_one_message_where_there_is_nothing_to_play(self):
        process = self.start({"signal": {"type": "bag", "files": ["absent.bag"], "topic": "/a"},
                              "signal_directory": self.folder.name})
        self.assertEqual(process.wait(PATIENCE), 1)
        self.assertIn(self.path("absent.bag") + ": no such file", self.printed())

    def test_launch_file_finds_profiles_tables_and_bags(self):
        profile = launch_parameters("profile:=mil_std_167_exploratory")
        self.assertEqual(profile["signal/type"], "sine_dwells")
        self.assertEqual(profile["sample_rate"], 2000.0)
        table = launch_parameters("table:=/data/measured.csv")
        self.assertEqual(table["signal/type"], "table")
        self.assertEqual(table["signal/file"], "/data/measured.csv")
        self.assertNotIn("sample_rate", table)
        bag = launch_parameters("bag:=run.bag", "topic:=/imu/data_raw", "input:=imu")
        self.assertEqual(bag["signal/files"], ["run.bag"])
        self.assertEqual(bag["signal/topic"], "/imu/data_raw")
        self.assertEqual(bag["signal/input"], "imu")
        self.assertEqual(bag["signal_directory"], "/where/it/is/started")
        # What is not asked for is left to the node; what only a bag of a sensor has is left out without one.
        sensor = ("axis:=-x", "frame_id:=deck", "sample_period:=0.004", "offset:=9.81")
        keys = ("signal/axis", "signal/frame_id", "signal/sample_period", "signal/offset")
        self.assertEqual([key for key in keys if key in bag], [])
        bag = launch_parameters("bag:=run.bag", "topic:=/deck/accel", "input:=accel", *sensor)
        self.assertEqual([bag[key] for key in keys], ["-x", "deck", 0.004, "9.81"])
        table = launch_parameters("table:=/data/measured.csv", *sensor)
        self.assertEqual([key for key in keys if key in table], [])
        # A block rate that is not given is the node's choice.
        self.assertNotIn("block_rate", table)
        self.assertEqual(launch_parameters("table:=/data/measured.csv", "block_rate:=5")["block_rate"], 5)


if __name__ == "__main__":
    rospy.init_node("excitation_test")
    rostest.rosrun("vibro_impact", "excitation_test", ExcitationTest)
