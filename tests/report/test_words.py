"""Numbers keep the digits that mean something, and no others."""

import math

import pytest

from spirob.report.words import column, fixed, given, interval, number, percent, prose, shown


def test_a_column_lines_up_on_its_median():
    assert column([0.1834, 0.0512, 0.0431]) == ["0.1834", "0.0512", "0.0431"]
    assert column([183.4, 51.2, 4310.0]) == ["183", "51", "4310"]


def test_a_column_shows_what_is_missing_as_a_dash():
    assert column([1.0, None, math.nan]) == ["1.00", "–", "–"]
    assert column([]) == []


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (2.31e-5, "2.31 × 10⁻⁵"),
        (-0.0123, "−0.0123"),
        (41000.0, "41\u202f000"),
        (None, "–"),
        (math.inf, "–"),
    ],
)
def test_one_number_is_short(value, text):
    assert number(value) == text


def test_an_interval_sets_the_digits_of_its_value():
    assert interval(0.2143, 0.2001, 0.2288) == ("0.214", "0.200 to 0.229")
    assert interval(2.31e-5, 2.19e-5, 2.43e-5) == ("2.31 × 10⁻⁵", "2.19 to 2.43 × 10⁻⁵")


@pytest.mark.parametrize("bounds", [(None, None), (1.0, 1.0), (math.nan, 2.0)])
def test_without_an_interval_it_says_so(bounds):
    assert interval(1.0, *bounds)[1] == "not determined"


def test_chosen_numbers_carry_no_zeros():
    assert [given(v) for v in (0.6, 1.0, 2e-5, 1e6)] == ["0.6", "1", "2 × 10⁻⁵", "1 × 10⁶"]


def test_shares_and_signs():
    shares = (0.58, 0.0996, 0.06, 0.0024, 0.0, None)
    assert [percent(s) for s in shares] == ["58 %", "10 %", "6.0 %", "0.24 %", "0 %", "–"]
    assert fixed(-1e-9, 3) == "0.000"
    assert shown("m") == ("mm", 1e3)


def test_prose_has_this_pages_signs_and_leaves_words_alone():
    assert prose("75% of it, -2.98 mA") == "75 % of it, −2.98 mA"
    assert prose("held-out, 2025-03 and 1.00-2") == "held-out, 2025-03 and 1.00-2"
