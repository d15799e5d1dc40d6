#!/usr/bin/env bash
# Builds wheel and sdist, checks them, and tries each in an empty environment:
#
#     tools/check_packages.sh [FOLDER]      FOLDER: where the packages go, by default dist
#
# It uses PyTorch's CPU build from PyTorch's own index, or from uv's usual index if that one cannot be reached.
# TORCH=torch==2.13.0 always takes that version from the usual index.
set -euo pipefail
cd "$(dirname "$0")/.."
here=$PWD

folder=${1:-dist}
python=${PYTHON:-python3}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset PYTHONPATH
rm -rf "$folder"
"$python" -m venv "$work/tools"
"$work/tools/bin/python" -m pip install --quiet 'build>=1.2' 'twine>=6.1' uv
if [ -n "${TORCH:-}" ]; then
    export UV_CONSTRAINT=$work/torch.txt
    echo "$TORCH" >"$UV_CONSTRAINT"
elif UV_HTTP_RETRIES=1 "$work/tools/bin/uv" pip install --quiet --dry-run --no-deps --torch-backend cpu \
    --python "$work/tools/bin/python" torch 2>/dev/null; then
    export UV_TORCH_BACKEND=cpu
else
    echo "PyTorch's own index of CPU builds cannot be reached; using uv's usual index instead." >&2
fi
"$work/tools/bin/python" -m build --outdir "$folder" # the sdist, and the wheel from the sdist
"$work/tools/bin/python" -m twine check --strict "$folder"/*

for package in "$folder"/*.whl "$folder"/*.tar.gz; do
    echo "== $(basename "$package")"
    environment=$work/$(basename "$package")
    "$python" -m venv "$environment"
    # Installed by its path, so that neither the repository nor an index can substitute another package.
    "$work/tools/bin/uv" pip install --quiet --python "$environment/bin/python" "$package[train]"
    "$work/tools/bin/uv" pip check --python "$environment/bin/python"
    mkdir "$work/empty"
    (
        cd "$work/empty"
        normalgan=$environment/bin/normalgan
        "$environment/bin/python" - "$(basename "$package")" <<'CHECK'
import sys
from pathlib import Path
import normalgan
folder = Path(normalgan.__file__).parent
assert folder.is_relative_to(sys.prefix), f"{folder} is not the installed one"
assert sys.argv[1].startswith(f"normalgan-{normalgan.__version__}"), f"{sys.argv[1]} has another version"
for name in ("py.typed", "weights", "studio/page"):
    assert (folder / name).exists(), f"{name} was not packed"
CHECK
        "$normalgan" --help >/dev/null
        "$normalgan" --version
        "$normalgan" plugins --kind renderer | tee plugins.txt
        grep -q '^Nothing was left out' plugins.txt
        "$normalgan" sketch fox-1 -o fox.png --size 256
        "$normalgan" generate fox.png -o maps # with the model that comes along
        test -s maps/fox_normal.png
        "$environment/bin/python" -c "import normalgan; normalgan.load()('fox.png').save('python.png')"
        cmp python.png maps/fox_normal.png
        "$normalgan" fit --config paper --config cpu --print_config | grep -q 'default_root_dir: runs/paper'
        "$normalgan" fit --config "$here/tests/conf/tiny.yaml" --trainer.default_root_dir run
        test -s run/checkpoints/last.ckpt
    )
    rm -rf "$work/empty" "$environment"
done
echo "wheel and sdist work."
