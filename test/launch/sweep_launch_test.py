#!/usr/bin/python3
"""sweep.launch as a user starts it: it ends by itself, and its bag holds everything."""

import math
import os
import shutil
import signal
import socket
import subprocess
import tempfile
import unittest

import rosbag
import rostest
import yaml
from roslib.packages import find_node

# Not by its name in the package: an install below the repository has a file of the same name, and roslaunch takes neither.
LAUNCH_FILE = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "launch", "sweep.launch")

# Longer than anything takes on a busy machine, s.
PATIENCE = 100.0

# Five steps about the resonance, half a second of stream time: hundreds of impacts.
SIGNAL = {
    "signal": {"type": "stepped_sine", "acceleration": 10.0, "reference_frequency": 271.45727650517387,
               "start_frequency": 1.5, "stop_frequency": 1.7, "frequency_step": 0.05, "cycles_per_step": 50},
    "sample_rate": 50000.0}
STEPS = [1.5, 1.55, 1.6, 1.65, 1.7]
SAMPLES = math.ceil(50000.0 * sum(50 / (271.45727650517387 * step) for step in STEPS))


class SweepLaunchTest(unittest.TestCase):
    def setUp(self):
        self.directory = tempfile.mkdtemp()
        self.signal = os.path.join(self.directory, "signal.yaml")
        with open(self.signal, "w") as stream:
            yaml.safe_dump(SIGNAL, stream)

    def tearDown(self):
        shutil.rmtree(self.directory)

    def launch(self, *arguments):
        with socket.socket() as probe:
            probe.bind(("localhost", 0))
            port = probe.getsockname()[1]
        environment = dict(os.environ, ROS_MASTER_URI="http://localhost:%d" % port, ROS_LOG_DIR=self.directory)
        process = subprocess.Popen(
            ["roslaunch", "-p", str(port), LAUNCH_FILE, "signal:=" + self.signal, *arguments],
            env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
        try:
            output, _ = process.communicate(timeout=PATIENCE)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGINT)
            output, _ = process.communicate()
            self.fail("did not end by itself:\n" + output)
        return output

    def expect_complete(self, path, output):
        streams = {"base_excitation": 0, "gap": 0, "contact_force": 0}
        periods = set()
        impacts = 0
        models = 0
        with rosbag.Bag(path) as bag:
            for topic, message, _ in bag.read_messages():
                topic = topic.lstrip("/")
                if topic in streams:
                    samples = {"base_excitation": "acceleration", "gap": "gap", "contact_force": "force"}[topic]
                    self.assertEqual(message.seq, streams[topic], topic + "\n" + output)
                    streams[topic] += len(getattr(message, samples))
                    periods.add(message.sample_period)
                elif topic == "impact":
                    self.assertEqual(message.number, impacts, output)
                    impacts += 1
                elif topic == "model_info":
                    models += 1
        self.assertEqual(streams, dict.fromkeys(streams, SAMPLES), output)
        self.assertEqual(periods, {2.0e-5})
        self.assertGreater(impacts, 200)
        self.assertEqual(models, 1)

    def test_records_everything_and_ends(self):
        # Of a name that a shell would cut into pieces.
        path = os.path.join(self.directory, "a sweep.bag")
        output = self.launch("bag:=" + path)
        self.assertEqual([name for name in os.listdir(self.directory) if ".bag" in name], ["a sweep.bag"], output)
        self.expect_complete(path, output)
        self.assertIn("published %d samples, all of them answered, all of them recorded by /record" % SAMPLES, output)
        self.assertIn("100.0 %, 461.5 Hz (1.700)", output)

    def test_takes_a_modal_table_beside_its_configuration(self):
        config = os.path.join(self.directory, "table.yaml")
        table = os.path.join(self.directory, "table.csv")
        with open(table, "w") as stream:
            stream.write("frequency_hz,contact_deflection,participation\n271.457,38.9,0.0257\n2443.1,38.9,0.0086\n")
        with open(config, "w") as stream:
            yaml.safe_dump({"beam1": {"modal_table": {"file": "table.csv"}}, "beam2": "rigid",
                            "contact": {"stiffness": 24309.0, "clearance": 0.0},
                            "damping": {"free": 0.01, "contact": 0.05}}, stream)
        path = os.path.join(self.directory, "table.bag")
        output = self.launch("bag:=" + path, "config:=" + config)
        self.expect_complete(path, output)
        os.remove(table)  # the bag has all of it
        with rosbag.Bag(path) as bag:
            info = next(message for _, message, _ in bag.read_messages(topics=["/model_info", "model_info"]))
        self.assertIn("271.457", info.configuration)
        self.assertNotIn(".csv", info.configuration)
        extracted = subprocess.run([find_node("vibro_impact", "extract_frf")[0], path, "--out", self.directory],
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True,
                                   timeout=PATIENCE, check=False)
        self.assertEqual(extracted.returncode, 0, extracted.stdout)
        self.assertIn("5 steps found", extracted.stdout)

    def test_keeps_to_a_speed(self):
        path = os.path.join(self.directory, "paced.bag")
        output = self.launch("bag:=" + path, "speed:=0.5", "block_rate:=200")
        self.expect_complete(path, output)

    def test_runs_without_a_recording(self):
        output = self.launch("record:=false")
        self.assertEqual([name for name in os.listdir(self.directory) if ".bag" in name], [], output)
        self.assertIn("published %d samples, all of them answered" % SAMPLES, output)

    def test_a_recorder_that_cannot_write_ends_it(self):
        output = self.launch("bag:=" + os.path.join(self.directory, "missing", "a.bag"))
        self.assertIn("record", output)
        self.assertNotIn("published", output)

    def test_a_simulator_that_fails_ends_it(self):
        config = os.path.join(self.directory, "config.yaml")
        with open(config, "w") as stream:
            stream.write("beam2: rigid\n")
        output = self.launch("config:=" + config)
        self.assertIn("beam1 is missing", output)
        # Nobody has waited for it until the timeout.
        self.assertNotIn("in vain", output)
        self.assertNotIn("published", output)


if __name__ == "__main__":
    rostest.rosrun("vibro_impact", "sweep_launch_test", SweepLaunchTest)
