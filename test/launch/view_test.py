#!/usr/bin/python3
"""The node `view`: what it draws of a real simulator, and that RViz shows it, on a screen that nobody sees."""

import os
import shutil
import signal
import subprocess
import tempfile
import time
from xmlrpc.client import ServerProxy

import rosgraph
import rospkg
import rospy
import rostest
from visualization_msgs.msg import Marker, MarkerArray

from node_process import PATIENCE, NodeProcessTest, wait_until
from simulator_rig import ShakenSimulator

LAUNCH_FILE = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "launch", "view.launch")

# RViz draws by software here, beside other tests, s.
SCREEN_PATIENCE = 300.0


def listens_to(node, topic):
    """Whether the node called `node` sends `topic` to anybody."""
    address = rosgraph.Master(rospy.get_name()).lookupNode(node)
    _, _, connections = ServerProxy(address).getBusInfo(rospy.get_name())
    return any(connection[2] == "o" and connection[4] == topic for connection in connections)


class ViewTest(NodeProcessTest):
    node = "view"

    def setUp(self):
        super().setUp()
        self.scenes = []
        self.shaken = None

    def tearDown(self):
        if self.shaken:
            self.shaken.end()
        super().tearDown()

    def watch(self):
        subscriber = rospy.Subscriber(self.namespace + "/view", MarkerArray, self.scenes.append, queue_size=None)
        self.interfaces.append(subscriber)
        return subscriber

    def simulate(self):
        self.node = "simulator"
        self.shaken = ShakenSimulator(self)
        self.node = "view"

    def marker(self, name, number=0):
        """Of the newest scene; None if it is not there."""
        if not self.scenes:
            return None
        return next((marker for marker in self.scenes[-1].markers
                     if (marker.ns, marker.id) == (name, number) and marker.action == Marker.ADD), None)

    def words(self):
        marker = self.marker("words")
        return marker.text if marker else ""

    def expect(self, condition):
        self.assertTrue(wait_until(condition), self.words() + "\n" + self.printed())

    def test_draws_what_the_simulator_moves(self):
        self.watch()
        self.start({"displacement_scale": 3000})
        self.expect(lambda: self.words() == "waiting for topic %s/model_info" % self.namespace)
        self.simulate()
        self.expect(lambda: self.words().startswith("slowed 1000 x: "))
        self.assertIn(" of the stream, then the newest (drive 434 Hz)\n", self.words())
        self.assertIn("\nlengths x 18.9, displacement x 3000 relative to the base\n", self.words())
        self.assertIn(" = 100 mm, a cell of the grid\n", self.words())
        # In one scene: an arrow, a mark, the gap of the words between the marks.
        self.expect(lambda: self.marker("force") and self.marker("impacts"))
        self.expect(lambda: "last impulse 43.1 uN s" in self.words())
        prefixes = {"um": 1e-6, "nm": 1e-9}
        checked = 0
        for scene in list(self.scenes)[-50:]:
            markers = {(marker.ns, marker.id): marker for marker in scene.markers}
            text = markers["words", 0].text
            if ("contact point", 1) in markers and text.startswith("slowed"):
                number, unit = text.split("\ngap ")[1].split(",")[0].split(" ")
                apart = markers["contact point", 1].pose.position.z - markers["contact point", 2].pose.position.z
                self.assertAlmostEqual(apart / 3000.0, float(number) * prefixes.get(unit, 1.0), delta=2e-7)
                checked += 1
        self.assertGreater(checked, 10)

        # When nothing comes any more, it says so.
        self.shaken.playing.clear()
        self.expect(lambda: "\nstale: no motion for " in self.words())
        self.assertTrue(self.shaken.rig.messages["gap"])

    def test_asks_for_the_motion_only_while_somebody_looks(self):
        subscriber = self.watch()
        self.start({})
        self.simulate()
        simulator, motion = self.namespace + "/simulator", self.namespace + "/motion"
        self.expect(lambda: listens_to(simulator, motion))
        self.expect(lambda: self.words().startswith("slowed"))
        subscriber.unregister()
        self.expect(lambda: not listens_to(simulator, motion))
        self.watch()
        self.expect(lambda: listens_to(simulator, motion))

    def test_faulty_parameters_end_it(self):
        process = self.start({"frame_rate": 0, "speed": 2})
        self.assertEqual(process.wait(PATIENCE), 1)
        for part in ("2 faults", "frame_rate = 0: must be a number > 0", "\"speed\" is unknown"):
            self.assertIn(part, self.printed())

    def screen(self, environment):
        """The picture of the screen: width, height and its pixels as bytes, red, green and blue of each."""
        result = subprocess.run(["import", "-window", "root", "-depth", "8", "ppm:-"], env=environment,
                                stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        fields = result.stdout.split(None, 4) if result.returncode == 0 else []
        if len(fields) < 5 or fields[0] != b"P6":
            return 0, 0, b""
        width, height = int(fields[1]), int(fields[2])
        return width, height, result.stdout[-3 * width * height:]

    def test_rviz_shows_beams_arrow_and_words(self):
        """All in one picture: blue over orange in the middle, a green arrow above the contact, words above that."""
        missing = [program for program in ("Xvfb", "import") if not shutil.which(program)]
        try:
            rospkg.RosPack().get_path("rviz")
        except rospkg.ResourceNotFound:
            missing.append("rviz")
        if missing:
            self.skipTest("not installed: %s; scripts/install_dependencies view pictures installs them" % ", ".join(missing))
        home = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, home)
        server = subprocess.Popen(["Xvfb", "-displayfd", "1", "-screen", "0", "1100x800x24", "-nolisten", "tcp"],
                                  stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, universal_newlines=True)
        self.addCleanup(server.stdout.close)
        self.addCleanup(server.wait)
        self.addCleanup(server.terminate)
        display = ":" + server.stdout.readline().strip()
        environment = dict(os.environ, DISPLAY=display, HOME=home, XDG_RUNTIME_DIR=home, LIBGL_ALWAYS_SOFTWARE="1",
                           QT_QPA_PLATFORM="xcb", ROS_NAMESPACE=self.namespace)
        # Slower than it would be by itself, so that even a few pictures a second show the arrow.
        launch = subprocess.Popen(["roslaunch", LAUNCH_FILE, "demo:=true", "slow_motion:=2000"],
                                  env=environment, stdout=self.output, stderr=subprocess.STDOUT)

        def end():
            launch.send_signal(signal.SIGINT)
            launch.wait()
        self.addCleanup(end)

        counts = {}
        start = time.monotonic()
        while time.monotonic() - start < SCREEN_PATIENCE and launch.poll() is None:
            width, height, pixels = self.screen(environment)
            counts = dict.fromkeys(("blue", "orange", "arrow", "words"), 0)
            for row in range(60, height - 40, 2):  # between RViz's own lines
                line = pixels[3 * width * row:3 * width * (row + 1)]
                red, green, blue = line[0::6], line[1::6], line[2::6]
                for r, g, b in zip(red, green, blue):
                    if r > 240 and g > 240 and b > 240:
                        continue
                    upper = row < 0.4 * height
                    if not upper and r < 20 and 100 < g < 130 and 160 < b < 200:
                        counts["blue"] += 1
                    elif not upper and 210 < r and 140 < g < 180 and b < 30:
                        counts["orange"] += 1
                    elif r < 40 and g > 60 and 1.15 * b < g < 1.7 * b and g > 3 * r:
                        counts["arrow"] += 1
                    elif upper and r < 60 and g < 60 and b < 60:
                        counts["words"] += 1
            # A quarter of the pixels were looked at.
            if counts["blue"] > 1500 and counts["orange"] > 1500 and counts["arrow"] > 60 and counts["words"] > 300:
                return
            time.sleep(0.1)
        self.fail("no such picture: %s\n%s" % (counts, self.printed()))


if __name__ == "__main__":
    rospy.init_node("view_test")
    rostest.rosrun("vibro_impact", "view_test", ViewTest)
