"""Fins: thin plates set along the spine of a fish, which bend with it."""

from dataclasses import dataclass

import numpy as np

from normalgan.animals.chain import Frame
from normalgan.animals.outline import rounded
from normalgan.animals.plate import Plate
from normalgan.animals.spine import Spine


@dataclass(frozen=True)
class Fin:
    """A fin in the sagittal plane, or a pair of them.

    Args:
        outline: corners (x, y) in units of the length of the fish; those of a pair are (outwards from the
            root, along the chord).
        thick: half the thickness of its rim.
        root: (x, y, z) where a pair is set on; None for a single one, given in the fish's own coordinates.
        spread: degrees by which a pair stands off the flank, 90 straight out.
        droop: degrees by which a pair hangs below the horizontal.
        chord: direction of a pair's second axis, as nearly as the first allows.
        swell: growth of half the thickness inwards.
        sharp: cut the corners of the outline once instead of twice.
    """

    outline: tuple[tuple[float, float], ...]
    thick: float = 0.007
    root: tuple[float, float, float] | None = None
    spread: float = 50.0
    droop: float = 20.0
    chord: tuple[float, float, float] = (1.0, 0.0, 0.0)
    swell: float = 0.08
    sharp: bool = False


def grow(fin: Fin, spine: Spine, factor: float = 1.0, flare: float = 0.0, flap: float = 0.0) -> list[Plate]:
    """Return the plates of a fin.

    Args:
        fin: the fin.
        spine: of the fish it grows on.
        factor: on its height.
        flare: degrees added to the spread of a pair.
        flap: degrees added to its droop.
    """
    corners = np.array(fin.outline)
    times = 1 if fin.sharp else 2
    if fin.root is None:
        middle = float(corners[:, 0].mean())
        base = float(np.abs(corners[:, 1]).min()) * np.sign(corners[:, 1].sum())
        flat = rounded([(x - middle, base + (y - base) * factor) for x, y in corners], times)
        # The plate bends as the spine does about its middle.
        h = 0.05
        before, after = (spine.frame(middle + d).rotation for d in (-h, h))
        turn = float(np.arctan2(-after[2, 0], after[0, 0]) - np.arctan2(-before[2, 0], before[0, 0]))
        return [Plate(flat, spine.frame(middle), fin.thick, fin.swell, 4 * fin.thick, (-turn / (2 * h), 0.0))]
    x, y, z = fin.root
    out, drop = np.deg2rad(fin.spread + flare), np.deg2rad(fin.droop + flap)
    first = np.array([-np.cos(out) * np.cos(drop), -np.sin(drop), np.sin(out) * np.cos(drop)])
    second = np.array(fin.chord) - (np.array(fin.chord) @ first) * first
    second /= np.linalg.norm(second)
    frame = Frame(np.array([0.0, y, z]), np.column_stack([first, second, np.cross(first, second)]))
    outline = rounded([(a * factor, b) for a, b in corners], times)
    right = Plate(outline, frame, fin.thick, fin.swell, 4 * fin.thick)
    return [each.placed(spine.frame(x), 1.0) for each in (right, right.mirrored())]
