"""Insects with long limbs: grasshopper and mantis."""

import numpy as np

from normalgan.animals.field import Part
from normalgan.animals.forms import both, by, fuse, tube
from normalgan.animals.insects import eyes, feelers, legs, ringed
from normalgan.animals.plan import Rng
from normalgan.animals.shapes import factors


def grasshopper(pose: str, rng: Rng) -> list[Part]:
    """Return a grasshopper, the knees of its hind legs above its back; one that leaps has them stretched."""
    f = factors(rng, 0.12, "tail", "knee", "feelers", "head")
    knee = np.array([-0.42, 0.36 * f["knee"], 0.20])
    foot = np.array([-0.30, -0.24, 0.30])
    if pose == "leap":
        knee, foot = np.array([-0.36, 0.10, 0.22]), np.array([-0.78, -0.30, 0.30])
    hind = tube(
        [[0.02, -0.04, 0.07], [-0.08, 0.02, 0.12], (np.array([0.0, 0.0, 0.13]) + knee) / 2, knee],
        [0.04, 0.065, 0.055, 0.028],
    )
    shin = tube(
        [knee, (knee + foot) / 2 + np.array([0, 0, 0.01]), foot, by(foot, -0.11, 0.0, 0.03)],
        [0.028, 0.022, 0.02, 0.018],
    )
    end = -0.52 * f["tail"]
    cover = [[0.08, 0.10, 0], [-0.2, 0.09, 0], [end - 0.1, 0.03, 0]]
    long = float(rng.uniform(0.25, 0.7)) * f["feelers"]
    parts = [
        fuse(ringed([[0.14, 0, 0], [-0.15, -0.01, 0], [end, -0.01, 0]], [0.11, 0.10, 0.045], 6, 0.08, 0.85)),
        fuse(tube(cover, [0.045, 0.05, 0.02], [0.10, 0.08, 0.04]), blend=0.015),
        fuse(tube([[0.05, 0.02, 0], [0.24, 0.03, 0]], [0.13, 0.12], [0.11, 0.10]), blend=0.01),
        fuse(
            tube(
                [[0.30, 0.08, 0], [0.34, -0.03, 0], [0.33, -0.12, 0]],
                np.array([0.085, 0.09, 0.05]) * f["head"],
            ),
            blend=0.012,
        ),
        eyes([0.355, 0.085, 0.065], [0.04, 0.05, 0.03]),
        feelers([0.345, 0.10, 0.03], [[0.5 * long, 0.35 * long, 0.12], [long, 0.42 * long, 0.22]], 0.016),
        fuse(*both(hind, shin), blend=0.01),
    ]
    rows = ((0.22, 0.06, 40, 0.26), (0.08, 0.07, 95, 0.26))
    return [*parts, legs(rows, "fly" if pose == "leap" else pose, rng, 0.24, 0.024, 1.3, -0.04)]


def mantis(pose: str, rng: Rng) -> list[Part]:
    """Return a praying mantis: raised breast, folded arms, a head like a triangle."""
    f = factors(rng, 0.12, "neck", "belly", "arms")
    tilt = np.deg2rad(float(rng.uniform(35, 65)))
    top = np.array([0.05, 0.02, 0]) + 0.45 * f["neck"] * np.array([np.cos(tilt), np.sin(tilt), 0])
    reach = 0.32 * f["arms"]
    open_by = 0.09 if pose == "strike" else 0.0
    elbow = top + np.array([0.55 * reach, -0.35 * reach + open_by, 0.10])
    wrist = elbow + np.array([0.35 * reach + 2 * open_by, reach - 1.5 * open_by, 0.02])
    claw = wrist + np.array([0.10 + 2 * open_by, -0.75 * reach + 2.2 * open_by, 0.0])
    arm = [
        tube([by(top, -0.05, -0.06, 0.01), by(top, 0.02, -0.10, 0.06), elbow], [0.04, 0.042, 0.034]),
        tube([elbow, (elbow + wrist) / 2 + np.array([0, 0, 0.02]), wrist], [0.036, 0.055, 0.03]),
        tube([wrist, claw], [0.032, 0.014]),
    ]
    face = top + np.array([0.07, 0.05, 0])
    return [
        fuse(
            ringed(
                [[0.08, 0.02, 0], [-0.25, 0.0, 0], [-0.66, -0.05, 0]],
                np.array([0.06, 0.11, 0.03]) * f["belly"],
                6,
                0.08,
            )
        ),
        fuse(
            tube(
                [[0.05, 0.10, 0], [-0.3, 0.10, 0], [-0.72, 0.0, 0]], [0.03, 0.04, 0.016], [0.06, 0.095, 0.04]
            ),
            blend=0.015,
        ),
        fuse(tube([np.zeros(3), by(top, 0.05, 0.02, 0) / 2, top], [0.055, 0.042, 0.05]), blend=0.02),
        fuse(
            tube([by(face, 0, 0.03, -0.07), face, by(face, 0, 0.03, 0.07)], [0.035, 0.06, 0.035]),
            tube([face, by(face, 0.06, -0.09, 0)], [0.055, 0.02]),
            blend=0.02,
        ),
        eyes(by(face, 0.0, 0.045, 0.095), [0.042, 0.052, 0.042]),
        feelers(by(face, 0.03, 0.05, 0.02), [[0.1, 0.16, 0.06], [0.14, 0.3, 0.14]], 0.015),
        fuse(*both(*arm), blend=0.012),
        legs(((0.04, 0.04, 80, 0.40), (-0.04, 0.04, 128, 0.46)), pose, rng, 0.34, 0.022, 1.28),
    ]
