#!/usr/bin/env bash
# Runs the quick tests with the oldest or the newest versions that pyproject.toml allows:
# tools/check_versions.sh lowest-direct|highest [ENVIRONMENT]
set -euo pipefail
cd "$(dirname "$0")/.."

resolution=${1:?usage: tools/check_versions.sh lowest-direct|highest [ENVIRONMENT]}
environment=${2:-.venv-$resolution}
python=${PYTHON:-python3}

"$python" -m venv "$environment"
"$environment/bin/python" -m pip install --quiet uv
# PyTorch for the CPU: the tests need no other, and it is a tenth of the size.
"$environment/bin/uv" pip install --python "$environment/bin/python" --torch-backend cpu \
    --resolution "$resolution" --editable '.[dev]'
"$environment/bin/uv" pip list --python "$environment/bin/python"

options=(-m "not slow")
if [ "$resolution" = highest ]; then
    # What a library will drop one day is told here and fails nowhere: CI must not break by itself.
    options+=(-W default)
fi
"$environment/bin/python" -m pytest "${options[@]}"
