"""Fuzzes a reader with atheris: tools/fuzz TARGET [--seconds N] [--corpus FOLDER]."""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

from seeds import READERS, lay_out_seeds

HERE = Path(__file__).parent
TIMEOUT = 60
"""Seconds for one input, that a child of the product's own would have at most too."""
MOST_BYTES = 2**20
"""Of an input; longer seeds are cut. A checkpoint that is cut is none, so most must fit."""


def main() -> int:
    """Fuzz; exit code 1 if anything was found, and the input that shows it lies in the working directory."""
    parser = argparse.ArgumentParser(prog="tools/fuzz", description=__doc__)
    parser.add_argument("target", choices=READERS)
    parser.add_argument("--seconds", type=int, default=600, help="for all of it")
    parser.add_argument("--seed", type=int, default=1, help="of the changes")
    parser.add_argument(
        "--corpus", type=Path, help="a folder to keep what is of interest in, and to go on from"
    )
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="fuzz-") as temporary:
        kept = options.corpus or Path(temporary) / "kept"
        kept.mkdir(parents=True, exist_ok=True)
        seeds = Path(temporary) / "seeds"
        longest = max(path.stat().st_size for path in lay_out_seeds(seeds, options.target))
        script = HERE / f"fuzz_{options.target}.py"
        flags = [f"-max_total_time={options.seconds}", f"-timeout={TIMEOUT}", f"-seed={options.seed}"]
        flags += [f"-max_len={min(longest, MOST_BYTES)}", "-rss_limit_mb=4096", "-print_final_stats=1"]
        return subprocess.call([sys.executable, str(script), "--fuzz", str(kept), str(seeds), *flags])


if __name__ == "__main__":
    sys.exit(main())
