#!/bin/sh
# Creates a virtual environment and installs the package into it: tools/install.sh VENV EXTRAS
# PYTHON names the interpreter, and TORCH the requirement for PyTorch (by default a version that the tests ran with).
set -eu
venv=$1
extras=${2:-}
python=${PYTHON:-python3}
torch=${TORCH:-torch==2.13.0}

say() { printf '%s\n' "$*" >&2; }

"$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || {
    say "normalgan needs Python 3.11 or newer; '$python' is not. Install one and run: make PYTHON=python3.12 …"
    exit 2
}
if [ ! -x "$venv/bin/python" ]; then
    "$python" -m venv "$venv" || {
        say "Python cannot make virtual environments here. On Debian or Ubuntu: apt-get install python3-venv"
        exit 2
    }
fi

# uv resolves in one second instead of pip's forty, and unpacks in parallel. If it cannot install, for example because
# only pip is configured for a mirror, pip takes over.
"$venv/bin/pip" install --quiet uv || say "uv cannot be installed; pip takes some minutes more."
# Neither compiles the installed modules, since most are never imported: pip would take a minute for PyTorch alone.
with_pip() {
    "$venv/bin/pip" install --no-compile "$@"
}
with_uv() {
    UV_HTTP_RETRIES=1 "$venv/bin/uv" pip install --quiet --python "$venv/bin/python" "$@" 2>/dev/null
}

# PyTorch comes first: without an NVIDIA GPU, its CPU build saves gigabytes of CUDA libraries. uv knows the index with
# those builds; on Linux, pip alone would install the CUDA build.
if ! "$venv/bin/python" -c 'import importlib.metadata as m; m.version("torch")' 2>/dev/null; then
    if [ "$(uname -s)" = Linux ] && ! command -v nvidia-smi >/dev/null 2>&1; then
        say "Installing PyTorch for the CPU …"
        with_uv --torch-backend cpu "$torch" || {
            say "PyTorch's own index of CPU builds cannot be reached; using pip's index instead."
            with_pip "$torch"
        }
    else
        say "Installing PyTorch …"
        with_uv "$torch" || with_pip --quiet "$torch"
    fi
fi
say "Installing normalgan …"
# pyrender requires a PyOpenGL without a wheel; without this flag, older versions of pip print long warnings.
with_uv --editable ".$extras" || with_pip --quiet --use-pep517 --editable ".$extras"
