"""Each section says what it must, without a browser."""

import re
from dataclasses import replace
from importlib import resources

import pytest

import spirob.report
from spirob.report.sections import discover
from spirob.report.sections.experiments import overlays
from spirob.report.sections.ladder import ladder
from spirob.report.sections.object_size import mae_interval
from spirob.report.sections.repairs import each_once
from tests.report.rendering import RIG, SECTIONS, rendered, text
from tests.report.synthetic import TRIALS

BY_NAME = pytest.mark.parametrize("name", SECTIONS)


def test_sections_stand_in_the_order_of_the_page():
    assert list(SECTIONS) == [
        "verdict",
        "composed",
        "switches",
        "comparison",
        "failure",
        "ladder",
        "laws",
        "trial",
        "parameters",
        "experiments",
        "contacts",
        "passive",
        "object_size",
        "size_study",
        "transfer",
        "sweep",
        "library",
        "home",
        "loop",
        "provenance",
    ]


def test_sections_of_a_rig_stand_in_the_order_of_its_page():
    assert [section.name for section in discover("rig")] == [
        "verdict",
        "composed",
        "switches",
        "overlay",
        "motion",
        "failure",
        "ladder",
        "laws",
        "parameters",
        "repairs",
        "library",
        "home",
        "provenance",
    ]


def test_every_template_belongs_to_a_section_or_the_page():
    files = {f.name for f in resources.files("spirob.report").joinpath("templates").iterdir()}
    used = {s.template for s in [*SECTIONS.values(), *discover("rig")]}
    assert files == used | {"page.html.j2", "parts.html.j2", "effect.html.j2"}


TOLD = "In 0.24% of the time 3.5% of it are left."  # as sentences of a diagnosis are written
SENTENCES = ("sentence", "explanation", "next_experiment")


def test_every_section_writes_per_cent_in_one_way(data):
    diagnosis = data.diagnosis | dict.fromkeys(SENTENCES, TOLD) | {"atlas_sentences": [TOLD]}
    diagnosis |= {"depends": {"sentence": TOLD}}
    diagnosis |= {"repairs": [TOLD], "excluded": {"creep": TOLD}}
    diagnosis |= {"floor": {"share": 0.003, "reason": TOLD}}
    diagnosis |= {"asked": {"experiment": "fast moves", "before": TOLD}}
    shown = replace(data, diagnosis=diagnosis)
    pages = [spirob.report.render(shown), *(rendered(s, shown) for s in RIG)]
    for page in pages:
        seen = re.sub(r"<(script|style).*?</\1>|<[^>]*>", " ", page, flags=re.DOTALL)
        assert re.findall(r".{0,40}\d(?:&nbsp;)?%", seen) == []
    assert sum(page.count("0.24 % of the time 3.5 %") for page in pages) >= 9


@BY_NAME
def test_sections_render_with_and_without_optional_files(name, data, sparse):
    assert text(name, data)
    assert text(name, sparse)


@BY_NAME
@pytest.mark.parametrize("verdict", ["undecided", "nothing_missing", "unknown"])
def test_sections_render_for_verdicts_that_name_nothing(name, verdict, data):
    base = [rung | {"effects": []} for rung in data.diagnosis["ladder"][:2]]
    diagnosis = data.diagnosis | {
        "verdict": verdict,
        "effects": [],
        "candidates": [],
        "ladder": base,
        "noise_floor": None,
        "atlas": [],
    }
    overlay = data.overlay.assign(
        named_current=float("nan"), named_displacement=float("nan"), named_velocity=float("nan")
    )
    assert text(name, replace(data, diagnosis=diagnosis, overlay=overlay))


@BY_NAME
def test_sections_render_when_a_rung_has_no_held_out_error(name, data):
    ladder = [
        rung | {"heldout": None, "train": {"rmse": None}} for rung in data.diagnosis["ladder"]
    ]
    diagnosis = data.diagnosis | {"ladder": ladder, "noise_floor": float("nan")}
    assert text(name, replace(data, diagnosis=diagnosis))


def test_the_errors_beside_the_signals_have_units_and_nothing_else(data):
    trials = SECTIONS["comparison"].get_context(data)["signals"]["trials"]
    texts = [m["errors"] for trial in trials for m in trial["motors"].values()]
    for channel, unit in (("current", "A"), ("displacement", "mm"), ("velocity", "mm/s")):
        pattern = rf"residual RMSE: base [\d.]+ {unit}, with effect [\d.]+ {unit}"
        assert all(re.fullmatch(pattern, text[channel]) for text in texts)


