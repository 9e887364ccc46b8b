"""Recordings of vibro_impact in NumPy arrays, and its model as a library.

    import vibro_impact
    recording = vibro_impact.read_bag("run.bag")
    plot(recording.time, recording.gap)

    model = vibro_impact.load_model("table1.yaml")
    sweep = model.sweep(0.5, 2.0, points=100)
    plot(sweep.responses["omega_star"], sweep.responses["impulse_mean"])

The messages are in vibro_impact.msg and vibro_impact.srv, as in every package of ROS.
"""

# Each name is imported when it is first used: who only wants a message does not load NumPy and the libraries.
_WHERE = {
    "Error": "error",
    "HarmonicRun": "_core",
    "Model": "_core",
    "Recording": "recording",
    "Simulation": "_core",
    "Sweep": "_core",
    "check_replay": "recording",
    "extract_responses": "recording",
    "load_model": "_core",
    "read_bag": "recording",
}


def __getattr__(name):
    if name not in _WHERE:
        raise AttributeError("module 'vibro_impact' has no attribute '%s'" % name)
    import importlib

    value = getattr(importlib.import_module("vibro_impact." + _WHERE[name]), name)
    globals()[name] = value
    return value


def __dir__():
    return sorted(set(globals()) | set(_WHERE))
