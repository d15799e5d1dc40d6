"""Makes a picture of a benchmark's report small enough for the docs, in few colours that stay as they are.

tools/benchmark_picture.py runs/benchmark/gallery.png docs/pictures/benchmark_gallery.png [COLOURS [SCALE]]
"""

import sys

from PIL import Image


def main(source: str, target: str, colours: str = "256", scale: str = "1") -> None:
    """Write the picture with a palette; without dithering, as normals and errors are read by their colour."""
    picture = Image.open(source).convert("RGB")
    if scale != "1":
        width, height = (round(side * float(scale)) for side in picture.size)
        picture = picture.resize((width, height), Image.Resampling.LANCZOS)
    picture.quantize(int(colours), dither=Image.Dither.NONE).save(target, optimize=True)


if __name__ == "__main__":
    main(*sys.argv[1:5])
