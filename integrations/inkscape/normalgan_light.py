#!/usr/bin/env python3
"""Extension for Inkscape: puts the drawing's normal map below it as a picture lit by an SVG filter."""

import base64
import math
import tempfile
from argparse import ArgumentParser
from pathlib import Path

import inkex
from inkex.command import inkscape
from lxml import etree
from normalgan_command import CommandError, predict

LAYER = "normalgan"


class NormalMapAndLight(inkex.EffectExtension):
    """Renders the page, has its normal map predicted, and inserts the map on a layer below the drawing.

    The light is a filter on the picture: the product of a normal and a direction is a weighted sum of
    channels, which feColorMatrix computes. So the light stays editable, and any SVG viewer shows it.
    """

    def add_arguments(self, pars: ArgumentParser) -> None:
        """Declare the settings of the dialogue."""
        pars.add_argument("--show", choices=["lit", "map"], default="lit")
        pars.add_argument("--azimuth", type=float, default=120)
        pars.add_argument("--elevation", type=float, default=40)
        pars.add_argument("--ambient", type=float, default=0.25)
        pars.add_argument("--colour", type=inkex.Color, default=inkex.Color("#d9a066"))
        pars.add_argument("--form", choices=["predicted", "round", "flat", "hollow"], default="predicted")
        pars.add_argument("--size", type=int, default=1024)
        pars.add_argument("--command", default="")

    def effect(self) -> None:
        """Insert the picture, or report in one sentence why there is none."""
        for former in self.svg.xpath(f"//svg:g[@inkscape:label='{LAYER}']"):
            former.delete()
        try:
            picture, warned = self.predicted()
        except CommandError as error:
            raise inkex.AbortExtension(str(error)) from error
        if warned:
            inkex.errormsg(warned)
        left, top, width, height = self.svg.get_viewbox()
        if not width or not height:
            left, top, width, height = 0, 0, self.svg.viewport_width, self.svg.viewport_height
        image = inkex.Image()
        image.update(
            x=str(left), y=str(top), width=str(width), height=str(height), preserveAspectRatio="none"
        )
        image.set("xlink:href", "data:image/png;base64," + base64.b64encode(picture).decode("ascii"))
        if self.options.show == "lit":
            image.style["filter"] = self.light().get_id(as_url=2)
        layer = inkex.Layer.new(LAYER)
        layer.append(image)
        first = next(
            (i for i, child in enumerate(self.svg) if isinstance(child, inkex.ShapeElement)), len(self.svg)
        )
        self.svg.insert(first, layer)

    def predicted(self) -> tuple[bytes, str]:
        """Return the map of the page as PNG, and the command's warnings."""
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            page, drawn, output = folder / "page.svg", folder / "drawing.png", folder / "map.png"
            self.document.write(str(page))
            wide = self.svg.viewport_width >= self.svg.viewport_height
            size = {"export_width" if wide else "export_height": str(self.options.size)}
            inkscape(str(page), export_type="png", export_filename=str(drawn), export_area_page=True, **size)
            # For an empty path, the dialogue gives the folder of the document.
            chosen = "" if Path(self.options.command).is_dir() else self.options.command
            form = self.options.form
            formed = () if form == "predicted" else ("--form", form)
            warned = predict(drawn, output, "--alpha", *formed, chosen=chosen)
            return output.read_bytes(), warned

    def light(self) -> inkex.Filter:
        """Return the filter that lights a normal map."""
        azimuth, elevation = math.radians(self.options.azimuth), math.radians(self.options.elevation)
        x, y = (math.cos(elevation) * part(azimuth) for part in (math.cos, math.sin))
        z = math.sin(elevation)
        row = f"{2 * x:.5f} {2 * y:.5f} {2 * z:.5f} 0 {-(x + y + z):.5f}"  # channels are (n + 1) / 2
        light = self.svg.defs.add(inkex.Filter())
        light.set_random_id("light")
        light.set("color-interpolation-filters", "sRGB")  # the channels are numbers, not colours
        light.update(x="0", y="0", width="1", height="1")
        light.add_primitive("feColorMatrix", type="matrix", values=f"{row} {row} {row} 0 0 0 1 0")
        shades = light.add_primitive("feComponentTransfer")
        for name, value in zip("RGB", self.options.colour.to_rgb(), strict=True):
            least = value / 255 * self.options.ambient
            line = {"type": "linear", "slope": f"{value / 255 - least:.5f}", "intercept": f"{least:.5f}"}
            etree.SubElement(shades, inkex.addNS(f"feFunc{name}", "svg"), line)
        return light


if __name__ == "__main__":
    NormalMapAndLight().run()
