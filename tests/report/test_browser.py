"""The page at work: figures drawn, the arm played, moments and regimes linked, phone and print."""

import numpy as np
import pytest

from spirob.report.sections.switches import Switches
from tests.report.browser import CHROMIUM, REASON, probe
from tests.report.synthetic import TRIALS

SWITCHES = Switches()
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason=REASON)


@pytest.fixture(scope="module")
def desk(page, tmp_path_factory):
    """One visit on a laptop: everything is tried in turn, and noted."""
    script = """
    const note = {};
    const names = ['steps', 'regimes', 'overlay', 'atlas', 'size'];
    note.drawn = names.filter((id) => get(id).querySelector('svg'));
    note.options = [get('arm-trial').length, get('overlay-trial').length];
    note.together = [get('arm-trial'), get('overlay-trial')].map((s) => s.selectedOptions[0].text);
    const cursor = document.querySelector('.cursor');
    turn('arm-time', 60, 'input');
    note.early = parseFloat(cursor.style.left);
    note.clock = get('arm-clock').textContent;
    note.apart = get('arm-apart').textContent;
    turn('arm-time', 600, 'input');
    note.late = parseFloat(cursor.style.left);
    turn('arm-trial', 1);
    await wait(200);
    note.followed = get('overlay-trial').selectedOptions[0].text;
    turn('overlay-trial', 0);
    await wait(200);
    note.back = get('arm-trial').selectedOptions[0].text;
    get('overlay').emit('plotly_click', { points: [{ x: 12.0 }] });
    note.clicked = get('arm-clock').textContent;
    const shapes = () => get('overlay').layout.shapes.length;
    note.unmarked = shapes();
    const bar = get('atlas').data[0].customdata.indexOf('winding in');
    const chosen = get('atlas').data[0].customdata[bar];
    get('atlas').emit('plotly_click', { points: [{ customdata: chosen }] });
    await wait(200);
    note.marked = shapes();
    note.regime = get('overlay-regime').value;
    note.said = get('overlay-marked').textContent;
    get('atlas').emit('plotly_click', { points: [{ customdata: 'winding in' }] });
    await wait(200);
    note.cleared = shapes();
    const flip = (name) => document.querySelector(`#switches-box [value="${name}"]`).click();
    const model = () => get('overlay').data.find((t) => t.meta.origin === 'named' && !t.meta.minus);
    const said = (id) => get(id).textContent;
    const read = () => ({ error: said('switches-error'), how: said('switches-how'),
      drawn: [...model().y].slice(300, 310), second: get('regimes').data[1].visible,
      note: get('overlay').layout.annotations[1].text });
    note.verdict = read();
    flip('coulomb_friction');
    await wait(200);
    note.both = read();
    flip('capstan_friction');
    await wait(200);
    note.other = read();
    flip('coulomb_friction');
    await wait(200);
    note.none = read();
    flip('capstan_friction');
    await wait(200);
    note.again = read();
    const press = (key) => document.activeElement.dispatchEvent(
      new KeyboardEvent('keydown', { key, bubbles: true, cancelable: true }));
    const entry = () => get('overlay').querySelector('.legend .traces');
    const lines = () => get('overlay').data.map((t) => t.visible);
    entry().focus();
    note.legend = [document.activeElement.getAttribute('aria-label')];
    const before = lines();
    for (const key of ['Enter', ' ']) {
      press(key);
      await wait(200);
      note.legend.push(entry().getAttribute('aria-checked'));
      note.legend.push(lines().filter((v, k) => v !== before[k] && v === 'legendonly').length);
    }
    note.kept = document.activeElement === entry();
    note.wide = document.documentElement.scrollWidth - innerWidth;
    const strip = document.querySelector('nav'), entries = [...strip.querySelectorAll('a')];
    note.cut = entries.filter((a) => a.getBoundingClientRect().right > innerWidth).length;
    note.bar = strip.offsetHeight;
    note.marked_entry = entries.filter((a) => a.ariaCurrent).length;
    note.focusable = [...document.querySelectorAll('a, button, input, select, summary, [tabindex]')]
      .every((element) => element.tabIndex >= 0);
    note.unnamed = [...document.querySelectorAll('button, input, select')]
      .filter((e) => !(e.labels?.length || e.ariaLabel || e.textContent.trim())).length;
    return note;
    """
    return probe(page, script, tmp_path_factory.mktemp("desk"))


def test_every_figure_is_drawn(desk):
    assert desk["drawn"] == ["steps", "regimes", "overlay", "atlas", "size"]
    assert desk["options"] == [len(TRIALS), len(TRIALS)]


