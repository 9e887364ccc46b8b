#!/usr/bin/python3
"""The monitor on real nodes: its sums are those of the bag, its alarms come and go, its wear opens the gap."""

import math
import os
import re
import signal
import subprocess
import tempfile
from xmlrpc.client import ServerProxy

import rosbag
import rosgraph
import rospy
import rostest
import yaml
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from roslib.packages import find_node
from std_msgs.msg import Header
from vibro_impact.msg import AlarmArray, BaseExcitation, ContactForce, Impact, ImpactStatistics, ModelInfo

from node_process import PATIENCE, NodeProcessTest, is_connected, wait_until
from simulator_rig import PACKAGE, configuration

PERIOD = 2.0e-5
BLOCK = 250
START = 1700000000
# Lowest natural frequency of the beam of config/limiting_case.yaml, Hz.
REFERENCE_FREQUENCY = 271.45727650517387
WEAR = {"coefficient": 1.0e-3, "source": "invented, to be seen within a second", "area": 1.0e-6, "sliding_speed": 0.5}


def stamp(sample):
    return rospy.Time(START) + rospy.Duration(nsecs=sample * 20000)


def excitation(seq, amplitude):
    """A block of a sine near the resonance, amplitude in m/s^2."""
    message = BaseExcitation(seq=seq, sample_period=PERIOD)
    message.header.stamp = stamp(seq)
    message.acceleration = [amplitude * math.sin(1.6 * 2.0 * math.pi * REFERENCE_FREQUENCY * i * PERIOD)
                            for i in range(seq, seq + BLOCK)]
    return message


def released(impact):
    """Time of the release, ns; as the monitor rounds it."""
    return impact.header.stamp.to_nsec() + int(math.floor(impact.duration * 1.0e9 + 0.5))


