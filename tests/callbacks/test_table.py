import pytest

from normalgan.callbacks.table import FIGURES, HEADINGS, results_table

# Each figure of each column another number, so that a mix-up shows.
RESULTS = {
    row: {figure: (i + 1) / 100 + j / 10 for j, figure in enumerate(FIGURES)}
    for i, row in enumerate(HEADINGS)
}


def test_every_figure_stands_in_its_row_and_column() -> None:
    lines = results_table(RESULTS, "Test split, 4 samples").splitlines()
    assert lines[0] == "Test split, 4 samples"
    (heading,) = (line for line in lines if "constant" in line and "hints" in line and ":" not in line)
    assert heading.split() == ["constant", "mean", "map", "no", "hints", "hints", "off", "hints"]
    for figure, label in FIGURES.items():
        (line,) = (line for line in lines if line.strip().startswith(f"{label} "))
        shown = line.replace(label, "").split()
        values = [RESULTS[row][figure] for row in HEADINGS]
        if figure.startswith(("below", "coverage")):
            assert shown == [f"{100 * v:.1f}%" for v in values]
        elif figure.startswith("angular"):
            assert shown == [f"{v:.2f}°" for v in values]
        else:
            assert shown == [f"{v:.3f}" for v in values]


@pytest.mark.parametrize("columns", ["40", None])
def test_it_fits_80_columns_whatever_the_terminal(
    columns: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = results_table(RESULTS, "Test split")
    monkeypatch.delenv("COLUMNS", raising=False)
    if columns is not None:
        monkeypatch.setenv("COLUMNS", columns)
    monkeypatch.setenv("FORCE_COLOR", "1")
    wide = {row: dict.fromkeys(FIGURES, 179.99) for row in HEADINGS}
    assert results_table(RESULTS, "Test split") == expected
    assert "\x1b" not in expected  # it can be piped
    assert "…" not in results_table(wide, "Test split")
    assert max(map(len, results_table(wide, "Test split").splitlines())) <= 80


def test_what_was_not_measured_is_a_dash() -> None:
    unmeasured = {**RESULTS, "off_hints": dict.fromkeys(FIGURES, float("nan"))}
    lines = results_table(unmeasured, "x").splitlines()
    assert sum(line.endswith("–") for line in lines) == len(FIGURES)
    assert "nan" not in "".join(lines)
