#!/usr/bin/python3
"""What goes wrong on a ship, staged with real processes; doc/operations.md says what comes of it."""

import itertools
import math
import os
import re
import resource
import signal
import subprocess
import tempfile
import time
from xmlrpc.client import ServerProxy

import rosbag
import rosgraph
import rospkg
import rospy
import rostest
import yaml
from diagnostic_msgs.msg import DiagnosticArray
from roslib.packages import find_node
from rosgraph_msgs.msg import Clock

from node_process import PATIENCE, NodeProcessTest, free_port, is_connected, wait_until
from vibro_impact.msg import BaseExcitation, Gap

PACKAGE = rospkg.RosPack().get_path("vibro_impact")
TOPICS = ["base_excitation", "gap", "contact_force", "impact", "model_info", "stream_start"]
RATE = 10000.0
BLOCK = 100
# Slow, an impact a cycle: a recorder, which takes in 100 of them, may be kept waiting.
FREQUENCY = 54.0
START = 1.7e9
# Blocks that a shaker that waits for its recorder has on their way at most.
ON_THEIR_WAY = 50


def configuration(**other):
    with open(os.path.join(PACKAGE, "config", "limiting_case.yaml")) as stream:
        return dict(yaml.safe_load(stream), diagnostic_period=0.1, **other)


def sine(duration, **other):
    """For a simulator and a recorder."""
    parameters = {
        "signal": {"type": "sine", "acceleration": 10.0, "frequency": FREQUENCY, "duration": duration},
        "sample_rate": RATE, "block_rate": RATE / BLOCK, "wait_for_subscribers": 2, "linger": 0.2,
        "timeout": PATIENCE}
    parameters.update(other)
    return parameters


def block(seq, stamp):
    """Of the same sine, for tests that choose the stamps."""
    message = BaseExcitation(seq=seq, sample_period=1.0 / RATE)
    message.header.stamp = rospy.Time.from_sec(stamp)
    message.acceleration = [10.0 * math.sin(2.0 * math.pi * FREQUENCY * i / RATE) for i in range(seq, seq + BLOCK)]
    return message


def memory(process):
    """Resident memory in MB."""
    with open("/proc/%d/status" % process.pid) as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmRSS:")) / 1000.0


def recorded(path, topic):
    with rosbag.Bag(path) as bag:
        return [record.message for record in bag.read_messages() if record.topic.split("/")[-1] == topic]


