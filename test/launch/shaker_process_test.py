#!/usr/bin/python3
"""The shaker as a process: whom it waits for, what it publishes, and how it ends."""

import math
import signal
import subprocess
import tempfile
import time

import rospy
import rostest
from roslib.packages import find_node

from node_process import PATIENCE, NodeProcessTest, is_connected, wait_until
from vibro_impact.msg import BaseExcitation, Gap


def sine(**other):
    """A second of 100 Hz in blocks of 50 samples."""
    parameters = {
        "signal": {"type": "sine", "acceleration": 10.0, "frequency": 100.0, "cycles": 100},
        "sample_rate": 10000.0, "linger": 0.2}
    parameters.update(other)
    return parameters


class ShakerProcessTest(NodeProcessTest):
    node = "shaker"

    def expect_end(self, process, status):
        self.assertEqual(process.wait(PATIENCE), status, self.printed())

    def subscribe(self, callback=None):
        blocks = []
        self.interfaces.append(rospy.Subscriber(
            self.namespace + "/base_excitation", BaseExcitation, callback or blocks.append, queue_size=None))
        return blocks

    def answer(self, publisher, block):
        publisher.publish(Gap(header=block.header, seq=block.seq, sample_period=block.sample_period,
                              gap=[0.0] * len(block.acceleration)))

    def advertise_answers(self):
        publisher = rospy.Publisher(self.namespace + "/gap", Gap, queue_size=1000)
        self.interfaces.append(publisher)
        return publisher

    def expect_stream(self, blocks, samples, samples_per_block, period):
        seq = 0
        start = blocks[0].header.stamp
        for block in blocks:
            self.assertEqual(block.seq, seq)
            self.assertEqual(len(block.acceleration), min(samples_per_block, samples - seq))
            self.assertEqual(block.sample_period, period)
            self.assertEqual(block.header.frame_id, "base_frame")
            self.assertEqual((block.header.stamp - start).to_nsec(), round(seq * 1e9 * period))
            seq += len(block.acceleration)
        self.assertEqual(seq, samples)

    def test_publishes_the_signal_to_all_whom_it_waited_for(self):
        first = self.subscribe()
        process = self.start(sine(wait_for_subscribers=2, speed=5.0))
        waiting = "waiting for subscribers of " + self.namespace + "/base_excitation (1 of 2 are there)"
        self.assertTrue(wait_until(lambda: waiting in self.printed()))
        self.assertEqual(first, [])
        # One node counts as one subscriber, however often it subscribes.
        second = subprocess.Popen(
            ["rostopic", "echo", "-n", "200", self.namespace + "/base_excitation/seq"],
            stdout=subprocess.PIPE, universal_newlines=True)
        self.processes.append(second)
        echoed, _ = second.communicate(timeout=PATIENCE)
        self.assertEqual([int(seq) for seq in echoed.replace("---", "").split()], list(range(0, 10000, 50)))
        self.expect_end(process, 0)
        self.assertTrue(wait_until(lambda: len(first) == 200))
        self.expect_stream(first, 10000, 50, 1.0e-4)
        acceleration = [value for block in first for value in block.acceleration]
        for i, value in enumerate(acceleration):
            self.assertAlmostEqual(value, 10.0 * math.sin(2.0 * math.pi * 100.0 * i * 1.0e-4), delta=1.0e-9)
        self.assertIn("100.0 %, 100.0 Hz, 1.0 s of 1.0 s", self.printed())
        self.assertIn("published 10000 samples", self.printed())

    def test_is_no_faster_than_its_speed(self):
        begin = time.monotonic()
        process = self.start(sine(speed=0.5, linger=0.0))
        self.expect_end(process, 0)
        self.assertGreaterEqual(time.monotonic() - begin, 2.0)

    def test_last_block_holds_what_is_left(self):
        parameters = sine(wait_for_subscribers=1, speed=10.0, block_rate=3.0)
        blocks = self.subscribe()
        process = self.start(parameters)
        self.expect_end(process, 0)
        self.assertTrue(wait_until(lambda: len(blocks) == 4))
        self.expect_stream(blocks, 10000, 3333, 1.0e-4)

    def test_stays_no_further_ahead_of_the_answers_than_told(self):
        blocks = self.subscribe()
        process = self.start(sine(speed=0.0, max_blocks_ahead=3, wait_for_subscribers=1))
        gap = self.advertise_answers()
        self.assertTrue(wait_until(lambda: len(blocks) == 3))
        time.sleep(0.3)
        self.assertEqual(len(blocks), 3)
        self.answer(gap, blocks[0])
        self.assertTrue(wait_until(lambda: len(blocks) == 4))
        answered = 1
        while answered < 200:
            self.assertTrue(wait_until(lambda: len(blocks) > answered))
            self.assertIsNone(process.poll())
            self.answer(gap, blocks[answered])
            answered += 1
        self.expect_end(process, 0)
        self.expect_stream(blocks, 10000, 50, 1.0e-4)
        self.assertIn("published 10000 samples, all of them answered", self.printed())

    def test_a_missing_answer_ends_it(self):
        blocks = self.subscribe()
        process = self.start(sine(speed=0.0, max_blocks_ahead=3, wait_for_subscribers=1))
        gap = self.advertise_answers()
        self.assertTrue(wait_until(lambda: len(blocks) == 3))
        self.answer(gap, blocks[0])
        self.answer(gap, blocks[2])
        self.expect_end(process, 1)
        self.assertIn("is to samples 100 to 150: must be to those from 50 on", self.printed())

    def test_silence_instead_of_answers_ends_it(self):
        self.subscribe()
        self.advertise_answers()
        process = self.start(sine(speed=0.0, max_blocks_ahead=3, wait_for_subscribers=1, timeout=3.0))
        self.expect_end(process, 1)
        self.assertIn("150 samples published, 0 answered", self.printed())

    def test_nobody_to_wait_for_ends_it(self):
        process = self.start(sine(wait_for_subscribers=1, max_blocks_ahead=2, recorder="record", timeout=1.0))
        self.expect_end(process, 1)
        printed = self.printed()
        self.assertIn("in vain for subscribers of " + self.namespace + "/base_excitation (0 of 1 are there)", printed)
        self.assertIn("a publisher of " + self.namespace + "/gap", printed)
        self.assertIn(self.namespace + "/record to record " + self.namespace + "/impact", printed)

    def expect_failure_without_recorder(self, stop):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        record = subprocess.Popen(
            [find_node("rosbag", "record")[0], "-O", directory.name + "/lost", "base_excitation",
             "__ns:=" + self.namespace, "__name:=record"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.processes.append(record)
        # The shaker is patient for a few seconds only, so that the recorder comes first.
        self.assertTrue(wait_until(lambda: is_connected(self.namespace + "/record", [])))
        parameters = sine(recorder="record", recorded_topics=["base_excitation"], timeout=4.0)
        parameters["signal"]["cycles"] = 1000000
        blocks = self.subscribe()
        process = self.start(parameters)
        self.assertTrue(wait_until(lambda: blocks))
        record.send_signal(stop)
        self.expect_end(process, 1)
        self.assertIn("in vain for " + self.namespace + "/record to receive", self.printed())

    def test_a_recorder_that_dies_ends_it(self):
        self.expect_failure_without_recorder(signal.SIGKILL)

    def test_a_recorder_that_hangs_ends_it(self):
        self.expect_failure_without_recorder(signal.SIGSTOP)

    def expect_clean_end(self, ask):
        blocks = self.subscribe()
        process = self.start(sine(signal={"type": "sine", "acceleration": 1.0, "frequency": 1.0, "duration": 1000.0}))
        self.assertTrue(wait_until(lambda: blocks))
        ask(process)
        self.expect_end(process, 0)
        self.assertIn("of 10000000 samples", self.printed())

    def test_interrupt_ends_it_cleanly(self):
        self.expect_clean_end(lambda process: process.send_signal(signal.SIGINT))

    def test_termination_ends_it_cleanly(self):
        self.expect_clean_end(lambda process: process.send_signal(signal.SIGTERM))

    def test_kill_over_the_graph_ends_it_cleanly(self):
        self.expect_clean_end(lambda process: subprocess.check_call(
            ["rosnode", "kill", self.namespace + "/shaker"], stdout=subprocess.DEVNULL))

    def test_interrupt_while_it_waits_ends_it_cleanly(self):
        process = self.start(sine(wait_for_subscribers=1))
        self.assertTrue(wait_until(lambda: "waiting for" in self.printed()))
        process.send_signal(signal.SIGINT)
        self.expect_end(process, 0)

    def test_all_faults_of_its_parameters_end_it_with_one_message(self):
        process = self.start({
            "signal": {"type": "stepped_sine", "acceleration": -1.0, "start_frequency": "low", "stop_frequency": 5e9,
                       "frequency_stop": 1.0, "cycles_per_step": 0},
            "sample_rate": "1e5", "speed": -2.0, "sped": 3.0})
        self.expect_end(process, 1)
        printed = self.printed()
        self.assertEqual(printed.count("FATAL"), 1, printed)
        for fault in [self.namespace + "/shaker: 8 faults", "signal.acceleration = -1", "signal.start_frequency = \"low\"",
                      "signal.stop_frequency = 5000000000", "signal.frequency_step is missing",
                      "signal.\"frequency_stop\" is unknown", "signal.cycles_per_step = 0", "speed = -2",
                      "\"sped\" is unknown: did you mean speed?"]:
            self.assertIn(fault, printed)

    def test_missing_parameters_end_it(self):
        process = self.start({"speed": 1.0})
        self.expect_end(process, 1)
        self.assertIn("signal is missing: must be a map", self.printed())


if __name__ == "__main__":
    rospy.init_node("shaker_process_test")
    rostest.rosrun("vibro_impact", "shaker_process_test", ShakerProcessTest)
