"""Arrays as text inside a page: little-endian numbers, their bytes sorted by significance, deflated, in base64."""

import base64
import math
import zlib

import numpy as np


def deflate(raw, width):
    """Base64 text of the bytes of numbers `width` bytes wide. The bytes of equal significance lie side by side, which
    compresses better: neighbours differ in the low ones only."""
    planes = np.frombuffer(raw, dtype=np.uint8).reshape(-1, width).T
    return base64.b64encode(zlib.compress(planes.tobytes(), 6)).decode("ascii")


def packed(values, kind="f4"):
    """An array for the page as a dictionary: `t` its type (f8, f4, i4, u2 or u1), `n` how many, `z` the text."""
    values = np.ascontiguousarray(values, dtype=np.dtype(kind).newbyteorder("<"))
    return {"t": kind, "n": int(values.size), "z": deflate(values.tobytes(), values.dtype.itemsize)}


def quantised(values, kind="u2"):
    """The same by steps of the range's 65 534th (u2) or 254th part (u1): number = b + s times what is stored, the
    greatest of which stands for a number that is not finite."""
    values = np.asarray(values, dtype=float)
    most = np.iinfo(kind).max - 1
    finite = np.isfinite(values)
    low, high = (float(values[finite].min()), float(values[finite].max())) if finite.any() else (0.0, 0.0)
    step = (high - low) / most or 1.0
    stored = np.full(values.shape, most + 1, dtype=kind)
    stored[finite] = np.rint((values[finite] - low) / step)
    return dict(packed(stored, kind), b=low, s=step, hole=most + 1)


def prefix(largest):
    """(factor, prefix) of the unit in which `largest` reads as 1 to 999."""
    if not (largest > 0.0 and math.isfinite(largest)):
        return 1.0, ""
    exponent = min(9, max(-12, 3 * math.floor(math.log10(largest) / 3.0)))
    return 10.0**-exponent, {9: "G", 6: "M", 3: "k", 0: "", -3: "m", -6: "\u00b5", -9: "n", -12: "p"}[exponent]
