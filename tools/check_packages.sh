#!/usr/bin/env bash
# Builds wheel and sdist, checks them, installs each in an empty environment and uses it there:
# tools/check_packages.sh [FOLDER]
set -euo pipefail
cd "$(dirname "$0")/.."

folder=${1:-dist}
python=${PYTHON:-python3}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

rm -rf "$folder"
"$python" -m venv "$work/tools"
"$work/tools/bin/python" -m pip install --quiet 'build>=1.2' 'twine>=6.1' uv onnx numpy
"$work/tools/bin/python" -m build --outdir "$folder"
"$work/tools/bin/python" -m twine check --strict "$folder"/*

# A model that paints a ramp, to try `generate` with: no trained one is needed for that.
(cd tests && "$work/tools/bin/python" -c "
import pathlib, sys, onnx_models
onnx_models.write_model(pathlib.Path(sys.argv[1]))" "$work/ramp.onnx")

for package in "$folder"/*.whl "$folder"/*.tar.gz; do
    echo "== $(basename "$package")"
    environment=$work/$(basename "$package")
    "$python" -m venv "$environment"
    # Named on its own, so that neither the repository nor an index can slip in another.
    "$work/tools/bin/uv" pip install --quiet --python "$environment/bin/python" --torch-backend cpu "$package"
    mkdir "$work/empty"
    (
        cd "$work/empty"
        "$environment/bin/normalgan" --help
        "$environment/bin/normalgan" --version
        "$environment/bin/normalgan" sketch fox-1 -o fox.png --size 256
        "$environment/bin/python" -c '
import normalgan
assert "site-packages" in normalgan.__file__, f"{normalgan.__file__} is not the installed one"'
        "$environment/bin/normalgan" generate fox.png -o maps --model "$work/ramp.onnx"
        test -s maps/fox_normal.png
    )
    rm -rf "$work/empty"
done
echo "wheel and sdist are well."
