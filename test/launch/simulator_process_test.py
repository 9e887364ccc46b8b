#!/usr/bin/python3
"""The simulator as a process: how it starts, how it refuses to, and how it ends."""

import math
import os
import signal
import subprocess

import rosgraph
import rospkg
import rospy
import rostest
import yaml
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rosgraph_msgs.msg import Log

from node_process import PATIENCE, NodeProcessTest, is_connected, wait_until
from vibro_impact.msg import BaseExcitation, Gap, Impact, ModelInfo

PERIOD = 2.0e-5


def configuration():
    path = os.path.join(rospkg.RosPack().get_path("vibro_impact"), "config", "limiting_case.yaml")
    with open(path) as stream:
        return yaml.safe_load(stream)


def block(seq, acceleration, begin=1700000000):
    message = BaseExcitation()
    message.header.stamp = rospy.Time(begin) + rospy.Duration(seq * PERIOD)
    message.seq = seq
    message.sample_period = PERIOD
    message.acceleration = acceleration
    return message


class SimulatorProcessTest(NodeProcessTest):
    node = "simulator"

    def subscribe(self, topic, kind):
        messages = []
        self.interfaces.append(rospy.Subscriber(topic, kind, messages.append, queue_size=None))
        return messages

    def connect(self, publisher, *topics):
        """Waits until nothing said to the simulator, nor by it on these topics, can be missed."""
        self.assertTrue(wait_until(
            lambda: publisher.get_num_connections() == 1
            and is_connected(self.namespace + "/simulator", [topic if topic[0] == "/" else self.namespace + "/" + topic
                                                             for topic in topics])), self.printed())

    def advertise(self):
        publisher = rospy.Publisher(self.namespace + "/base_excitation", BaseExcitation, queue_size=100)
        self.interfaces.append(publisher)
        return publisher

    def expect_failure(self, parameters, faults):
        process = self.start(parameters)
        self.assertEqual(process.wait(PATIENCE), 1)
        printed = self.printed()
        self.assertEqual(printed.count("FATAL"), 1, printed)
        for fault in faults:
            self.assertIn(fault, printed)

    def test_all_faults_of_a_configuration_end_it_with_one_message(self):
        parameters = configuration()
        parameters["beam1"]["length"] = -0.5
        parameters["beam2"]["density"] = "heavy"
        del parameters["damping"]["free"]
        parameters["contact"]["stifness"] = 1.0
        parameters["basis"]["modes_free"] = 0
        parameters["mirror_rate"] = -5.0
        parameters["max_acceleration"] = "plenty"
        parameters["mirorr_rate"] = 50.0
        self.expect_failure(parameters, [
            "beam1.length = -0.5", "beam2.density", "heavy", "damping.free", "stifness", "modes_free",
            "mirror_rate = -5", "max_acceleration = \"plenty\"", "\"mirorr_rate\" is unknown: did you mean mirror_rate?"])

    def test_missing_configuration_ends_it(self):
        self.expect_failure({}, ["beam1 is missing", "beam2 is missing", "contact is missing", "damping is missing"])

    def test_model_info_says_that_everything_is_there(self):
        found = []

        def look_up(_):
            master = rosgraph.Master(rospy.get_name())
            services = dict(master.getSystemState()[2])
            subscribers = dict(master.getSystemState()[1])
            found.append([name for name in ("reset", "set_contact") if self.namespace + "/simulator/" + name in services]
                         + subscribers.get(self.namespace + "/base_excitation", []))

        self.interfaces.append(rospy.Subscriber(self.namespace + "/model_info", ModelInfo, look_up))
        self.start(configuration())
        self.assertTrue(wait_until(lambda: found), self.printed())
        self.assertEqual(found[0], ["reset", "set_contact", self.namespace + "/simulator"])

    def test_says_what_it_waits_for(self):
        log = self.subscribe("/rosout", Log)
        self.start(configuration())
        text = "still waiting for data on topic " + self.namespace + "/base_excitation"
        self.assertTrue(wait_until(lambda: any(text in message.msg for message in log)))

    def test_says_why_it_refuses_where_simulated_time_stands_still(self):
        rospy.set_param("/use_sim_time", True)
        self.addCleanup(rospy.delete_param, "/use_sim_time")
        publisher = self.advertise()
        self.start(configuration())
        self.connect(publisher)
        publisher.publish(block(0, [1.0, math.nan]))
        self.assertTrue(wait_until(lambda: "block refused: acceleration[1] is nan m/s^2" in self.printed()))

    def test_input_is_not_stale_because_computing_took_long(self):
        parameters = configuration()
        parameters["diagnostic_period"] = 0.1
        parameters["max_input_age"] = 0.3
        publisher = self.advertise()
        diagnostics = self.subscribe("/diagnostics", DiagnosticArray)
        self.start(parameters)
        self.connect(publisher, "/diagnostics")
        # A second between two samples: hundreds of vibrations, and most of a second of computing for all.
        message = block(0, [1.0e5 * (-1.0) ** i for i in range(1000)])
        message.sample_period = 1.0
        publisher.publish(message)

        def accepted():
            return [status for message in diagnostics for status in message.status
                    for value in status.values if value.key == "Blocks accepted" and value.value == "1"]

        self.assertTrue(wait_until(accepted))
        self.assertEqual(accepted()[0].level, DiagnosticStatus.OK, accepted()[0].message)

    def test_two_publishers_are_both_named(self):
        parameters = configuration()
        parameters["diagnostic_period"] = 0.1
        parameters["max_input_age"] = 60.0
        publisher = self.advertise()
        gaps = self.subscribe(self.namespace + "/gap", Gap)
        diagnostics = self.subscribe("/diagnostics", DiagnosticArray)
        self.start(parameters)
        sent = 0

        def send():
            nonlocal sent
            publisher.publish(block(10 * sent, [0.0] * 10))
            sent += 1

        self.connect(publisher, "gap", "/diagnostics")
        send()
        self.assertTrue(wait_until(lambda: gaps))
        self.processes.append(subprocess.Popen([
            "rostopic", "pub", "-r", "20", self.namespace + "/base_excitation", "vibro_impact/BaseExcitation",
            "{header: {stamp: {secs: 1800000000}}, seq: 7, sample_period: 2.0e-5, acceleration: [0.0]}"]))

        def complaints():
            send()
            return [status.message for message in diagnostics for status in message.status
                    if status.level == DiagnosticStatus.ERROR and "two publishers" in status.message]

        self.assertTrue(wait_until(complaints))
        self.assertIn(self.namespace + "/base_excitation", complaints()[0])
        self.assertIn(rospy.get_name(), complaints()[0])
        self.assertIn("/rostopic_", complaints()[0])
        self.assertTrue(all(gap.seq != 7 for gap in gaps), "a block of the second publisher was taken")

    def expect_clean_end(self, ask):
        """The process ends by what `ask` does to it."""
        publisher = self.advertise()
        gaps = self.subscribe(self.namespace + "/gap", Gap)
        impacts = self.subscribe(self.namespace + "/impact", Impact)
        process = self.start(configuration())
        self.connect(publisher, "gap", "impact")
        # An acceleration that grows to a steady one presses the structures together for good.
        publisher.publish(block(0, [10.0 * (1.0 - math.exp(-0.01 * i)) for i in range(1000)]))
        self.assertTrue(wait_until(lambda: gaps))
        self.assertLess(gaps[0].gap[-1], 0.0)
        ask(process)
        self.assertEqual(process.wait(PATIENCE), 0, self.printed())
        self.assertTrue(wait_until(lambda: any(impact.cut_short for impact in impacts)))

    def test_interrupt_publishes_the_open_impact_and_ends_cleanly(self):
        self.expect_clean_end(lambda process: process.send_signal(signal.SIGINT))

    def test_termination_publishes_the_open_impact_and_ends_cleanly(self):
        self.expect_clean_end(lambda process: process.send_signal(signal.SIGTERM))

    def test_kill_over_the_graph_publishes_the_open_impact_and_ends_cleanly(self):
        self.expect_clean_end(lambda process: subprocess.check_call(
            ["rosnode", "kill", self.namespace + "/simulator"], stdout=subprocess.DEVNULL))
        self.assertIn("asked to end: user request", self.printed())

    def test_a_new_node_of_its_name_takes_over(self):
        gaps = self.subscribe(self.namespace + "/gap", Gap)
        self.expect_clean_end(lambda process: self.start({}))
        successor = self.processes[-1]
        publisher = next(interface for interface in self.interfaces if isinstance(interface, rospy.Publisher))
        self.connect(publisher, "gap")
        gaps.clear()
        publisher.publish(block(0, [0.0] * 10))
        self.assertTrue(wait_until(lambda: gaps), self.printed())
        self.assertIsNone(successor.poll())


if __name__ == "__main__":
    rospy.init_node("simulator_process_test")
    rostest.rosrun("vibro_impact", "simulator_process_test", SimulatorProcessTest)
