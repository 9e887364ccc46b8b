#!/usr/bin/python3
"""The aggregator of diagnostics.launch: one branch per concern, and a worst state of all."""

import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from vibro_impact.msg import BaseExcitation

from node_process import wait_until

CONCERNS = ("Input", "Real-time factor", "Output queues", "Model")


class DiagnosticsTest(unittest.TestCase):
    def setUp(self):
        self.levels = {}
        self.subscriber = rospy.Subscriber("/diagnostics_agg", DiagnosticArray, self.take)
        self.publisher = rospy.Publisher("/base_excitation", BaseExcitation, queue_size=1)

    def take(self, message):
        for status in message.status:
            self.levels[status.name] = status.level

    def level(self, concern):
        """Of the simulator's status in the branch of this concern."""
        return self.levels.get("/vibro_impact/%s/simulator: %s" % (concern, concern))

    def test_every_concern_has_its_branch_and_a_silent_input_is_stale(self):
        self.assertTrue(wait_until(lambda: all(self.level(concern) is not None for concern in CONCERNS)), self.levels)
        self.assertTrue(wait_until(lambda: self.level("Input") == DiagnosticStatus.STALE), self.levels)
        for concern in CONCERNS[1:]:
            self.assertTrue(wait_until(lambda: self.level(concern) == DiagnosticStatus.OK), self.levels)

    def test_a_refused_block_is_an_error_of_the_input_alone(self):
        self.assertTrue(wait_until(lambda: self.publisher.get_num_connections() == 1))
        bad = BaseExcitation(sample_period=-1.0, acceleration=[0.0])
        bad.header.stamp = rospy.Time(1800000000)

        def failed():
            self.publisher.publish(bad)  # the aggregator shows the latest, which the next report replaces
            return self.level("Input") == DiagnosticStatus.ERROR

        self.assertTrue(wait_until(failed), self.levels)
        self.assertEqual(self.levels["/vibro_impact/Input"], DiagnosticStatus.ERROR)
        self.assertEqual(self.level("Model"), DiagnosticStatus.OK)


if __name__ == "__main__":
    rospy.init_node("diagnostics_test")
    rostest.rosrun("vibro_impact", "diagnostics_test", DiagnosticsTest)
