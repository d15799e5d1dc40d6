"""Commands: the list of all commands, their one-line help, and the modules that run them."""

from normalgan.cli.training.help import COMMANDS as TRAINING

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
  convert    convert normal and height maps between formats, conventions and kinds
  mcp        serve predictions to assistants as tools (MCP)
  studio     draw, pin normals, light and export in the browser
  export     export a checkpoint as ONNX, safetensors or TorchScript
  benchmark  train and measure the methods of a plan, or your own model, on one split
  models     list the models that can be loaded by name
  plugins    list all samplers, networks, losses, renderers and line styles
  completion print a completion script for a shell

normalgan COMMAND --help lists the options of a command. Configurations repeat: later ones win.
A configuration can run any code; with --safe-config it can only name known classes.
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
"""The commands that do not use the Trainer, and the modules whose ``run`` function runs them."""
COMMANDS = (*TRAINING, *OTHERS)