def test_the_comparison_has_a_row_for_each_held_out_motor_in_millimetres(data):
    context = SECTIONS["comparison"].get_context(data)
    heldout = [name for name, (role, _) in TRIALS.items() if role != "train"]
    assert len(context["heldout"]) == 2 * len(heldout)
    assert context["units"] == {"current": "A", "displacement": "mm", "velocity": "mm/s"}
    trial = data.compare["trials"][0]
    displacement = context["heldout"][0]["cells"][3]["text"]
    assert float(displacement) == pytest.approx(
        1e3 * trial["motors"]["left"]["displacement"]["mae"], rel=0.01
    )


def test_held_out_trials_come_first_in_the_overlay(data):
    roles = [t["role"] for t in SECTIONS["comparison"].get_context(data)["signals"]["trials"]]
    assert roles == sorted(roles, key=["heldout", "validate", "train"].index)


def test_the_worst_regime_comes_first(data):
    groups = SECTIONS["failure"].get_context(data)["groups"]
    regimes = [row["regime"] for _, rows in groups for row in rows]
    assert regimes[0] == "winding in"
    assert regimes[-1] == "low load"


def test_regimes_are_grouped_by_what_they_are_about(data):
    groups = dict(SECTIONS["failure"].get_context(data)["groups"])
    assert list(groups) == ["velocity", "reversal", "load"]
    assert [row["regime"] for row in groups["velocity"]] == ["winding in", "paying out", "standing"]


def test_only_regimes_that_hold_more_error_than_time_are_drawn(data):
    figure = SECTIONS["failure"].get_context(data)["plot"].figure
    assert list(figure.data[0].customdata) == ["winding in", "0.1 s around reversals"]


def test_orders_lateness_and_dependence_are_told(data):
    shown = text("failure", data)
    assert all(part in shown for part in ("Order [1/turn]", "3.02", "12 %", "depends on speed"))
    assert "by 1.42 ms would explain 7.0 % of the squared error" in shown
    none = text("failure", replace(data, diagnosis=data.diagnosis | {"atlas_orders": []}))
    assert "comes again from trial to trial" in none
    older = {k: v for k, v in data.diagnosis.items() if k not in ("atlas_orders", "depends")}
    assert "comes again from trial" not in text("failure", replace(data, diagnosis=older))


def test_a_regime_that_no_shown_trial_holds_cannot_be_chosen_for_marking(data):
    atlas = [*data.diagnosis["atlas"], data.diagnosis["atlas"][0] | {"regime": "train_slow_left"}]
    shown = replace(data, diagnosis=data.diagnosis | {"atlas": atlas})
    chosen = SECTIONS["comparison"].get_context(shown)["regimes"]
    assert "winding in" in chosen
    assert "train_slow_left" not in chosen


@pytest.mark.parametrize("effects", [1, 4])
def test_a_long_label_of_the_ladder_has_a_place_of_its_own(effects):
    label = "fitted numbers" + " + direction dependent efficiency" * effects
    rungs = [{"label": label, "heldout": {"rmse": 1.0}, "train": {"rmse": 1.0}}] * 3
    figure = ladder(rungs, None, "A")
    margin = figure.layout.margin
    room = (figure.layout.height - margin.t - margin.b) / len(rungs)
    lines = figure.data[0].y[0].count("<br>") + 1
    assert lines > effects
    assert room >= 1.2 * figure.layout.font.size * lines


def test_the_named_candidate_is_marked(data):
    rows = SECTIONS["ladder"].get_context(data)["candidates"]
    assert [row["title"] for row in rows if row["chosen"]] == ["capstan friction"]


def test_candidates_are_those_that_were_fitted_with_the_errors_that_decide(data):
    """How many the screening ended is said."""
    context = SECTIONS["ladder"].get_context(data)
    assert len(context["candidates"]) == 4
    assert context["candidates"][0]["errors"] == ["0.047", "0.050", "0.051"]
    assert "The screening ended 1 more." in text("ladder", data)
    every = data.diagnosis | {"candidates": data.diagnosis["candidates"][:4]}
    assert "The screening ended" not in text("ladder", replace(data, diagnosis=every))


def test_a_diagnosis_that_is_doubted_has_no_model_to_take_home(data):
    doubted = {"doubts": ["The sign is turned."], "verdict": "unknown", "effects": []}
    assert not SECTIONS["home"].get_context(data)["senseless"]
    shown = replace(data, diagnosis=data.diagnosis | doubted)
    assert SECTIONS["home"].get_context(shown)["senseless"]
    assert text("home", shown) != text("home", data)


