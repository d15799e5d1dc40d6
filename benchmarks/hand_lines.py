"""The evidence for the hand: measures its lines and people's, and what training on its lines is worth.

benchmarks/hand_lines.py stats
benchmarks/hand_lines.py train --seeds 0 1 2
"""

import argparse
import sys
from dataclasses import astuple, fields
from pathlib import Path

import cv2
import numpy as np
from line_figures import Figures, measure

from normalgan.animals import Animal
from normalgan.rendering import EmbreeRenderer, Views
from normalgan.rendering.hand import Hand
from normalgan.rendering.lines import SuggestiveContours
from normalgan.rendering.samples import Recipe

ROOT = Path(__file__).parents[1]
KINDS = (
    *("bear", "camel", "cat", "cow", "dog", "elephant", "fox", "giraffe"),
    *("goat", "horse", "lion", "pig", "rhino", "sheep", "stag"),
)
SIZE = 256
WORDS = {
    "density": "ink, share of the bounding box",
    "width": "width, thousandths of the drawing's size",
    "width_spread": "spread of the width, quartiles over median",
    "turning": "turning, radians on the drawing's size",
    "corners": "corners on the drawing's size",
    "ends": "open ends",
    "ends_per_length": "open ends on the drawing's size",
    "junctions": "junctions",
    "length": "length of all lines, in the drawing's size",
}


def people(folder: Path) -> dict[str, list[Figures]]:
    """Return the figures of people's drawings, by folder."""
    found: dict[str, list[Figures]] = {}
    for path in sorted(folder.glob("*/*.png")):
        grey = cv2.imdecode(np.frombuffer(path.read_bytes(), np.uint8), cv2.IMREAD_GRAYSCALE)
        if grey is None or grey.shape != (SIZE, SIZE):
            raise SystemExit(f"{path} is not a picture of {SIZE} × {SIZE} pixels.")
        found.setdefault(path.parent.name, []).append(measure(1 - grey.astype(np.float32) / 255))
    return found


def ours(views: int) -> dict[str, list[Figures]]:
    """Return the figures of drawings of embedded animals, by draughtsman; all draw the same views."""
    found: dict[str, list[Figures]] = {}
    hands = {"exact": None, "hand": Hand(), "hand at 1": Hand(strength=(1.0, 1.0))}
    for kind in KINDS:
        mesh = Animal(kind, 1).load()
        for name, hand in hands.items():
            recipe = Recipe(Views(), EmbreeRenderer(), SuggestiveContours(), SIZE, hand=hand)
            for index in range(views):
                ink = recipe.render(mesh, index).sketch.astype(np.float32) / 255
                found.setdefault(name, []).append(measure(ink))
    return found


def table(groups: dict[str, list[Figures]]) -> str:
    """Return medians and quartiles as a Markdown table with a column for each group."""
    names = [f"{name} ({len(group)})" for name, group in groups.items()]
    lines = [f"| | {' | '.join(names)} |", "| --- |" + " --- |" * len(names)]
    values = {name: np.array([astuple(one) for one in group]) for name, group in groups.items()}
    for index, field in enumerate(fields(Figures)):
        cells = []
        for group in values.values():
            low, median, high = np.percentile(group[:, index], [25, 50, 75])
            cells.append(f"{median:.3g} ({low:.3g} – {high:.3g})")
        lines.append(f"| {WORDS[field.name]} | {' | '.join(cells)} |")
    return "\n".join(lines)


def stats(options: argparse.Namespace) -> None:
    """Print the table of figures, without people's columns if there are no drawings of theirs."""
    drawn = people(options.sketches)
    if not drawn:
        print(f"There are no drawings in {options.sketches}: people's columns are missing.", file=sys.stderr)
    print(table({**drawn, **ours(options.views)}))


def train(options: argparse.Namespace) -> None:
    """Train and test what the results lack, and print the table."""
    from hand_training import Settings, run_all  # imported here, because torch takes seconds to import

    settings = Settings(options.epochs, options.animals, options.train_views, options.test_views)
    print(run_all(settings, options.seeds, options.output, options.cache))


def main() -> None:
    """Run the command that the command line names."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    commands = parser.add_subparsers(required=True)
    one = commands.add_parser("stats", help="figures of people's lines and of ours")
    one.add_argument("--sketches", type=Path, default=ROOT.parent / "shared" / "sketches")
    one.add_argument("--views", type=int, default=4, help="of each of the 15 animals")
    one.set_defaults(run=stats)
    two = commands.add_parser("train", help="train on exact and on the hand's lines, test on both")
    two.add_argument("--seeds", type=int, nargs="+", default=[0, 1, 2])
    two.add_argument("--epochs", type=int, default=10)
    two.add_argument("--animals", type=int, default=30)
    two.add_argument("--train_views", type=int, default=40)
    two.add_argument("--test_views", type=int, default=20)
    two.add_argument("--output", type=Path, default=ROOT / "docs" / "results" / "hand_lines.json")
    two.add_argument("--cache", default="cache")
    two.set_defaults(run=train)
    options = parser.parse_args()
    options.run(options)


if __name__ == "__main__":
    main()
