"""YAML is read as YAML 1.2's plain data: no surprise, and every mistake has its line."""

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from spirob.errors import ConfigError
from spirob.plain_yaml import read


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("100:00", "100:00"),
        ("2026-13-45", "2026-13-45"),
        ("2026-01-02 03:04:05", "2026-01-02 03:04:05"),
        ("yes", "yes"),
        ("off", "off"),
        ("010", 10),
        ("0o17", 15),
        ("0x1F", 31),
        ("1e5", 1e5),
        ("-.5", -0.5),
        ("12.", 12.0),
        ("true", True),
        ("~", None),
        ("", None),
        ("'1'", "1"),
        ("=", "="),
        ("[1, a, {b: c}]", [1, "a", {"b": "c"}]),
    ],
)
def test_a_value_is_what_it_looks_like(text, value):
    found = read(f"key: {text}", "a.yaml")["key"]
    assert found == value
    assert type(found) is type(value)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("a: 1\nb: 2\na: 3", r"a\.yaml: line 3: 'a' is given twice, first in line 1"),
        ("a:\n  b: 1\n  'b': 2", "line 3: 'b' is given twice, first in line 2"),
        ("a: " + "9" * 5000, "line 1: a number of 5000 characters"),
        ("a: !!timestamp 2020-01-01", "line 1: the tag 'timestamp'"),
        ("!!python/object/apply:os.system ['true']", "the tag 'python/object/apply:os.system'"),
        ("a: !!int x", "'x' is no int"),
        ("a: !!bool maybe", "'maybe' is no bool"),
        ("a: !!set {b}", "the tag 'set'"),
        ("? [1]\n: 2", "a key is text"),
        ("a: &a [*a]", "nested more than 32 deep"),
        ("[" * 40 + "]" * 40, "nested more than 32 deep"),
        ("[" * 5000, "nested too deeply"),
        ("a: *absent", "is not YAML"),
        ("a: b: c", "is not YAML: line 1: mapping values are not allowed here$"),
        ("\0", "is not YAML"),
        (b"\xc3\x28", "is not YAML: unacceptable character .* at position 0$"),
        ("a: 1\n---\nb: 2", "is not YAML"),
    ],
)
def test_what_is_no_plain_data_is_a_sentence(text, sentence):
    with pytest.raises(ConfigError, match=sentence):
        read(text, "a.yaml")


def test_aliases_are_counted_as_what_they_repeat():
    lines = ["a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1]"]
    lines += [f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 8)}]" for k in range(1, 9)]
    with pytest.raises(ConfigError, match="more than 10000 values"):
        read("\n".join(lines), "a.yaml")
    assert read("a: &x {b: 1}\nc: *x", "a.yaml") == {"a": {"b": 1}, "c": {"b": 1}}


PLAIN = st.recursive(
    st.none() | st.booleans() | st.integers(-(10**30), 10**30) | st.text() | st.floats(-1e9, 1e9),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=4),
    max_leaves=20,
)


@given(PLAIN)
def test_what_is_written_is_read_back(value):
    # escaped: within plain text YAML 1.1 takes U+0085 for the end of a line
    assert read(yaml.safe_dump(value), "a.yaml") == value


@given(st.text() | st.binary())
def test_any_text_is_data_or_a_sentence(text):
    try:
        read(text, "a.yaml")
    except ConfigError as error:
        assert str(error).startswith("a.yaml: ")
