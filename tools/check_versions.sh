#!/usr/bin/env bash
# Runs the quick tests, or those that are named, with the oldest or the newest versions that pyproject.toml allows:
#
#     tools/check_versions.sh lowest-direct|highest [ENVIRONMENT] [TESTS...]
#
# PyTorch is its build for the CPU, of its own index: the tests need no other, and it is a tenth of the size.
# TORCH=torch==2.13.0 takes that version, of uv's usual index; with lowest-direct name the build too, as 2.13.0+cpu.
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

# Warnings fail nowhere: the newest tell what they will drop one day, and the oldest stand on newer libraries, which do.
"$environment/bin/python" -m pytest -m "not slow" -W default "${tests[@]}"
