"""A node as a process of its own, for the tests of how it starts, what it says and how it ends."""

import socket
import subprocess
import tempfile
import time
import unittest
from xmlrpc.client import ServerProxy

import rosgraph
import rospy
from roslib.packages import find_node

# Longer than anything takes, though a virtual machine be given a tenth of its processors, s: ends what hangs.
PATIENCE = 120.0


def free_port():
    """A port of 127.0.0.1 that nobody listens on."""
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


def wait_until(condition):
    end = time.monotonic() + PATIENCE
    while not condition():
        if rospy.is_shutdown() or time.monotonic() > end:
            return False
        time.sleep(0.01)
    return True


def is_connected(node, topics):
    """Whether `node` sends all of these topics to this one. A subscriber counts its connection before that."""
    try:
        address = rosgraph.Master(rospy.get_name()).lookupNode(node)
        _, _, connections = ServerProxy(address).getBusInfo(rospy.get_name())
    except (rosgraph.MasterException, OSError):
        return False
    sent = {connection[4] for connection in connections
            if connection[1] == rospy.get_name() and connection[2] == "o"}
    return sent.issuperset(topics)


class NodeProcessTest(unittest.TestCase):
    node = None  # name of the program, set by the tests of one

    def setUp(self):
        self.processes = []
        self.interfaces = []
        # A namespace of its own keeps every test apart from the others.
        self.namespace = "/" + self._testMethodName
        self.output = tempfile.TemporaryFile(mode="w+")

    def tearDown(self):
        for interface in self.interfaces:
            interface.unregister()
        for process in self.processes:
            if process.poll() is None:
                process.kill()
            process.wait()
        self.output.close()
        if rospy.has_param(self.namespace):
            rospy.delete_param(self.namespace)

    def start(self, parameters):
        if parameters:
            rospy.set_param(self.namespace + "/" + self.node, parameters)
        program = find_node("vibro_impact", self.node)[0]
        process = subprocess.Popen(
            [program, "__ns:=" + self.namespace], stdout=self.output, stderr=subprocess.STDOUT)
        self.processes.append(process)
        return process

    def printed(self):
        self.output.seek(0)
        return self.output.read()
