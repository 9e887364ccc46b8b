#!/usr/bin/python3
"""How long the report of a ten-minute 50 kHz bag takes, how large the page is, and how fast Chromium opens it.

Records a stepped sine of 701 frequencies at 50 kHz, answered by the core, as test/report/recorded.py does; makes the
page; opens it in a headless Chromium. Needs the setup.bash of the build, chromium and chromium-driver. """

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time

import numpy as np

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "test", "report"))
import recorded  # noqa: E402
from browser import Browser  # noqa: E402

SCRIPT = os.path.join(HERE, "..", "scripts", "report")


def stepped_drive(seconds):
    """701 steps of omega* 0.5 to 4, as many cycles each as fill the time."""
    omega_stars = np.linspace(0.5, 4.0, 701)
    cycles = seconds / np.sum(1.0 / (omega_stars * recorded.FREQUENCY))
    return recorded.stepped_sine(omega_stars, int(cycles))


def processor_time():
    """Of the programs that have ended, s."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def opening_times(page):
    """Seconds until the document is there with the first charts under way, and until all charts are drawn."""
    browser = Browser()
    try:
        browser.open(page)
        loaded = browser.value("performance.getEntriesByType('navigation')[0].loadEventEnd") / 1e3
        begun = time.monotonic()
        browser.value("await window.vibroImpactReport.draw('overview')")
        first = browser.value("performance.now()") / 1e3
        browser.value("await window.vibroImpactReport.drawAll()")
        complaints = browser.complaints()
        return loaded, first, time.monotonic() - begun, complaints
    finally:
        browser.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=600.0, help="length of the recording (default: %(default)s)")
    parser.add_argument("--drive", choices=("stepped", "random"), default="stepped")
    parser.add_argument(
        "--runs", type=int, default=3, help="how often the page is made and opened (default: %(default)s)"
    )
    parser.add_argument("--folder", help="where bag and page are left (default: nowhere)")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.folder or temporary
        bag, page = (os.path.join(folder, "run." + ending) for ending in ("bag", "html"))
        if not os.path.exists(bag):
            drive = (
                stepped_drive(arguments.seconds)
                if arguments.drive == "stepped"
                else recorded.random_drive(arguments.seconds)
            )
            recorded.write_bag(
                bag, recorded.configuration(clearance=0.0 if arguments.drive == "stepped" else 2e-6), drive
            )
        print("bag: %.0f MB, load average %.1f" % (os.path.getsize(bag) / 1e6, os.getloadavg()[0]))
        for _ in range(arguments.runs):
            begun, used = time.monotonic(), processor_time()
            subprocess.run([SCRIPT, bag, "--out", page], check=True, stderr=subprocess.DEVNULL)
            made, used = time.monotonic() - begun, processor_time() - used
            loaded, first, drawn, complaints = opening_times(page)
            print(
                "report %.1f s (%.1f s of processor time), page %.2f MB; Chromium: loaded %.2f s, first chart %.2f s,"
                " all charts %.1f s later; complaints %s"
                % (made, used, os.path.getsize(page) / 1e6, loaded, first, drawn, complaints)
            )


if __name__ == "__main__":
    main()
