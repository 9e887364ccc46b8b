#!/usr/bin/python3
"""The terminal view in a real terminal (tmux) before a real simulator: what it draws, its keys, and how it ends."""

import os
import re
import shutil
import signal
import subprocess
import tempfile
import time

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from roslib.packages import find_node

from node_process import PATIENCE, NodeProcessTest, free_port, wait_until
from simulator_rig import BLOCK, ShakenSimulator, SimulatorRig, configuration, sine_block


class Terminal:
    """A shell in a terminal of tmux."""

    def __init__(self, width, height, **environment):
        self.folder = tempfile.mkdtemp()
        self.socket = os.path.join(self.folder, "socket")
        environment = dict(os.environ, LC_ALL="C.UTF-8", **environment)
        environment.pop("TMUX", None)
        subprocess.run(["tmux", "-u", "-S", self.socket, "-f", "/dev/null", "new-session", "-d", "-x", str(width),
                        "-y", str(height), "/bin/sh"], env=environment, check=True)
        self.type("PS1='pro''mpt> '")

    def tmux(self, *words):
        return subprocess.run(["tmux", "-S", self.socket] + list(words), stdout=subprocess.PIPE,
                              universal_newlines=True, check=True).stdout

    def type(self, line):
        self.tmux("send-keys", "-l", line)
        self.tmux("send-keys", "Enter")

    def press(self, key):
        self.tmux("send-keys", key)

    def screen(self):
        return self.tmux("capture-pane", "-p").split("\n")

    def shows(self, pattern):
        """Whether a screen with the regular expression in it comes."""
        return wait_until(lambda: re.search(pattern, "\n".join(self.screen())))

    def close(self):
        subprocess.run(["tmux", "-S", self.socket, "kill-server"], check=False)
        shutil.rmtree(self.folder)


