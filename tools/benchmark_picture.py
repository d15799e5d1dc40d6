"""Makes a picture of a benchmark's report small enough for the docs, in few colours that stay as they are.

tools/benchmark_picture.py runs/benchmark/gallery.png docs/pictures/benchmark_gallery.png [COLOURS [SCALE]]
"""

import sys

from PIL import Image, ImageOps


def main(source: str, target: str, colours: int = 256, scale: float = 1) -> None:
    """Write the picture with a palette; without dithering, as normals and errors are read by their colour."""
    picture = ImageOps.scale(Image.open(source).convert("RGB"), scale, Image.Resampling.LANCZOS)
    picture.quantize(colours, dither=Image.Dither.NONE).save(target, optimize=True)


if __name__ == "__main__":
    main(*sys.argv[1:3], *map(int, sys.argv[3:4]), *map(float, sys.argv[4:5]))
