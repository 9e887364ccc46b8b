#!/usr/bin/python3
"""The contact of a running simulator changes; what a bag holds of it gives the same impacts again in a new one."""

import csv
import math
import os
import subprocess
import tempfile

import rosbag
import rospy
import rostest
import yaml
from roslib.packages import find_node

from node_process import PATIENCE, NodeProcessTest, wait_until
from simulator_rig import PACKAGE, SimulatorRig, configuration, fields
from vibro_impact.msg import BaseExcitation, ModelInfo

PERIOD = 2.0e-5
BLOCK = 250
STIFFNESS = 24309.426302924


def block(seq, start=1700000000):
    message = BaseExcitation(seq=seq, sample_period=PERIOD)
    message.header.stamp = rospy.Time(start) + rospy.Duration(nsecs=seq * 20000)
    message.acceleration = [2.0 * math.sin(1.6 * 1705.6 * i * PERIOD) for i in range(seq, seq + BLOCK)]
    return message


def contact(info):
    values = yaml.safe_load(info.configuration)["contact"]
    return float(values["stiffness"]), float(values["clearance"])


def table(path):
    with open(path) as stream:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(stream)]


class ContactChangeTest(NodeProcessTest):
    node = "simulator"

    def refused(self, rig, stiffness, clearance, seq, reason):
        answer = rig.set_contact(stiffness, clearance, seq)
        self.assertFalse(answer.success)
        self.assertIn(reason, answer.message)
        self.assertEqual(len(answer.message.splitlines()), 1)

    def test_a_bag_gives_the_same_impacts_in_a_new_simulator(self):
        rig = SimulatorRig(self, self.namespace, configuration("interference_fit.yaml"))
        rig.connect()
        # Named beforehand, in and out of order, two of them in one block; then one as it comes.
        for seq, stiffness, clearance in [
                (9000, STIFFNESS, -5.0e-8), (3000, 0.8 * STIFFNESS, -7.0e-8), (3100, 0.8 * STIFFNESS, -6.0e-8)]:
            answer = rig.set_contact(stiffness, clearance, seq)
            self.assertTrue(answer.success, answer.message)
            self.assertEqual(answer.message, "holds from sample %d on" % seq)
        blocks = [block(seq) for seq in range(0, 25000, BLOCK)]
        for message in blocks[:60]:
            rig.publisher.publish(message)
        rig.answered(60)
        self.assertEqual(rig.set_contact(1.3 * STIFFNESS, 1.0e-8, 0).message, "holds from the next sample on")
        for message in blocks[60:]:
            rig.publisher.publish(message)
        rig.answered(100)

        infos = rig.messages["model_info"]
        self.assertEqual([(info.seq, info.number) for info in infos], [(0, 0), (3000, 1), (3100, 2), (9000, 3), (15000, 4)])
        self.assertEqual(contact(infos[0]), (STIFFNESS, -1.0e-7))
        self.assertEqual(contact(infos[4]), (1.3 * STIFFNESS, 1.0e-8))
        self.assertTrue(infos[0].header.stamp.is_zero())
        self.assertEqual(infos[4].header.stamp, blocks[60].header.stamp)
        self.assertNotEqual(infos[1].contact_frequencies, infos[0].contact_frequencies)
        impacts = [fields(impact) for impact in rig.messages["impact"]]
        self.assertGreater(len(impacts), 80)

        # The latched one is the latest, for whoever comes late.
        late = []
        self.interfaces.append(rospy.Subscriber(self.namespace + "/model_info", ModelInfo, late.append))
        self.assertTrue(wait_until(lambda: late))
        self.assertEqual(late[0].number, 4)

        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        path = os.path.join(directory.name, "run.bag")
        with rosbag.Bag(path, "w") as bag:
            for info in infos:
                bag.write("model_info", info, blocks[0].header.stamp)
            for message in blocks:
                bag.write("base_excitation", message, message.header.stamp)

        again = SimulatorRig(self, self.namespace + "/again", configuration("interference_fit.yaml"))
        again.connect()
        again.publisher.unregister()
        output = subprocess.check_output(
            [os.path.join(PACKAGE, "scripts", "replay_contact"), path, "--node", again.name], universal_newlines=True)
        self.assertIn("4 changes of the contact told to", output)
        subprocess.check_call(
            ["rosbag", "play", "--quiet", "--rate", "5", "--delay", "1", "--wait-for-subscribers", path,
             "--topics", "base_excitation", "base_excitation:=" + self.namespace + "/base_excitation"],
            stdout=subprocess.DEVNULL, timeout=PATIENCE)
        again.answered(100)
        self.assertEqual([fields(impact) for impact in again.messages["impact"]], impacts)
        self.assertEqual([(info.seq, info.number, info.configuration) for info in again.messages["model_info"]],
                         [(info.seq, info.number, info.configuration) for info in infos])
        self.assertEqual([gap.gap for gap in again.messages["gap"]], [gap.gap for gap in rig.messages["gap"]])

    def test_simulate_gives_what_the_node_published(self):
        rig = SimulatorRig(self, self.namespace, configuration("interference_fit.yaml"))
        rig.connect()
        for seq, clearance in [(0, -9.0e-8), (3100, -6.0e-8), (3000, -7.0e-8), (15100, 2.0e-8)]:
            answer = rig.set_contact(STIFFNESS, clearance, seq)
            self.assertTrue(answer.success, answer.message)
        first = [block(seq) for seq in range(0, 10000, BLOCK)]
        # A shaker that begins anew counts the same samples again; 500 samples of it are lost, and bridged over.
        second = [block(seq, 1700000100) for seq in range(0, 10000, BLOCK) if not 4000 <= seq < 4500]
        last = [block(seq, 1700000200) for seq in range(12000, 20000, BLOCK)]
        published = 0
        for blocks, change in [(first, None), (second[:16], (0.7 * STIFFNESS, -2.0e-8, 0)),
                               (second[16:], (0.8 * STIFFNESS, 0.0, 4200)), (last, None)]:
            if change:
                answer = rig.set_contact(*change)
                self.assertTrue(answer.success, answer.message)
            for message in blocks:
                rig.publisher.publish(message)
            published += len(blocks)
            rig.answered(published)
        infos = rig.messages["model_info"]
        self.assertEqual([info.seq for info in infos], [0, 0, 3000, 3100, 0, 4200, 15100])

        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        path = os.path.join(directory.name, "run.bag")
        with rosbag.Bag(path, "w") as bag:
            for message in first + second + last:
                bag.write("base_excitation", message, message.header.stamp)
            for info in infos:  # a recorder hears of a change when the block is answered in which it was made
                stamp = info.header.stamp if info.number > 0 else first[0].header.stamp
                bag.write("model_info", info, stamp + rospy.Duration(0.005))
        out = os.path.join(directory.name, "out")
        report = subprocess.check_output(
            [find_node("vibro_impact", "simulate")[0], "--bag", path, "--out", out], universal_newlines=True)
        self.assertIn("500 bridged, 2 restarts from rest, 0 blocks refused", report)

        impacts = table(os.path.join(out, "impacts.csv"))
        self.assertEqual(len(impacts), len(rig.messages["impact"]))  # the excitation ends while the beams are apart
        self.assertGreater(len(impacts), 50)
        for row, impact in zip(impacts, rig.messages["impact"]):
            self.assertEqual(row["duration_s"], impact.duration)
            for name in ("number", "impulse", "peak_force", "approach_speed", "separation_speed", "energy_lost", "cut_short"):
                self.assertEqual(row[name], getattr(impact, name), name)
        history = table(os.path.join(out, "history.csv"))
        bridged = len(first) * BLOCK + 4000
        del history[bridged:bridged + 500]
        self.assertEqual([row["gap"] for row in history], [gap for message in rig.messages["gap"] for gap in message.gap])
        self.assertEqual([row["force"] for row in history],
                         [force for message in rig.messages["contact_force"] for force in message.force])

    def test_bad_values_change_nothing(self):
        rig = SimulatorRig(self, self.namespace, configuration("interference_fit.yaml"))
        rig.connect()
        for seq in range(0, 1000, BLOCK):
            rig.publisher.publish(block(seq))
        rig.answered(4)
        self.refused(rig, -1.0, 0.0, 0, "contact.stiffness = -1")
        self.refused(rig, 0.0, 0.0, 0, "contact.stiffness")
        self.refused(rig, math.nan, 0.0, 0, "contact.stiffness = nan")
        self.refused(rig, STIFFNESS, math.inf, 0, "contact.clearance = inf")
        self.refused(rig, 1.0e30, 0.0, 0, "k L^3/(E I)")
        self.refused(rig, STIFFNESS, 0.0, 999, "seq: 999 has been simulated; allowed: 0, the next sample, or at least 1000")
        rig.publisher.publish(block(1000))
        rig.answered(5)
        self.assertEqual(len(rig.messages["model_info"]), 1)
        self.assertEqual(rig.count("Contact changes"), 0)
        self.assertIn("contact not changed: contact.stiffness", self.printed())

    def test_replay_refuses_what_it_cannot_replay(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)

        def replay(*arguments):
            result = subprocess.run([os.path.join(PACKAGE, "scripts", "replay_contact"), *arguments],
                                    stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, check=False)
            self.assertEqual(result.returncode, 1, result.stdout)
            self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
            return result.stderr

        def bag(name, *infos):
            path = os.path.join(directory.name, name)
            with rosbag.Bag(path, "w") as file:
                file.write("base_excitation", block(0), rospy.Time(1))
                for info in infos:
                    file.write("model_info", info, rospy.Time(1))
            return path

        good = yaml.safe_dump(configuration("interference_fit.yaml"))
        self.assertIn("nowhere.bag", replay(os.path.join(directory.name, "nowhere.bag")))
        self.assertIn("holds 0 topics of type vibro_impact/ModelInfo", replay(bag("none.bag")))
        self.assertIn("holds a model_info that cannot be read", replay(bag("bad.bag", ModelInfo(configuration="contact: 3"))))
        lost = bag("lost.bag", ModelInfo(configuration=good), ModelInfo(configuration=good, number=2))
        self.assertIn("number 1 is missing", replay(lost))
        whole = bag("whole.bag", ModelInfo(configuration=good))
        self.assertIn("/nobody/set_contact", replay(whole, "--node", "/nobody", "--timeout", "0.5"))


if __name__ == "__main__":
    rospy.init_node("contact_change_test")
    rostest.rosrun("vibro_impact", "contact_change_test", ContactChangeTest)
