#!/usr/bin/env bash
# Runs the doctests and the numeric tests as if on other processors. PyTorch, oneDNN and OpenBLAS choose their code by the
# processor's instructions, so the last bits of results differ; no test may depend on them.
#
#     tools/check_processors.sh [PYTHON] [old|avx2]      old: without AVX, like the first 64-bit processors; avx2: with AVX2
set -euo pipefail
cd "$(dirname "$0")/.."
python=${1:-.venv/bin/python}
case ${2:-old} in
    old) export ATEN_CPU_CAPABILITY=default DNNL_MAX_CPU_ISA=SSE41 OPENBLAS_CORETYPE=Prescott ;;
    avx2) export ATEN_CPU_CAPABILITY=avx2 DNNL_MAX_CPU_ISA=AVX2 OPENBLAS_CORETYPE=Haswell ;;
    *) echo "unknown processor '$2': use old or avx2" >&2; exit 2 ;;
esac
exec "$python" -m pytest -q --numprocesses=logical --maxprocesses=4 --dist=loadfile -m "not slow" \
    src tests/inference tests/metrics tests/models tests/losses tests/hints