def test_a_legend_is_worked_by_keyboard(desk):
    name, hidden, lines, shown, back = desk["legend"]
    assert name
    assert (hidden, shown, back) == ("false", "true", 0)
    assert lines > 0
    assert desk["kept"], "the focus stays on the entry"


def test_the_slider_moves_the_line_in_the_plots(desk):
    assert desk["together"][0] == desk["together"][1]
    assert desk["clock"] == "2.0 s"
    assert desk["late"] > desk["early"] + 100  # pixels


def test_robot_and_model_are_on_top_of_each_other(desk):
    assert desk["apart"].startswith("tips ")
    assert desk["apart"].endswith(" mm apart")
    assert float(desk["apart"].split()[1]) > 0


def test_the_trials_of_arm_and_plots_follow_each_other(desk):
    assert desk["followed"] == list(TRIALS)[1]
    assert desk["back"] == next(iter(TRIALS))


def test_a_click_in_the_plots_moves_the_arm(desk):
    assert desk["clicked"] == "12.0 s"


def test_a_click_on_a_regime_marks_its_samples_and_a_second_takes_it_back(desk):
    assert desk["unmarked"] == desk["cleared"] == 0
    assert desk["marked"] > 0
    assert desk["regime"] == "winding in"
    assert desk["said"].endswith(" s of this trial")


def test_a_switch_redraws_error_regimes_and_signals(desk, data):
    combinations = SWITCHES.get_context(data)["combinations"]
    left = {tuple(c["effects"]): c["rmse"]["heldout"] for c in combinations}
    shown = {
        "verdict": ("capstan_friction",),
        "both": ("capstan_friction", "coulomb_friction"),
        "other": ("coulomb_friction",),
        "none": (),
    }
    for state, effects in shown.items():
        read = float(desk[state]["error"].removesuffix(" mA").split(" ")[-1])
        assert read == pytest.approx(left[effects], rel=5e-3), state
    assert "in replay" in desk["both"]["how"]
    assert "full simulation" in desk["other"]["how"]
    assert desk["other"]["second"]
    assert not desk["none"]["second"]
    for state, effects in (("other", 0.4), ("both", 1.3)):  # shares in the synthetic run
        base, named = np.array(desk["none"]["drawn"]), np.array(desk["verdict"]["drawn"])
        expected = base + effects * (named - base)
        assert np.allclose(desk[state]["drawn"], expected, atol=4e-3), state  # A, a coarse step
    assert desk["other"]["drawn"] != desk["verdict"]["drawn"]
    assert "switched" in desk["other"]["note"]
    assert desk["again"] == desk["verdict"]


def test_everything_can_be_reached_by_keyboard_and_has_a_name(desk):
    assert desk["focusable"]
    assert desk["unnamed"] == 0
    assert desk["wide"] <= 0


def test_the_bar_of_sections_is_whole_and_low(desk):
    assert desk["cut"] == 0
    assert desk["bar"] < 90  # pixels: two lines
    assert desk["marked_entry"] == 1


def test_a_phone_scrolls_in_one_direction_only(page, tmp_path):
    script = """
    const page = document.documentElement;
    const pushed = () => {
      const bar = document.querySelector('nav'), last = [...bar.querySelectorAll('a')].pop();
      const before = last.getBoundingClientRect().right;
      last.focus();
      return { bar: bar.offsetHeight, before, after: last.getBoundingClientRect().right };
    };
    const right = (id) => get(id).querySelector('svg').getBoundingClientRect().right;
    return { width: innerWidth, over: page.scrollWidth - innerWidth,
      plots: ['steps', 'overlay', 'atlas', 'size'].map(right), ...pushed(),
      targets: [...document.querySelectorAll('button, select')].map((e) => e.offsetHeight) };
    """
    found = probe(page, script, tmp_path, width=390)
    assert found["width"] == 390
    assert found["over"] <= 0
    assert max(found["plots"]) <= 390
    assert min(found["targets"]) >= 30  # pixels, for a finger
    assert found["bar"] < 60  # one line, pushed sideways by finger or by keyboard
    assert found["before"] > 390 >= found["after"]


def test_print_unfolds_everything_but_the_library_and_takes_light_colours(page, tmp_path):
    script = """
    const folded = () => document.querySelectorAll('details:not([open]):not(.card)').length;
    const before = folded();
    dispatchEvent(new Event('beforeprint'));
    await wait(500);
    const note = { before, during: folded(), theme: document.documentElement.dataset.theme };
    dispatchEvent(new Event('afterprint'));
    await wait(200);
    return { ...note, after: folded() };
    """
    found = probe(page, script, tmp_path)
    assert found["during"] == 0
    assert found["theme"] == "light"
    assert found["after"] == found["before"] > 0
