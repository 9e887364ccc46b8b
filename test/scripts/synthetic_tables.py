"""Tables of a response that looks like the paper's, for the tests of the scripts that read them."""

import csv
import os

FRF_COLUMNS = (
    "omega_star,frequency_hz,acceleration,period,steady,impacts,impacts_per_cycle,impulse_mean,impulse_min,impulse_max,"
    "impulse_star_mean,impulse_star_min,impulse_star_max,impulse_per_cycle,peak_force,duration_mean,contact_share,stiffness,clearance"
).split(",")
IMPACT_COLUMNS = "omega_star,number,onset_s,duration_s,impulse,peak_force,approach_speed,separation_speed".split(",")
IMPULSE_STAR_PER_IMPULSE = 250.0


def _peak(omega_star, centre, width):
    return 1.0 / (1.0 + ((omega_star - centre) / width) ** 2)


def synthetic_response(step=0.01, scale=1.0):
    """[(omega*, period, [I* of each captured impact])]: resonance at 1.60, period two from 2.41, its peak at 3.20 (0.31)."""
    response = []
    for number in range(round(3.5 / step) + 1):
        omega_star = 0.5 + number * step
        mean = scale * (0.04 + _peak(omega_star, 1.60, 0.12) + 0.27 * _peak(omega_star, 3.20, 0.10))
        period = 1 if omega_star < 2.405 else 2
        spread = 0.0 if period == 1 else min(0.9, (omega_star - 2.40) ** 0.5)
        response.append((omega_star, period, [mean * (1.0 + (spread if i % 2 else -spread)) for i in range(16)]))
    return response


def write_tables(folder, response, frequencies_hz=None):
    """frf.csv and impacts.csv, and model.csv if the (free, contact) frequencies are given."""
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, "frf.csv"), "w", newline="") as frf, open(
        os.path.join(folder, "impacts.csv"), "w", newline=""
    ) as impacts:
        frf_writer = csv.DictWriter(frf, FRF_COLUMNS, restval=0)
        impact_writer = csv.DictWriter(impacts, IMPACT_COLUMNS, restval=0)
        frf_writer.writeheader()
        impact_writer.writeheader()
        for omega_star, period, impulses in response:
            mean = sum(impulses) / len(impulses) if impulses else 0.0
            frf_writer.writerow(
                dict(
                    omega_star=omega_star,
                    acceleration=10.0,
                    period=period,
                    steady=1,
                    impacts=len(impulses),
                    impulse_mean=mean / IMPULSE_STAR_PER_IMPULSE,
                    impulse_star_mean=mean,
                )
            )
            for number, impulse in enumerate(impulses):
                impact_writer.writerow(
                    dict(omega_star=omega_star, number=number, impulse=impulse / IMPULSE_STAR_PER_IMPULSE)
                )
    if frequencies_hz is not None:
        with open(os.path.join(folder, "model.csv"), "w", encoding="utf-8") as model:
            model.write("key,value\nfree_frequency_hz,{}\ncontact_frequency_hz,{}\n".format(*frequencies_hz))
