"""Writes training pages of the reader as pictures: page_pictures.py VIEWS OUT [--count 128] [--seed 777]."""

import argparse
from itertools import islice
from pathlib import Path

import cv2
import numpy as np
from train import Pages


def main() -> None:
    """Write the first picture of each batch."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("views", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--count", type=int, default=128)
    parser.add_argument("--seed", type=int, default=777)
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    for number, batch in enumerate(islice(Pages(given.views, given.seed), given.count)):
        picture = np.asarray(batch[0][0]).transpose(1, 2, 0)
        cv2.imwrite(str(given.out / f"{number:03}.png"), picture)


if __name__ == "__main__":
    main()