class FaultsTest(NodeProcessTest):
    node = "simulator"

    def setUp(self):
        super().setUp()
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = directory.name
        self.bag = os.path.join(self.directory, "run.bag")
        self.values = {}
        self.interfaces.append(rospy.Subscriber("/diagnostics", DiagnosticArray, self.on_diagnostics))

    def on_diagnostics(self, message):
        for status in message.status:
            name = status.name.lstrip("/")
            if name.startswith(self.namespace.lstrip("/") + "/simulator: "):
                self.values.update({value.key: value.value for value in status.values})

    def spawn(self, command, **options):
        process = subprocess.Popen(command, stdout=self.output, stderr=subprocess.STDOUT, **options)
        self.processes.append(process)
        return process

    def start_node(self, node, parameters, **options):
        rospy.set_param(self.namespace + "/" + node, parameters)
        return self.spawn([find_node("vibro_impact", node)[0], "__ns:=" + self.namespace, "__name:=" + node], **options)

    def record(self, *options, bag=None, name="record", topics=None, **process):
        return self.spawn([find_node("rosbag", "record")[0], "-O", bag or self.bag, "-b", "0", "--tcpnodelay", *options,
                           *(topics or TOPICS), "__ns:=" + self.namespace, "__name:=" + name], **process)

    def end(self, process, status=0, ask=signal.SIGINT):
        process.send_signal(ask)
        self.assertEqual(process.wait(PATIENCE), status, self.printed())

    def expect(self, condition):
        self.assertTrue(wait_until(condition), self.printed())

    def ended(self, shaker):
        """How many samples it has published, as it says itself."""
        self.assertEqual(shaker.wait(PATIENCE), 0, self.printed())
        return int(re.findall(r"published (\d+) samples", self.printed())[-1])

    def samples(self, *kinds):
        return sum(int(self.values.get("Samples " + kind, 0)) for kind in kinds)

    def expect_balance(self, sent):
        """Whatever was sent to the simulator was received, refused, discarded while it paused, or counted as lost."""
        self.expect(lambda: self.samples("accepted", "refused", "discarded", "lost") == sent)

    def subscribe(self, topic, kind):
        messages = []
        self.interfaces.append(rospy.Subscriber(self.namespace + "/" + topic, kind, messages.append, queue_size=None))
        return messages

    def check(self, *arguments, bag=None):
        result = subprocess.run([find_node("vibro_impact", "replay_check")[0], bag or self.bag, *arguments],
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, check=False)
        return result.returncode, result.stdout + result.stderr

    def connected_recorder(self, *options, **process):
        """A recorder to which the simulator sends all that there will be."""
        recorder = self.record(*options, **process)
        address = rosgraph.Master(rospy.get_name())

        def connected():
            try:
                _, _, connections = ServerProxy(address.lookupNode(self.namespace + "/simulator")).getBusInfo("/test")
            except (rosgraph.MasterException, OSError):
                return False
            topics = {connection[4] for connection in connections if connection[1] == self.namespace + "/record"}
            return topics.issuperset(self.namespace + "/" + topic for topic in TOPICS[1:])

        self.expect(connected)
        return recorder

    def has_written(self, recorder, **messages):
        """Whether the recorder has received so many messages of these topics, and sleeps."""
        address = rosgraph.Master(rospy.get_name()).lookupNode(self.namespace + "/record")
        # roscpp says of each topic [number of the connection, bytes, messages, ...].
        received = {topic: sum(connection[2] for connection in connections)
                    for topic, connections in ServerProxy(address).getBusStats(rospy.get_name())[1]}
        tasks = "/proc/%d/task" % recorder.pid
        states = [open(os.path.join(tasks, task, "stat")).read().rpartition(")")[2].split()[0] for task in os.listdir(tasks)]
        return set(states) == {"S"} and all(
            received.get(self.namespace + "/" + topic, 0) >= count for topic, count in messages.items())

    def end_recorder(self, recorder):
        """Ends it when it has written all that the simulator has published."""
        accepted, impacts = int(self.values["Blocks accepted"]), int(self.values["Impacts"])
        self.expect(lambda: self.has_written(recorder, gap=accepted, contact_force=accepted, impact=impacts))
        self.end(recorder)

    def expect_identical(self, samples, bag=None):
        status, report = self.check(bag=bag)
        self.assertEqual(status, 0, report)
        self.assertIn("identical: ", report)
        self.assertIn(", %d samples, " % samples, report)

    def expect_identical_where_compared(self, bag=None):
        status, report = self.check("--allow-gaps", bag=bag)
        self.assertEqual(status, 0, report)
        return report

    def process_of(self, node):
        """None while the master knows only one that does not answer."""
        try:
            return ServerProxy(rosgraph.Master(rospy.get_name()).lookupNode(node)).getPid(rospy.get_name())[2]
        except (rosgraph.MasterException, OSError):
            return None

    def test_simulator_killed_and_respawned(self):
        gaps = self.subscribe("gap", Gap)
        rospy.set_param(self.namespace + "/simulator/diagnostic_period", 0.1)
        launch = self.spawn(["roslaunch", os.path.join(PACKAGE, "launch", "simulator.launch"), "respawn:=true",
                             "diagnostic_period:=0.1"],
                            env=dict(os.environ, ROS_NAMESPACE=self.namespace))
        recorder = self.connected_recorder()
        publisher = self.advertise()
        # As many blocks as it takes, however long another simulator needs to start.
        blocks = (block(seq, START + seq / RATE) for seq in itertools.count(0, BLOCK))
        sent = 0

        def shake_until(condition):
            nonlocal sent

            def shaken():
                nonlocal sent
                if condition():
                    return True
                publisher.publish(next(blocks))
                sent += BLOCK
                return False

            self.expect(shaken)

        shake_until(lambda: len(gaps) > 50)
        node = self.namespace + "/simulator"
        first = self.process_of(node)
        self.values.clear()
        os.kill(first, signal.SIGKILL)
        shake_until(lambda: self.process_of(node) not in (None, first))
        answered = len(gaps)
        shake_until(lambda: len(gaps) > answered + 50 and self.samples("accepted") > 0)
        self.expect(lambda: gaps[-1].seq == sent - BLOCK and self.has_written(recorder, base_excitation=sent // BLOCK))
        self.end(recorder)
        self.end(launch)
        # The recorder, which nothing has happened to, has all that was sent.
        self.assertEqual(sum(len(message.acceleration) for message in recorded(self.bag, "base_excitation")), sent)
        report = self.expect_identical_where_compared()
        self.assertIn("\n2 starts from rest", report)
        # What came while nobody was there, or before the recorder had found the second simulator, is named.
        blocks = [int(count) for count in re.findall(r"(\d+) blocks, |(?<=, )(\d+) not taken|gap: .*?(\d+) blocks?\)", report)
                  for count in count if count]
        self.assertEqual(sum(blocks), sent // BLOCK, report)
        # And all that the second was sent is counted by it.
        counted = self.samples("accepted", "refused", "lost")
        self.assertEqual(int(self.values["Restarts"]), 0)
        self.assertEqual(counted % BLOCK, 0)
        self.assertLess(counted, sent - 50 * BLOCK)
        self.assertGreater(counted, 0)

    def test_shaker_killed_and_restarted(self):
        gaps = self.subscribe("gap", Gap)
        self.start_node("simulator", configuration())
        recorder = self.record()
        shaker = self.start_node("shaker", sine(1000.0, recorder="record"))
        self.expect(lambda: len(gaps) > 50)
        shaker.kill()
        shaker.wait()
        before = len(gaps)
        sent = self.ended(self.start_node("shaker", sine(1.0, recorder="record")))
        self.assertEqual(sent, 10000)
        self.expect(lambda: int(self.values.get("Restarts", 0)) == 1 and gaps[-1].seq == sent - BLOCK)
        self.assertGreaterEqual(len(gaps), before + sent // BLOCK)
        self.expect_balance(len(gaps) * BLOCK)
        self.assertEqual(self.samples("lost", "refused"), 0)
        self.end(recorder)
        # What one of two subscribers still got of the shaker that was killed may be missing at the other.
        self.assertIn("\n2 starts from rest, ", self.expect_identical_where_compared())
        self.assertLessEqual(abs(len(recorded(self.bag, "base_excitation")) - len(gaps)), ON_THEIR_WAY)

    def test_recorder_killed_in_the_middle_of_a_chunk(self):
        active = self.bag + ".active"
        self.start_node("simulator", configuration())
        recorder = self.connected_recorder("--chunksize=128")
        # At real time: nobody waits for the recorder, which drops what it cannot take.
        parameters = sine(0.0)
        parameters["signal"] = {"type": "stepped_sine", "acceleration": 10.0, "start_frequency": 50.0,
                                "stop_frequency": 64.0, "frequency_step": 1.0, "cycles_per_step": 20}
        shaker = self.start_node("shaker", parameters)
        self.expect(lambda: os.path.getsize(active) > 6e5)  # 20 000 samples and their answers, some five steps
        recorder.kill()
        recorder.wait()
        sent = self.ended(shaker)
        self.expect_balance(sent)  # the others never noticed
        status, report = self.check(bag=active)
        self.assertEqual(status, 2)
        self.assertIn("has no index, the recording did not end properly; 'rosbag reindex' repairs it", report)
        subprocess.check_call(["rosbag", "reindex", active], stdout=subprocess.DEVNULL)
        self.expect_identical_where_compared(bag=active)
        self.assertGreater(len(recorded(active, "base_excitation")), 100)
        extraction = subprocess.run(
            [find_node("vibro_impact", "extract_frf")[0], active, "--allow-gaps", "--out", self.directory + "/frf"],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, check=False)
        self.assertEqual(extraction.returncode, 0, extraction.stdout + extraction.stderr)
        self.assertGreater(int(re.search(r"(\d+) steps found", extraction.stdout).group(1)), 3)

    def test_subscriber_that_stops_reading(self):
        gaps = self.subscribe("gap", Gap)
        queue = 50
        simulator = self.start_node("simulator", configuration(queue_size=queue))
        recorder = self.record()
        slow_bag = os.path.join(self.directory, "slow.bag")
        slow = self.record(bag=slow_bag, name="slow", topics=["gap", "impact"])
        # 200 blocks of 20 kB a second: more than what the kernel takes in for a program that does not read.
        parameters = sine(11.5, sample_rate=500000.0, block_rate=200.0, max_blocks_ahead=queue // 2, recorder="record")
        shaker = self.start_node("shaker", parameters)
        self.expect(lambda: len(gaps) > 20 and is_connected(self.namespace + "/simulator", [self.namespace + "/gap"]))
        before = memory(simulator)
        slow.send_signal(signal.SIGSTOP)
        heard = len(gaps)
        most = before
        while len(gaps) <= heard + 36 * queue and shaker.poll() is None:
            most = max(most, memory(simulator))
            time.sleep(0.1)
        slow.send_signal(signal.SIGCONT)
        # A queue of 50 blocks is 1 MB; what came meanwhile is 36 MB. A sanitizer keeps what has been freed for a while.
        if not {"ASAN_OPTIONS", "TSAN_OPTIONS"} & set(os.environ):
            self.assertLess(most - before, 15.0, "memory before, MB: %.1f" % before)
        self.assertGreater(len(gaps), heard + 20 * queue)
        sent = self.ended(shaker)  # and the recorder has lost nothing, or the shaker would have failed
        self.expect_balance(sent)
        self.assertEqual(self.samples("lost", "refused"), 0)
        self.end(slow)
        self.end(recorder)
        self.expect_identical(sent)
        # What the stopped one has missed it can see, and the simulator says so, too.
        numbers = [message.seq for message in recorded(slow_bag, "gap")]
        size = len(gaps[0].gap)
        missed = sum((after - number) // size - 1 for number, after in zip(numbers, numbers[1:]))
        self.assertGreater(missed, 0)
        self.assertIn("Messages dropped", self.values)
        self.assertGreater(int(self.values["Messages dropped"]), 0)

    def start_master(self, environment):
        """A master of the test's own, at the address that the environment says."""
        address = environment["ROS_MASTER_URI"]
        master = self.spawn(["rosmaster", "--core", "-p", address.rpartition(":")[2]], env=environment)
        proxy = ServerProxy(address)

        def answers():
            try:
                return proxy.getPid("/test")[0] == 1
            except OSError:
                return False

        self.expect(answers)
        return master, proxy

    def own_environment(self):
        return dict(os.environ, ROS_MASTER_URI="http://localhost:%d" % free_port())

    def start_at(self, proxy, environment, node, parameters):
        proxy.setParam("/test", "%s/%s" % (self.namespace, node), parameters)
        return self.spawn([find_node("vibro_impact", node)[0], "__ns:=" + self.namespace, "__name:=" + node],
                          env=environment)

    def test_master_stopped_and_restarted(self):
        environment = self.own_environment()
        master, proxy = self.start_master(environment)
        simulator = self.start_at(proxy, environment, "simulator", configuration())
        recorder = self.record(env=environment)
        shaker = self.start_at(proxy, environment, "shaker", sine(1000.0, recorder="record", progress_period=0.5))
        self.expect(lambda: " x real time" in self.printed())
        self.end(master)
        printed = self.printed().count(" x real time")
        self.expect(lambda: self.printed().count(" x real time") >= printed + 2)
        self.start_master(environment)
        self.end(shaker)
        sent = int(re.findall(r"ended after (\d+) of", self.printed())[-1])
        self.end(simulator)
        self.end(recorder)
        # It was ended in the middle: what was on its way to the recorder then may be missing, and nothing before.
        for topic in ("base_excitation", "gap", "contact_force"):
            numbers = [message.seq for message in recorded(self.bag, topic)]
            self.assertEqual(numbers, list(range(0, len(numbers) * BLOCK, BLOCK)), topic)
            self.assertLessEqual(sent // BLOCK - len(numbers), ON_THEIR_WAY, topic)
        self.assertIn("\n1 start from rest, ", self.expect_identical_where_compared())

    def test_nodes_end_without_a_master(self):
        environment = self.own_environment()
        master, proxy = self.start_master(environment)
        simulator = self.start_at(proxy, environment, "simulator", configuration())
        shaker = self.start_at(proxy, environment, "shaker", sine(1000.0, wait_for_subscribers=1, progress_period=0.5))
        self.expect(lambda: " x real time" in self.printed())
        self.end(master)
        self.end(simulator)
        self.end(shaker)

    def play(self, blocks, gaps, recorder, refused=()):
        """Sends one block after another, each when the one before is answered."""
        publisher = self.advertise()
        for message in blocks:
            answered = len(gaps)
            publisher.publish(message)
            if message.seq not in refused:
                self.expect(lambda expected=answered + 1: len(gaps) == expected)
            if message.seq % (10 * BLOCK) == 0:
                # The recorder's queue takes 100 impacts.
                self.expect(lambda: self.has_written(recorder, gap=len(gaps)))

    def advertise(self):
        publisher = rospy.Publisher(self.namespace + "/base_excitation", BaseExcitation, queue_size=1000)
        self.interfaces.append(publisher)
        self.expect(lambda: publisher.get_num_connections() == 2 and is_connected(
            self.namespace + "/simulator", [self.namespace + "/gap", "/diagnostics"]))
        return publisher

    def test_clock_of_the_stream_steps_back_and_forth(self):
        gaps = self.subscribe("gap", Gap)
        self.start_node("simulator", configuration())
        recorder = self.connected_recorder()
        blocks = []
        offset = START
        for seq in range(0, 100 * BLOCK, BLOCK):
            # An hour on, back again, a little back within what is a repetition, and for good.
            offset += {20: 3600.0, 40: -3600.0, 60: -0.06, 61: 0.06, 80: -5.0}.get(seq // BLOCK, 0.0)
            blocks.append(block(seq, offset + seq / RATE))
        self.play(blocks, gaps, recorder, refused=[60 * BLOCK])
        self.expect_balance(len(blocks) * BLOCK)
        self.assertEqual(self.values["Restarts"], "3")
        self.assertEqual(self.values["Blocks refused"], "1")
        self.assertEqual(self.samples("bridged"), BLOCK)  # the refused one
        self.assertEqual(len(gaps), 99)
        self.end_recorder(recorder)
        self.expect_identical(99 * BLOCK)

    def test_simulated_clock_steps_back_and_forth(self):
        gaps = self.subscribe("gap", Gap)
        rospy.set_param("/use_sim_time", True)
        self.addCleanup(rospy.delete_param, "/use_sim_time")
        self.start_node("simulator", configuration())
        clock = rospy.Publisher("/clock", Clock, queue_size=10)
        self.interfaces.append(clock)
        self.expect(lambda: clock.get_num_connections() == 1)
        rospy.set_param("/use_sim_time", False)
        recorder = self.connected_recorder()
        times = [1000.0, 5000.0, 4000.0, 0.0, 1.0e9, 999.0]

        def blocks():
            for seq in range(0, 60 * BLOCK, BLOCK):
                if seq % (10 * BLOCK) == 0:
                    clock.publish(Clock(clock=rospy.Time.from_sec(times[seq // (10 * BLOCK)])))
                yield block(seq, START + seq / RATE)

        self.play(blocks(), gaps, recorder)
        self.expect_balance(60 * BLOCK)
        self.assertEqual(self.values["Restarts"], "0")
        self.assertEqual(len(gaps), 60)
        self.end_recorder(recorder)
        self.expect_identical(60 * BLOCK)

    def test_disk_full_while_recording(self):
        gaps = self.subscribe("gap", Gap)
        limit = 1 << 20
        simulator = self.start_node("simulator", configuration())
        # A limit on the size of its files is to a program what a full disk is: a write that fails.
        recorder = self.connected_recorder(
            "--chunksize=64", "--min-space=0",
            preexec_fn=lambda: (signal.signal(signal.SIGXFSZ, signal.SIG_IGN),
                                resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))))
        shaker = self.start_node("shaker", sine(20.0, speed=10.0, recorder="record", timeout=5.0))
        # The recorder dies of it. The shaker, which waits for it, says so and ends with a failure.
        self.assertEqual(recorder.wait(PATIENCE), -signal.SIGABRT, self.printed())
        self.assertEqual(shaker.wait(PATIENCE), 1, self.printed())
        self.assertIn("in vain for %s/record to receive" % self.namespace, self.printed())
        self.expect(lambda: self.samples("accepted") == len(gaps) * BLOCK)
        self.assertEqual(self.samples("lost", "refused"), 0)
        # The simulator goes on.
        sent = self.ended(self.start_node("shaker", sine(0.5, wait_for_subscribers=1)))
        self.expect(lambda: gaps[-1].seq == sent - BLOCK)
        self.assertIsNone(simulator.poll())
        # What is on the disk can be used elsewhere.
        active = self.bag + ".active"
        self.assertLessEqual(os.path.getsize(active), limit)
        subprocess.check_call(["rosbag", "reindex", active], stdout=subprocess.DEVNULL)
        self.expect_identical_where_compared(bag=active)
        self.assertGreater(len(recorded(active, "gap")), 50)

    def test_no_room_to_record_from_the_start(self):
        self.start_node("simulator", configuration())
        self.assertEqual(self.record("--min-space=9000000G").wait(PATIENCE), 1, self.printed())
        shaker = self.start_node("shaker", sine(1.0, recorder="record", timeout=1.0))
        self.assertEqual(shaker.wait(PATIENCE), 1, self.printed())
        self.assertIn("in vain for ", self.printed())
        self.assertIn("%s/record to record %s/gap" % (self.namespace, self.namespace), self.printed())
        self.assertEqual(self.samples("accepted", "refused", "lost"), 0)

    def test_configuration_edited_wrongly_between_restarts(self):
        simulator = self.start_node("simulator", configuration())
        recorder = self.record()
        sent = self.ended(self.start_node("shaker", sine(1.0, recorder="record")))
        self.expect_balance(sent)
        self.end(simulator)
        self.end(recorder)
        wrong = configuration()
        wrong["contact"]["stiffness"] = "1e4 N/m"
        wrong["beam1"]["lenght"] = wrong["beam1"].pop("length")
        wrong["max_bridged_gap"] = -1.0
        self.assertEqual(self.start_node("simulator", wrong).wait(PATIENCE), 1)
        printed = self.printed()
        self.assertEqual(printed.count("FATAL"), 1, printed)
        for fault in ["contact.stiffness", "1e4 N/m", "beam1.length is missing", "lenght", "max_bridged_gap = -1"]:
            self.assertIn(fault, printed)
        self.assertNotIn(self.namespace + "/gap", [topic for topic, _ in rospy.get_published_topics()])
        self.expect_identical(sent)


if __name__ == "__main__":
    rospy.init_node("faults_test")
    rostest.rosrun("vibro_impact", "faults_test", FaultsTest)