class LiveTest(NodeProcessTest):
    node = "simulator"

    def setUp(self):
        super().setUp()
        self.program = find_node("vibro_impact", "live")[0]
        self.terminals = []
        self.shaken = None

    def tearDown(self):
        if self.shaken:
            self.shaken.end()
        for terminal in self.terminals:
            terminal.close()
        super().tearDown()

    def terminal(self, width=80, height=24, **environment):
        self.terminals.append(Terminal(width, height, **environment))
        self.assertTrue(self.terminals[-1].shows("prompt>"))
        return self.terminals[-1]

    def live(self, *options):
        return " ".join([self.program, "__ns:=" + self.namespace] + list(options))

    def expect(self, terminal, pattern):
        self.assertTrue(terminal.shows(pattern), "no %r in\n%s" % (pattern, "\n".join(terminal.screen())))

    def expect_restored(self, terminal):
        """The shell is back on its own screen, and its terminal echoes and edits lines."""
        self.expect(terminal, r"prompt>\n*$")
        terminal.type("stty -a; echo status of the ter''minal")
        self.expect(terminal, "status of the terminal")
        settings = " ".join(terminal.screen()).replace(";", " ").split()
        for setting in ("echo", "icanon", "isig", "icrnl", "opost"):
            self.assertIn(setting, settings)

    def test_draws_what_comes_and_obeys_keys(self):
        self.shaken = ShakenSimulator(self)
        terminal = self.terminal()
        terminal.type(self.live())
        self.expect(terminal, r"running\n(.*\n)*drive 434\.\d\d Hz   impacts 4\d\d/s \((1\.0|0\.9)")
        self.expect(terminal, r"gap .* um, 10 ms = 4\.3 drive cycles, triggered\n")
        self.expect(terminal, r"last \d+ impulses: mean \d.* uN s")
        self.expect(terminal, "missed here 0 samples, 0 impacts   new streams 0")
        self.expect(terminal, "diagnostics: (OK|WARN|ERROR)")
        screen = terminal.screen()
        self.assertIn("q quit", screen[23])
        trace = [line[11:] for line in screen[2:13]]
        # Four times a cycle of the trace rises from below zero, where the line is, to the top.
        self.assertTrue(any("\u2500\u2500\u2500" in line for line in trace), "\n".join(screen))
        self.assertTrue(all(any(c in "\u2580\u2584\u2588" for c in line) for line in trace[1:-1]), "\n".join(screen))
        bars = [line[11:] for line in screen[14:19]]
        self.assertTrue(all("\u2588" in line or "\u2583" in line for line in bars[1:]), "\n".join(screen))

        terminal.press("+")
        self.expect(terminal, r"gap .* um, 20 ms = 8\.7 drive cycles, triggered")
        terminal.press("-")
        terminal.press("-")
        self.expect(terminal, r"gap .* um, 5 ms = 2\.2 drive cycles, triggered")

        terminal.press("p")
        self.expect(terminal, "FROZEN, p goes on")
        frozen = terminal.screen()
        gaps = self.shaken.rig.messages["gap"]
        blocks = len(gaps)
        self.assertTrue(wait_until(lambda: len(gaps) > blocks + 50))
        self.assertEqual(terminal.screen(), frozen)
        terminal.press("p")
        self.expect(terminal, "running")

        terminal.tmux("resize-window", "-x", "120", "-y", "40")
        self.assertTrue(wait_until(lambda: "q quit" in (terminal.screen() + [""] * 40)[39]),
                        "\n".join(terminal.screen()))
        terminal.tmux("resize-window", "-x", "50", "-y", "12")
        self.expect(terminal, "terminal too small: 50 x 12, needs 60 x 16")
        terminal.tmux("resize-window", "-x", "80", "-y", "24")
        self.expect(terminal, "q quit")

        self.shaken.playing.clear()
        self.expect(terminal, r"STALE, nothing for \d+ s")
        self.shaken.playing.set()
        self.expect(terminal, "running")
        terminal.press("q")
        self.expect_restored(terminal)

    def test_draws_in_ascii_and_ends_by_signals(self):
        self.shaken = ShakenSimulator(self)
        for end in ("interrupt", "terminate"):
            terminal = self.terminal()
            terminal.type(self.live("--ascii") + "; echo status $?")
            self.expect(terminal, r"running\n(.*\n)*drive 434\.\d\d Hz")
            self.assertTrue("\n".join(terminal.screen()).isascii())
            if end == "interrupt":
                terminal.press("C-c")
            else:
                shell = int(terminal.tmux("list-panes", "-F", "#{pane_pid}"))
                children = subprocess.run(["ps", "-o", "pid=", "--ppid", str(shell)],
                                          stdout=subprocess.PIPE, check=True)
                os.kill(int(children.stdout.split()[0]), signal.SIGTERM)
            self.expect(terminal, "status %d" % {"interrupt": 130, "terminate": 143}[end])
            self.expect_restored(terminal)

    def test_does_not_hold_up_the_simulator(self):
        rig = SimulatorRig(self, self.namespace, configuration("limiting_case.yaml"))
        rig.connect()
        process = subprocess.Popen([self.program, "__ns:=" + self.namespace, "--once", "--timeout", "1000"],
                                   stdout=subprocess.PIPE, universal_newlines=True)
        self.processes.append(process)
        self.assertTrue(wait_until(lambda: rig.publisher.get_num_connections() == 2))
        process.send_signal(signal.SIGSTOP)
        for seq in range(0, 300 * BLOCK, BLOCK):
            rig.publisher.publish(sine_block(seq))
        rig.answered(300)
        process.send_signal(signal.SIGCONT)
        printed = process.communicate(timeout=PATIENCE)[0]
        self.assertEqual(process.returncode, 0)
        self.assertIn("drive 434.3", printed)

    def test_ends_when_the_master_is_lost(self):
        port = free_port()
        master = subprocess.Popen(["rosmaster", "--core", "-p", str(port)],
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.processes.append(master)
        terminal = self.terminal(120, 24, ROS_MASTER_URI="http://localhost:%d" % port)
        # Not before the master answers.
        self.assertTrue(wait_until(lambda: subprocess.run(
            ["rosparam", "list"], env=dict(os.environ, ROS_MASTER_URI="http://localhost:%d" % port),
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode == 0))
        terminal.type(self.program + " __ns:=/rig1; echo status $?")
        self.expect(terminal, "waiting for topic /rig1/gap")
        master.terminate()
        master.wait()
        self.expect(terminal, r"live: error: the master at http://localhost:%d/? is gone\nstatus 1" % port)
        self.expect_restored(terminal)

    def run_live(self, *options, **environment):
        start = time.monotonic()
        result = subprocess.run([self.program, "__ns:=" + self.namespace] + list(options), stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True,
                                env=dict(os.environ, **environment))
        self.assertLess(time.monotonic() - start, PATIENCE)
        return result

    def test_prints_one_frame_without_a_terminal(self):
        result = self.run_live("--once", "--timeout", "0.2", LC_ALL="C")
        self.assertEqual((result.returncode, result.stderr), (1, ""))
        self.assertIn("waiting for topic %s/gap" % self.namespace, result.stdout)
        self.shaken = ShakenSimulator(self)
        # What is wrong with a simulator whose namespace begins alike is none of this one's.
        neighbour = self.namespace.lstrip("/") + "0/simulator: Input"
        publisher = rospy.Publisher("/diagnostics", DiagnosticArray, queue_size=1, latch=True)
        self.interfaces.append(publisher)
        publisher.publish(DiagnosticArray(status=[
            DiagnosticStatus(name=neighbour, level=DiagnosticStatus.ERROR, message="refused")]))
        result = self.run_live("--plain", "--width", "100", "--height", "30", LC_ALL="C")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertTrue(result.stdout.isascii())
        self.assertEqual(len(result.stdout.splitlines()), 30)
        self.assertIn("running", result.stdout)
        self.assertIn("#", result.stdout)
        self.assertIn("diagnostics: ", result.stdout)
        self.assertNotIn(neighbour, result.stdout)

    def test_says_what_is_wrong(self):
        result = self.run_live()
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr, "live: error: standard input and output are not a terminal: "
                                        "--once prints a frame without one\n")
        result = self.run_live("--once", ROS_MASTER_URI="http://localhost:%d" % free_port())
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stderr, r"^live: error: no master at http://localhost:\d+/?: .*\n$")
        for option, value in (("--span", "2"), ("--rate", "fast"), ("--width", "59"), ("--listen", "-1"),
                              ("--height", "1e3")):
            result = self.run_live("--once", option, value)
            self.assertEqual(result.returncode, 2)
            self.assertRegex(result.stderr, r"live: error: argument %s.*: %s: must be a number from " % (option, value))


if __name__ == "__main__":
    rospy.init_node("live_test")
    rostest.rosrun("vibro_impact", "live_test", LiveTest)
