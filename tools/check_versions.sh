#!/usr/bin/env bash
# Runs the quick tests, or the given ones, with the oldest or the newest versions that pyproject.toml allows:
#
#     tools/check_versions.sh lowest-direct|highest [ENVIRONMENT] [TESTS...]
#
# It uses PyTorch's CPU build from PyTorch's own index, which suffices for the tests at a tenth of the size.
# TORCH=torch==2.13.0 takes that version from uv's usual index; with lowest-direct give the build too, as in 2.13.0+cpu.
set -euo pipefail
cd "$(dirname "$0")/.."

resolution=${1:?usage: tools/check_versions.sh lowest-direct|highest [ENVIRONMENT] [TESTS...]}
environment=${2:-.venv-$resolution}
tests=("${@:3}")
python=${PYTHON:-python3}

"$python" -m venv --clear "$environment"
if [ -n "${TORCH:-}" ]; then
    export UV_CONSTRAINT=$environment/torch.txt
    echo "$TORCH" >"$UV_CONSTRAINT"
else
    export UV_TORCH_BACKEND=cpu
fi
"$environment/bin/python" -m pip install --quiet uv
"$environment/bin/uv" pip install --python "$environment/bin/python" \
    --resolution "$resolution" --editable '.[dev]'
"$environment/bin/uv" pip list --python "$environment/bin/python"

# Warnings are not errors here: the newest versions announce removals, and the oldest run on newer libraries that do so.
"$environment/bin/python" -m pytest -m "not slow" -W default "${tests[@]}"
