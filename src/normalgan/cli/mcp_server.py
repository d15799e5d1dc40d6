"""normalgan mcp: serve the Python API to assistants as Model Context Protocol tools."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from normalgan.cli.parsing.light_parser import LightParser
from normalgan.errors import InputError, did_you_mean, unwritable
from normalgan.files.writing import write_bytes

if TYPE_CHECKING:
    from mcp.server import MCPServer

    from normalgan.inference.normal_map import NormalMap
    from normalgan.inference.predictor import Predictor

_INSTRUCTIONS = (
    "normalgan turns line drawings and sprites into normal maps for lighting in games and 3D programs. "
    "Paths are relative to the folder that the server serves."
)


def run(arguments: list[str]) -> int:
    """Serve over standard input and output until the client disconnects; return the exit code.

    Raises:
        InputError: if the extra is not installed, or a setting is invalid.
    """
    settings = build_parser().parse_args(arguments)
    make_server(Path(settings.root), settings.model).run("stdio")
    return 0


def build_parser() -> LightParser:
    """Return the parser of the command line."""
    parser = LightParser(
        prog="normalgan mcp",
        usage="%(prog)s [--root FOLDER] [--model FILE]",
        description="Serve infer, preview, sheet and explain as MCP tools over standard input and output.",
    )
    parser.add_argument(
        "--root", default=".", help="folder that the tools read from and write to (default %(default)s)"
    )
    parser.add_argument(
        "--model", default="shipped", help="model written by normalgan export (default %(default)s)"
    )
    return parser


def make_server(root: Path, model: str = "shipped") -> "MCPServer[Any]":
    """Return a server whose tools read and write below a folder.

    Raises:
        InputError: if the extra is not installed, or the folder does not exist.
    """
    try:
        from mcp.server import MCPServer
        from mcp.server.mcpserver.exceptions import ToolError
    except ImportError:
        raise InputError("normalgan mcp needs mcp; run `pip install 'normalgan[mcp]'`.") from None
    if not root.is_dir():
        raise InputError(f"there is no folder {root} to serve.")
    import normalgan

    class Server(MCPServer[Any]):
        async def call_tool(self, name: str, arguments: dict[str, Any], context: Any = None) -> Any:
            """Call a tool; refuse unknown arguments, which MCPServer itself would ignore."""
            schemas = {tool.name: tool.input_schema for tool in await self.list_tools()}
            known = schemas[name]["properties"] if name in schemas else arguments
            if unknown := [argument for argument in arguments if argument not in known]:
                hint = did_you_mean(unknown[0], known)
                raise ToolError(f"{name} has no argument {unknown[0]}.{hint} Known: {', '.join(known)}.")
            return await super().call_tool(name, arguments, context)

    tools = Tools(root.resolve(), model)
    server = Server("normalgan", instructions=_INSTRUCTIONS, version=normalgan.__version__)
    for tool in (tools.infer, tools.preview, tools.sheet, tools.explain):
        server.tool()(tool)
    return server


@dataclass
class Tools:
    """The tools of the server; assistants see their docstrings and annotations.

    Args:
        root: folder that the tools read from and write to.
        model: path of a model, or ``shipped``.
    """

    root: Path
    model: str = "shipped"
    _predictor: "Predictor | None" = None

    def infer(
        self,
        drawing: str,
        output: str,
        hints: list[dict[str, Any]] | None = None,
        mask: str | None = None,
        size: int | None = None,
        green: Literal["up", "down"] = "up",
        bits: Literal[8, 16] = 8,
        alpha: bool = False,
        strength: float = 1.0,
        tile: Literal["both", "x", "y"] | None = None,
        detail: float = 0.0,
        pixel_art: bool = False,
        form: str | None = None,
    ) -> dict[str, Any]:
        """Predict the normal map of a line drawing or sprite and write it to a file.

        Args:
            drawing: path of the picture: PNG, JPEG, WebP, TIFF, SVG, PSD, KRA, ORA or Aseprite.
            output: path of the file to write: .png, .exr or .tiff.
            hints: known normals: [{"x": 10, "y": 20, "normal": [0, 0.6, 0.8]}], in pixels from the top left.
            mask: path of a picture that is white on the object, or "outline", "model" or "reader".
            size: longer side of the map in pixels; by default the drawing's.
            green: "up" for OpenGL, Godot, Unity and Blender; "down" for DirectX and Unreal.
            bits: bits per channel of a PNG.
            alpha: whether the object's mask becomes the alpha channel.
            strength: factor applied to the slopes.
            tile: directions in which the drawing repeats.
            detail: strength of the details taken from a sprite's own shading, 0 to 1.
            pixel_art: whether each art pixel of a sprite gets one of 25 normals; outlines are flat.
            form: form of the object, or with tile of each area between the lines: "round", "flat" (a face
                with a bevelled edge) or "hollow", optionally with parameters, as in
                "flat,bevel=0.1,strength=1"; by default as predicted.
        """
        from normalgan.inference.forms import parse_form
        from normalgan.inference.inputs import as_picture
        from normalgan.inference.sprites import Sprite

        with _tool_errors():
            if form is not None and hints:
                raise InputError("form overrides hints; use only one of the two.")
            where, target = self._mask(mask), self._target(output, drawing, mask)
            sprite = Sprite(detail, pixel_art, None if form is None else parse_form(form))
            picture = as_picture(self._inside(drawing), size)
            preds = self._load()(picture, hints, where, size, tile)
            preds = sprite(preds, picture).stronger(strength)
            preds.save(target, bits, green, alpha)
        return self._answer(target, preds)

    def preview(self, drawing: str, output: str | None = None) -> Any:
        """Show a drawing lit from eight directions by its predicted normal map.

        Args:
            drawing: path of the picture.
            output: path of a PNG for the preview; by default none is written.
        """
        from mcp.server.mcpserver import Image
        from PIL import Image as Pictures

        from normalgan.inference.outputs.preview import Preview

        with _tool_errors():
            target = None if output is None else self._target(output, drawing)
            if target is not None and target.suffix.lower() != ".png":
                raise InputError(f"the preview {output} must end in .png.")
            preds = self._load()(self._inside(drawing))
            (content,) = Preview().encode(preds).values()
            if target is not None:
                write_bytes(target, content)
        with Pictures.open(BytesIO(content)) as picture:
            picture.thumbnail((1024, 1024))
            picture.save(small := BytesIO(), "PNG")
        return Image(data=small.getvalue(), format="png")

    def sheet(
        self,
        drawing: str,
        output: str,
        grid: str | None = None,
        atlas: str | None = None,
        green: Literal["up", "down"] = "up",
        alpha: bool = True,
    ) -> dict[str, Any]:
        """Predict the normal map of a sprite sheet, each sprite separately, and write it to a file.

        Args:
            drawing: path of the sheet.
            output: path of the file to write: .png, .exr or .tiff.
            grid: columns x rows, such as "4x3".
            atlas: path of an atlas, such as the JSON of TexturePacker or Aseprite. Without grid and atlas,
                sprites are found by the space between them.
            green: "up" for OpenGL, Godot, Unity and Blender; "down" for DirectX and Unreal.
            alpha: whether the objects' mask becomes the alpha channel.
        """
        from normalgan.inference.composites.packing import Packing
        from normalgan.inference.composites.series import Member
        from normalgan.inference.composites.sheets import predict_sheet
        from normalgan.inference.reading.drawings import read_pixels
        from normalgan.inference.reading.picture import to_picture

        with _tool_errors():
            path, target = self._inside(drawing), self._target(output, drawing, atlas)
            if grid is not None and atlas is not None:
                raise InputError("grid and atlas both give the positions of the sprites; use only one.")
            split = "auto" if grid is None and atlas is None else None
            packing = Packing(grid, split, None if atlas is None else str(self._inside(atlas)))
            pixels = read_pixels(path)
            found = packing.cells(pixels, path)
            page = Member(to_picture(pixels))
            preds = predict_sheet(self._load(), pixels, found.cells, page, said=found.warnings)
            preds.save(target, 8, green, alpha)
        return self._answer(target, preds) | {"sprites": len(found.cells)}

    def explain(self, drawing: str, output: str, mask: str | None = None) -> dict[str, Any]:
        """Show how the mask of a drawing is found: write a picture of each stage to a folder.

        The stages are input, ink, outline, regions with the reader's votes, presence and mask. If the mask
        was given or is the drawing's opacity, there is no outline, region or presence.

        Args:
            drawing: path of the picture.
            output: path of the folder to write to.
            mask: path of a picture that is white on the object, or "outline", "model" or "reader".
        """
        from normalgan.inference.inputs import as_picture, prepare_any
        from normalgan.inference.outputs.explanation import STAGES, write_explanation
        from normalgan.inference.pipeline import predict

        with _tool_errors():
            where = self._mask(mask)
            path, folder, predictor = self._inside(drawing), self._inside(output), self._load()
            picture, backend = as_picture(path), predictor.backend
            prepared = prepare_any(picture, predictor.size, mask=where, line_widths=backend.line_widths)
            preds = predict(backend, prepared, predictor.upsample)
            write_explanation(folder, path.stem, picture, prepared, preds)
        names = [f"{path.stem}_{number}_{stage}.png" for number, stage in enumerate(STAGES, 1)]
        written = {name: folder / name for name in names if (folder / name).is_file()}
        return {
            "files": [str(each.relative_to(self.root)) for each in written.values()],
            "object_share": round(float(preds.mask.mean()), 3),
            "warning": preds.warning,
        }

    def _load(self) -> "Predictor":
        from normalgan.inference.load import load

        if self._predictor is None:
            self._predictor = load(self.model)
        return self._predictor

    def _inside(self, name: str) -> Path:
        """Return the path of a file below the root.

        Raises:
            InputError: if the file lies outside the root, or the name is not a valid file name.
        """
        try:
            path = (self.root / name).resolve()
        except (ValueError, OSError):  # a null byte, or a loop of links
            raise InputError(f"{name!r} is not the name of a file.") from None
        if not path.is_relative_to(self.root):
            raise InputError(f"{name} lies outside {self.root}; name a file in that folder.")
        return path

    def _target(self, output: str, *inputs: str | None) -> Path:
        """Return the path of an output file below the root.

        Raises:
            InputError: if the file lies outside the root, or is one of the inputs.
        """
        target = self._inside(output)
        if target in [self._inside(each) for each in inputs if each is not None]:
            raise InputError(f"{output} is an input and would be overwritten; give another output.")
        return target

    def _mask(self, mask: str | None) -> str | None:
        """Return a mask source unchanged, or the path of a mask below the root."""
        from normalgan.inference.mask.mask_files import SOURCES

        return mask if mask is None or mask in SOURCES else str(self._inside(mask))

    def _answer(self, target: Path, preds: "NormalMap") -> dict[str, Any]:
        height, width = preds.mask.shape
        return {
            "file": str(target.relative_to(self.root)),
            "width": width,
            "height": height,
            "object_share": round(float(preds.mask.mean()), 3),
            "warning": preds.warning,
        }


@contextmanager
def _tool_errors() -> Iterator[None]:
    """Convert errors that a user can act on to protocol errors."""
    from mcp.server.mcpserver.exceptions import ToolError

    try:
        yield
    except OSError as error:
        raise ToolError(
            str(unwritable(f"{error.filename} cannot be written: {error.strerror}.", error))
        ) from error
    except InputError as error:
        raise ToolError(str(error)) from error
