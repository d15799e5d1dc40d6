#!/usr/bin/env bash
# Checks that a third-party package works: builds wheels of normalgan and of examples/normalgan-poisson, installs them
# into a new environment, runs the example's tests, lists its plug-ins, trains with it, and loads its checkpoint.
#
#     tools/check_example.sh [PYTHON]      PYTHON: the interpreter whose environment has torch and the rest
#
# The new environment contains only the two wheels. A .pth file that names PYTHON's site-packages makes PyTorch and
# the other libraries, gigabytes of them, visible. Python does not follow .pth files found there, so an editable
# install of normalgan in PYTHON stays invisible, and the tests use the wheel.
set -euo pipefail
here=$(cd "$(dirname "$0")/.." && pwd)
python=$(command -v "${1:-$here/.venv/bin/python}") || { echo "there is no Python ${1:-.venv/bin/python}" >&2; exit 2; }
python=$(cd "$(dirname "$python")" && pwd)/$(basename "$python") # a link as it is: it tells the environment
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset PYTHONPATH
export PYTHONDONTWRITEBYTECODE=1 PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_NO_INDEX=1

step() { printf '\n== %s\n' "$*"; }

step "building wheels"
cp -r "$here/examples/normalgan-poisson" "$work/example"
for source in "$here" "$work/example"; do
    (cd "$source" && "$python" -m hatchling build -t wheel -d "$work/wheels")
done

step "installing them into an environment of their own"
"$python" -m venv --without-pip "$work/venv"
"$python" -m pip --python "$work/venv" install --quiet --no-deps "$work"/wheels/*.whl
libraries=$("$python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
echo "$libraries" >"$("$work/venv/bin/python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')/libraries.pth"
cd "$work"
"$work/venv/bin/python" - <<'CHECK'
import sys
import normalgan, normalgan_poisson
for package in (normalgan, normalgan_poisson):
    assert package.__file__.startswith(sys.prefix), f"{package.__file__} is not from the wheel"
CHECK

step "its tests"
(cd example && "$work/venv/bin/python" -m pytest -q -p no:cacheprovider)

step "normalgan plugins"
"$work/venv/bin/normalgan" plugins | tee plugins.txt
grep -Eq '^  PoissonHints +normalgan-poisson 0\.1\.0 +Scatters points' plugins.txt
grep -Eq '^  Pebbles +normalgan-poisson 0\.1\.0 +Heaps of round stones' plugins.txt
grep -Eq '^  WorstPicture +normalgan-poisson 0\.1\.0 +The largest mean angular error' plugins.txt
grep -q '^Nothing was left out' plugins.txt

step "a few steps of training with its sampler, its pairs and its metric, named in YAML"
cat >poisson.yaml <<'YAML'
trainer: {default_root_dir: run, max_epochs: 1, limit_train_batches: 3, enable_progress_bar: false}
data:
  batch_size: 4
  source: {class_path: Pebbles, init_args: {count: 10, size: 64, distance: 16}}
model:
  hint_sampler:
    class_path: PoissonHints
    init_args: {distance: 6}
report:
  samples: 1
  metrics: [{class_path: WorstPicture}]
YAML
quickstart=(--config "$here/configs/quickstart.yaml" --config poisson.yaml)
"$work/venv/bin/normalgan" fit "${quickstart[@]}"

step "its checkpoint, tested by the short name"
"$work/venv/bin/normalgan" test "${quickstart[@]}" --model.hint_sampler PoissonHints \
    --model.hint_sampler.distance 6 --ckpt_path run/checkpoints/last.ckpt
grep -q worst_picture run/test/*/metrics.json
"$work/venv/bin/python" - <<'CHECK'
import torch
saved = torch.load("run/checkpoints/last.ckpt", weights_only=True)["hyper_parameters"]["hint_sampler"]
assert saved["class_path"] == "normalgan_poisson.PoissonHints", saved
assert saved["init_args"]["distance"] == 6, saved
CHECK
step "its plan"
(cd example && "$work/venv/bin/normalgan" benchmark --config plan.yaml --rows poisson,uniform --images 16)
grep -q 'hints scattered evenly' example/runs/benchmark/table.md
step "all as it should be"
