#!/usr/bin/env bash
# Trains the methods in the benchmark's first table on the embedded animals, and exports them with a card:
# tools/baselines.sh [FOLDER] [PYTHON]
#
# The default FOLDER is build/baselines, where `make release` looks. It takes about half an hour on two cores, at 128
# pixels. The runs stay in runs/baselines; run the command again to continue one that was stopped.
set -euo pipefail
cd "$(dirname "$0")/.."
folder=${1:-build/baselines}
python=${2:-.venv/bin/python}
runs=runs/baselines

"$python" -m normalgan benchmark --config configs/benchmark/embedded.yaml --config configs/cpu.yaml \
    --images 10500 --seeds 0 --rows constant,inflation,pix2pix,sketch2normal,paper,ours -o "$runs"
mkdir -p "$folder"
for row in pix2pix sketch2normal paper ours; do
    best=("$runs/$row"/seed0/checkpoints/[0-9]*.ckpt)
    "$python" -m normalgan export "${best[0]}" -o "$folder/$row.onnx" --half \
        --licence "MIT; trained on procedural shapes of normalgan"
done
{
    cat <<'CARD'
# Baselines of the benchmark

The methods of Table 1, small and trained for minutes on the animals that the package makes, at 128 pixels
(`tools/baselines.sh`). They show how the methods differ at equal cost. To work with drawings, take the model that comes
with the package. Compare your own with them, or train on from one:

```sh
normalgan benchmark --config configs/benchmark/embedded.yaml --set data.size=128 --evaluate paper.onnx
normalgan fit --config paper --config cpu --trainer.callbacks '[{class_path: normalgan.callbacks.StartFrom, init_args: {weights: paper.onnx}}]'
```

Licence: MIT.

CARD
    cat "$runs/table.md"
} >"$folder/README.md"
ls -l "$folder"
