"""The command line of the report."""

import argparse
import os
import sys
import tempfile
import time

import vibro_impact
from vibro_impact.report import document
from vibro_impact.report import run as runs

NAME = "report"


class Refused(Exception):
    """Something the user asked for cannot be done; the message is one line."""


def parse(arguments):
    parser = argparse.ArgumentParser(
        prog=NAME,
        description=(
            "Writes one self-contained HTML page about a recorded run: configuration and integrity, impulse response,"
            " period map, stroboscopic diagram, histograms, time histories, spectra and, for a random drive,"
            " frequency-response functions. It opens in any browser of today, without network."
        ),
    )
    parser.add_argument("bags", metavar="BAG", nargs="+", help="one bag, or all of a split one")
    parser.add_argument(
        "--out",
        metavar="HTML",
        required=True,
        help="the page to write; one that is there is replaced when the new one is complete",
    )
    parser.add_argument(
        "--with",
        dest="other",
        metavar="BAG",
        nargs="+",
        help="another run, such as the sweep back, whose responses are drawn along",
    )
    parser.add_argument(
        "--namespace", metavar="NS", default="", help="the run to take from a recording of several, such as /rig1"
    )
    parser.add_argument(
        "--excitation", metavar="TOPIC", default="", help="the topic of the excitation, where several are recorded"
    )
    parser.add_argument(
        "--step",
        metavar="STEP",
        help=(
            "the step shown first: its number, from 1 on, or omega* with a decimal point (default: the one with the"
            " greatest impulse)"
        ),
    )
    parser.add_argument(
        "--resolution",
        metavar="HZ",
        type=float,
        help="spacing of the lines of frequency-response functions (default: by the damping; stated in the page)",
    )
    parser.add_argument(
        "--drive",
        choices=runs.DRIVES,
        help="what the drive is, which decides what is shown of it (default: found out; said in the page)",
    )
    parser.add_argument(
        "--no-replay", dest="replay", action="store_false", help="do not recompute the recording to check it"
    )
    return parser.parse_args(arguments)


def check_out(path, bags):
    """Refuses to write where there is no folder, something else than a file, or one of the bags."""
    if not os.path.isdir(os.path.dirname(os.path.abspath(path))):
        raise Refused("--out: the folder of %s does not exist" % path)
    if not os.path.exists(path):
        return
    if os.path.isdir(path):
        raise Refused("--out: %s is a folder, not a file" % path)
    if not os.path.isfile(path):
        raise Refused("--out: %s is a device or a pipe, must be a file or not there yet" % path)
    for bag in bags:
        if os.path.exists(bag) and os.path.samefile(bag, path):
            raise Refused("--out: %s is a bag of the recording, must be another file" % path)


def write(path, text):
    """The whole file or none."""
    folder = os.path.dirname(os.path.abspath(path))
    temporary = None
    try:
        handle, temporary = tempfile.mkstemp(prefix=".report-", suffix=".html", dir=folder)
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
        temporary = None
    except OSError as error:
        raise Refused("--out: cannot write %s: %s" % (path, error.strerror))
    finally:
        if temporary:
            os.unlink(temporary)


def make(options):
    begun = time.monotonic()

    def stage(words):
        print("%6.1f s  %s" % (time.monotonic() - begun, words), file=sys.stderr, flush=True)

    check_out(options.out, options.bags + (options.other or []))
    if options.step is not None:
        document.step_asked_for(options.step)
    if options.resolution is not None and not 1e-6 <= options.resolution <= 1e6:
        raise Refused("--resolution: %g Hz is out of range, allowed is 1e-6 to 1e6" % options.resolution)
    suffix = ", first run" if options.other else ""
    common = (options.namespace, options.excitation, options.replay)
    read = [runs.read(options.bags, *common, suffix, options.drive, stage)]
    if options.other:
        read.append(runs.read(options.other, *common, ", second run", options.drive, stage))
    text = document.make(read, options, stage)
    write(options.out, text)
    stage("written to %s, %.1f MB" % (options.out, os.path.getsize(options.out) / 1e6))


def main(arguments=None):
    options = parse(arguments)
    try:
        make(options)
    except (vibro_impact.Error, Refused, document.Refused) as error:
        print("%s: error: %s" % (NAME, error), file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    return 0
