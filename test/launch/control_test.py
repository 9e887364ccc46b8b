#!/usr/bin/python3
"""~reset and ~pause while blocks come as fast as they can be sent: nothing is lost, and everything is accounted for."""

import math
import threading

import rospy
import rostest
from std_srvs.srv import SetBool, Trigger

from node_process import PATIENCE, NodeProcessTest, wait_until
from simulator_rig import SimulatorRig, configuration
from vibro_impact.msg import BaseExcitation, StreamStart

PERIOD = 2.0e-5
SAMPLES = 250
BLOCKS = 3000
ROUNDS = 20


def block(number):
    """Near the resonance: an impact in every cycle of 115 samples."""
    message = BaseExcitation()
    message.seq = number * SAMPLES
    message.header.stamp = rospy.Time(1800000000) + rospy.Duration(message.seq * PERIOD)
    message.sample_period = PERIOD
    message.acceleration = [50.0 * math.sin(1.6 * 1705.6 * (message.seq + i) * PERIOD) for i in range(SAMPLES)]
    return message


class ControlTest(NodeProcessTest):
    node = "simulator"

    def test_reset_and_pause_under_load(self):
        rig = SimulatorRig(self, self.namespace, configuration("limiting_case.yaml"))
        rig.subscribe(self.namespace + "/stream_start", "stream_start", StreamStart)
        rig.connect()
        reset = rospy.ServiceProxy(rig.name + "/reset", Trigger)
        pause = rospy.ServiceProxy(rig.name + "/pause", SetBool)
        blocks = [block(i) for i in range(BLOCKS)]
        half_way = threading.Event()
        controlled = threading.Event()

        def publish():
            for number, message in enumerate(blocks):
                rig.publisher.publish(message)
                if number == BLOCKS // 2:
                    half_way.set()
                    controlled.wait(PATIENCE)

        # Half of the blocks while the calls are made, as it comes; the other half when they are over.
        sender = threading.Thread(target=publish)
        sender.start()
        for _ in range(ROUNDS):
            self.assertTrue(reset().success)
            self.assertTrue(pause(True).success)
            self.assertTrue(pause(False).success)
        self.assertTrue(half_way.wait(PATIENCE))
        controlled.set()
        sender.join(PATIENCE)

        self.assertTrue(wait_until(
            lambda: rig.count("Samples accepted") + rig.count("Samples discarded") == BLOCKS * SAMPLES), rig.seen())
        self.assertEqual(rig.count("Blocks refused"), 0)
        self.assertEqual(rig.count("Samples lost"), 0)
        self.assertEqual(rig.count("Resets"), ROUNDS)
        accepted = rig.count("Blocks accepted")
        self.assertTrue(wait_until(
            lambda: len(rig.messages["gap"]) == len(rig.messages["contact_force"]) == accepted
            and len(rig.messages["impact"]) == rig.count("Impacts")), rig.seen())
        # From every start on, impacts are numbered from 0, and every start says why.
        starts = rig.messages["stream_start"]
        numbers = [impact.number for impact in rig.messages["impact"]]
        self.assertEqual(starts[0].seq, rig.messages["gap"][0].seq)
        self.assertEqual([start.number for start in starts], list(range(len(starts))))
        self.assertEqual(starts[0].cause, StreamStart.FIRST)
        self.assertTrue({start.cause for start in starts[1:]} <= {StreamStart.RESET, StreamStart.PAUSE}, starts)
        self.assertTrue({start.reason for start in starts} <= {"first block", "reset", "paused until then"}, starts)
        self.assertTrue(all(b in (0, a + 1) for a, b in zip(numbers, numbers[1:])), numbers)
        cut_short = sum(impact.cut_short for impact in rig.messages["impact"])
        self.assertEqual(cut_short, rig.count("Impacts cut short"))


if __name__ == "__main__":
    rospy.init_node("control_test")
    rostest.rosrun("vibro_impact", "control_test", ControlTest)