def test_a_parameter_at_its_bound_is_flagged_at_the_end_of_its_track(data):
    rows = {row["name"]: row for row in SECTIONS["parameters"].get_context(data)["rows"]}
    assert rows["rotor damping"]["at_bound"]
    assert rows["rotor damping"]["place"]["value"] == 100
    assert "at bound" in text("parameters", data)


def test_the_paper_stands_beside_our_figures(data):
    shown = text("object_size", data)
    assert all(number in shown for number in ("1.12", "0.98", "3.95", "0.76", "1.31", "3.42"))


def test_the_error_of_size_has_an_interval_around_it(data):
    from_predictions = data.predictions[data.predictions["domain"] == "robot"]
    error = (from_predictions["predicted_mm"] - from_predictions["true_mm"]).abs()
    low, high = (float(text) for text in mae_interval(data.predictions, "robot").split(" to "))
    assert low < error.mean() < high
    spread = 2 * 1.96 * error.std() / len(error) ** 0.5
    assert high - low == pytest.approx(spread, rel=0.1)
    assert mae_interval(data.predictions.head(3), "simulation") == ""


def test_the_transfer_is_compared_with_the_paper(data):
    context = SECTIONS["object_size"].get_context(data)
    assert "2.6 times as large, in the paper 3.5 times" in context["transfer"]


def test_without_a_sweep_the_command_is_given(sparse):
    assert "python -m pipeline.sweep -m" in text("sweep", sparse)


def test_experiments_show_ours_beside_the_papers(data, sparse):
    shown = text("experiments", data)
    assert "1 of 1 aims are met" in shown
    assert shown.index("53.4") < shown.index("54.0") < shown.index("52.4")
    assert "odd &lt;; aim: within 5 %" in shown
    assert shown.index("All figures") < shown.index("rise at 1 N")
    assert "were not played in this run" in text("experiments", sparse)


def test_the_baseline_does_not_flatten_the_others():
    lines = [
        {"quantity": "v", "play": "a", "unit": "mm/s", "side": s, "x": [0, 1], "y": [0.0, y]}
        for s, y in (("robot", 1.0), ("named", 1.1), ("single", 40.0))
    ]
    figure = overlays("curl", lines)[0].figure
    assert figure.layout.yaxis.range[1] < 2.0
    assert overlays("curl", lines[:2])[0].figure.layout.yaxis.range is None


def test_closing_the_loop_says_whether_the_error_falls(data, sparse):
    shown = text("transfer", data)
    assert "Where the model itself plays them the error falls at each step" in shown
    assert shown.count("many builds about it") >= 3
    assert 'id="transfer"' not in shown  # that is the section's own anchor
    assert shown.index("2.10 (1.50 to 2.70)") < shown.index("0.13 (−0.17 to 0.39)")
    assert "92 %" in shown
    worse = data.transfer["robot"] | {"named": data.transfer["robot"]["nominal"] | {"mae": 9.0}}
    told = text("transfer", replace(data, transfer=data.transfer | {"robot": worse}))
    assert "does not fall" in told
    alone = {k: v for k, v in data.transfer.items() if k != "machines"}
    without = text("transfer", replace(data, transfer=alone))
    assert "The error falls at each step" in without
    assert "many machines" not in without
    assert "stiffness of the base hinge 0.401 for 0.146 N·m/rad" in told
    assert "torque transmitted by the gear 0.890, where its bound held it, for 0.702" in told
    assert "stiffness of the base hinge" not in shown
    assert "was not learned from the other models" in text("transfer", sparse)


def test_no_two_things_on_the_page_have_the_same_id(data):
    """A figure named like a section would be drawn in its place."""
    page = re.sub(r"<script>.*?</script>", "", spirob.report.render(data), flags=re.DOTALL)
    found = re.findall(r'\bid="([^"]+)"', page)
    assert "transfer-error" in found
    assert len(found) == len(set(found))


@pytest.mark.parametrize(("covered", "told"), [(0.69, True), (0.88, False)])
def test_intervals_that_miss_more_often_than_chance_say_so(data, covered, told):
    robot = {"covered": covered, "samples": 26, "width": 0.005, "refused": 0.0}
    interval = {"confidence": 0.9, "robot": robot}
    shown = text("transfer", replace(data, transfer=data.transfer | {"interval": interval}))
    assert ("On the robot they hold only" in shown) == told


def test_what_is_said_of_several_logs_is_said_once_with_their_names():
    others = ["b: 3 samples.", "No test log: the end is held out.", "Odd.", "d: Odd."]
    told = ["a, c: is short.", *others]
    assert each_once(["a: is short.", *others, "c: is short."]) == told
    assert each_once(told) == told