def processor_time(process):
    """Of a process that runs, s."""
    with open("/proc/%d/stat" % process.pid) as stat:
        fields = stat.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class MonitorTest(NodeProcessTest):
    def run_node(self, node, parameters):
        self.node = node
        return self.start(parameters)

    def listen(self, topic, kind):
        heard = []
        name = topic if topic.startswith("/") else self.namespace + "/" + topic
        self.interfaces.append(rospy.Subscriber(name, kind, heard.append, queue_size=None, tcp_nodelay=True))
        return heard

    def publisher(self, topic, kind, latch=False):
        publisher = rospy.Publisher(self.namespace + "/" + topic, kind, queue_size=0, latch=latch)
        self.interfaces.append(publisher)
        return publisher

    def expect(self, condition):
        self.assertTrue(wait_until(condition), self.printed())

    def connected(self, subscriber, node, topics):
        """Waits until `node` sends these topics of the namespace to `subscriber`."""
        master = rosgraph.Master(rospy.get_name())

        def all_sent():
            try:
                address = master.lookupNode(self.namespace + "/" + node)
                connections = ServerProxy(address).getBusInfo(rospy.get_name())[2]
            except (rosgraph.MasterException, OSError):
                return False
            sent = {c[4] for c in connections if c[1] == self.namespace + "/" + subscriber and c[2] == "o"}
            return sent.issuperset(self.namespace + "/" + topic for topic in topics)

        self.expect(all_sent)

    def start_monitor(self, **parameters):
        """The monitor, and all that it says; it is heard before it is started. A machine that stands still is no silence."""
        self.statistics = self.listen("impact_statistics", ImpactStatistics)
        self.alarms = self.listen("alarm", AlarmArray)
        self.diagnostics = self.listen("/diagnostics", DiagnosticArray)
        self.run_node("monitor", dict({"diagnostic_period": 0.2, "queue_size": 0, "silence": 3600.0}, **parameters))
        self.expect(lambda: is_connected(self.namespace + "/monitor", [
            self.namespace + "/impact_statistics", self.namespace + "/alarm", "/diagnostics"]))

    def value(self, key):
        """A value of the monitor's latest diagnostics; nothing before the first."""
        for message in reversed(self.diagnostics):
            for status in message.status:
                if status.name.lstrip("/").startswith(self.namespace.lstrip("/") + "/monitor:"):
                    for value in status.values:
                        if value.key == key:
                            return value.value
        return None

    def start_graph(self, config, **parameters):
        self.publisher_ = self.publisher("base_excitation", BaseExcitation)
        self.infos = self.listen("model_info", ModelInfo)
        self.forces = self.listen("contact_force", ContactForce)
        self.impacts = self.listen("impact", Impact)
        self.run_node("simulator", configuration(config))
        self.start_monitor(**parameters)
        self.connected("monitor", "simulator", ["gap", "contact_force", "impact", "model_info"])
        self.expect(lambda: self.publisher_.get_num_connections() == 2 and is_connected(
            self.namespace + "/simulator",
            [self.namespace + "/" + topic for topic in ("contact_force", "impact", "model_info")]))

    def play(self, first, blocks, amplitude):
        for i in range(first, first + blocks):
            self.publisher_.publish(excitation(BLOCK * i, amplitude))
        self.expect(lambda: len(self.forces) == first + blocks)

    def test_its_sums_are_those_of_the_bag(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        path = os.path.join(directory.name, "run.bag")
        self.run_node("simulator", configuration("limiting_case.yaml"))
        self.start_monitor(window=0.5, report_period=0.1, settling_time=5.0, wear=WEAR)
        topics = ["base_excitation", "gap", "contact_force", "impact", "model_info"]
        recorder = subprocess.Popen(
            [find_node("rosbag", "record")[0], "-O", path, "-b", "0", "--tcpnodelay",
             *(self.namespace + "/" + topic for topic in topics), "__name:=record", "__ns:=" + self.namespace],
            stdout=self.output, stderr=subprocess.STDOUT)
        self.processes.append(recorder)
        for listener in ("monitor", "record"):
            self.connected(listener, "simulator", topics[1:])
        self.node = "shaker"
        shaker = self.start({
            "signal": {"type": "stepped_sine", "acceleration": 10.0, "reference_frequency": REFERENCE_FREQUENCY,
                       "start_frequency": 1.55, "stop_frequency": 1.75, "frequency_step": 0.05, "cycles_per_step": 150,
                       "soft_start_cycles": 20},
            "sample_rate": 50000.0, "speed": 0.0, "max_blocks_ahead": 10, "wait_for_subscribers": 3,
            "recorder": "record"})
        self.assertEqual(shaker.wait(PATIENCE), 0, self.printed())
        samples = int(self.printed().split("published ")[-1].split()[0])
        recorder.send_signal(signal.SIGINT)
        self.assertEqual(recorder.wait(PATIENCE), 0)

        with rosbag.Bag(path) as bag:
            read = {topic: [message for _, message, _ in bag.read_messages(self.namespace + "/" + topic)] for topic in topics}
        forces = [force for block in read["contact_force"] for force in block.force]
        self.origin = read["contact_force"][0].header.stamp.to_nsec()
        self.assertEqual(len(forces), samples)
        self.expect(lambda: self.value("Samples of force") == str(samples) and
                    self.value("Impacts") == str(len(read["impact"])))
        # An hour later: another stretch, so that the one that was recorded ends with statistics at its last block.
        to_force = self.publisher("contact_force", ContactForce)
        self.expect(lambda: to_force.get_num_connections() == 1)
        later = read["contact_force"][-1].header.stamp + rospy.Duration(3600)
        to_force.publish(ContactForce(header=Header(stamp=later), seq=samples, sample_period=PERIOD, force=[0.0]))
        self.expect(lambda: self.statistics and abs(self.statistics[-1].total_time - samples * PERIOD) < 0.1 * PERIOD)
        statistics_heard = self.statistics
        for statistics in statistics_heard:
            self.compare(statistics, read["impact"], forces)
        last = statistics_heard[-1]
        self.assertGreater(last.total_impacts, 500)
        self.assertEqual(last.total_impacts + last.total_cut_short, len(read["impact"]))
        self.assertEqual((last.missing_impacts, last.missing_samples, last.late_impacts, last.restarts), (0, 0, 0, 0))
        self.assertGreater(len(statistics_heard), 15)
        # In the steady part of a step the drive is known, and so is the period.
        self.assertAlmostEqual(last.drive_frequency, 1.75 * REFERENCE_FREQUENCY, delta=1.0e-5 * REFERENCE_FREQUENCY)
        self.assertIn(1, [statistics.period for statistics in statistics_heard])

    def compare(self, statistics, impacts, forces):
        """Sums in the order of the bag, which is the monitor's: equal to the bit but for products and quotients."""
        time = statistics.header.stamp.to_nsec()
        begin = time - 500000000
        samples = (time - self.origin) // 20000
        first = max(0, (begin - self.origin) // 20000)
        window = (samples - first) * PERIOD
        for impact_sums, since in ((True, begin), (False, 0)):
            heard = [impact for impact in impacts if since < released(impact) <= time]
            whole = [impact.impulse for impact in heard if not impact.cut_short]
            impulse = sum(impact.impulse for impact in heard)
            energy = sum(impact.energy_lost for impact in heard)
            if impact_sums:
                self.assertEqual((statistics.impacts, statistics.cut_short), (len(whole), len(heard) - len(whole)))
                self.assertEqual(statistics.impulse_max, max(whole, default=0.0))
                self.assertEqual(statistics.impulse_mean, sum(whole) / len(whole) if whole else 0.0)
                self.assertAlmostEqual(
                    statistics.impulse_rms, math.sqrt(sum(i * i for i in whole) / max(1, len(whole))), delta=1.0e-18)
                self.assertEqual(statistics.peak_force, max((impact.peak_force for impact in heard), default=0.0))
                edges = [-1.0, *statistics.histogram_edges, math.inf]
                self.assertEqual(list(statistics.histogram), [
                    sum(low <= i < high for i in whole) for low, high in zip(edges, edges[1:])])
                self.near(statistics.window, window)
                self.near(statistics.impact_rate, len(whole) / window)
                self.near(statistics.mean_force, impulse / window)
                self.near(statistics.impact_power, energy / window)
                self.near(statistics.normal_work_rate, 0.5 * impulse / window)
                self.near(statistics.wear_rate, 1.0e-3 * 0.5 * impulse / window)
                self.near(statistics.contact_duty, sum(force != 0.0 for force in forces[first:samples]) * PERIOD / window)
            else:
                self.assertEqual((statistics.total_impacts, statistics.total_cut_short), (len(whole), len(heard) - len(whole)))
                self.assertEqual(statistics.total_impulse, impulse)
                self.assertEqual(statistics.total_energy_lost, energy)
                self.assertEqual(statistics.total_normal_work, 0.5 * impulse)
                self.assertEqual(statistics.wear_volume, 1.0e-3 * (0.5 * impulse))
                self.assertEqual(statistics.wear_depth, 1.0e-3 * (0.5 * impulse) / 1.0e-6)
                self.near(statistics.total_time, samples * PERIOD)
                self.near(statistics.total_contact_time, sum(force != 0.0 for force in forces[:samples]) * PERIOD)

    def near(self, value, expected):
        self.assertAlmostEqual(value, expected, delta=1.0e-12 * abs(expected))

    def impacts_every(self, gap, first, count, start):
        """`count` impacts, one every `gap` s from `start` (s after START) on, numbered from `first`."""
        return [Impact(header=Header(stamp=rospy.Time(START) + rospy.Duration(start + gap * i)), number=first + i,
                       duration=1.0e-4, impulse=1.0e-6, peak_force=0.02) for i in range(count)]

    def force(self, start, samples):
        """A block of contact_force without contact, 1 kHz."""
        return ContactForce(header=Header(stamp=rospy.Time(START) + rospy.Duration(1.0e-3 * start)), seq=start,
                            sample_period=1.0e-3, force=[0.0] * samples)

    def start_alone(self, **parameters):
        """A monitor that hears what is published here."""
        self.to_impact = self.publisher("impact", Impact)
        self.to_force = self.publisher("contact_force", ContactForce)
        self.start_monitor(**parameters)
        self.expect(lambda: self.to_impact.get_num_connections() == 1 and self.to_force.get_num_connections() == 1)

    def test_alarms_come_and_go_and_a_late_listener_hears_of_all(self):
        self.start_alone(window=1.0, report_period=0.1, alarms={
            "hammering": {"quantity": "impact_rate", "raise_at": 60.0, "clear_at": 40.0, "severity": "error"},
            "patient": {"quantity": "impact_rate", "raise_at": 60.0, "clear_at": 40.0, "on_delay": 1.5},
            "silent": {"quantity": "impact_rate", "raise_at": 5.0, "clear_at": 20.0}})
        # Impacts per second in each second: about the limit of 60 in the third and fourth, without reaching 40.
        number = 0
        for second, rate in enumerate((50, 100, 56, 64, 100, 100, 50, 0, 0, 50)):
            for impact in self.impacts_every(1.0 / rate if rate else 1.0, number, rate, second + 0.0005):
                self.to_impact.publish(impact)
            number += rate
        self.expect(lambda: self.value("Impacts") == str(number))
        # What is due at 10 s comes when the force has gone on for the settling time, 0.5 s.
        for start in range(0, 10500, 250):
            self.to_force.publish(self.force(start, 250))
        self.expect(lambda: self.statistics and self.statistics[-1].header.stamp.secs == START + 10)
        self.assertEqual(len(self.statistics), 100)
        rates = {round((message.header.stamp - rospy.Time(START)).to_sec(), 3): message.impact_rate
                 for message in self.statistics}
        self.assertAlmostEqual(rates[4.0], 64.0)

        changes = {}
        for message in self.alarms:
            for alarm in message.alarms:
                if not alarm.since.is_zero():
                    entry = (round((alarm.since - rospy.Time(START)).to_sec(), 3), alarm.active)
                    if entry not in changes.setdefault(alarm.name, []):
                        changes[alarm.name].append(entry)
        first = min(time for time, rate in rates.items() if rate > 60.0)
        low = min(time for time, rate in rates.items() if time > first and rate < 40.0)
        self.assertEqual(changes["hammering"], [(first, True), (low, False)])
        # It is above for less than 1.5 s the first time; in the third second it is not.
        above = [time for time, rate in rates.items() if rate > 60.0]
        held = min(time for time in above if all(
            rates[round(time - 0.1 * i, 3)] > 60.0 for i in range(16) if round(time - 0.1 * i, 3) in rates) and time > 1.6)
        self.assertEqual(changes["patient"], [(held, True), (low, False)])
        silent = min(time for time, rate in rates.items() if rate < 5.0)
        again = min(time for time, rate in rates.items() if time > silent and rate > 20.0)
        self.assertEqual(changes["silent"], [(silent, True), (again, False)])

        late = self.listen("alarm", AlarmArray)
        self.expect(lambda: late)
        self.assertEqual([(alarm.name, alarm.active, alarm.raised) for alarm in late[0].alarms],
                         [("hammering", False, 1), ("patient", False, 1), ("silent", False, 1)])
        self.assertEqual(late[0].alarms[0].text.split(": ")[1], "cleared below 40")
        self.expect(lambda: self.level("Alarms") == DiagnosticStatus.OK)

    def level(self, name):
        """Level of the latest status of that name; nothing before the first."""
        for message in reversed(self.diagnostics):
            for status in message.status:
                if status.name == "%s/monitor: %s" % (self.namespace.lstrip("/"), name):
                    return status.level
        return None

    def test_a_late_listener_hears_of_an_active_alarm(self):
        self.start_alone(alarms={"silent": {"quantity": "impact_rate", "raise_at": 5.0, "clear_at": 20.0, "severity": "error"},
                                 "hard": {"quantity": "peak_force", "raise_at": 5.0, "clear_at": 2.0}})
        # Before any statistics all of them are there, too.
        self.expect(lambda: self.alarms and [alarm.active for alarm in self.alarms[0].alarms] == [False, False])
        self.to_force.publish(self.force(0, 1000))
        self.expect(lambda: self.level("Alarms") == DiagnosticStatus.ERROR)
        late = self.listen("alarm", AlarmArray)
        self.expect(lambda: late)
        self.assertEqual([(alarm.name, alarm.active) for alarm in late[0].alarms], [("hard", False), ("silent", True)])
        self.assertEqual(late[0].alarms[1].text, "impact_rate is 0 1/s: raised below 5")

    def test_silence_brings_all_that_is_open(self):
        self.start_alone(silence=0.2)
        self.to_force.publish(self.force(0, 350))
        self.expect(lambda: len(self.statistics) == 2)
        self.assertEqual([message.header.stamp - rospy.Time(START) for message in self.statistics],
                         [rospy.Duration(0.2), rospy.Duration(0.35)])

    def test_no_impact_of_a_flood_is_missing(self):
        self.start_alone(window=1.0, report_period=0.1)
        monitor = self.processes[-1]
        before = processor_time(monitor)
        for second in range(4):
            for impact in self.impacts_every(2.0e-4, 5000 * second, 5000, second + 1.0e-4):
                self.to_impact.publish(impact)
            self.expect(lambda: self.value("Impacts") == str(5000 * (second + 1)))
            self.to_force.publish(self.force(1000 * second, 1000))
        self.to_force.publish(self.force(4000, 500))  # the settling time
        self.expect(lambda: self.statistics and self.statistics[-1].header.stamp.secs == START + 4)
        # However long it took: a monitor that needs less of a processor than the stream lasts keeps up with it.
        self.assertLess(processor_time(monitor) - before, 4.0)
        last = self.statistics[-1]
        self.assertEqual((last.total_impacts, last.missing_impacts, last.late_impacts), (20000, 0, 0))
        self.assertEqual((last.impacts, last.impact_rate), (5000, 5000.0))

    def test_what_no_simulator_sends_is_refused_and_ends_nothing(self):
        self.start_alone()

        class Boast(ContactForce):
            """Says that 2^32 - 1 samples follow, and ends."""

            def serialize(self, buff):
                ContactForce.serialize(self, buff)
                buff.seek(-4, os.SEEK_END)
                buff.write(b"\xff\xff\xff\xff")

        self.to_force.publish(Boast(sample_period=PERIOD))
        last = rospy.Time(4294967295)  # the last second that a stamp can hold
        self.to_force.publish(ContactForce(header=Header(stamp=last), sample_period=1.0, force=[0.0]))
        self.to_force.publish(ContactForce(header=Header(stamp=stamp(0)), sample_period=1.0e6, force=[0.0]))
        self.to_force.publish(ContactForce(header=Header(stamp=stamp(0)), sample_period=PERIOD, force=[math.nan]))
        self.expect(lambda: self.value("Messages refused") == "3")
        self.to_force.publish(self.force(0, 1000))
        self.expect(lambda: self.value("Samples of force") == "1000")

    def test_wear_opens_the_gap(self):
        unworn = -1.0e-7
        self.start_graph("interference_fit.yaml", window=0.1, report_period=0.02, settling_time=0.1, wear=dict(WEAR, coefficient=5.0e-10),
                         wear_feedback={"interval": 0.05, "greatest_step": 1.0e-8})
        played = 0

        def clearance(info):
            return float(yaml.safe_load(info.configuration)["contact"]["clearance"])

        def play_until(amplitude, condition):
            nonlocal played
            for _ in range(400):
                self.play(played, 20, amplitude)
                played += 20
                if condition():
                    return
            self.fail("after %d blocks:\n%s\n%s" % (played, self.diagnostics[-1], self.printed()))

        play_until(0.5, lambda: clearance(self.infos[-1]) > unworn + 3.0e-8)
        # Without a drive wear ends, and what is worn is handed over to the last bit.
        play_until(0.0, lambda: self.value("Depth to hand over (m)") == "0" and
                   int(self.value("Changes taken")) == len(self.infos) - 1 and
                   float(self.value("Depth handed over (m)")) == self.statistics[-1].wear_depth)
        infos = {info.number: clearance(info) for info in self.infos}
        self.assertEqual(sorted(infos), list(range(len(infos))))
        self.assertEqual(infos[0], unworn)
        self.assertEqual(float(self.value("Clearance unworn (m)")), unworn)
        self.assertEqual(infos[len(infos) - 1], unworn + self.statistics[-1].wear_depth)
        steps = [infos[i + 1] - infos[i] for i in range(len(infos) - 1)]
        self.assertTrue(all(0.0 < step < 1.0000001e-8 for step in steps), steps)
        self.assertGreater(len(steps), 3)
        self.assertLessEqual(len(steps), 1 + played * BLOCK * PERIOD / 0.05)
        self.assertEqual(self.value("Changes asked for"), str(len(steps)))
        self.assertEqual(self.value("Changes refused"), "0")
        self.assertEqual(self.value("Contact changes"), str(len(steps)))
        self.assertEqual(self.statistics[-1].missing_impacts, 0)

    def test_a_simulator_that_is_not_there_holds_nothing_up(self):
        info = ModelInfo(configuration=yaml.safe_dump(
            {key: value for key, value in configuration("interference_fit.yaml").items()
             if key not in ("queue_size", "diagnostic_period")}))
        to_info = self.publisher("model_info", ModelInfo, latch=True)
        to_info.publish(info)
        self.start_alone(wear=WEAR, wear_feedback={"simulator": "nobody", "interval": 0.2})
        self.expect(lambda: to_info.get_num_connections() == 1)
        for second in range(20):
            for impact in self.impacts_every(0.01, 100 * second, 100, second + 0.005):
                self.to_impact.publish(impact)
        self.expect(lambda: self.value("Impacts") == "2000")
        for start in range(0, 20500, 500):
            self.to_force.publish(self.force(start, 500))
        self.expect(lambda: self.statistics and self.statistics[-1].header.stamp.secs == START + 20)
        self.assertEqual((self.statistics[-1].total_impacts, self.statistics[-1].missing_impacts), (2000, 0))
        # The next statistics see that nobody has answered.
        self.to_force.publish(self.force(20500, 2000))
        self.expect(lambda: int(self.value("Changes refused") or 0) > 0)
        self.assertIn("no answer from " + self.namespace + "/nobody/set_contact", self.value("Last refusal"))
        self.assertEqual(self.value("Depth handed over (m)"), "0")

    def test_the_shipped_configuration_is_good(self):
        with open(os.path.join(PACKAGE, "config", "monitor.yaml")) as stream:
            text = stream.read()
        # With the keys that stand there as comments; README.md says that there are all.
        everything = yaml.safe_load(re.sub(r"^# (( {2})?\w+:( .*)?)$", r"\1", text, flags=re.MULTILINE))
        self.assertEqual(set(everything), {
            "window", "report_period", "settling_time", "silence", "drive_frequency", "period_tolerance", "queue_size",
            "diagnostic_period", "histogram", "wear", "alarms", "wear_feedback"})
        self.assertEqual(set(everything["wear_feedback"]), {"simulator", "interval", "greatest_step"})
        self.start_alone(**everything)
        self.expect(lambda: self.alarms)
        self.assertEqual([alarm.name for alarm in self.alarms[0].alarms], ["hammering", "hard_impacts", "silent"])

    def test_the_launch_file_leaves_to_the_configuration_what_it_is_not_told(self):
        with tempfile.NamedTemporaryFile("w", suffix=".yaml") as config:
            config.write("{window: 7.0, silence: 3.0}")
            config.flush()
            output = subprocess.check_output(
                ["roslaunch", "--dump-params", os.path.join(PACKAGE, "launch", "monitor.launch"), "config:=" + config.name,
                 "silence:=20", "wear_feedback:=true"], universal_newlines=True)
        self.assertEqual(yaml.safe_load(output), {
            "/monitor/window": 7.0, "/monitor/silence": 20.0, "/monitor/wear_feedback/simulator": "simulator"})

    def test_bad_parameters_end_it_with_all_faults(self):
        monitor = self.run_node("monitor", {"window": 0, "wear": {"coefficient": -1.0}, "alarm": {}})
        self.assertNotEqual(monitor.wait(PATIENCE), 0)
        for part in ("window = 0: must be", "wear.coefficient = -1", "wear.source", "wear.area is missing",
                     "did you mean alarms?"):
            self.assertIn(part, self.printed())


if __name__ == "__main__":
    rospy.init_node("monitor_test")
    rostest.rosrun("vibro_impact", "monitor_test", MonitorTest)
