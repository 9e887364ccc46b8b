#!/usr/bin/python3
"""The simulator listens to accelerometers: messages of one stamped sample each, from a real publisher."""

import math
import os
import random
import signal
import subprocess

import rospy
import rostest
import yaml
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import AccelStamped
from sensor_msgs.msg import Imu
from std_msgs.msg import String

from node_process import PATIENCE, NodeProcessTest, wait_until
from simulator_rig import PACKAGE, SimulatorRig, configuration, fields

PERIOD_NS = 100000  # 10 kHz
BEGIN = 1700000000
FREQUENCY = 434.0  # near the resonance: an impact a cycle
AMPLITUDE = 50.0


def parameters(source, **more):
    return configuration("limiting_case.yaml", input=source, **more)


def drive(nanoseconds):
    return AMPLITUDE * math.sin(2.0e-9 * math.pi * FREQUENCY * nanoseconds)


def accel(nanoseconds, x=0.0, frame="sensor"):
    message = AccelStamped()
    message.header.stamp = rospy.Time(BEGIN) + rospy.Duration(nsecs=nanoseconds)
    message.header.frame_id = frame
    message.accel.linear.x = x
    return message


def imu(nanoseconds, z=0.0):
    message = Imu()
    message.header.stamp = rospy.Time(BEGIN) + rospy.Duration(nsecs=nanoseconds)
    message.header.frame_id = "imu_link"
    message.linear_acceleration.z = z
    return message


