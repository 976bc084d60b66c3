#!/usr/bin/env bash
# The Python packages of these checks, into target/venv. Needs python3 with venv and access to PyPI.
set -euo pipefail
cd "$(dirname "$0")/../../.."
venv="target/venv"
if ! "$venv/bin/python" -c "import can, canopen, cantools, serial" 2>/dev/null; then
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet canopen==2.4.1 python-can==4.6.1 cantools==45.1.0 pyserial==3.5
fi
