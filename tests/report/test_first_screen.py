"""The first screen says what the verdict is, what it is worth and what decided it."""

from dataclasses import replace

import pytest

from spirob.report.sections.verdict import explained_sentence, gain_sentence, kind, share
from tests.report.rendering import SECTIONS, text


def test_a_doubt_about_the_data_is_no_gap_in_the_library():
    assert kind({"verdict": "unknown", "doubts": ["another unit"]}) == "Look at the data first"
    assert "missing" in kind({"verdict": "unknown", "doubts": []})


def test_the_first_screen_says_with_what_it_was_decided(data):
    asked = {"experiment": "fast moves", "before": "Undecided: play or a soft tendon."}
    shown = text("verdict", replace(data, diagnosis={**data.diagnosis, "asked": asked}))
    assert "Decided with &#39;fast moves&#39;" in shown
    assert asked["before"] in shown
    assert "Decided with" not in text("verdict", data)


@pytest.mark.parametrize(("holds", "told"), [(True, "holds"), (False, "too little for a name")])
def test_the_verdict_tells_what_a_name_was_worth_on_a_trial_of_its_own(data, holds, told):
    proof = {"experiment": "soft pull", "share": 0.93 if holds else -0.2, "holds": holds}
    shown = text("verdict", replace(data, diagnosis={**data.diagnosis, "proof": proof}))
    assert "soft pull" in shown
    assert told in shown
    assert ("93 %" if holds else "for 0 %") in shown


def test_the_verdict_says_what_counts_as_an_effect_and_why(data):
    floor = {"share": 0.0072, "reason": "19 builds leave up to 0.72% of the effort."}
    shown = text("verdict", replace(data, diagnosis={**data.diagnosis, "floor": floor}))
    assert "The least that counts as an effect is 0.72 %: 19 builds leave up to 0.72 % of" in shown
    unmeasured = {k: v for k, v in data.diagnosis.items() if k != "floor"}
    assert "counts as an effect is" not in text("verdict", replace(data, diagnosis=unmeasured))


def test_the_verdict_says_by_how_much_the_error_falls(data):
    context = SECTIONS["verdict"].get_context(data)
    assert context["gain"] == (
        "On held-out trials the RMSE of current falls from 0.183 to 0.051 A, by 72 %; "
        "sensor noise alone is 0.012 A."
    )


def test_noise_far_below_the_errors_is_told_with_its_own_digits():
    errors = {(): 0.0282, ("stribeck_friction",): 0.0116}
    rungs = [{"effects": list(names), "heldout": {"rmse": e}} for names, e in errors.items()]
    assert gain_sentence(rungs, 0.000221, "A").endswith(
        "falls from 0.028 to 0.012 A, by 59 %; sensor noise alone is 0.00022 A."
    )


def test_the_verdict_says_how_much_is_explained(data):
    context = SECTIONS["verdict"].get_context(data)
    assert context["explained"] == (
        "The fitted model explains 87 % of the current that it has not seen; "
        "with the effect 99.0 %."
    )
    assert explained_sentence([], "A") == ""
    assert explained_sentence(data.diagnosis["ladder"][:1], "A").endswith("not seen.")


@pytest.mark.parametrize(
    ("r2", "shown"),
    [(0.712, "71 %"), (0.9907, "99.1 %"), (0.99984, "99.98 %"), (-3.0, "0 %"), (1.0, "100 %")],
)
def test_a_share_shows_what_is_missing_to_all(r2, shown):
    assert share(r2) == shown


def test_the_truth_is_shown_only_when_it_was_opened(data, sparse):
    assert "Opened after the verdict" in text("verdict", data)
    assert "Opened after the verdict" not in text("verdict", sparse)


def test_without_motion_the_arm_gives_way_to_a_reason(sparse):
    shown = text("verdict", sparse)
    assert "<canvas" not in shown
    assert "data/diagnosis/motion.parquet is absent" in shown


def test_text_from_files_cannot_become_markup(data):
    diagnosis = data.diagnosis | {"sentence": "<script>alert(1)</script>"}
    assert "<script>alert" not in text("verdict", replace(data, diagnosis=diagnosis))
