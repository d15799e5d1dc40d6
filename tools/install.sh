#!/bin/sh
# Makes a virtual environment and installs the package into it: tools/install.sh VENV EXTRAS
# PYTHON names the interpreter; TORCH the requirement for PyTorch (a version that the tests were run with).
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

# uv resolves in a second what takes pip forty, and unpacks in parallel. Where it cannot install, because only pip knows
# of a mirror for example, pip does.
"$venv/bin/pip" install --quiet uv || say "uv cannot be installed; pip takes some minutes more."
# Neither compiles what it installs, as most modules are never imported: pip would take a minute for PyTorch alone.
with_pip() {
    "$venv/bin/pip" install --no-compile "$@"
}
with_uv() {
    UV_HTTP_RETRIES=1 "$venv/bin/uv" pip install --quiet --python "$venv/bin/python" "$@" 2>/dev/null
}

# PyTorch first: where there is no NVIDIA GPU, its build for the CPU saves gigabytes of CUDA libraries. uv knows
# where PyTorch keeps those builds; pip alone would take the one with CUDA on Linux.
if ! "$venv/bin/python" -c 'import importlib.metadata as m; m.version("torch")' 2>/dev/null; then
    if [ "$(uname -s)" = Linux ] && ! command -v nvidia-smi >/dev/null 2>&1; then
        say "Installing PyTorch for the CPU …"
        with_uv --torch-backend cpu "$torch" || {
            say "PyTorch's own index of CPU builds is out of reach; asking pip's index instead."
            with_pip "$torch"
        }
    else
        say "Installing PyTorch …"
        with_uv "$torch" || with_pip --quiet "$torch"
    fi
fi
say "Installing normalgan …"
# pyrender asks for a PyOpenGL that has no wheel; without the flag older pips complain at length.
with_uv --editable ".$extras" || with_pip --quiet --use-pep517 --editable ".$extras"
