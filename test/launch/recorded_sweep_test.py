#!/usr/bin/python3
"""The main job on real nodes: sweep.launch records a bag, extract_frf finds in it what frf_sweep computes."""

import csv
import os
import subprocess
import tempfile
import unittest

import rosbag
import rospkg
import rostest
from roslib.packages import find_node

PACKAGE = rospkg.RosPack().get_path("vibro_impact")
CONFIG = os.path.join(PACKAGE, "config", "limiting_case.yaml")
SIGNAL = os.path.join(PACKAGE, "test", "launch", "recorded_sweep.yaml")
POINTS = 11
CYCLES = 150
# Longer than anything takes on a busy machine, s.
PATIENCE = 100.0


def run(*command):
    """Output of a command that must end well."""
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=PATIENCE, check=False)
    if result.returncode != 0:
        raise AssertionError("%s ended with %d: %s%s" % (command[0], result.returncode, result.stdout, result.stderr))
    return result.stdout


def tool(name, *arguments):
    return run(find_node("vibro_impact", name)[0], *arguments)


def table(path):
    with open(path) as stream:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(stream)]


class RecordedSweep(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.directory = tempfile.TemporaryDirectory()
        cls.bag = os.path.join(cls.directory.name, "sweep.bag")
        run("roslaunch", os.path.join(PACKAGE, "launch", "sweep.launch"), "config:=" + CONFIG, "signal:=" + SIGNAL, "bag:=" + cls.bag)
        cls.report = tool("extract_frf", cls.bag, "--out", os.path.join(cls.directory.name, "bag"))
        tool("frf_sweep", CONFIG, "--from", "1.5", "--to", "1.7", "--points", str(POINTS), "--cycles", str(CYCLES),
             "--acceleration", "10", "--follow", "up", "--out", os.path.join(cls.directory.name, "core"))
        cls.extracted = table(os.path.join(cls.directory.name, "bag", "frf.csv"))
        cls.computed = table(os.path.join(cls.directory.name, "core", "frf.csv"))

    @classmethod
    def tearDownClass(cls):
        cls.directory.cleanup()

    def test_nothing_is_lost(self):
        self.assertIn("none lost", self.report)
        self.assertIn("%d steps found, 0 left out" % POINTS, self.report)

    def test_simulate_gives_the_same_impacts_bit_for_bit(self):
        out = os.path.join(self.directory.name, "simulated")
        report = tool("simulate", "--bag", self.bag, "--every", "1000", "--out", out)
        self.assertIn("0 bridged, 0 restarts from rest, 0 blocks refused", report)
        simulated = table(os.path.join(out, "impacts.csv"))
        with rosbag.Bag(self.bag) as bag:
            topics = {info.msg_type: topic for topic, info in bag.get_type_and_topic_info().topics.items()}
            period = next(bag.read_messages(topics["vibro_impact/BaseExcitation"])).message.sample_period
            recorded = [record.message for record in bag.read_messages(topics["vibro_impact/Impact"])]
        self.assertGreater(len(recorded), POINTS * CYCLES // 2)
        # What is cut short by the end of the stream is published when the node ends.
        self.assertIn(len(simulated) - len(recorded), (0, 1))
        for row, impact in zip(simulated, recorded):
            self.assertEqual(row["number"], impact.number)
            self.assertEqual(row["onset_s"], impact.seq * period + impact.offset)
            for name in ("impulse", "peak_force", "approach_speed", "separation_speed", "energy_lost"):
                self.assertEqual(row[name], getattr(impact, name), name)
            self.assertEqual(row["duration_s"], impact.duration)

    def test_replay_is_identical_bit_for_bit(self):
        with rosbag.Bag(self.bag) as bag:
            counts = {info.msg_type: info.message_count for info in bag.get_type_and_topic_info().topics.values()}
        report = tool("replay_check", self.bag)
        self.assertIn("identical: %d blocks, " % counts["vibro_impact/Gap"], report)
        self.assertIn(" samples, %d impacts\n1 start from rest, " % counts["vibro_impact/Impact"], report)

    def test_steps_are_those_of_the_shaker(self):
        self.assertEqual(len(self.extracted), POINTS)
        for i, row in enumerate(self.extracted):
            self.assertAlmostEqual(row["omega_star"], 1.5 + 0.02 * i, delta=1.0e-6)
            self.assertAlmostEqual(row["acceleration"], 10.0, delta=1.0e-3)

    def test_response_is_that_of_the_core(self):
        for extracted, computed in zip(self.extracted, self.computed):
            self.assertEqual(extracted["period"], computed["period"])
            self.assertEqual(extracted["impacts"], computed["impacts"])
            if computed["period"] == 1.0:
                self.assertAlmostEqual(extracted["impulse_mean"] / computed["impulse_mean"], 1.0, delta=5.0e-3)


if __name__ == "__main__":
    rostest.rosrun("vibro_impact", "recorded_sweep_test", RecordedSweep)
