"""What the runs of the benchmarks have in common: a master of their own, nodes, a recorder, and what these say of themselves."""

import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time
from xmlrpc.client import ServerProxy

import rosbag
import rospkg
import yaml
from roslib.packages import find_node

# Longer than a node takes to start or to end on a busy machine, s.
PATIENCE = 60.0
# Lowest natural frequency of the beam of config/limiting_case.yaml, Hz.
REFERENCE_FREQUENCY = 271.45727650517387


class Failure(Exception):
    pass


def configuration(modes):
    """The limiting case in the attachment basis with so many modes per beam."""
    path = os.path.join(rospkg.RosPack().get_path("vibro_impact"), "config", "limiting_case.yaml")
    with open(path) as stream:
        return dict(yaml.safe_load(stream), basis={"type": "attachment", "modes_per_beam": modes})


def program(name, package="vibro_impact"):
    found = find_node(package, name)
    if not found:
        raise Failure("%s is not there: build, and source build/install/setup.bash" % name)
    return found[0]


def memory(process):
    """Resident memory, kB; 0 when the process has ended."""
    try:
        with open("/proc/%d/status" % process.pid) as status:
            return next((int(line.split()[1]) for line in status if line.startswith("VmRSS:")), 0)
    except OSError:
        return 0


class Rig:
    """A master and nodes on this machine alone; all ends with the `with` block, and their files are gone."""

    def __init__(self, folder):
        self.folder = folder
        self.processes = []

    def __enter__(self):
        self.directory = tempfile.TemporaryDirectory(prefix="vibro_impact_", dir=self.folder)
        self.log = open(os.path.join(self.directory.name, "log"), "w+")
        try:
            self.start_master()
        except BaseException:
            self.__exit__()
            raise
        return self

    def start_master(self):
        with socket.socket() as listener:
            listener.bind(("127.0.0.1", 0))
            port = listener.getsockname()[1]
        self.environment = dict(os.environ, ROS_MASTER_URI="http://localhost:%d" % port, ROS_HOSTNAME="localhost",
                                ROS_LOG_DIR=self.directory.name)
        self.master = ServerProxy(self.environment["ROS_MASTER_URI"])
        self.spawn(["rosmaster", "--core", "-p", str(port)])
        self.expect(lambda: self.master.getPid("/benchmark")[0] == 1, "the master")

    def __exit__(self, *_):
        for process in reversed(self.processes):
            if process.poll() is None:
                process.kill()
            process.wait()
        self.log.close()
        self.directory.cleanup()

    def spawn(self, command):
        process = subprocess.Popen(command, env=self.environment, stdout=self.log, stderr=subprocess.STDOUT)
        self.processes.append(process)
        return process

    def printed(self):
        with open(self.log.name) as log:
            return log.read()

    def expect(self, condition, what):
        end = time.monotonic() + PATIENCE
        while True:
            try:
                if condition():
                    return
            except OSError:
                pass  # not there yet
            if time.monotonic() > end:
                raise Failure("waited in vain for %s:\n%s" % (what, self.printed()))
            time.sleep(0.05)

    def start(self, node, parameters, namespace="/", *arguments):
        self.master.setParam("/benchmark", namespace.rstrip("/") + "/" + node, parameters)
        return self.spawn([program(node), "__ns:=" + namespace, "__name:=" + node, *arguments])

    def record(self, *arguments):
        """To the bag `self.bag`."""
        self.bag = os.path.join(self.directory.name, "run.bag")
        return self.spawn([program("record", "rosbag"), "-O", self.bag, "-b", "0", "--tcpnodelay", *arguments,
                           "__name:=record"])

    def sends(self, node, subscriber, topics):
        """Whether a node has a connection for each of these topics to a subscriber."""
        code, _, address = self.master.lookupNode("/benchmark", node)
        if code != 1:
            return False
        connections = ServerProxy(address).getBusInfo("/benchmark")[2]
        return {connection[4] for connection in connections if connection[1] == subscriber}.issuperset(topics)

    def end(self, process):
        process.send_signal(signal.SIGINT)
        if process.wait(PATIENCE) != 0:
            raise Failure("a process has failed:\n" + self.printed())

    def published(self):
        """Samples that the shaker says it has published."""
        found = re.findall(r"published (\d+) samples", self.printed())
        if not found:
            raise Failure("the shaker has failed:\n" + self.printed())
        return int(found[-1])

    def recorded(self, topic):
        """Messages of this topic in the bag."""
        with rosbag.Bag(self.bag) as bag:
            return bag.get_message_count(topic)

    def diagnostics(self):
        """By name of the status, all that nodes have said of themselves, in order: [level, {key: value}]."""
        statuses = {}
        with rosbag.Bag(self.bag) as bag:
            for record in bag.read_messages(topics=["/diagnostics"]):
                for status in record.message.status:
                    values = {value.key: value.value for value in status.values}
                    statuses.setdefault(status.name.lstrip("/"), []).append((status.level, values))
        return statuses


def replay_check(bag, *arguments):
    """Whether it is content; and its first line."""
    result = subprocess.run([program("replay_check"), bag, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                            universal_newlines=True, check=False)
    lines = (result.stdout + result.stderr).splitlines()
    return result.returncode == 0, lines[0]


def main(run, arguments):
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # by way of all that is to be put away
    try:
        sys.exit(0 if run(arguments) else 1)
    except (Failure, OSError) as failure:
        sys.exit("error: %s" % failure)
    except KeyboardInterrupt:
        sys.exit(130)
