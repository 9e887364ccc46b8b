"""Two published cases played again by the scheme, the mesh and the step with which they were published: whether a number differs
from the library's because it was computed for something else, or because of how it was computed."""

import math

import numpy


def two_masses_by_central_differences(steps_per_second, times):
    """Code_Aster SDND102: displacement of the left one of two masses at `times`, which are whole numbers of steps or lie between
    two of every eighth, joined by a straight line, as they are stored there. By symmetry that mass meets a wall in the middle,
    of twice the stiffness."""
    mass, spring, damping, drive = 25.0, 98696.0, 0.07, 20.0 * math.pi
    stop, clearance = 2.0 * 2.88e7, 0.5e-3
    frequency = math.sqrt(spring / mass)
    step = 1.0 / steps_per_second

    def anchor(time):
        return -math.sin(drive * time) / drive**2

    relative, velocity = 0.0, 0.0
    stored = [0.0]
    for i in range(steps_per_second):
        time = i * step
        absolute = relative + anchor(time)
        acceleration = -math.sin(drive * time) - frequency**2 * relative - 2.0 * damping * frequency * velocity
        velocity += step * (acceleration - stop / mass * max(0.0, absolute - clearance))
        relative += step * velocity
        if (i + 1) % 8 == 0:
            stored.append(relative + anchor((i + 1) * step))
    return numpy.interp(times, 8.0 * step * numpy.arange(len(stored)), stored)


def cantilever_by_finite_elements(elements, step, displacement_time, velocity_time):
    """Code_Aster SDNL104: displacement and velocity of the tip at one time each; Euler-Bernoulli elements with cubic shape
    functions and consistent mass, Newmark's method of constant mean acceleration."""
    length, radius, modulus, density = 1.0, 0.1, 1.0e10, 1.0e6
    force, stop, clearance = -1000.0, 1.0e8, 1.0e-4
    l = length / elements
    rigidity = modulus * math.pi * radius**4 / 4.0
    mass_per_length = density * math.pi * radius**2
    element_stiffness = numpy.array(
        [[12, 6 * l, -12, 6 * l], [6 * l, 4 * l * l, -6 * l, 2 * l * l], [-12, -6 * l, 12, -6 * l], [6 * l, 2 * l * l, -6 * l, 4 * l * l]]
    )
    element_mass = numpy.array(
        [[156, 22 * l, 54, -13 * l], [22 * l, 4 * l * l, 13 * l, -3 * l * l], [54, 13 * l, 156, -22 * l], [-13 * l, -3 * l * l, -22 * l, 4 * l * l]]
    )
    size = 2 * (elements + 1)
    stiffness, mass = numpy.zeros((size, size)), numpy.zeros((size, size))
    for i in range(elements):
        part = slice(2 * i, 2 * i + 4)
        stiffness[part, part] += rigidity / l**3 * element_stiffness
        mass[part, part] += mass_per_length * l / 420.0 * element_mass
    stiffness, mass = stiffness[2:, 2:], mass[2:, 2:]  # clamped
    tip = size - 4
    load = numpy.zeros(size - 2)
    load[tip] = force
    touching = stiffness.copy()
    touching[tip, tip] += stop
    touching_load = load.copy()
    touching_load[tip] -= stop * clearance

    x, v = numpy.zeros(size - 2), numpy.zeros(size - 2)
    a = numpy.linalg.solve(mass, load)
    at_times = {round(displacement_time / step): None, round(velocity_time / step): None}
    for i in range(1, max(at_times) + 1):
        predicted = x + step * v + 0.25 * step**2 * a
        for k, f in ((stiffness, load), (touching, touching_load)):
            following = numpy.linalg.solve(mass + 0.25 * step**2 * k, f - k @ predicted)
            x = predicted + 0.25 * step**2 * following
            if (x[tip] < -clearance) == (k is touching):
                break
        v = v + 0.5 * step * (a + following)
        a = following
        if i in at_times:
            at_times[i] = (x[tip], v[tip])
    return at_times[round(displacement_time / step)][0], at_times[round(velocity_time / step)][1]
