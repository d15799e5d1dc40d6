"""Commands: their list, one line of help for each, and the module that runs it."""

from normalgan.cli.training.help import COMMANDS as TRAINING

__all__ = ["COMMANDS", "OTHERS", "USAGE"]

USAGE = """\
normalgan: from a line sketch to a surface normal map

Usage: normalgan COMMAND [--config FILE]... [options]

Commands:
  fit        train a generator on rendered meshes
  validate   measure a checkpoint on the validation split
  test       measure a checkpoint on the test split: table, baselines, gallery
  predict    predict normal maps for sketches of your own
  render     only render the training samples to disk
  sketch     draw a mesh from a view, as SVG or PNG
  generate   predict normal maps for drawings with an exported model, without torch
  convert    normal and height maps to another format, direction or kind
  mcp        serve these to assistants as tools (MCP)
  studio     draw, pin normals, light and export in the browser, with an exported model
  export     write a checkpoint as a file for elsewhere: ONNX, safetensors, TorchScript
  benchmark  train and measure the methods of a plan on one split, or a model of yours
  models     list the models that can be loaded by name
  plugins    list the samplers, networks, losses, renderers and line styles there are
  completion print a script by which a shell completes commands and settings

normalgan COMMAND --help lists the options of a command. Configurations repeat: later ones win.
A configuration is a program; with --safe-config it can name known classes only.
"""
OTHERS = {
    "sketch": "normalgan.cli.sketch",
    "generate": "normalgan.cli.generate.command",
    "convert": "normalgan.cli.convert",
    "mcp": "normalgan.cli.mcp_server",
    "studio": "normalgan.studio.command",
    "export": "normalgan.exporting.command",
    "benchmark": "normalgan.benchmark.command",
    "models": "normalgan.cli.models",
    "plugins": "normalgan.cli.plugins",
    "completion": "normalgan.cli.completion",
}
"""The commands that are not the Trainer's, and the module of each, which has a ``run``."""
COMMANDS = (*TRAINING, *OTHERS)
