"""Two pinned beams that knock against each other, without a line of the package: the modes from the textbook's formulas, the
states and their damping from the matrices, and the motion by two methods that share nothing but these equations.

In the coordinates eta of the free modes (mass-normalised; b: gap per unit coordinate, Gamma: participation)

    apart         eta'' + 2 zeta_0 diag(omega) eta' + diag(omega^2) eta       = -Gamma a(t)
    in contact    eta'' + C_1 eta'                  + (diag(omega^2) + k b b') eta = -Gamma a(t) - k clearance b

with C_1 = Q diag(2 zeta_1 sqrt(lambda)) Q' from the eigenvectors Q and eigenvalues lambda of the stiffness matrix in contact.
"""

import math

import numpy
import scipy.integrate
import scipy.linalg
import scipy.optimize


class Beam:
    """A uniform pinned-pinned beam of rectangular section; SI units."""

    def __init__(self, youngs_modulus, contact_location, density=954.0, length=0.0529, height=0.00127, width=0.0127):
        self.length = length
        self.location = contact_location
        self.mass_per_length = density * height * width
        self.bending_stiffness = youngs_modulus * width * height**3 / 12.0

    def modes(self, numbers):
        """Frequency, deflection at the contact and participation of the modes of these numbers."""
        angle = math.pi * numbers
        mass = self.mass_per_length * self.length
        frequency = (angle / self.length) ** 2 * math.sqrt(self.bending_stiffness / self.mass_per_length)
        deflection = math.sqrt(2.0 / mass) * numpy.sin(angle * self.location / self.length)
        return frequency, deflection, math.sqrt(2.0 * mass) * (1.0 - numpy.cos(angle)) / angle

    def space(self, count, attachment):
        """The lowest `count` modes and, if wanted, the static deflection under a force at the contact less its part in them."""
        frequency, deflection, participation = self.modes(numpy.arange(1.0, count + 1.0))
        if attachment:
            omega, phi, gamma = self.modes(numpy.arange(1.0e5, count, -1.0))
            flexibility = numpy.sum(phi**2 / omega**2)
            norm = math.sqrt(numpy.sum(phi**2 / omega**4))
            frequency = numpy.append(frequency, math.sqrt(flexibility) / norm)
            deflection = numpy.append(deflection, flexibility / norm)
            participation = numpy.append(participation, numpy.sum(phi * gamma / omega**2) / norm)
        return frequency, deflection, participation


class System:
    """Both states as y' = M y with y = (eta, eta', impulse, cos Omega t, sin Omega t, 1), a(t) = -cos Omega t."""

    def __init__(self, beams, count, attachment, stiffness, clearance, damping, drive):
        spaces = [beam.space(count, attachment) for beam in beams]
        omega = numpy.concatenate([space[0] for space in spaces])
        b = numpy.concatenate([spaces[0][1], -spaces[1][1]])
        gamma = numpy.concatenate([space[2] for space in spaces])
        free = numpy.diag(omega**2)
        contact = free + stiffness * numpy.outer(b, b)
        squared, shapes = numpy.linalg.eigh(contact)
        free_damping = numpy.diag(2.0 * damping[0] * omega)
        contact_damping = shapes @ numpy.diag(2.0 * damping[1] * numpy.sqrt(squared)) @ shapes.T

        n = len(omega)
        self.size = 2 * n + 4
        self.drive = drive
        self.cycle = 2.0 * math.pi / drive
        self.shortest_period = 2.0 * math.pi / math.sqrt(squared[-1])
        self.gap = numpy.concatenate([b, numpy.zeros(n + 3), [clearance]])
        self.gap_rate = numpy.concatenate([numpy.zeros(n), b, numpy.zeros(4)])
        self.matrices = []
        for in_contact, k, c in ((False, free, free_damping), (True, contact, contact_damping)):
            m = numpy.zeros((self.size, self.size))
            m[:n, n : 2 * n] = numpy.eye(n)
            m[n : 2 * n, :n] = -k
            m[n : 2 * n, n : 2 * n] = -c
            m[n : 2 * n, 2 * n + 1] = gamma
            m[2 * n + 1, 2 * n + 2] = -drive
            m[2 * n + 2, 2 * n + 1] = drive
            if in_contact:
                m[n : 2 * n, 2 * n + 3] = -stiffness * clearance * b
                m[2 * n] = -stiffness * self.gap
            self.matrices.append(m)

    def rest(self):
        y = numpy.zeros(self.size)
        y[[-3, -1]] = 1.0
        return y


class Episodes:
    """Contact episodes as they are found: onsets (in drive cycles) and impulses (N s) of the whole ones."""

    def __init__(self, system):
        self.system = system
        self.onset = []
        self.impulse = []

    def switch(self, in_contact, time, y):
        """The state after a switch at `time`."""
        if in_contact:
            self.onset.append(time / self.system.cycle)
        else:
            self.impulse.append(y[-4])
        y = y.copy()
        y[-4] = 0.0
        return y

    def whole(self):
        return self.onset[: len(self.impulse)], self.impulse


def by_matrix_exponential(system, cycles, steps_per_period=40):
    """Steps exp(M h), h a fraction of the shortest period, each searched for a crossing and for a pair of crossings; roots by
    Brent's method on exp(M t)."""
    episodes = Episodes(system)
    step = system.cycle / math.ceil(steps_per_period * system.cycle / system.shortest_period)
    propagators = [scipy.linalg.expm(m * step) for m in system.matrices]
    state, time, y = 0, 0.0, system.rest()
    end = cycles * system.cycle
    side = (1.0, -1.0)

    def after(duration):
        return scipy.linalg.expm(system.matrices[state] * duration) @ y

    def root(row, upper):
        return scipy.optimize.brentq(lambda t: row @ after(t), 0.0, upper, xtol=1.0e-18, rtol=4.0 * numpy.finfo(float).eps)

    while time < end:
        following = propagators[state] @ y
        inside = side[state] * system.gap
        rate = side[state] * system.gap_rate
        upper = step if inside @ following < 0.0 else None
        if upper is None and rate @ y < 0.0 < rate @ following:
            turn = root(rate, step)
            upper = turn if inside @ after(turn) < 0.0 else None
        if upper is None or (inside @ y <= 0.0 and rate @ y >= 0.0):
            time, y = time + step, following
            continue
        # Just after a switch the gap is zero but for rounding.
        duration = root(inside, upper) if inside @ y > 0.0 else 0.0
        y = after(duration)
        time += duration
        state = 1 - state
        y = episodes.switch(state == 1, time, y)
    return episodes.whole()


def by_lsoda(system, cycles):
    """ODEPACK's LSODA, a multistep method of variable order, with the events of solve_ivp."""
    episodes = Episodes(system)
    state, time, y = 0, 0.0, system.rest()
    end = cycles * system.cycle
    scale = 1.0 / system.drive**2
    while time < end:
        matrix = system.matrices[state]

        def crossing(_, y):
            return system.gap @ y

        crossing.terminal = True
        crossing.direction = 1.0 if state == 1 else -1.0
        part = scipy.integrate.solve_ivp(
            lambda _, y: matrix @ y,
            (time, end),
            y,
            method="LSODA",
            rtol=1.0e-10,
            atol=1.0e-12 * scale,
            max_step=system.shortest_period,
            events=crossing,
        )
        time, y = part.t[-1], part.y[:, -1]
        if part.status == 1:
            state = 1 - state
            y = episodes.switch(state == 1, time, y)
    return episodes.whole()
