"""What the model of a recording says of its linear motions."""

import re

import numpy as np

import vibro_impact

# Damping ratio, at least, by which the resolution of spectra is chosen.
LEAST_DAMPING = 0.002
# Damping ratio by which it is chosen where no configuration says one.
USUAL_DAMPING = 0.01
# Images of the spectrum of a sampled drive that are summed on either side; those beyond weigh less than 1e-6.
IMAGES = 4


def of_recording(recording):
    """(model of the recording's first configuration, ""), or (None, why there is none)."""
    if not recording.models:
        return None, "the recording holds no model_info"
    try:
        return vibro_impact.Model(recording.models[0].configuration), ""
    except vibro_impact.Error as error:
        return None, "the recorded configuration cannot be used: " + " ".join(str(error).split())


def contact_apart(configuration):
    """(YAML text of a configuration without what a change of the contact changes, stiffness, clearance): as it is
    recorded, "" where it is written in another way."""
    found = re.search(r"^contact:\n  stiffness: (\S+)\n  clearance: (\S+)\n", configuration, re.MULTILINE)
    if not found:
        return configuration, "", ""
    return configuration[: found.start()] + configuration[found.end() :], found.group(1), found.group(2)


def bandwidth(recording, model):
    """Least half-power bandwidth 2 zeta f of the resonances while apart, Hz: a modal table may damp each mode in its
    own way. `model` may be None: of the recorded natural frequencies, at USUAL_DAMPING."""
    if model:
        frequency, damping = model.free_frequencies, np.maximum(model.free_damping_ratios, LEAST_DAMPING)
    else:
        frequency = recording.models[0].free_frequencies if recording.models else np.empty(0)
        damping = USUAL_DAMPING
    bandwidths = (2.0 * damping * frequency)[frequency > 0.0]
    return float(np.min(bandwidths)) if len(bandwidths) else 1.0


def linear_state(recording, touched, pressed):
    """The linear state, "free" or "contact", in which the whole recording is; "" where it is in both or its contact
    changes."""
    if len(recording.models) != 1 or (touched and not pressed):
        return ""
    return "contact" if pressed else "free"


def receptance(model, sample_period, state, frequency):
    """Gap per base acceleration in a linear state (complex, s^2) at `frequency` in Hz, for a drive that is linear
    between its samples, as the simulator takes it.

    The closed form is H = -sum_n b_n Gamma_n/(omega_n^2 - omega^2 + 2 i zeta_n omega_n omega), from the modal equations
    of doc/model.md, section 3. Joined by straight lines, samples at a frequency f are a drive that has sinc^2(f T) of
    their amplitude there, and an image at every f + k/T, of which the samples of the response show the answer at f
    again."""
    total = np.zeros(len(frequency), dtype=complex)
    for k in range(-IMAGES, IMAGES + 1):
        image = frequency + k / sample_period
        answer = np.asarray(model.gap_response(np.abs(image), state))
        total += np.where(image < 0.0, np.conj(answer), answer) * np.sinc(image * sample_period) ** 2
    return total