class InputTest(NodeProcessTest):
    node = "simulator"

    def send(self, rig, messages):
        """Sends all, and waits until they have been dealt with."""
        total = max(0, rig.count("Messages received")) + len(messages)
        for message in messages:
            rig.publisher.publish(message)
        self.assertTrue(wait_until(lambda: rig.count("Messages received") == total), self.printed())
        rig.answered(rig.count("Blocks accepted"))

    def used(self, rig):
        """The excitation simulated, as values by number."""
        blocks = rig.messages["excitation_used"]
        self.assertTrue(wait_until(lambda: len(blocks) == len(rig.messages["gap"])))
        for excitation, gap in zip(blocks, rig.messages["gap"]):
            self.assertEqual((excitation.header.stamp, excitation.seq, excitation.sample_period, len(excitation.acceleration)),
                             (gap.header.stamp, gap.seq, gap.sample_period, len(gap.gap)))
        return {block.seq + i: value for block in blocks for i, value in enumerate(block.acceleration)}

    def expect_the_same_from_blocks(self, rig):
        """What excitation_used says gives the same answers in a simulator that takes blocks."""
        again = SimulatorRig(self, self.namespace + "/again", configuration("limiting_case.yaml"))
        again.connect()
        for block in rig.messages["excitation_used"]:
            again.publisher.publish(block)
        again.answered(len(rig.messages["excitation_used"]))
        self.assertEqual([fields(impact) for impact in again.messages["impact"]],
                         [fields(impact) for impact in rig.messages["impact"]])
        self.assertEqual([gap.gap for gap in again.messages["gap"]], [gap.gap for gap in rig.messages["gap"]])
        for key in ("Samples bridged", "Restarts"):
            self.assertEqual(again.count(key), rig.count(key), key)

    def test_exact_samples_of_an_accelerometer_are_the_excitation(self):
        rig = SimulatorRig(self, self.namespace, parameters("accel", axis="-x", sample_period=1.0e-9 * PERIOD_NS), AccelStamped)
        rig.connect()
        samples = [drive(i * PERIOD_NS) for i in range(3000)]
        self.send(rig, [accel(i * PERIOD_NS, x=-value) for i, value in enumerate(samples)])
        self.assertEqual(self.used(rig), dict(enumerate(samples)))
        self.assertEqual(rig.messages["excitation_used"][-1].header.frame_id, "base_frame")
        self.assertGreater(len(rig.messages["impact"]), 50)
        self.expect_the_same_from_blocks(rig)

    def test_jittered_specific_forces_less_their_mean_are_put_on_a_grid(self):
        rig = SimulatorRig(self, self.namespace, parameters("imu", offset_duration=0.05), Imu)
        rig.connect()
        source = random.Random(1)
        stamps = [0] + [i * PERIOD_NS + source.randint(-20000, 20000) for i in range(1, 3000)]
        forces = [9.81 + drive(stamp) for stamp in stamps]
        self.send(rig, [imu(stamp, force) for stamp, force in zip(stamps, forces)])
        waiting = [force for stamp, force in zip(stamps, forces) if stamp < 50000000]
        mean = 0.0
        for force in waiting:
            mean += force
        mean /= len(waiting)
        self.assertAlmostEqual(float(rig.value("Offset (m/s^2)")), mean, 6)
        intervals = sorted(b - a for a, b in zip(stamps[:101], stamps[1:102]))
        period = intervals[50]
        self.assertAlmostEqual(float(rig.value("Sample period (s)")), 1.0e-9 * period, 12)
        longest = 1.0e-9 * max(b - a for a, b in zip(stamps, stamps[1:]))
        bound = longest ** 2 / 8.0 * AMPLITUDE * (2.0 * math.pi * FREQUENCY) ** 2
        used = self.used(rig)
        self.assertEqual(sorted(used), list(range(len(used))))
        self.assertGreater(len(used), stamps[-1] // period - 1)
        for number, value in used.items():
            self.assertLessEqual(abs(value + mean - 9.81 - drive(number * period)), bound + 1.0e-9)
        self.assertGreater(len(rig.messages["impact"]), 50)
        self.expect_the_same_from_blocks(rig)

    def test_missing_and_bad_samples_follow_the_rules_of_blocks(self):
        rig = SimulatorRig(self, self.namespace,
                           parameters("imu", sample_period=1.0e-9 * PERIOD_NS, offset=9.81), Imu)
        rig.connect()
        good = [imu(i * PERIOD_NS, 9.81 + drive(i * PERIOD_NS)) for i in range(4000)]
        self.send(rig, good[:1000])
        bad = [imu(1000 * PERIOD_NS, value) for value in (math.nan, math.inf, -1.1e5)]
        bad += [imu(999 * PERIOD_NS, 0.0), imu(900 * PERIOD_NS, 0.0), Imu(), imu(1000 * PERIOD_NS, 0.0)]
        bad[5].header.frame_id = "imu_link"
        bad[6].linear_acceleration_covariance[0] = -1.0
        self.send(rig, bad)
        self.assertEqual(rig.count("Blocks refused"), len(bad))
        self.assertIn("sample refused: linear_acceleration.z is nan m/s^2, must be finite", self.printed())
        self.assertIn("linear_acceleration_covariance[0] is -1", rig.value("Last refusal"))
        self.send(rig, good[1000:2000] + good[2050:3000])
        self.assertEqual(rig.count("Samples bridged"), 50)
        self.assertEqual(rig.count("Restarts"), 0)
        self.send(rig, good[3500:])
        self.assertEqual(rig.count("Samples bridged"), 50)
        self.assertEqual(rig.count("Samples lost"), 550)
        self.assertEqual(rig.count("Restarts"), 1)
        self.send(rig, good[:500])
        self.assertEqual(rig.count("Restarts"), 2)
        self.assertEqual(rig.count("Messages received"), rig.count("Blocks refused") + rig.count("Blocks accepted"))
        self.expect_the_same_from_blocks(rig)

    def test_samples_of_another_frame_are_refused(self):
        for frame, allowed in [(None, "that of the first sample"), ("sensor", "as ~frame_id says")]:
            more = {"frame_id": frame} if frame else {}
            rig = SimulatorRig(self, self.namespace, parameters("accel", axis="x", sample_period=1.0e-9 * PERIOD_NS, **more),
                               AccelStamped)
            rig.connect()
            self.send(rig, [accel(0), accel(PERIOD_NS, frame="other"), accel(PERIOD_NS, frame=""), accel(PERIOD_NS, 3.0)])
            self.assertEqual(rig.count("Blocks refused"), 2)
            self.assertEqual(self.used(rig), {0: 0.0, 1: 3.0})
            self.assertIn('sample refused: header.frame_id is "other", must be "sensor", ' + allowed, self.printed())
            self.namespace += "/again"

    def expect_complaint(self, rig, text):
        """The error is in the log and in the diagnostics, and the node lives."""
        self.assertTrue(wait_until(lambda: text in self.printed()), self.printed())
        self.assertTrue(wait_until(lambda: any(
            status.level == DiagnosticStatus.ERROR and text in status.message for status in rig.statuses())))

    def test_a_wrong_type_says_what_to_set(self):
        topic = self.namespace + "/base_excitation"
        wrong = subprocess.Popen(["rostopic", "pub", "-r", "10", topic, "sensor_msgs/Imu", "{}"], stdout=subprocess.DEVNULL)
        self.processes.append(wrong)
        rig = SimulatorRig(self, self.namespace, parameters("accel", axis="x", sample_period=1.0e-9 * PERIOD_NS), None)
        self.expect_complaint(rig, "topic %s has type sensor_msgs/Imu, ~input is accel: set ~input to imu" % topic)
        wrong.send_signal(signal.SIGINT)
        wrong.wait(PATIENCE)
        rig.advertise(AccelStamped)
        rig.connect()
        self.send(rig, [accel(0, 1.0)])
        self.assertEqual(self.used(rig), {0: 1.0})
        self.assertTrue(wait_until(lambda: rig.status("Input").level == DiagnosticStatus.OK), rig.status("Input"))

    def test_a_type_that_no_input_has_says_which_to_send(self):
        """Also if the topic is there before the node."""
        publisher = rospy.Publisher(self.namespace + "/base_excitation", String, queue_size=1)
        self.interfaces.append(publisher)
        self.start(configuration("limiting_case.yaml"))
        text = ("topic %s/base_excitation has type std_msgs/String, ~input is block: remap base_excitation to a topic of "
                "type vibro_impact/BaseExcitation" % self.namespace)
        self.assertTrue(wait_until(lambda: text in self.printed()), self.printed())
        self.assertTrue(wait_until(lambda: "still waiting for data: " + text in self.printed()), self.printed())
        self.assertIsNone(self.processes[-1].poll())

    def test_the_launch_file_sets_what_is_asked_for(self):
        def launched(*arguments):
            output = subprocess.check_output(
                ["roslaunch", "--dump-params", os.path.join(PACKAGE, "launch", "simulator.launch"), *arguments], universal_newlines=True)
            values = yaml.safe_load(output)
            keys = ("input", "axis", "frame_id", "sample_period", "offset", "offset_duration", "max_stamp_jitter")
            return {key: values["/simulator/" + key] for key in keys if "/simulator/" + key in values}

        self.assertEqual(launched(), {"input": "block"})
        self.assertEqual(
            launched("input:=imu", "axis:=-x", "frame_id:=sensor", "sample_period:=0.004", "offset:=9.81",
                     "offset_duration:=5", "max_stamp_jitter:=0.1"),
            {"input": "imu", "axis": "-x", "frame_id": "sensor", "sample_period": 0.004, "offset": "9.81",
             "offset_duration": 5.0, "max_stamp_jitter": 0.1})


if __name__ == "__main__":
    rospy.init_node("input_test")
    rostest.rosrun("vibro_impact", "input_test", InputTest)
