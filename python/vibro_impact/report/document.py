"""Which sections a run gives, and what they say."""

import datetime
import html
import inspect
import math
import os

import numpy as np

import vibro_impact
from vibro_impact.report import impact_charts, response_charts, spectra, spectral_charts, step_data
from vibro_impact.report import model as models
from vibro_impact.report import run as runs
from vibro_impact.report.packing import prefix
from vibro_impact.report.page import Page, figure, plotly_licence, plotly_version, table

# A page of this many characters opens at once; what the rest leaves of it is for the data of the steps.
LARGEST_PAGE = 13.0e6
# Rows of a list, and configurations that are shown in full.
ROWS_SHOWN = 20
MODELS_SHOWN = 5
# Independent averages of a frequency-response function below which the page warns.
LEAST_AVERAGES = 8
STATE_WORDS = {"free": "the contact never reached", "contact": "the contact never left"}


class Refused(Exception):
    """Something the user asked for is not in the recording; the message is one line."""


def names(bags):
    """Of bags, without their folders, for people."""
    return " ".join(os.fsencode(os.path.basename(bag)).decode("utf-8", "replace") for bag in bags)


def utc(stamp):
    """A time stamp (seconds, nanoseconds) for people."""
    if stamp[0] < 86400 * 365:
        return "%d.%09d s" % tuple(stamp)
    moment = datetime.datetime.fromtimestamp(stamp[0], datetime.timezone.utc)
    return moment.strftime("%Y-%m-%d %H:%M:%S") + ".%06d UTC" % (stamp[1] // 1000)


def stepped(run):
    return run.drive == "steps"


def drive_words(run):
    told = ", as --drive says" if run.told else ""
    if stepped(run):
        frequencies = [segment.frequency for segment in run.segments]
        return "%d steps of constant frequency, %.4g to %.4g Hz%s" % (
            len(frequencies),
            min(frequencies),
            max(frequencies),
            told,
        )
    lines = run.spectral_lines
    if run.drive == "random":
        if not lines:
            return "random" + told
        words = "random%s: about %d lines share the power of a segment of %.3g s"
        return words % (told, round(lines.lines), lines.duration)
    if told:
        return "other" + told
    if not lines:
        known = run.recording.acceleration[np.isfinite(run.recording.acceleration)]
        return "none" if len(known) == 0 or known.min() == known.max() else "too short, or too often lost, to be judged"
    if lines.loud < runs.RANDOM_SHARE:
        silent = 100.0 * (1.0 - lines.loud)
        return "neither steps of constant frequency nor random: silent for %.3g %% of the time" % silent
    return "neither steps of constant frequency nor random"


def counts(run):
    recording = run.recording
    impacts = recording.impacts
    return [
        ("bags", names(run.bags)),
        ("first sample", "%s (number %d)" % (utc(recording.start_stamp), recording.first)),
        (
            "length",
            "%.6g s: %d samples at %.6g Hz"
            % (len(recording.gap) * recording.sample_period, len(recording.gap), 1.0 / recording.sample_period),
        ),
        ("drive", drive_words(run)),
        ("impacts", "%d, of which %d cut short" % (len(impacts), int(np.count_nonzero(impacts["cut_short"])))),
    ]


def replay_limits():
    """What the replay check takes the limits of the simulator for: it is not recorded what they were."""
    defaults = {name: given.default for name, given in inspect.signature(vibro_impact.check_replay).parameters.items()}
    return (
        " Computed with the simulator's default limits: max_acceleration %g m/s\u00b2, max_bridged_gap %g s,"
        " max_step_back %g s, max_stamp_jitter %g s; replay_check takes others."
        % tuple(defaults[name] for name in ("max_acceleration", "max_bridged_gap", "max_step_back", "max_stamp_jitter"))
    )


def replay_verdict(run):
    """(class of the verdict, text)."""
    report = run.replay
    if report is None:
        return "open", "Not compared. " + run.replay_error
    if report.difference:
        found = report.difference
        return (
            "bad",
            "Different: topic %s, %s: %s: recorded %s, recomputed %s. Before it %d samples and %d impacts are"
            " identical."
            % (
                found.topic,
                found.place,
                found.field,
                found.recorded,
                found.recomputed,
                report.samples,
                report.impacts,
            )
            + replay_limits(),
        )
    words = (
        "%d samples of gap and contact force and %d impacts, recomputed from the excitation and the model recorded with"
        " them, bit for bit."
        % (
            report.samples,
            report.impacts,
        )
    )
    if report.losses or report.impacts_not_compared:
        return "open", "Identical where compared: " + words + replay_limits()
    return "", "Identical: " + words + replay_limits()


def listed(page, title, rows, header):
    """A table with a heading, of so many rows as a reader reads; how many more there are."""
    page.put("<h3>%s</h3>" % title + table(rows[:ROWS_SHOWN], header))
    if len(rows) > ROWS_SHOWN:
        page.put("<p>And %d more.</p>" % (len(rows) - ROWS_SHOWN))


def integrity(page, run):
    recording = run.recording
    kind, words = replay_verdict(run)
    page.put("<p class='verdict %s'>%s</p>" % (kind, html.escape(words)))
    summary = recording.summary
    page.put(
        table(
            [
                ("blocks of excitation", "%d, and %d recorded twice" % (summary.blocks, summary.repeated)),
                ("samples", "%d" % summary.samples),
                ("impacts", "%d" % summary.impacts),
                ("restarts of the motion", "%d" % summary.restarts),
                ("losses", "%d" % len(recording.losses) if recording.losses else "none"),
                ("steps left out", "%d" % len(run.left_out) if run.left_out else "none"),
            ]
        )
    )
    if recording.losses:
        rows = [(int(first), int(last), reason) for first, last, reason in recording.losses]
        listed(page, "Losses", rows, ("from sample", "to before", "what"))
    if run.left_out:
        rows = [
            ("%.4f" % omega_star, int(first), int(last), reason) for omega_star, first, last, reason in run.left_out
        ]
        listed(page, "Steps left out", rows, ("\u03c9*", "from sample", "to before", "why"))
    starts = [(int(sample), cause, reason) for sample, cause, reason in recording.starts]
    if starts:
        listed(page, "Starts from rest", starts, ("at sample", "cause", "reason"))


def in_full(page, model):
    """All that a model_info says."""

    def hertz(values):
        return ", ".join("%.6g" % value for value in values) + " Hz"

    page.put("<h3>From sample %d on</h3>" % model.seq)
    page.put(
        table(
            [
                ("version", model.version),
                ("free natural frequencies", hertz(model.free_frequencies)),
                ("natural frequencies in contact", hertz(model.contact_frequencies)),
                ("loss of the mapping", ", ".join("%.3g" % loss for loss in model.mapping_loss)),
            ]
        )
    )
    page.put("<pre tabindex='0'>%s</pre>" % html.escape(model.configuration))


def configuration(page, run):
    """What was computed with: in full where more than the contact is another, for its changes can be many."""
    full, changes = [], []
    for model in run.recording.models:
        rest, stiffness, clearance = models.contact_apart(model.configuration)
        if full and stiffness and full[-1][1] == (model.version, rest):
            changes.append((model.seq, stiffness, clearance))
        else:
            full.append((model, (model.version, rest)))
    for model, _ in full[:MODELS_SHOWN]:
        in_full(page, model)
    if len(full) > MODELS_SHOWN:
        page.put("<p>And %d more.</p>" % (len(full) - MODELS_SHOWN))
    if changes:
        header = ("from sample", "stiffness (N/m)", "clearance (m)")
        listed(page, "Changes of the contact alone", changes, header)


def label(number, segment, period, total):
    """How the list of steps calls one."""
    if segment.frequency:
        direction = {1: ", up", -1: ", down", 0: ""}[segment.direction]
        cycles = "period %d" % segment.period if segment.period else "no period"
        return "%d of %d: \u03c9* %.4f, %.2f Hz, %.4g m/s\u00b2%s, %s" % (
            number + 1,
            total,
            segment.omega_star,
            segment.frequency,
            segment.acceleration,
            direction,
            cycles,
        )
    return "%d of %d: %.4g to %.4g s" % (number + 1, total, segment.first * period, segment.last * period)


def step_asked_for(text):
    """What --step means: the number of a step, from 1 on (int), or omega* (float)."""
    try:
        value = float(text) if "." in text else int(text)
    except ValueError:
        value = -1
    if not (isinstance(value, int) and value >= 1 or isinstance(value, float) and 0.0 < value < math.inf):
        raise Refused("--step: '%s' is neither the number of a step, from 1 on, nor omega* with a decimal point" % text)
    return value


def chosen_step(run, wanted):
    """Number of the segment that is shown first."""
    if wanted is None:
        if not stepped(run):
            return 0
        return int(np.argmax([np.max(impacts["impulse"], initial=0.0) for impacts in run.captured]))
    value = step_asked_for(wanted)
    if isinstance(value, int):
        if value <= len(run.segments):
            return value - 1
        raise Refused("--step: there is no step %d, allowed is 1 to %d" % (value, len(run.segments)))
    if not stepped(run):
        raise Refused(
            "--step: %s is an omega*, but the drive has no steps; allowed is a number from 1 to %d"
            % (wanted, len(run.segments))
        )
    differences = [abs(segment.omega_star - value) for segment in run.segments]
    nearest = int(np.argmin(differences))
    if not differences[nearest] <= 0.05 * max(value, 0.1):
        raise Refused(
            "--step: no step has omega* %s, allowed is %.4g to %.4g"
            % (wanted, min(s.omega_star for s in run.segments), max(s.omega_star for s in run.segments))
        )
    return nearest


def responses(page, read):
    run = read[0]
    if not stepped(run):
        page.left_out("impulse", "Impulse response, period map, stroboscopic diagram", run.without_steps + ".")
        return
    shown = [each for each in read if stepped(each)]
    if len(shown) < len(read):
        page.put(
            "<p class='left-out'>The second run is left out of the responses: %s.</p>"
            % html.escape(read[1].without_steps)
        )
    if any(len(impacts) for each in shown for impacts in each.captured):
        page.section("impulse", "Impulse response")
        page.chart(response_charts.impulse_response(shown))
    else:
        page.left_out("impulse", "Impulse response", "no step has an impact in its steady response.")
    page.section("period", "Period map")
    page.chart(response_charts.period_map(shown))
    page.section("strobe", "Stroboscopic diagram")
    page.chart(response_charts.stroboscopic(shown))


def histograms(page, run):
    impacts = run.recording.impacts
    whole = impacts[~impacts["cut_short"].astype(bool)]
    if len(whole) == 0:
        reason = "the contact was never left" if pressed(run) else "there are no whole impacts in the recording"
        page.left_out("histograms", "Histograms", reason + ".")
        return
    page.section("histograms", "Histograms")
    page.put("<p>Of every whole impact of the recording, transients included.</p>")
    charts = impact_charts.histograms(whole)
    page.pairs(charts)


def pressed(run):
    """Whether the surfaces touch at every sample that is known."""
    force = run.recording.contact_force
    known = force[np.isfinite(force)]
    return len(known) > 0 and bool(np.all(known > 0.0))


def touched(run):
    return bool(np.nanmax(run.recording.contact_force, initial=0.0) > 0.0) or len(run.recording.impacts) > 0


STEP_CHARTS = (
    (
        "step_time",
        "Gap and contact force",
        (
            "Lines: every sample of the end of the %(step)s. Shaded: least and greatest value in each of many parts of"
            " the whole of it. Drag over a stretch to zoom, double-click for all; a negative gap is a compressed"
            " spring. The CSV holds every sample of the end, to the seven digits of single precision."
        ),
        560,
    ),
    (
        "step_portrait",
        "Phase portrait",
        (
            "Gap velocity over gap, over the stretch that the chart above shows at first. The velocity is not recorded:"
            " it is the central difference of the recorded gap over two sample periods, which takes sin(x)/x of a"
            " frequency f, x = 2\u03c0 f times the period. Dashed: contact."
        ),
        480,
    ),
    (
        "step_spectrum",
        "Spectrum",
        (
            "Amplitude spectra of the second half of the %(step)s, at most 131 072 samples (whole drive cycles of it"
            " where there is a drive), with a Hann window: a sine of amplitude A has A at its line. Where lines are"
            " more than the chart can hold, each value is the greatest of its neighbours. Dotted: frequency of the"
            " drive."
        ),
        480,
    ),
)


def steps(page, run, options):
    page.put("<section class='chosen'>")  # as far as the chooser stays in view
    page.section("step", "A chosen step" if stepped(run) else "A chosen part")
    chosen = chosen_step(run, options.step)
    page.put(
        "<div class='chooser'><label for='step-choice'>%s</label><select id='step-choice'></select>"
        "<button type='button' id='step-back'>Previous</button><button type='button' id='step-on'>Next</button></div>"
        % ("Step of the drive" if stepped(run) else "Part of the recording")
    )
    if not stepped(run):
        page.put("<p>The drive has no steps; these are %d equal parts of the recording.</p>" % len(run.segments))

    for key, title, caption, height in STEP_CHARTS:
        page.put(figure(key, title, caption % {"step": "step" if stepped(run) else "part"}, height))
    page.put("</section>")
    held = step_data.embedded(run.segments, chosen)
    if len(held) < len(run.segments):
        page.put(
            "<p class='left-out'>The page holds %d of the %d steps, evenly chosen.</p>" % (len(held), len(run.segments))
        )
    return chosen, held


def waterfalls(page, run):
    recording = run.recording
    page.section("waterfall", "Waterfall")
    quantities = [(recording.gap, "gap", "gap", "m")]
    if touched(run):
        quantities.append((recording.contact_force, "force", "contact force", "N"))
    segments = run.segments if stepped(run) else []
    for values, key, words, unit in quantities:
        chart, reason = spectral_charts.waterfall(values, recording.sample_period, segments, key, words, unit)
        if chart:
            page.chart(chart)
        else:
            page.put("<p class='left-out'>Left out: %s.</p>" % reason)
    if not touched(run):
        page.put("<p class='left-out'>That of the contact force is left out: the contact is never reached.</p>")


def segment_of(run, resolution, model):
    """Samples of a segment for the frequency-response functions."""
    recording = run.recording
    if resolution:
        return 2 * max(32, int(round(0.5 / (resolution * recording.sample_period))))
    return spectra.segment_length(len(recording.gap), recording.sample_period, models.bandwidth(recording, model))


def why_no_estimate(recording, response, length):
    """Why frequency_response() has nothing of a response, in segments of so many samples."""
    segment = "a segment of %d samples (%.4g s)" % (length, length * recording.sample_period)
    if length > len(response):
        return "the recording, %d samples, is shorter than %s." % (len(response), segment)
    if not len(spectra.whole_segments((recording.acceleration, response), length)):
        return "there is a loss in every stretch as long as %s." % segment
    return "only one stretch as long as %s is without a loss, and one segment alone has no coherence." % segment


def few_averages(page, estimate):
    """Says so where an estimate is of few averages."""
    if estimate.averages < LEAST_AVERAGES:
        page.put(
            "<p class='left-out'>Few averages: %d segments are worth %.1f independent ones. Of fewer than %d the"
            " coherence is too high by chance and the random error larger than stated; a coarser resolution"
            " (--resolution) or a longer recording gives more.</p>" % (estimate.segments, estimate.averages, LEAST_AVERAGES)
        )


def frequency_responses(page, run, resolution):
    title = "Frequency-response functions"
    if run.drive != "random":
        page.left_out("frf", title, "the drive is not random (%s)." % drive_words(run))
        return
    recording = run.recording
    model, no_model = models.of_recording(recording)
    length = segment_of(run, resolution, model)

    def estimate(response):
        return spectra.frequency_response(recording.acceleration, response, recording.sample_period, length)

    gap = estimate(recording.gap)
    if gap is None:
        page.left_out("frf", title, why_no_estimate(recording, recording.gap, length))
        return
    if not gap.auto_excitation.max() > 0.0:
        page.left_out("frf", title, "the base does not move.")
        return
    page.section("frf", title)
    page.put(
        "<p>Ratios of the phasors of a response and of the base acceleration that excites it (ISO 7626-1). The"
        " excitation is an acceleration, not a force: the gap per base acceleration, in s\u00b2, stands for the"
        " receptance (dynamic compliance), as the base acts on every mode like the force \u2212\u0393<sub>n</sub>"
        " <i>a</i>.</p>"
    )
    few_averages(page, gap)
    page.chart(spectral_charts.excitation_density(gap))
    state = models.linear_state(recording, touched(run), pressed(run))
    closed_form = models.receptance(model, recording.sample_period, state, gap.frequency) if state and model else None
    page.chart(spectral_charts.frequency_response(gap, "gap", "gap", "m", closed_form, STATE_WORDS.get(state, "")))
    if not touched(run):
        page.put("<p class='left-out'>That of the contact force is left out: the contact is never reached.</p>")
    else:
        force = estimate(recording.contact_force)
        if force:
            page.chart(spectral_charts.frequency_response(force, "force", "contact force", "N"))
        else:
            reason = why_no_estimate(recording, recording.contact_force, length)
            page.put("<p class='left-out'>That of the contact force is left out: %s</p>" % html.escape(reason))
        if not state:
            page.put(
                "<p>No closed form is drawn along: a contact that opens and closes is not linear, which the coherence"
                " shows.</p>"
            )
    if not model:
        words = "" if resolution else " The resolution is that for a damping ratio of %g." % models.USUAL_DAMPING
        page.put("<p class='left-out'>No closed form is drawn along: %s.%s</p>" % (html.escape(no_model), words))


def make(read, options, stage):
    """The page as text."""
    run = read[0]
    recording = run.recording
    page = Page("Vibro-impact run: " + names(run.bags))
    page.lead(
        "Made from the recording alone. Charts can be zoomed with the mouse or, in focus, with the keys plus, minus,"
        " arrows and 0."
    )
    page.section("run", "Run")
    page.put(table(counts(run)))
    for other in read[1:]:
        page.put("<h3>Second run, drawn along in the responses</h3>" + table(counts(other)))
    stage("charts over time")
    page.chart(impact_charts.over_time(recording))
    page.section("integrity", "Integrity")
    for other in read:
        if other is not run:
            page.put("<h3>Second run</h3>")
        integrity(page, other)
    page.section("configuration", "Configuration")
    configuration(page, run)
    stage("responses")
    responses(page, read)
    histograms(page, run)
    chosen, held = steps(page, run, options)
    stage("waterfalls")
    waterfalls(page, run)
    stage("frequency-response functions")
    frequency_responses(page, run, options.resolution)

    stage("data of %d %s" % (len(held), "steps" if stepped(run) else "parts"))
    factor_gap, unit_gap = prefix(greatest(recording.gap))
    factor_force, unit_force = prefix(greatest(recording.contact_force))
    page.data.update(
        sample_period=recording.sample_period,
        units={
            "gap": {"factor": factor_gap, "text": unit_gap + "m"},
            "force": {"factor": factor_force, "text": unit_force + "N"},
        },
        part="step" if stepped(run) else "part",
        chosen=chosen,
        segments=[
            {
                "label": label(i, segment, recording.sample_period, len(run.segments)),
                "first": segment.first,
                "last": segment.last,
                "frequency": segment.frequency,
                "period": segment.period,
            }
            for i, segment in enumerate(run.segments)
        ],
    )
    footer = (
        "Charts by plotly.js %s (MIT licence, &#169; Plotly, Inc.), which is inside this page. The page makes no"
        " request. Definitions: doc/report.md of the package vibro_impact."
        % plotly_version()
    ) + plotly_licence()
    rest = LARGEST_PAGE - len(page.render(footer))
    size = step_data.sizes(len(held), rest)
    top = 0.5 / recording.sample_period
    page.data["step_data"] = {str(i): step_data.of_segment(recording, run.segments[i], size, top) for i in held}
    return page.render(footer)


def greatest(values):
    return float(np.nanmax(np.abs(values))) if np.isfinite(values).any() else 0.0
