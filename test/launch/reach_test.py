#!/usr/bin/python3
"""What of a running graph other machines can reach: as doc/operations.md says."""

import os
import pathlib
import re
import signal
import socket
import subprocess
import tempfile
import time
import unittest

import rostest
from roslib.packages import find_node

from node_process import free_port

PATIENCE = 30.0
LAUNCH_FILE = str(pathlib.Path(__file__).resolve().parents[2] / "launch" / "simulator.launch")
LOOPBACK = "0100007F"  # 127.0.0.1 as /proc/net/tcp writes it
ANY = "00000000"
LISTENING = "0A"


def listening_addresses(process):
    """The local addresses on which a process accepts connections, IPv4 and IPv6."""
    sockets = set()
    for descriptor in pathlib.Path("/proc", str(process), "fd").iterdir():
        try:
            target = os.readlink(descriptor)
        except FileNotFoundError:
            continue
        if target.startswith("socket:["):
            sockets.add(target[8:-1])
    addresses = []
    for table in ("tcp", "tcp6"):
        lines = pathlib.Path("/proc", str(process), "net", table).read_text().splitlines()[1:]
        fields = [line.split() for line in lines]
        addresses += [field[1].split(":")[0] for field in fields if field[3] == LISTENING and field[9] in sockets]
    return addresses


def programs_below(process):
    """Process numbers of all descendants, by the name of the program."""
    found = {}
    for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            name, fields = stat.read_text().rsplit(")", 1)
        except OSError:
            continue
        found[int(stat.parent.name)] = (name.split("(", 1)[1], int(fields.split()[1]))
    below = {process}
    while True:
        more = {child for child, (_, parent) in found.items() if parent in below} - below
        if not more:
            return {found[child][0]: child for child in below if child in found}
        below |= more


def wait_for(condition, output):
    end = time.monotonic() + PATIENCE
    while True:
        answer = condition()
        if answer:
            return answer
        if time.monotonic() > end:
            output.seek(0)
            raise AssertionError("waited in vain; printed: " + output.read())
        time.sleep(0.05)


class ReachTest(unittest.TestCase):
    def launch(self, prefix=(), **changes):
        """A roslaunch of the simulator with a master of its own; the port of that."""
        environment = {key: value for key, value in os.environ.items()
                       if key not in ("ROS_HOSTNAME", "ROS_IP", "ROS_MASTER_URI")}
        environment.update(changes)
        port = free_port()
        output = tempfile.TemporaryFile(mode="w+")
        self.addCleanup(output.close)
        process = subprocess.Popen([*prefix, "roslaunch", "-p", str(port), LAUNCH_FILE],
                                   env=environment, stdout=output, stderr=subprocess.STDOUT, start_new_session=True)

        def end():
            os.killpg(process.pid, signal.SIGINT)
            process.wait(PATIENCE)

        self.addCleanup(end)

        def running():
            programs = programs_below(process.pid)
            complete = {"simulator", "rosmaster"} <= set(programs)
            return programs if complete and len(listening_addresses(programs["simulator"])) >= 2 else None

        return port, wait_for(running, output)

    def hostname(self, **changes):
        """What the launch file lets the simulator call itself, in an environment with these changes."""
        environment = {key: value for key, value in os.environ.items() if key not in ("ROS_HOSTNAME", "ROS_IP")}
        environment.update(changes)
        printed = subprocess.run(["roslaunch", "--args", "simulator", LAUNCH_FILE],
                                 env=environment, capture_output=True, text=True, check=True).stdout
        # What does not differ from the environment is not printed.
        found = re.search('ROS_HOSTNAME="([^"]*)"', printed)
        return found.group(1) if found else environment.get("ROS_HOSTNAME")

    def test_the_launch_file_keeps_its_nodes_to_loopback_unless_told_otherwise(self):
        self.assertEqual(self.hostname(), "localhost")
        self.assertEqual(self.hostname(ROS_IP="10.0.0.1"), "10.0.0.1")
        self.assertEqual(self.hostname(ROS_HOSTNAME="127.0.0.2", ROS_IP="10.0.0.1"), "127.0.0.2")

    def test_only_what_roscpp_opens_everywhere_is_open(self):
        """Data goes through loopback; the node's XML-RPC server listens everywhere, whatever is asked for."""
        _, programs = self.launch(ROS_HOSTNAME="localhost")
        self.assertEqual(set(listening_addresses(programs["rosmaster"])), {LOOPBACK})
        self.assertEqual(sorted(listening_addresses(programs["simulator"])), [ANY, LOOPBACK])

    def test_an_isolated_graph_cannot_be_reached_from_outside(self):
        isolated = find_node("vibro_impact", "isolated")[0]
        trial = subprocess.run([isolated, "true"], capture_output=True, text=True, check=False)
        if trial.returncode != 0:
            self.skipTest(trial.stderr.strip())
        port, programs = self.launch(prefix=[isolated])
        inside = subprocess.run(
            ["nsenter", "--target", str(programs["simulator"]), "--net", *([] if os.getuid() == 0 else ["--user"]),
             "--preserve-credentials", "/usr/bin/python3", "-c",
             f"import socket; socket.create_connection(('127.0.0.1', {port}), 5); print(open('/proc/net/dev').read())"],
            capture_output=True, text=True, check=False)
        self.assertEqual(inside.returncode, 0, inside.stderr)
        interfaces = [line.split(":")[0].strip() for line in inside.stdout.splitlines() if ":" in line]
        self.assertEqual(interfaces, ["lo"])
        with self.assertRaises(OSError):
            socket.create_connection(("127.0.0.1", port), 5)

    def test_isolated_says_what_it_wants(self):
        isolated = find_node("vibro_impact", "isolated")[0]
        self.assertEqual(subprocess.run([isolated, "--help"], stdout=subprocess.DEVNULL, check=False).returncode, 0)
        self.assertEqual(subprocess.run([isolated], stdout=subprocess.DEVNULL, check=False).returncode, 2)


if __name__ == "__main__":
    rostest.rosrun("vibro_impact", "reach_test", ReachTest)
